"""What of a recording goes in, and what is never stored; done twice it changes nothing."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from d3a.images import decode
from d3a.ingest import ingest
from d3a.ingesting.intake import (
    EVERYTHING,
    GREY,
    IN_OFF_LIMITS,
    NOT_EACH,
    NOT_YET,
    NOWHERE,
    THING_OFF_LIMITS,
    Intake,
    inside,
    off_limits_of,
)
from d3a.model import BadInput
from d3a.parameters import DEFAULT
from d3a.readers.opening import open_source
from d3a.store.base import Batch, Region
from tests.worlds.folders import as_recording, dumped, moments
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import START_MS, detection_line, frame_line, write_recording

OFTEN = DEFAULT.with_changes(checkpoint_frames=3)
BATHROOM = Region("bathroom", ((-1.0, -1.0), (0.35, -1.0), (0.35, 1.0), (-1.0, 1.0)))
"""The first four cameras of the small recording stand in it."""
CASES = {
    "every": Intake(every=2),
    "since": Intake(since_ms=START_MS + 1500),
    "ignore": Intake(ignore=frozenset(["Bowl"])),
    "off limits": Intake(off_limits=(BATHROOM,)),
    "all": Intake(START_MS + 500, 3, frozenset(["cup"]), (BATHROOM,)),
}


def done(folder: Path, intake: Intake) -> OracleStore:
    store = OracleStore()
    ingest(open_source(folder), store, OFTEN, intake=intake)
    return store


@pytest.mark.parametrize("intake", CASES.values(), ids=CASES.keys())
def test_twice_or_in_parts_is_as_once(tmp_path: Path, intake: Intake) -> None:
    folder = as_recording(tmp_path / "r")
    once = done(folder, intake)
    assert dumped(once) != dumped(done(folder, EVERYTHING))
    before = dumped(once)
    assert ingest(open_source(folder), once, OFTEN, intake=intake).already
    assert dumped(once) == before
    parts = OracleStore()
    for _ in range(9):
        ingest(open_source(folder), parts, OFTEN, intake=intake, max_frames=1)
    ingest(open_source(folder), parts, OFTEN, intake=intake)
    assert dumped(parts) == before
    assert parts.check() == []


def test_a_recording_of_which_nothing_goes_in_is_not_called_there_already(tmp_path: Path) -> None:
    nothing = Intake(since_ms=START_MS + 3_600_000)
    store = OracleStore()
    for _ in range(2):
        summary = ingest(open_source(as_recording(tmp_path / "r")), store, OFTEN, intake=nothing)
        assert summary.skipped.counts == {NOT_YET: len(moments())}
        assert not summary.already


def test_a_refusal_names_the_options_as_they_are_said(tmp_path: Path) -> None:
    folder = as_recording(tmp_path / "r")
    store = done(folder, CASES["all"])
    with pytest.raises(BadInput) as refused:
        ingest(open_source(folder), store, OFTEN)
    said = str(refused.value)
    assert "--since 20" in said
    assert "--every 3, not 1" in said
    assert "--ignore cup, not none" in said
    assert "--off-limits bathroom, not none" in said


@pytest.mark.parametrize("intake", CASES.values(), ids=CASES.keys())
@pytest.mark.parametrize("max_frames", [1, None])
def test_other_options_for_a_recording_that_is_there_are_refused(
    tmp_path: Path, intake: Intake, max_frames: int | None
) -> None:
    folder = as_recording(tmp_path / "r")
    for first, second in ((intake, EVERYTHING), (EVERYTHING, intake)):
        store = OracleStore()
        ingest(open_source(folder), store, OFTEN, intake=first, max_frames=max_frames)
        before = dumped(store)
        with pytest.raises(BadInput, match="say the same again"):
            ingest(open_source(folder), store, OFTEN, intake=second)
        assert dumped(store) == before


def test_another_recording_may_be_taken_in_otherwise(tmp_path: Path) -> None:
    store = OracleStore()
    ingest(open_source(as_recording(tmp_path / "r")), store, OFTEN, intake=CASES["every"])
    other = write_recording(
        tmp_path / "b", [frame_line(5)], [detection_line(5)], recording="b", zone="UTC"
    )
    ingest(open_source(other), store, OFTEN)
    ingest(open_source(other), store, OFTEN)
    assert len(store.recordings()) == 2


def test_frames_are_taken_by_their_number_and_time(tmp_path: Path) -> None:
    folder, store = as_recording(tmp_path / "r"), OracleStore()
    intake = Intake(since_ms=START_MS + 1000, every=3)
    summary = ingest(open_source(folder), store, OFTEN, intake=intake)
    assert summary.frames == 2  # numbers 3 and 6
    assert summary.skipped.counts == {NOT_YET: 2, NOT_EACH: 4}
    (record,) = store.recordings()
    assert (record.frames, record.last_frame) == (2, moments()[6].name)


def test_an_ignored_category_leaves_nothing(tmp_path: Path) -> None:
    store = done(as_recording(tmp_path / "r"), Intake(ignore=frozenset(["CUP"])))
    assert {record.category for record in store.objects()} == {"bowl"}
    assert store.meta("categories") == ["bowl"]
    assert store.recordings()[0].skipped == (("ignored: cup", 8),)
    keys = {sighting.image for sighting in store.sightings() if sighting.image}
    assert keys
    for key in keys:
        keyframe = store.keyframe(key)
        assert keyframe is not None
        number = (keyframe.time_ms - START_MS) // 500
        picture = decode(keyframe.jpeg).astype(int)
        assert abs(picture[12:28, 12 + number : 28 + number] - GREY).max() < 16
        assert picture[:, 40:60].std() > 1


def test_an_ignored_thing_is_painted_over(tmp_path: Path) -> None:
    pixels = np.full((48, 64, 3), 200, np.uint8)
    intake = Intake(ignore=frozenset(["person"]))
    kept = intake.painted(pixels, [(10.4, 5.0, 20.2, 15.5)], None, None, None)
    assert (kept[5:16, 10:21] == GREY).all()
    assert (kept[16:] == 200).all()
    assert (pixels == 200).all()


def test_an_off_limits_place_leaves_nothing(tmp_path: Path) -> None:
    folder = as_recording(tmp_path / "r")
    store = OracleStore()
    summary = ingest(open_source(folder), store, OFTEN, intake=CASES["off limits"])
    counts = summary.skipped.counts
    assert counts[IN_OFF_LIMITS] == 4
    assert counts[THING_OFF_LIMITS] > 0
    assert summary.frames == 4
    first_ms = moments()[4].time_ms
    assert all(view.start_ms >= first_ms for view in store.views())
    assert all(sighting.start_ms >= first_ms for sighting in store.sightings())
    assert not any(
        BATHROOM.polygon[0][0] <= stay.position[0] <= 0.35
        for stay in store.stays()
        if stay.position is not None
    )


def test_a_frame_that_does_not_know_where_it_is_may_be_of_it(tmp_path: Path) -> None:
    folder = as_recording(tmp_path / "r", poses=False)
    summary = ingest(open_source(folder), OracleStore(), OFTEN, intake=CASES["off limits"])
    assert summary.skipped.counts == {NOWHERE: 8}
    assert summary.frames == 0


def test_what_depth_puts_off_limits_is_painted_over(tmp_path: Path) -> None:
    folder = as_recording(tmp_path / "r")
    left = Region("left", ((-9.0, -9.0), (0.0, -9.0), (0.0, 9.0), (-9.0, 9.0)))
    behind = tmp_path / "r" / "frames.jsonl"
    rows = [json.loads(line) for line in behind.read_text().splitlines()]
    for row in rows:
        row["pose"] = [0.3, 0, 1, 0, 0, 0, 1]
    behind.write_text("".join(json.dumps(row) + "\n" for row in rows))
    store = done(folder, Intake(off_limits=(left,)))
    keys = {s.image for s in store.sightings() if s.image}
    assert keys
    for key in keys:
        keyframe = store.keyframe(key)
        assert keyframe is not None
        picture = decode(keyframe.jpeg).astype(int)
        # x = 0.3 + (u - 32) / 50 * z, and z is about 2 m: left of u = 24.5 lies off limits
        assert abs(picture[:, :20] - GREY).max() < 16
        assert abs(picture[:, 44:] - GREY).min() > 0 or picture[:, 44:].std() > 1


def test_a_region_is_named_or_drawn(tmp_path: Path) -> None:
    regions = [{"name": "Bath Room", "polygon": [list(c) for c in BATHROOM.polygon]}]
    folder = as_recording(tmp_path / "r")
    facts = json.loads((folder / "recording.json").read_text()) | {"regions": regions}
    (folder / "recording.json").write_text(json.dumps(facts))
    named = done(folder, Intake(off_limits=(off_limits_of("bath room"),)))
    drawn = done(folder, Intake(off_limits=(off_limits_of("-1,-1 0.35,-1 0.35,1 -1,1"),)))
    assert [s.start_ms for s in named.sightings()] == [s.start_ms for s in drawn.sightings()]
    assert named.recordings()[0].frames == 4
    with pytest.raises(BadInput, match="Did you mean Bath Room"):
        done(folder, Intake(off_limits=(off_limits_of("bathroom"),)))
    redrawn = OracleStore()
    redrawn.apply(Batch(regions=[Region("Bath Room", ((5, 5), (6, 5), (6, 6)), "lab")]))
    ingest(
        open_source(folder), redrawn, OFTEN, intake=Intake(off_limits=(Region("bath room", ()),))
    )
    assert redrawn.recordings()[0].frames == 8


def test_a_slip_in_an_ignored_category_is_refused(tmp_path: Path) -> None:
    folder = write_recording(
        tmp_path / "r", [frame_line(0)], [detection_line(0)], classes=["cup", "person"]
    )
    with pytest.raises(BadInput, match="Did you mean person"):
        ingest(
            open_source(folder), OracleStore(), OFTEN, intake=Intake(ignore=frozenset(["persn"]))
        )
    store = OracleStore()
    ingest(open_source(folder), store, OFTEN, intake=Intake(ignore=frozenset(["Person"])))
    assert store.meta("classes") == ["cup"]


@pytest.mark.parametrize("text", ["0,0 1,1", "0,0 1,1 a,b", "0,0 1,1 nan,2"])
def test_a_polygon_needs_three_corners(text: str) -> None:
    with pytest.raises(BadInput, match="three or more"):
        off_limits_of(text)


def test_every_must_be_one_or_more() -> None:
    with pytest.raises(BadInput, match="1 or more"):
        Intake(every=0)


@given(
    x=st.floats(-3, 3).filter(lambda v: abs(abs(v) - 1) > 1e-6),
    y=st.floats(-3, 3).filter(lambda v: abs(abs(v) - 1) > 1e-6),
    turned=st.integers(0, 3),
)
def test_inside_of_a_square_is_what_it_says(x: float, y: float, turned: int) -> None:
    corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
    polygon = (*corners[turned:], *corners[:turned])
    assert bool(inside(polygon, np.array([x]), np.array([y]))[0]) == (abs(x) < 1 and abs(y) < 1)


def test_two_recordings_of_one_name_keep_their_pictures_apart(tmp_path: Path) -> None:
    store = OracleStore()
    first, second = as_recording(tmp_path / "a"), as_recording(tmp_path / "b")
    rows = [json.loads(line) for line in (second / "frames.jsonl").read_text().splitlines()]
    for row in rows:
        row["time"] = row["time"].replace("2020-", "2021-")
    (second / "frames.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    for _ in range(2):
        for folder in (first, second):
            ingest(open_source(folder), store, OFTEN)
    assert [record.name for record in store.recordings()] == ["same", "same (2)"]
    images = {sighting.image for sighting in store.sightings()}
    assert {str(image).partition("/")[0] for image in images} == {"same", "same (2)"}
    assert store.check() == []
