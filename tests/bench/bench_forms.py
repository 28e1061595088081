"""Time every form of formal query on a large memory, and print the slow ones.

    python -m tests.bench.bench_forms [--places 200000] [--cache DIR] [--slow 500] [--only WORD]

Every question word is asked of a common thing and of anything at all, plainly and in every
relation, with and without a place, a time, a choice of the sightings: some six hundred forms, as
formal queries. `first` is the processor's ms of a form about things of which nothing is known but
landmarks, rooms and colours; `again` of the same once more. A line is printed for each form that
takes longer than --slow ms, at once, and in the end the slow ones by time, with how many forms
take how long. --only: those whose notation holds a word, as `together`.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from itertools import product
from pathlib import Path

import numpy as np

from assistant.asking import ask, ask_query
from d3a.answering.facts import forget
from d3a.store import open_store
from d3a.store.base import Store
from grammar.forms import (
    ANYTHING,
    ASKS,
    RELATION_KINDS,
    SELECTS,
    Ask,
    FormalQuery,
    ObjectTerm,
    Relation,
    RelationKind,
    Select,
    TimeSlice,
)
from tests.bench.bench_scale import filled, folder_of, load, now_of, say

RELATED: tuple[Ask, ...] = ("whether", "where", "when", "what", "count", "how_long", "how_often")
ON_FURNITURE: tuple[RelationKind, ...] = ("on", "under", "in", "above", "near")
CHOSEN: tuple[Select, ...] = ("all", "last")
CUP, THING = ObjectTerm("cup", "cup"), ObjectTerm(ANYTHING, "thing")
BOOK, TABLE = ObjectTerm("book", "book"), ObjectTerm("dining table", "table")
BOTTLE = ObjectTerm("bottle", "bottle")


@dataclass(frozen=True)
class Timed:
    """A form, the processor's ms of the first time and of the next, and its keyframes."""

    query: FormalQuery
    first: float
    again: float
    status: str
    told: int


def main() -> None:
    """Time what the options say."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--places", type=int, default=200_000)
    options.add_argument("--cache", type=Path, help="a folder that keeps the stores")
    options.add_argument("--slow", type=float, default=500.0, metavar="MS")
    options.add_argument("--only", default="", metavar="WORD")
    given = options.parse_args()
    with folder_of(given.cache) as folder:
        path = filled(folder, given.places)
        with closing(open_store(str(path), read_only=True)) as store:
            say(f"{given.places} stays; {load()}")
            now = now_of(store)
            timed = []
            for query in forms(now):
                if given.only in query.formal:
                    timed.append(asked(store, query, now))
                    if timed[-1].first >= given.slow:
                        say(line(timed[-1]))
    report(timed, given.slow)


def forms(now: datetime) -> Iterator[FormalQuery]:
    """Yield every form of query, none twice."""
    known = set()
    for query in (*plain(now), *related(now), *gathered()):
        if query not in known:
            known.add(query)
            yield query


def plain(now: datetime) -> Iterator[FormalQuery]:
    """Yield every question word with every choice of sightings, by place and time."""
    red = replace(CUP, attributes=("red",))
    for term, place, when in product((CUP, red, THING), (None, "kitchen"), (None, a_day(now))):
        for word, select in product(ASKS, SELECTS if term is not red else CHOSEN):
            yield FormalQuery("", "Q1", word, (term,), None, place, when, select)
    for term in (CUP, THING):
        there = FormalQuery("", "Q1", "what", (term,), None, "kitchen", select="last")
        yield replace(there, outside=True)
        yield replace(there, or_places=("bedroom",))


def related(now: datetime) -> Iterator[FormalQuery]:
    """Yield every relation under every question word that it may stand in."""
    for kind, word, select in product(RELATION_KINDS, RELATED, CHOSEN):
        grounds = (BOOK, BOTTLE) if kind == "between" else (BOOK,)
        relation = Relation(kind)
        asked = FormalQuery("", "Q2", word, (CUP, *grounds), relation, select=select)
        yield asked
        yield replace(asked, objects=(THING, *grounds))
        if kind in ON_FURNITURE:
            yield replace(asked, objects=(CUP, TABLE))
            yield replace(asked, objects=(THING, TABLE))
        if select == "all":
            yield replace(asked, relation=Relation(kind, negated=True))
            yield replace(asked, place="kitchen")
            yield replace(asked, time=a_day(now))


def gathered() -> Iterator[FormalQuery]:
    """Yield every question word of several things together."""
    two, together = replace(CUP, quantity=2), Relation("together")
    groups = ((two,), (two, BOOK), (CUP,), (CUP, BOOK, BOTTLE))
    for word, select, objects in product(RELATED, CHOSEN, groups):
        yield FormalQuery("", "Q2", word, objects, together, select=select)


def a_day(now: datetime) -> TimeSlice:
    """Return yesterday."""
    today = now.replace(hour=0, minute=0, second=0, microsecond=0)
    return TimeSlice(today - timedelta(days=1), today)


def asked(store: Store, query: FormalQuery, now: datetime) -> Timed:
    """Ask a form of things that are not known; again where it took long, but not minutes."""
    forget()
    ask(store, "Did you see a red thingamajig?", now=now)  # landmarks, rooms, colours
    spent: list[float] = []
    while not spent or (len(spent) == 1 and 100 < spent[0] < 10_000):
        worked = time.process_time()
        answer = ask_query(store, query, now=now)
        spent.append((time.process_time() - worked) * 1000)
    return Timed(query, spent[0], spent[-1], answer.status, len(answer.keyframes))


def line(one: Timed) -> str:
    """Return a line of the table."""
    said = one.query.formal
    return f"{one.first:9.0f}{one.again:9.0f}{one.told:5} {one.status:10} {said}"


def report(timed: Sequence[Timed], slow: float) -> None:
    """Print the slow ones by time, and how many forms take how long."""
    say(f"\n{'first ms':>9}{'again':>9} told            slower than {slow:.0f} ms; {load()}")
    for one in sorted(timed, key=lambda one: -one.first):
        if one.first >= slow:
            say(line(one))
    first = np.array([one.first for one in timed])
    shares = ", ".join(f"p{p} {np.percentile(first, p):.0f}" for p in (50, 75, 90, 95, 99, 100))
    over = ", ".join(f"{int((first > ms).sum())} over {ms} ms" for ms in (250, 500, 1000, 2000))
    say(f"{len(timed)} forms; {shares} ms; {over}")


if __name__ == "__main__":
    main()
