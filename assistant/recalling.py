"""What was taught, said back: the lessons that hold, and what an undo took back."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime

from assistant.asking import ask_query
from assistant.english import listed, plural
from assistant.own_words import said_back
from assistant.phrases import kind_of, whose
from assistant.wording import place_words
from d3a.answer import RankedKeyframe
from d3a.constraints import Correction
from d3a.store.base import Store
from d3a.teaching import history
from grammar import vocabulary
from grammar.forms import FormalQuery, ObjectTerm

Name = tuple[str, str | None]
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
            gained, lost = _gained_and_lost(done)
            names = _names(done, gained or lost)
            return f"{_is(store, said['ids'][0], now)}{'' if gained else ' not'} {names}"
        case "deny":
            denied = _names(done, [(said["word"], said["owner"])])
            return f"{_is(store, said['ids'][0], now)} not {denied}"
        case "merge":
            return f"{_is(store, said['kept'], now)} the same as another that I saw"
        case "split":
            other = "elsewhere" if said.get("from_ms") is None else "there before"
            return f"{_is(store, said['new'], now)} not the same as what I saw {other}"
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
            new = [f"“{name}”" for name in after if name not in before]
            gone = f"{listed(new)} is no place any more" if new else ""
            return f"I have undone that: {' and '.join(p for p in (gone, back) if p)}."
        case "teach":
            gained, lost = _gained_and_lost(done)
            how = "no longer" if gained else "again"
            return f"I have undone that: I know it {how} as {_names(done, gained or lost)}."
        case "deny":
            denied = _names(done, [(said["word"], said["owner"])])
            return f"I have undone that: it may be {denied} again."
        case "look":
            return "I have undone that: I no longer know what was in the box."
        case _:
            return f"I have undone that: {done.said}."


def _gained_and_lost(done: Correction) -> tuple[list[Name], list[Name]]:
    """Return the names, each with its owner, that a thing got by a lesson, and those it lost."""
    before, after = (
        [(word, owner) for word, owner in done.arguments[k]] for k in ("before", "after")
    )
    return [n for n in after if n not in before], [n for n in before if n not in after]


def _names(done: Correction, names: Sequence[Name]) -> str:
    """Return the names of a lesson as they were heard: “your keys”, “Anna's key”, “Excalibur”.

    What was taught on a command line with its owner apart, as the store has it: “your key”.
    """
    heard = done.arguments.get("heard")
    if heard:
        return f"“{said_back(heard, names[0][0])}”"
    return listed([f"“{f'{whose(owner)} ' if owner else ''}{word}”" for word, owner in names])


def row_name(row: RankedKeyframe) -> str:
    """Return a row in words: the key (kitchen, by the table)."""
    return f"the {kind_of(row)} ({place_words(row)})"
