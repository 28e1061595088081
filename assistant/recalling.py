"""What was taught, said back: the lessons that hold, and what an undo took back."""

from __future__ import annotations

from datetime import datetime

from assistant.asking import ask_query
from assistant.english import listed, plural
from assistant.phrases import kind_of, whose
from assistant.wording import place_words
from d3a.answer import RankedKeyframe
from d3a.constraints import Correction
from d3a.store.base import Store
from d3a.teaching import history
from grammar import vocabulary
from grammar.forms import FormalQuery, ObjectTerm

TOLD = 3
"""So many lessons are told, the newest."""


def recalled(store: Store, now: datetime) -> str:
    """Return what people taught that holds, in a sentence. Raises StoreError."""
    past = history(store)
    if not past:
        return "You have taught me nothing yet."
    newest = [_lesson(store, each, now) for each in past[: -TOLD - 1 : -1]]
    more = f", and {len(past) - TOLD} more before" if len(past) > TOLD else ""
    return f"You told me, the newest first: {'; '.join(newest)}{more}."


def _lesson(store: Store, done: Correction, now: datetime) -> str:
    """Return a lesson as a clause that names its thing by where it was last seen, not by an id."""
    said = done.arguments
    match done.kind:
        case "teach":
            gained = [n for n in said["after"] if n not in said["before"]]
            lost = [n for n in said["before"] if n not in said["after"]]
            names = listed([called(word, owner) for word, owner in gained or lost])
            return f"{_is(store, said['ids'][0], now)}{'' if gained else ' not'} {names}"
        case "deny":
            name = called(said["word"], said["owner"])
            return f"{_is(store, said['ids'][0], now)} not {name}"
        case "merge":
            return f"{_is(store, said['kept'], now)} the same as another that I saw"
        case "split":
            return f"{_is(store, said['new'], now)} not the same as what I saw elsewhere"
        case "look":
            return f"{_is(store, said['new'], now)} what you drew a box around"
        case _:
            return done.said


def _is(store: Store, object_id: str, now: datetime) -> str:
    """Return a thing and its verb: "the glasses (kitchen, by the sink) are"."""
    known = store.objects(ids=[object_id], embeddings=False)
    if not known:
        return "a thing that I forgot is"
    kind = vocabulary.canonical(known[0].category)
    verb = "are" if plural(kind) == kind else "is"
    query = FormalQuery(kind, "Q1", "where", (ObjectTerm(kind, kind),))
    rows = ask_query(store, query, now=now).keyframes
    row = next((each for each in rows if each.object_id == object_id), None)
    return f"{row_name(row) if row is not None else f'the {kind}'} {verb}"


def undone_words(done: Correction) -> str:
    """Return what is as it was before, in a sentence."""
    said = done.arguments
    match done.kind:
        case "merge":
            return "I have undone that: I take them for two things again."
        case "split":
            return "I have undone that: I take them for one thing again."
        case "place":
            before, after = ([each["name"] for each in said[k]] for k in ("before", "after"))
            back = f"I know {listed([f'“{n}”' for n in before])} as before" if before else ""
            gone = [f"“{name}”" for name in after if name not in before]
            lost = f"{listed(gone)} is no place any more" if gone else ""
            return f"I have undone that: {' and '.join(p for p in (lost, back) if p)}."
        case "teach":
            gone_names = [n for n in said["after"] if n not in said["before"]]
            names = [called(word, owner) for word, owner in gone_names or said["before"]]
            how = "no longer" if gone_names else "again"
            return f"I have undone that: I know it {how} as {listed(names)}."
        case "deny":
            name = called(said["word"], said["owner"])
            return f"I have undone that: it may be {name} again."
        case "look":
            return "I have undone that: I no longer know what was in the box."
        case _:
            return f"I have undone that: {done.said}."


def called(word: str, owner: str | None) -> str:
    """Return a taught name as it is said back: “your key”, “Anna's key”, “excalibur”."""
    return f"“{word}”" if owner is None else f"“{whose(owner)} {word}”"


def row_name(row: RankedKeyframe) -> str:
    """Return a row in words: the key (kitchen, by the table)."""
    return f"the {kind_of(row)} ({place_words(row)})"
