"""What forgetting does to the history of what people said: no undo brings back what was forgotten.

A correction that concerns nothing which is left goes; one that concerns something else too stays
as a constraint, without the records that it replaced.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field, replace
from typing import Any

from d3a.constraints import (
    HISTORY,
    Correction,
    History,
    forgetting,
    history_meta,
    latest,
    with_records,
)
from d3a.constraints import removed as removed_parts
from d3a.store.base import Store


@dataclass(frozen=True, slots=True)
class Said:
    """The meta entries to write, pictures that only an undo needed, and those it still needs."""

    meta: dict[str, Any] = field(default_factory=dict)
    lost_pictures: frozenset[str] = frozenset()
    kept_pictures: frozenset[str] = frozenset()


def history_without(
    store: Store, touched: Collection[str], gone: Collection[str], words: Collection[str]
) -> Said:
    """Return what becomes of the history when something of objects is forgotten.

    touched: ids that lose anything; gone: those that go altogether; words: categories of which
    nothing is left.
    """
    history = History.read(store)
    every = (*history.entries, *history.undone)
    if not every or not touched:
        return Said(kept_pictures=frozenset(history.pictures()))
    hit = [each for each in every if _mentions(store, each, touched)]
    meta = forgetting(store, touched)
    kept = History.of_json(meta[HISTORY]) if HISTORY in meta else history
    kept = latest(kept, [_sealed(each) for each in hit if not each.ids() & set(touched)])
    for each in hit:
        meta |= removed_parts(each)
    ids = sorted(set().union(*(each.ids() for each in hit)))
    left = {r.object_id for r in store.objects(ids=ids, embeddings=False)} - set(gone)
    numbers = {each.number for each in hit if not each.ids() & left}
    kept = replace(kept, entries=_alive(kept.entries, numbers, words))
    kept = replace(kept, undone=_alive(kept.undone, numbers, words))
    return Said(
        meta | history_meta(kept),
        frozenset(history.pictures() - kept.pictures()),
        frozenset(kept.pictures()),
    )


def _sealed(correction: Correction) -> Correction:
    """Return a correction that holds and cannot be undone."""
    arguments = correction.arguments | {"parts": 0, "sealed": True}
    return replace(correction, arguments=arguments, lost=())


def _mentions(store: Store, correction: Correction, touched: Collection[str]) -> bool:
    """Whether a correction concerns an object, or what it replaced tells of having met one."""
    if correction.ids() & set(touched):
        return True
    told = with_records(store, correction)
    portions = (portion for portion in (told.before, told.after, told.undoing) if portion)
    met = {name for portion in portions for key in portion.encounters for name in key[:2]}
    return bool(met & set(touched))


def _alive(
    corrections: tuple[Correction, ...], dead: set[int], words: Collection[str]
) -> tuple[Correction, ...]:
    return tuple(_plain(each, words) for each in corrections if each.number not in dead)


def _plain(correction: Correction, words: Collection[str]) -> Correction:
    """Return a correction without categories of which nothing is left."""
    called = correction.arguments.get("categories")
    if not called or not set(called) & set(words):
        return correction
    rest = [name for name in called if name not in words]
    return replace(correction, arguments=correction.arguments | {"categories": rest})
