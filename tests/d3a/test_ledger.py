"""The ledger reads as the store will after the batch, whatever is put and removed."""

from __future__ import annotations

from dataclasses import dataclass

from hypothesis import given
from hypothesis import strategies as st

from d3a.ledger import Ledger, encounter_key
from d3a.store.base import Area, Batch, Encounter, ObjectRecord, Sighting, StayRecord
from tests.worlds.oracle import OracleStore

IDS = ("o1", "o2", "o3")


@dataclass(frozen=True)
class Write:
    kind: str
    number: int
    place: int
    at: int


writes = st.lists(
    st.builds(
        Write,
        st.sampled_from(["put", "put", "put", "meet", "lose object", "lose stay", "lose sighting"]),
        st.integers(0, 2),
        st.integers(0, 1),
        st.integers(0, 9),
    ),
    max_size=25,
)


def by_key(encounters: list[Encounter]) -> list[Encounter]:
    return sorted(encounters, key=encounter_key)


def write(ledger: Ledger, step: Write) -> None:
    """One write; what refers to nothing is left out, as the tiers never do that."""
    object_id, start = IDS[step.number], step.at * 100
    category = "cup" if step.at % 2 else "bowl"
    if step.kind == "put":
        ledger.put_object(ObjectRecord(object_id, category, 1.0 + step.at, start, start))
        position = (float(step.at), float(step.place), 0.0)
        ledger.put_stay(StayRecord(object_id, step.place, position, start, start, 1.0))
        box = (0.0, 0.0, 1.0, 1.0)
        ledger.put_sighting(Sighting(object_id, step.place, start, start, "f", 0.5, box))
    elif step.kind == "meet":
        known = {stay.key for stay in ledger.stays()}
        a, b = (IDS[0], step.place), (IDS[1 + step.number % 2], step.place)
        if a in known and b in known:
            box = (0.0, 0.0, 1.0, 1.0)
            meeting = Encounter(a[0], b[0], a[1], b[1], start, start, "f", box, box, 0.5)
            ledger.put_encounter(meeting)
    elif step.kind == "lose object":
        ledger.remove_objects({object_id})
    elif step.kind == "lose stay":
        ledger.remove_stay((object_id, step.place))
    else:
        for sighting in ledger.sightings([object_id])[:1]:
            ledger.remove_sighting(sighting)


@given(writes, writes)
def test_reads_are_those_of_the_store_after_the_batch(
    before: list[Write], after: list[Write]
) -> None:
    store = OracleStore()
    ledger = Ledger(store)
    for step in before:
        write(ledger, step)
    store.apply(Batch(**ledger.batch_fields()))
    ledger.clear()
    for step in after:
        write(ledger, step)
    area = Area(2.0, 0.0, 6.0, 0.5)
    read = (
        ledger.objects(),
        ledger.objects(ids=["o1", "o3"]),
        ledger.objects(categories=["cup"]),
        ledger.stays(),
        ledger.stays(object_ids=["o2"]),
        ledger.stays(area=area),
        ledger.sightings(["o1", "o2"]),
        ledger.sightings(["o1", "o3"], 200, 500),
        ledger.encounters("o1"),
        ledger.encounters("o1", with_ids=["o3"]),
        ledger.encounters(None, with_ids=["o3"]),
    )
    store.apply(Batch(**ledger.batch_fields()))
    assert read == (
        store.objects(),
        store.objects(ids=["o1", "o3"]),
        store.objects(categories=["cup"]),
        store.stays(),
        store.stays(object_ids=["o2"]),
        store.stays(area=area),
        store.sightings(object_ids=["o1", "o2"]),
        store.sightings(object_ids=["o1", "o3"], start_ms=200, end_ms=500),
        by_key(store.encounters(object_ids=["o1"])),
        by_key(store.encounters(object_ids=["o1"], with_ids=["o3"])),
        by_key(store.encounters(with_ids=["o3"])),
    )
