"""Exports say what the store holds, and a recording comes back from one."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from d3a.exporting import COLUMNS, export
from d3a.images import decode
from d3a.ingest import ingest
from d3a.model import BadInput
from d3a.parameters import PROFILES
from d3a.readers.opening import open_source
from d3a.store import open_store
from d3a.store.base import Batch, Keyframe, ObjectRecord, Sighting, StayRecord, Store, TaughtName
from d3a.store.copy import copy_store
from d3a.teaching import merge
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import ListReader, Thing, circle, jpeg, rounds

ZONE = small_home.ZONE
THINGS = [
    Thing(name, at, n) for n, (name, at) in enumerate(zip("abcd", circle(3.0, 4), strict=True))
]


def filled() -> OracleStore:
    store = OracleStore()
    frames = [replace(f, image=jpeg(n)) for n, f in enumerate(rounds(THINGS, 40, missed=0.1))]
    ingest(ListReader(frames), store, PROFILES["default"])
    return store


def lines(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def test_coco_has_a_box_a_sighting_in_the_pixels_of_its_picture(tmp_path: Path) -> None:
    store = OracleStore()
    small_home.fill(store)
    halved = Keyframe("p1", small_home.jpeg((1, 2, 3)), 640, 360, 1)  # it was taken twice as large
    store.apply(Batch(keyframes=[halved]))
    written = export(store, tmp_path / "coco", "coco", ids=None, zone=ZONE)
    record = json.loads((tmp_path / "coco" / "annotations.json").read_text(encoding="utf-8"))
    assert [c["name"] for c in record["categories"]] == ["bowl", "couch", "cup", "keys"]
    assert written.pictures == len(record["images"]) == 3
    sizes = {}
    for image in record["images"]:
        pixels = decode(tmp_path / "coco" / "images" / image["file_name"])
        assert (image["width"], image["height"]) == (pixels.shape[1], pixels.shape[0])
        sizes[image["id"]] = image
    shown = [s for s in store.sightings() if s.image is not None]
    assert [a["d3a_object"] for a in record["annotations"]] == [s.object_id for s in shown]
    for annotation, sighting in zip(record["annotations"], shown, strict=True):
        assert sizes[annotation["image_id"]]["d3a_image"] == sighting.image
        x, y, width, height = annotation["bbox"]
        scale = 0.5 if sighting.image == "p1" else 1.0
        assert [x, y, x + width, y + height] == [v * scale for v in sighting.box]
        assert annotation["area"] == width * height
        assert annotation["score"] == sighting.probability


def test_csv_has_a_row_a_place_and_no_formula(tmp_path: Path) -> None:
    store = OracleStore()
    small_home.fill(store)
    (bowl,) = store.objects(ids=["bowl-1"])
    nasty = replace(bowl, category="=cmd()", names=(TaughtName("-2+3", "anna"),))
    store.apply(Batch(objects=[nasty]))
    export(store, tmp_path / "out" / "home.csv", "csv", ids=None, zone=ZONE)
    with (tmp_path / "out" / "home.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == COLUMNS
    assert [(r["object_id"], int(r["place"])) for r in rows] == [s.key for s in store.stays()]
    by_id = {r["object_id"]: r for r in rows}
    assert (by_id["bowl-1"]["category"], by_id["bowl-1"]["names"]) == ("'=cmd()", "'-2+3 of anna")
    assert (by_id["bowl-1"]["keyframe"], by_id["bowl-1"]["room"]) == ("p3", "kitchen")
    assert by_id["couch-1"]["keyframe"] == ""
    for row, stay in zip(rows, store.stays(), strict=True):
        assert tuple(float(row[axis]) for axis in "xyz") == stay.position
        assert row["first"].endswith("-05:00")
        assert float(row["probability"]) == 0.8


def test_a_recording_that_was_exported_fills_an_equal_store(tmp_path: Path) -> None:
    store = filled()
    written = export(store, tmp_path / "out", "recording", ids=None, zone=ZONE)
    assert written.to_json()["intervals"] == len(store.sightings())
    again = OracleStore()
    reader = open_source(tmp_path / "out")
    summary = ingest(reader, again, PROFILES["default"])
    assert dict(summary.skipped.counts) == {}
    assert summary.detections == written.intervals
    assert again.meta("zone") == store.meta("zone")

    def things(of: Store) -> list[tuple[str, list[float]]]:
        kinds = {r.object_id: r.category for r in of.objects()}
        placed = [(kinds[s.object_id], list(s.position or ())) for s in of.stays()]
        return sorted(placed)

    assert [kind for kind, _ in things(again)] == [kind for kind, _ in things(store)]
    np.testing.assert_allclose(
        [at for _, at in things(again)], [at for _, at in things(store)], atol=1e-6
    )
    pictures = {Path(key).name for key in again.keyframe_keys()}
    assert pictures == {Path(key).name for key in store.keyframe_keys()} & pictures
    assert pictures
    looks = {r.category: r.embedding for r in store.objects()}
    for record in again.objects():
        was = looks[record.category]
        assert record.embedding is not None
        assert was is not None
        assert float(np.abs(record.embedding - was).max()) < 1e-4


def test_several_recordings_are_folders_and_names_are_never_paths(tmp_path: Path) -> None:
    store = OracleStore()
    small_home.fill(store)
    moved = [
        replace(s, recording=name)
        for s, name in zip(store.sightings(), ["../../etc", "a/b", "", "ü", "x", "x"], strict=True)
    ]
    store.apply(Batch(sightings=moved))
    export(store, tmp_path / "out", "recording", ids=None, zone=ZONE)
    folders = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert folders == ["01-recording", "02-etc", "03-a-b", "04-x", "05-recording"]
    assert sum(len(lines(tmp_path / "out" / f / "detections.jsonl")) for f in folders) == 6
    assert not (tmp_path / "etc").exists()


@pytest.mark.parametrize("format_name", ["coco", "csv", "recording"])
def test_only_what_is_asked_for_is_written(tmp_path: Path, format_name: str) -> None:
    store = OracleStore()
    small_home.fill(store)
    out = tmp_path / "out"
    written = export(store, out, format_name, ids={"keys-1"}, zone=ZONE)
    assert (written.objects, written.places, written.intervals) == (1, 3, 3)
    text = "".join(p.read_text() for p in [out, *out.rglob("*.json*")] if p.is_file())
    assert "keys" in text
    assert "bowl" not in text
    with pytest.raises(BadInput, match="there already"):
        export(store, out, format_name, ids=None, zone=ZONE)


def test_an_empty_store_is_exported_as_nothing(tmp_path: Path) -> None:
    for format_name in ("coco", "csv", "recording"):
        written = export(OracleStore(), tmp_path / format_name, format_name, ids=None, zone=ZONE)
        assert (written.objects, written.pictures) == (0, 0)
    assert len((tmp_path / "csv").read_text().splitlines()) == 1
    assert (tmp_path / "recording" / "frames.jsonl").read_text() == ""


def test_a_copy_over_the_wire_and_back_is_equal(
    tmp_path: Path, new_database: Callable[[str], str]
) -> None:
    with (
        closing(open_store(str(tmp_path / "a.db"))) as first,
        closing(open_store(new_database("double"))) as wire,
        closing(open_store(str(tmp_path / "b.db"))) as last,
    ):
        frames = [replace(f, image=jpeg(n)) for n, f in enumerate(rounds(THINGS, 30))]
        ingest(ListReader(frames), first, PROFILES["default"], max_frames=20)
        merge(first, *sorted(r.object_id for r in first.objects())[:2], force=True)
        first.apply(Batch(meta={"retention": {"seconds": 500}, "a.b": {"ü": [1, None]}}))
        copy_store(first, wire)
        copy_store(wire, last)
        dump = list(first.dump())
        assert {record["kind"] for record in dump} >= {"meta", "state", "keyframe", "encounter"}
        assert list(wire.dump()) == list(last.dump()) == dump
        assert first.state() == last.state()
        looks, matrix = first.embeddings()
        assert last.embeddings()[0] == looks
        assert last.embeddings()[1].tobytes() == matrix.tobytes()
        summary = ingest(ListReader(frames), last, PROFILES["default"])
        assert summary.already_frames == 20, "a copy goes on where its source was"
        assert last.check() == []


def test_a_sighting_without_anything_else_is_exported(tmp_path: Path) -> None:
    store = OracleStore()
    store.apply(
        Batch(
            objects=[ObjectRecord("a", "cup", 1.0, 5, 9)],
            stays=[StayRecord("a", 0, None, 5, 9, 1.0)],
            sightings=[Sighting("a", 0, 5, 9, "f", 0.5, (0, 0, 2, 2))],
        )
    )
    export(store, tmp_path / "out", "recording", ids=None, zone=ZONE)
    (frame,), (found,) = (
        lines(tmp_path / "out/frames.jsonl"),
        lines(tmp_path / "out/detections.jsonl"),
    )
    assert (frame["pose"], frame["image"], found["position"], found["embedding"]) == (None,) * 4
    assert (found["category"], frame["time"]) == ("cup", "1969-12-31T19:00:00.005-05:00")
