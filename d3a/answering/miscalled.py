"""What a detector calls a vase once or twice, where a plant that looks the same stands.

A detector's slip has looks, too: "Did you ever see a green vase?" finds the green plant that was
called so twice. A yes that rests on seldom seen things alone is therefore looked at again: what
lies where something else was seen far more often, looks the same, and was never beside it in one
picture, is most likely that thing.
"""

from __future__ import annotations

from collections.abc import Sequence

from d3a.answering.lookalikes import LIKELY, same_look, same_spot, seen_beside
from d3a.answering.match import is_named
from d3a.answering.moments import Entry, Moment
from d3a.answering.run import Run
from d3a.plan import FindObjects
from d3a.store.base import Area, ObjectRecord

SELDOM = 9.0
"""Views, by summed probability: what was seen more often was hardly called wrong each time."""
FAR_MORE = 2.0
"""So many times as often the other thing was seen."""
MOST_ASKED = 16
"""Of so many seldom seen things some are what they are called."""


def without_miscalled(run: Run, moments: list[Moment]) -> list[Moment]:
    """Return the moments; where all that stand rest on seldom seen things, without the miscalled.

    What is miscalled leaves the variables of the run, too. It reads where the things lie and what
    lies around them. Raises StoreError.
    """
    seldom = [_seldom(moment) for moment in run.standing(moments)]
    records = {e.sighting.object_id: e.candidate.record for entries in seldom for e in entries}
    if not all(seldom) or not records or len(records) > MOST_ASKED:
        return moments
    wrong = {name for name in sorted(records) if _is_miscalled(run, records[name])}
    for found in run.found.values():
        found.candidates = {n: c for n, c in found.candidates.items() if n not in wrong}
        found.sightings = [s for s in found.sightings if s.object_id not in wrong]
    return [moment for moment in moments if wrong.isdisjoint(moment.ids)]


def _seldom(moment: Moment) -> Sequence[Entry]:
    """Return the entries whose looks were asked for, of things that were seen seldom."""
    return [
        entry
        for entry in moment.entries
        if entry.candidate.attributes and entry.candidate.record.weight < SELDOM
    ]


def _is_miscalled(run: Run, record: ObjectRecord) -> bool:
    if record.embedding is None or _is_taught(run, record):
        return False
    stays = list(run.facts.stays([record.object_id]).values())
    reach = run.parameters.near_m
    around: set[str] = set()
    for stay in stays:
        if stay.position is None:
            continue
        x, y, _ = stay.position
        near = run.store.stays(area=Area(x - reach, y - reach, x + reach, y + reach))
        around |= {other.object_id for other in near if same_spot(stay, other, run.parameters)}
    others = [
        other
        for other in run.store.objects(ids=sorted(around - {record.object_id}))
        if other.category != record.category
        and other.weight >= FAR_MORE * record.weight
        and same_look(record.embedding, other) >= LIKELY
    ]
    if not others:
        return False
    ids = [other.object_id for other in others]
    return not seen_beside(run.store, record.object_id, ids).issuperset(ids)


def _is_taught(run: Run, record: ObjectRecord) -> bool:
    """Whether a person called the thing by a word that is asked for."""
    return any(isinstance(step, FindObjects) and is_named(record, step) for step in run.steps)
