"""The `default` profile: the three tiers by likelihood, its memory and what it learns."""
