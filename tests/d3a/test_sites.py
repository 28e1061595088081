"""Two homes in one store: what was seen in one is never taken for a thing of the other."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime

import pytest

from assistant.asking import ask
from d3a.answer import Answer
from d3a.answering.places import room_of
from d3a.ingest import ingest
from d3a.model import Frame
from d3a.parameters import PROFILES
from d3a.readers.base import RecordingFacts, Regions
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import ListReader, Thing, circle, rounds

LATER_MS = 3_600_000


def later(frames: list[Frame], ms: int) -> list[Frame]:
    return [replace(f, name=f"{ms}-{f.name}", time_ms=f.time_ms + ms) for f in frames]


def at(site: str, name: str) -> RecordingFacts:
    return RecordingFacts(name, site=site, zone="UTC")


def things() -> list[Thing]:
    places = circle(1.5, 4)
    return [Thing(name, places[n], n) for n, name in enumerate(("cup", "bowl", "book"))]


@pytest.mark.parametrize("profile", ["default", "paper"])
@pytest.mark.parametrize("capacity", [400, 2])
@pytest.mark.parametrize("positions", [True, False], ids=["placed", "placeless"])
def test_the_same_things_of_another_site_are_others(
    profile: str, capacity: int, positions: bool
) -> None:
    parameters = PROFILES[profile].with_changes(stm_capacity=capacity, interval_gap_s=30.0)
    frames = rounds(things(), 40)
    if not positions:
        frames = [
            replace(
                f,
                detections=tuple(replace(d, position=None) for d in f.detections or ()),
                pose=None,
            )
            for f in frames
        ]
    alone, store = OracleStore(), OracleStore()
    ingest(ListReader(frames, at("home", "one")), alone, parameters)
    for n, site in enumerate(("home", "office", "home", "office")):
        reader = ListReader(later(frames, n * LATER_MS), at(site, f"{site}-{n}"))
        ingest(reader, store, parameters)
    by_site = {
        site: {o.object_id for o in store.objects() if o.site == site}
        for site in ("home", "office")
    }
    sites = {o.object_id: o.site for o in store.objects()}
    assert all(sites[stay.object_id] == stay.site for stay in store.stays())
    assert by_site["home"]
    assert by_site["office"]
    assert not by_site["home"] & by_site["office"]
    # each object's sightings are within the recordings of its site
    for sighting in store.sightings():
        recording = (sighting.start_ms - frames[0].time_ms) // LATER_MS
        assert sites[sighting.object_id] == ("home", "office")[recording % 2]
    if positions:  # and the second visit finds what the first saw
        assert len(by_site["home"]) == len(alone.objects())
        assert len(by_site["office"]) == len(by_site["home"])
    assert store.check() == []


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_one_site_is_remembered_as_if_there_were_no_other(profile: str) -> None:
    parameters = PROFILES[profile].with_changes(stm_capacity=2, interval_gap_s=30.0)
    frames = rounds(things(), 40)
    store = OracleStore()
    ingest(ListReader(frames, at("", "unsaid")), store, parameters)
    ingest(ListReader(later(frames, LATER_MS), at("lab", "said")), store, parameters)
    # a recording that does not say its site is of none that is said
    assert {o.site for o in store.objects()} == {"", "lab"}


@pytest.fixture
def two_homes() -> OracleStore:
    """A cup and a table near each other in one site; in the other the table is where a cup is."""
    store = OracleStore()
    cup, table = Thing("cup", (1.5, 0.0, 0.5), 1), Thing("table", (1.5, 0.2, 0.4), 2)
    bowl = Thing("bowl", (1.5, 0.1, 0.5), 3)
    for n, (site, seen) in enumerate((("home", [cup, table]), ("office", [bowl]))):
        facts = replace(
            at(site, site),
            regions=Regions(((f"kitchen of the {site}", ((0, -2), (4, -2), (4, 2), (0, 2))),)),
        )
        frames = later(rounds(seen, 30, missed=0.0), n)  # two robots at one time
        ingest(ListReader(frames, facts), store, PROFILES["default"])
    return store


def asked(store: OracleStore, question: str) -> Answer:
    return ask(store, question, now=datetime(2026, 5, 1, 20, tzinfo=UTC))


def test_questions_are_answered_across_sites(two_homes: OracleStore) -> None:
    for word in ("cup", "bowl"):
        assert asked(two_homes, f"Where is the {word}?").status == "found"


def test_what_is_near_is_of_one_site(two_homes: OracleStore) -> None:
    assert asked(two_homes, "Where is the cup near the table?").status == "found"
    assert asked(two_homes, "Where is the bowl near the table?").status != "found"


def test_a_room_holds_what_is_of_its_site(two_homes: OracleStore) -> None:
    rooms = {
        o.category: room_of(two_homes.regions(), stay.position, stay.site)
        for o in two_homes.objects()
        for stay in two_homes.stays(object_ids=[o.object_id])
    }
    assert rooms["cup"] == rooms["table"] == "kitchen of the home"
    assert rooms["bowl"] == "kitchen of the office"
