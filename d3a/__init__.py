"""D3A: frames and poses in, OIc and STc filled, ranked keyframes out. Needs no language.

Start at `d3a.readers` (recordings), `d3a.ingest` (the three tiers), `d3a.store` (both backends)
and `d3a.execute` (answers). Nothing is imported here, so that a command loads only what it uses.
"""
