"""The questions that a first screen offers: such as this store can answer."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from assistant.lately import lately

if TYPE_CHECKING:
    from assistant.session import Session
    from d3a.store.base import Sighting, Store

OFFERED = 5


def starters(session: Session) -> Iterator[str | None]:
    """Yield questions that this store can answer, one of each kind; None for one it cannot.

    Each step tries one question, so that a person's own may be asked in between. The kinds are
    the paper's (objects, relations, places and times), the last place, and one about a thing that
    was never seen, as the honest no is worth seeing too.
    """
    if session.suggestions:
        yield from session.suggestions[:OFFERED]
        return
    kept: list[str] = []
    for choices in _candidates(session.store):
        for question in choices:
            if question in kept:
                continue
            if session.safely(question, alone=True).status == "found":
                kept.append(question)
                yield question
                break
            yield None


def _candidates(store: Store) -> Iterator[Sequence[str]]:
    """Yield, for each kind of question, some that may be answerable, the likeliest first."""
    recent = lately(store)
    ids = sorted({sighting.object_id for sighting in recent})
    objects = store.objects(ids=ids, embeddings=False)
    category = {thing.object_id: thing.category for thing in objects}
    small = _by_interest(recent, category)
    yield [f"Where {_is(name)} the {name}?" for name in small[:4]]
    pairs = _pairs(store, recent, category)
    yield [f"When were the {a} and the {b} seen together?" for a, b in pairs[:4]]
    yield [f"When did you last see the {name}?" for name in small[1:5]]
    yield [f"How many {name}s did you see?" for name in small[:4] if not name.endswith("s")]
    yield [f"Did you ever see a {name}?" for name in small[2:6] if not name.endswith("s")]


def _is(noun: str) -> str:
    """Return the verb for a category: keys and scissors are many, a glass is one."""
    return "are" if noun.endswith("s") and not noun.endswith("ss") else "is"


def _by_interest(recent: Sequence[Sighting], category: dict[str, str]) -> list[str]:
    """Return categories, things that lay in several places first: those get lost."""
    stays = {(sighting.object_id, sighting.place) for sighting in recent}
    places = Counter(category[thing] for thing, _ in stays if thing in category)
    return sorted(places, key=lambda name: (-places[name], name))


def _pairs(
    store: Store, recent: Sequence[Sighting], category: dict[str, str]
) -> list[tuple[str, str]]:
    """Return pairs of different categories that were seen together, the oftenest first."""
    if not recent:
        return []
    counted: Counter[tuple[str, str]] = Counter()
    ends = max(sighting.end_ms for sighting in recent)
    for met in store.encounters(
        object_ids=list(category),
        with_ids=list(category),
        start_ms=min(sighting.start_ms for sighting in recent),
        end_ms=ends,
    ):
        a, b = category[met.object_a], category[met.object_b]
        if a != b:
            counted[(a, b) if a < b else (b, a)] += met.seen
    return sorted(counted, key=lambda pair: (-counted[pair], pair))
