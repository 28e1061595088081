"""Records as documents and back, without a server."""

from __future__ import annotations

from d3a.store.base import Encounter
from d3a.store.mongo_documents import encounter_document, encounter_record

BOX = (0.0, 0.0, 10.0, 10.0)
MET = Encounter(
    "a", "b", 0, 1, 5, 9, "f", BOX, BOX, 0.5, "p", 3, "lab", (0.0,) * 7, (0.1, 0.2, 0.3, 0.05)
)


def test_an_encounter_comes_back_as_it_was() -> None:
    assert encounter_record(encounter_document(MET)) == MET


def test_documents_of_the_first_versions_have_not_measured_how_far_things_are_apart() -> None:
    document = encounter_document(MET)
    del document["apart"]
    assert encounter_record(document).apart is None
