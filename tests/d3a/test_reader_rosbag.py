"""ROS bags: the same store as the recording they hold, whatever ROS or storage wrote them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from d3a.ingest import IngestSummary, ingest
from d3a.parameters import DEFAULT, PAPER, Parameters
from d3a.readers.opening import open_source

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'd3a[ros]'")

from tests.worlds.bags import KINDS, as_bag
from tests.worlds.folders import as_recording, dumped
from tests.worlds.oracle import OracleStore

NAMED = {"name": "same", "site": "lab"}


def taken(bag: Path, **options: str) -> tuple[IngestSummary, OracleStore]:
    store = OracleStore()
    reader = open_source(bag, zone="UTC", options=NAMED | options)
    return ingest(reader, store, DEFAULT), store


@pytest.mark.parametrize("parameters", [DEFAULT, PAPER], ids=["default", "paper"])
@pytest.mark.parametrize("kind", KINDS)
def test_the_store_is_that_of_the_recording(
    tmp_path: Path, parameters: Parameters, kind: str
) -> None:
    plain, store = OracleStore(), OracleStore()
    folder = as_recording(tmp_path / "r")
    if kind == "ros1":  # the bag names the detector's classes
        facts = json.loads((folder / "recording.json").read_text())
        (folder / "recording.json").write_text(json.dumps(facts | {"classes": ["cup", "bowl"]}))
    ingest(open_source(folder), plain, parameters)
    reader = open_source(as_bag(tmp_path / "b", kind), zone="UTC", options=NAMED)
    assert type(reader).__name__ == "RosbagReader"
    summary = ingest(reader, store, parameters)
    assert summary.skipped.counts == {}
    assert dumped(store) == dumped(plain)
    assert len(store.objects()) == 2
