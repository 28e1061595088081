"""A seeded world of boxes with the paper's statistics: rooms, things, a robot and its sensor.

Nothing here is known to the association: it is read back from a recording, as anybody's is.
"""
