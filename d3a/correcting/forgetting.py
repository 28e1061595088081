"""Forgetting: what a person wants out of the memory, found and removed without a rest.

Objects, their stays, sightings, encounters, pictures and looks go together, in one batch that is
put on the disk at once; then the store is scrubbed, so that no byte is left in its files. What the
memory keeps of it is that something was forgotten, so that no answer says "never" of it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from d3a.answering.match import Lexicon
from d3a.constraints import HISTORY, SAID
from d3a.correcting.forgotten import UNSCRUBBED, Removal, Selection, removal_of
from d3a.correcting.forgotten_history import history_without
from d3a.correcting.forgotten_pictures import Pictures, pictures_of
from d3a.emptied import Emptied, emptied
from d3a.ledger import encounter_key
from d3a.model import BadInput, Json
from d3a.store.base import FORGOTTEN, Batch, Expected, Store, StoreConflict

PERSON = "person"


@dataclass(frozen=True, slots=True)
class Lost:
    """One object of a plan: how many of its places and intervals go, and whether it goes itself."""

    object_id: str
    category: str
    names: tuple[str, ...]
    places: int
    intervals: int
    whole: bool
    first_ms: int
    last_ms: int

    def to_json(self) -> Json:
        """Return the object's line of a plan."""
        return {
            "object_id": self.object_id,
            "category": self.category,
            "names": list(self.names),
            "places": self.places,
            "intervals": self.intervals,
            "whole": self.whole,
        }


@dataclass(frozen=True, slots=True)
class ForgetPlan:
    """Exactly what will go. bytes: of the pictures and looks in it.

    shortened: intervals of which a part stays. encounters: what was seen together. also_shown:
    pictures in `keyframes` that are the proof of other things, which lose them. is_empty: nothing
    would change.
    """

    selection: Selection
    batch: Batch = field(repr=False)
    lost: tuple[Lost, ...]
    objects: int
    places: int
    intervals: int
    shortened: int
    encounters: int
    views: int
    keyframes: int
    also_shown: int
    bytes: int
    is_empty: bool

    def to_json(self) -> Json:
        """Return the counts, and a record per object."""
        names = ("objects", "places", "intervals", "shortened", "encounters", "views")
        counted = {name: getattr(self, name) for name in (*names, "keyframes", "also_shown")}
        return {**counted, "bytes": self.bytes, "lost": [each.to_json() for each in self.lost]}


def plan_forgetting(store: Store, selection: Selection) -> ForgetPlan:
    """Find what a selection takes; nothing is written. Raises BadInput for no condition."""
    if selection.is_everything:
        raise BadInput("nothing says what to forget: name a thing, a place, a time or people")
    with store.moment():
        return _planned(store, selection)


def _planned(store: Store, selection: Selection) -> ForgetPlan:
    expected = Expected(
        {key: store.meta(key) for key in (FORGOTTEN, HISTORY, SAID)}, tuple(store.recordings())
    )
    memory = emptied(store)
    removal = removal_of(memory.ledger, store, selection)
    words = removal.vanished_categories(store, memory.ledger.batch_fields()["removed_objects"])
    said = history_without(store, removal.objects, removal.gone_objects, words)
    pictures = pictures_of(memory, store, removal, said, selection.time)
    batch = _batch(store, memory, removal, pictures, words, expected)
    batch = replace(batch, meta={**batch.meta, **said.meta})
    sizes = [len(picture.jpeg) for key in pictures.gone if (picture := store.keyframe(key))]
    looks = [r.embedding.nbytes for r in removal.gone_objects.values() if r.embedding is not None]
    return ForgetPlan(
        selection=selection,
        batch=batch,
        lost=_lost(removal),
        objects=len(removal.gone_objects),
        places=len(removal.gone_stays),
        intervals=len(removal.gone_sightings),
        shortened=len(removal.shortened),
        encounters=len(removal.gone_encounters),
        views=len(removal.gone_views),
        keyframes=len(sizes),
        also_shown=len(pictures.also_shown),
        bytes=sum(sizes) + sum(looks),
        is_empty=not (removal.objects or removal.gone_views),
    )


@dataclass(frozen=True, slots=True)
class Forgotten:
    """What went. is_anew: another wrote since the plan was shown, so that it was planned anew.

    is_scrubbed: no byte of it is left in the store's files; False: a server frees its own space.
    """

    plan: ForgetPlan
    is_anew: bool
    is_scrubbed: bool


