"""The queries of a world: what is asked, in words, at each precision, and what would be right.

Drawn from what was truly seen, uniformly: never only from what is seen well, unless the reading
of the paper asks for it. The words are a person's; categories and colours are the truth's.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from itertools import islice
from typing import Literal
from zoneinfo import ZoneInfo

import numpy as np

from d3a.truth import Truth

Level = Literal["perfect", "category", "attribute", "any"]
Form = Literal["Q1", "Q2", "Q3"]
LEVELS: tuple[Level, ...] = ("perfect", "category", "attribute", "any")
FORMS: tuple[Form, ...] = ("Q1", "Q2", "Q3")
POSITIVES = 45
NEGATIVES = 5
ATTEMPTS = 100
"""Draws per wanted negative: in a small home nearly everything is seen with everything."""
SLICE = timedelta(minutes=45)


@dataclass(frozen=True, slots=True)
class Question:
    """One query: its targets (true objects), its words at each level, and its time slice.

    alternatives: at each level, how many answers (objects, pairs) fit the words as well as the
    asked one, itself among them: from it comes the ceiling of MRR. negative: nothing fits the
    words at the Attribute level. slice_ms: of Q3, half-open. terms: colour and category of each
    thing asked for, as spoken.
    """

    form: Form
    targets: tuple[int, ...]
    texts: dict[Level, str]
    alternatives: dict[Level, int] = field(default_factory=dict)
    slice_ms: tuple[int, int] | None = None
    negative: bool = False
    terms: tuple[tuple[str, str], ...] = ()


def taught_name(number: int) -> str:
    """Return a word that no vocabulary has, one per true object: what a person could call it."""
    first, second = divmod(number, 20)
    syllables = [c + v for c in "zqxv" for v in "aeiou"]
    return f"{syllables[first % 20]}{syllables[second]}kw{syllables[(7 * number + 3) % 20]}"


def draw(
    truth: Truth,
    zone: ZoneInfo,
    rng: np.random.Generator,
    *,
    count: int = POSITIVES,
    negatives: int = NEGATIVES,
    least: int = 1,
) -> list[Question]:
    """Draw `count` queries of each form about objects seen at least `least` times, and negatives.

    Without replacement while there are enough objects (or pairs), then again. zone: in which
    slices are spoken.
    """
    maker = _Maker(truth, zone, rng, least)
    kinds: tuple[tuple[Callable[[], Question | None], int], ...] = (
        (maker.one, count),
        (maker.pair, count),
        (maker.sliced, count),
        (maker.no_such_object, negatives),
        (maker.no_such_pair, negatives),
        (maker.not_then, negatives),
    )
    questions: list[Question] = []
    for make, wanted in kinds:
        made = (make() for _ in range(ATTEMPTS * wanted))
        questions += islice((one for one in made if one is not None), wanted)
    return questions


class _Deck:
    """Deals its cards in random order, all of them before any again."""

    def __init__(self, cards: Sequence[tuple[int, ...]], rng: np.random.Generator) -> None:
        self._cards, self._rng = list(cards), rng
        self._left: list[tuple[int, ...]] = []

    def deal(self) -> tuple[int, ...] | None:
        if not self._cards:
            return None
        if not self._left:
            self._left = [self._cards[k] for k in self._rng.permutation(len(self._cards))]
        return self._left.pop()


class _Maker:
    """Makes questions of each kind from one truth."""

    def __init__(self, truth: Truth, zone: ZoneInfo, rng: np.random.Generator, least: int) -> None:
        self._truth, self._zone, self._rng = truth, zone, rng
        self._seen = truth.seen()
        asked = truth.seen(least)
        self._frames = _frames(truth)
        self._pairs = sorted(
            {
                (a, b)
                for shown in self._frames.values()
                for a in shown
                for b in shown
                if a < b and truth.objects[a].category != truth.objects[b].category
            }
        )
        self._singles = _Deck([(k,) for k in asked], rng)
        self._slices = _Deck([(k,) for k in asked], rng)
        well = set(asked)
        self._duos = _Deck([p for p in self._pairs if well.issuperset(p)], rng)
        self._kinds = sorted({truth.objects[k].category for k in self._seen})
        self._colours = sorted({one.colour for one in truth.objects})

    def one(self) -> Question | None:
        card = self._singles.deal()
        if card is None:
            return None
        (k,) = card
        return Question(
            "Q1",
            card,
            self._words("Did you ever see {0}?", card, article="a"),
            self._among(self._seen, k),
            terms=self._terms(card),
        )

    def pair(self) -> Question | None:
        card = self._duos.deal()
        if card is None:
            return None
        words = self._words("When were {0} and {1} seen together?", card, article="the")
        return Question("Q2", card, words, self._pairs_like(card), terms=self._terms(card))

    def sliced(self) -> Question | None:
        card = self._slices.deal()
        if card is None:
            return None
        (k,) = card
        row = int(self._rng.choice(self._truth.objects[k].detections))
        start, end = self._slice_around(int(self._truth.time_ms[row]))
        return Question(
            "Q3",
            card,
            self._words(self._where(start, end), card, article="the"),
            self._among(self._seen_between(start, end), k),
            (start, end),
            terms=self._terms(card),
        )

    def no_such_object(self) -> Question | None:
        term = self._absent_term(self._seen)
        if term is None:
            return None
        text = f"Did you ever see {_a(' '.join(term))}?"
        return Question("Q1", (), {"attribute": text}, negative=True, terms=(term,))

    def no_such_pair(self) -> Question | None:
        """Ask for two things that exist in these colours, though none were ever in one frame."""
        a, b = (int(k) for k in self._rng.choice(self._seen, size=2))
        one, other = self._truth.objects[a], self._truth.objects[b]
        together = {(self._term(x), self._term(y)) for p in self._pairs for x, y in (p, p[::-1])}
        terms = (self._term(a), self._term(b))
        if one.category == other.category or terms in together:
            return None
        text = f"When were the {terms[0]} and the {terms[1]} seen together?"
        return Question("Q2", (), {"attribute": text}, negative=True, terms=self._terms((a, b)))

    def not_then(self) -> Question | None:
        """Ask for a thing in a slice in which nothing of its kind and colour was seen."""
        k = int(self._rng.choice(self._seen))
        times = self._truth.time_ms
        start, end = self._slice_around(int(self._rng.choice(times)))
        seen = {self._term(j) for j in self._seen_between(start, end)}
        if self._term(k) in seen:
            return None
        text = self._where(start, end).format(f"the {self._term(k)}")
        terms = self._terms((k,))
        return Question("Q3", (), {"attribute": text}, {}, (start, end), negative=True, terms=terms)

    def _terms(self, things: Sequence[int]) -> tuple[tuple[str, str], ...]:
        objects = self._truth.objects
        return tuple((objects[k].colour, objects[k].category) for k in things)

    def _absent_term(self, seen: Sequence[int]) -> tuple[str, str] | None:
        category = str(self._rng.choice(self._kinds))
        colour = str(self._rng.choice(self._colours))
        if any(self._term(k) == f"{colour} {category}" for k in seen):
            return None
        return colour, category

    def _term(self, k: int) -> str:
        one = self._truth.objects[k]
        return f"{one.colour} {one.category}"

    def _words(self, form: str, targets: Sequence[int], *, article: str) -> dict[Level, str]:
        def said(terms: Sequence[str]) -> str:
            named = [_a(term) if article == "a" else f"the {term}" for term in terms]
            return form.format(*named)

        category = said([self._truth.objects[k].category for k in targets])
        return {
            "perfect": form.format(*(taught_name(k) for k in targets)),
            "category": category,
            "attribute": said([self._term(k) for k in targets]),
            "any": category,
        }

    def _among(self, seen: Sequence[int], k: int) -> dict[Level, int]:
        objects = self._truth.objects
        alike = [j for j in seen if objects[j].category == objects[k].category]
        same = [j for j in alike if objects[j].colour == objects[k].colour]
        return {"perfect": 1, "category": len(alike), "attribute": len(same), "any": len(seen)}

    def _pairs_like(self, card: tuple[int, ...]) -> dict[Level, int]:
        objects = self._truth.objects
        kinds = sorted(objects[k].category for k in card)
        terms = sorted(self._term(k) for k in card)
        return {
            "perfect": 1,
            "category": sum(sorted(objects[k].category for k in p) == kinds for p in self._pairs),
            "attribute": sum(sorted(self._term(k) for k in p) == terms for p in self._pairs),
            "any": len(self._pairs),
        }

    def _slice_around(self, time_ms: int) -> tuple[int, int]:
        """Return a slice of 45 minutes that holds the time, on whole minutes."""
        length = int(SLICE.total_seconds())
        begin = time_ms / 1000 - self._rng.uniform(0.05, 0.95) * length
        start = int(begin // 60 * 60 * 1000)
        return start, start + length * 1000

    def _seen_between(self, start: int, end: int) -> list[int]:
        inside = (self._truth.time_ms >= start) & (self._truth.time_ms < end)
        return sorted(set(self._truth.owner[inside].tolist()) - {-1})

    def _where(self, start: int, end: int) -> str:
        first, last = (datetime.fromtimestamp(ms / 1000, self._zone) for ms in (start, end))
        if first.date() == last.date():
            slot = f"between {_clock(first)} and {_clock(last)} on {_day(first)}"
        else:
            slot = f"between {_day(first)} {_clock(first)} and {_day(last)} {_clock(last)}"
        return f"Where did you see {{0}} {slot}?"


def _frames(truth: Truth) -> dict[str, set[int]]:
    shown: dict[str, set[int]] = defaultdict(set)
    for frame, owner in zip(truth.frame, truth.owner.tolist(), strict=True):
        if owner >= 0:
            shown[frame].add(owner)
    return shown


def _a(term: str) -> str:
    return f"{'an' if term[0] in 'aeiou' else 'a'} {term}"


def _clock(moment: datetime) -> str:
    hour = moment.hour % 12 or 12
    return f"{hour}:{moment.minute:02d} {'am' if moment.hour < 12 else 'pm'}"


def _day(moment: datetime) -> str:
    return f"{moment.day} {moment:%B %Y}"
