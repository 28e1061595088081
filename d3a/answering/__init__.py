"""The steps of a plan, taken over a store: nouns, attributes, places, times and relations."""