def forget(store: Store, plan: ForgetPlan) -> Forgotten:
    """Carry a plan out, and scrub the store.

    Where an ingest or a person wrote since the plan was made, the same selection is planned again,
    while nobody can write: what they brought of it goes too. An ingest that runs meanwhile writes
    nothing of what it remembers: it ends at its next frame, and goes on from its checkpoint.
    Raises StoreError; where only the scrubbing failed, `finish_scrubbing` does it later.
    """
    is_anew = False
    with store.turn():
        try:
            store.apply(plan.batch)
        except StoreConflict:
            plan, is_anew = plan_forgetting(store, plan.selection), True
            store.apply(plan.batch)
    return Forgotten(plan, is_anew, finish_scrubbing(store))


def finish_scrubbing(store: Store) -> bool:
    """Scrub a store that something was removed from; returns as `Store.scrub`."""
    scrubbed = store.scrub()
    store.apply(Batch(meta={UNSCRUBBED: None}))
    return scrubbed


def people(store: Store, lexicon: Lexicon) -> frozenset[str]:
    """Return the categories of people, as the store spells them: person, and kinds of it."""
    known = {category for category, _ in store.categories()}
    known |= set(store.meta("categories") or ()) | set(store.meta("classes") or ())
    return frozenset(
        category
        for category in known
        if PERSON in (own := lexicon.canonical(category), *lexicon.broader(own))
    )


def _batch(
    store: Store,
    memory: Emptied,
    removal: Removal,
    pictures: Pictures,
    gone_categories: frozenset[str],
    expected: Expected,
) -> Batch:
    """Return the flushed memory's writes, less what goes, with the removals."""
    written = memory.ledger.batch_fields()
    objects = {r.object_id: r for r in written["objects"]} | removal.changed_objects
    stays = {r.key: r for r in written["stays"]} | removal.changed_stays
    sightings = {(*r.stay, r.start_ms): r for r in written["sightings"]}
    sightings = sightings | removal.changed_sightings | pictures.sightings
    encounters = {encounter_key(r): r for r in written["encounters"]} | pictures.encounters
    times = store.meta(FORGOTTEN) or 0
    meta: Json = {FORGOTTEN: times + 1, UNSCRUBBED: True}
    meta[SAID] = (store.meta(SAID) or 0) + 1  # an ingest that runs is to look
    if gone_categories:
        known = store.meta("categories") or ()
        meta["categories"] = [name for name in known if name not in gone_categories]
    return Batch(
        objects=_but(objects, removal.gone_objects),
        stays=_but(stays, removal.gone_stays),
        sightings=_but(sightings, removal.gone_sightings),
        encounters=_but(encounters, removal.gone_encounters),
        views=removal.new_views,
        removed_objects=sorted({*written["removed_objects"], *removal.gone_objects}),
        removed_stays=sorted({*written["removed_stays"], *removal.gone_stays}),
        removed_sightings=sorted({*written["removed_sightings"], *removal.old_keys}),
        removed_encounters=sorted(removal.gone_encounters),
        removed_views=[(r.site, r.recording, r.start_ms) for r in removal.gone_views],
        removed_keyframes=sorted(pictures.gone),
        meta=meta,
        state=memory.state(removal.gone_objects, gone_categories),
        expects=expected,
    )


def _but(records: Mapping[Any, Any], gone: Collection[Any]) -> list[Any]:
    return [record for key, record in sorted(records.items()) if key not in gone]


def _lost(removal: Removal) -> tuple[Lost, ...]:
    """Return what goes of each object, by category, the oldest first."""
    lost = []
    for object_id in removal.touched:
        record = removal.objects[object_id]
        intervals = [s for key, s in removal.gone_sightings.items() if key[0] == object_id]
        intervals += [s for s in removal.shortened if s.object_id == object_id]
        lost.append(
            Lost(
                object_id,
                record.category,
                tuple(name.word for name in record.names),
                places=sum(key[0] == object_id for key in removal.gone_stays),
                intervals=len(intervals),
                whole=object_id in removal.gone_objects,
                first_ms=min((s.start_ms for s in intervals), default=record.first_ms),
                last_ms=max((s.end_ms for s in intervals), default=record.last_ms),
            )
        )
    return tuple(sorted(lost, key=lambda each: (each.category, each.first_ms, each.object_id)))
