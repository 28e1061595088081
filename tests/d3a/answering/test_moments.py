"""What is told of found objects together: their sizes."""

from __future__ import annotations

import math

from d3a.answering.match import Candidate
from d3a.answering.moments import Found, extents
from d3a.store.base import ObjectRecord


def test_what_nothing_measured_is_as_large_as_its_like() -> None:
    table = Found()
    sizes = {"a": (1.5, 0.75), "b": (1.1, 0.85), "c": (1.3, 0.8), "d": None}
    for name, size in sizes.items():
        record = ObjectRecord(name, "table", 1.0, 0, 99, extent_m=size)
        table.candidates[name] = Candidate(record, 1.0)
    lamp = ObjectRecord("lamp", "lamp", 1.0, 0, 99)
    table.candidates["lamp"] = Candidate(lamp, 1.0)
    found = extents(table, ["d", "a", "lamp", "d"]).tolist()
    assert found[:2] == [[1.3, 0.8], [1.5, 0.75]]
    assert found[3] == found[0]
    assert all(math.isnan(side) for side in found[2])
    assert extents(table, []).shape == (0, 2)
