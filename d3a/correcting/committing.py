"""How what a person says gets into a store: read, made and written in one turn of its writers."""

from __future__ import annotations

import difflib
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from d3a.answering.match import squash
from d3a.constraints import SAID, Correction, History, history_meta, packed
from d3a.correcting.corrections import UnknownThing
from d3a.model import BadInput
from d3a.store.base import Batch, Store

Made = tuple[Correction, dict[str, Any]]
"""A correction, and the fields of the batch that carries it out."""


def commit(store: Store, make: Callable[[int], Made]) -> Correction:
    """Write a correction and what it changes in one batch; `make` gets its number."""
    made: list[Correction] = []

    def batch(past: History) -> Batch | None:
        correction, fields = make(past.serial + 1)
        kept, parts = packed(correction)
        made[:] = [kept]
        if correction.number == 0:
            return None
        fresh = replace(past, serial=kept.number, entries=(*past.entries, kept))
        meta = {**fields.pop("meta", {}), **parts, **history_meta(fresh)}
        return Batch(**fields, meta=meta)

    apply_change(store, batch)
    return made[0]


def apply_change(store: Store, make: Callable[[History], Batch | None]) -> None:
    """Apply what `make` reads and makes; nobody writes in between."""
    with store.turn():
        batch = make(History.read(store))
        if batch is not None:
            meta = {**batch.meta, SAID: (store.meta(SAID) or 0) + 1}
            store.apply(replace(batch, meta=meta))


def unknown_object(store: Store, said: str) -> UnknownThing:
    """Return the error for an id that no object has: the nearest ids, or those it is a word for."""
    records = store.objects(embeddings=False)
    word = squash(said)
    meant = [
        r.object_id
        for r in sorted(records, key=lambda r: (-r.weight, r.object_id))
        if word in {squash(r.category), *(squash(n.word) for n in r.names)}
    ]
    ids = [r.object_id for r in records]
    near = tuple((meant or difflib.get_close_matches(said, ids, n=3, cutoff=0.0))[:3])
    hint = f" The nearest are {', '.join(near)}." if near else " The store has no objects."
    return UnknownThing(f"There is no object {said!r}.{hint}", near)


def checked_name(text: str) -> str:
    """Return a name in small letters; raises BadInput where it says nothing."""
    words = " ".join(text.split()).lower()
    if not squash(words):
        raise BadInput(f"{text!r} is no name: it needs a letter or a digit")
    return words
