"""Default profile: the identity of things that were moved.

A thing that turns up at a new place is an old one, or none that is known. How alike the looks of
two things must be for that is learned from things that cannot be one, as both were seen since; and
a place that was looked at in vain since says that its thing has left. To inherit an id from
whatever is most alike, as the paper does, is right once in ten times.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from d3a.known import Known, Place
from d3a.ledger import Ledger
from d3a.likelihood import SAME, LookModel
from d3a.look_space import LookSpace
from d3a.memory import Memory
from d3a.parameters import Parameters
from d3a.sightings import Became, entry_name
from d3a.store.base import StayKey

Floats = NDArray[np.float64]
BINS = 40
"""Of cosines, -1 to 1."""
OTHER_PRIOR, OTHER_MEAN, OTHER_SIGMA = 10.0, 0.3, 0.3
"""Pairs of different things that are assumed before any was seen, and how alike they are."""
SAME_SIGMA, SAME_OUTLIERS = 0.12, 0.05
"""How the likeness of two means of one thing varies between places, and the share that does not
follow it: another side, another light."""
GONE_MOST = 5.0
"""Log-odds that looks in vain count for at most."""
Pair = tuple[Known, Known, Place]
"""What may be a move: what turned up, what left, and the place that it left."""


@dataclass(frozen=True, slots=True)
class Link:
    """`new` is `old`, moved; score: how likely that is, 0..1."""

    old: Known
    new: Known
    score: float


@dataclass(frozen=True, slots=True)
class Alike:
    """What a likeness of two things of a category tells.

    density: of different things at likenesses (BINS,). least: log-odds of the likeness alone from
    which it tells one thing from the others of the category.
    """

    density: list[float]
    least: float


class Moves:
    """Finds the moves that are plain, and learns how alike different things look."""

    def __init__(
        self, memory: Memory, space: LookSpace, looks: LookModel, parameters: Parameters
    ) -> None:
        self._memory = memory
        self._space = space
        self._looks = looks
        self._parameters = parameters
        self.others: dict[str, list[float]] = {}
        """By category (BINS,): how often two different things of it were so much alike."""
        self.compared: set[int] = set()
        """Numbers of the things that `others` has learned from."""
        self._dense: dict[str, list[float]] = {}
        """What `_densities` has told by category, until more is learned."""

    def find(self, changed: set[int]) -> list[Link]:
        """Return the moves that are likelier than all else that either thing may be, together.

        changed: numbers of the things that were seen, or missed, since the last call; a move has
        one of them at either end. By the numbers of the new and the old.
        """
        of_kind = self._alike(changed)
        fresh = {kind: [t for t in each if _is_unexplained(t)] for kind, each in of_kind.items()}
        for kind, news in fresh.items():
            self._compare([new for new in news if new.number not in self.compared], of_kind[kind])
        links: list[Link] = []
        for kind, each in of_kind.items():
            left = [(old, place) for old in each if (place := old.latest).misses > 0]
            pairs = [
                (new, old, place)
                for old, place in left
                for new in fresh[kind]
                if place.last_ms < new.first_ms
                and new is not old
                and (new.number in changed or old.number in changed)
            ]
            if pairs:
                links += self._links(pairs, fresh[kind], left, self._told(kind, len(each)))
        return sorted(links, key=lambda link: (link.new.number, link.old.number))

    def _alike(self, changed: set[int]) -> dict[str, list[Known]]:
        """Return all confirmed things of the categories of the changed ones, by category."""
        least, things = self._parameters.confirm_sightings, self._memory.things
        kinds = {things[n].category for n in changed if n in things and things[n].seen >= least}
        of_kind: dict[str, list[Known]] = {kind: [] for kind in sorted(kinds)}
        if kinds:
            for thing in things.values():
                if thing.seen >= least and (each := of_kind.get(thing.category)) is not None:
                    each.append(thing)
        return of_kind

    def _links(
        self,
        pairs: list[Pair],
        fresh: list[Known],
        left: list[tuple[Known, Place]],
        told: Alike,
    ) -> list[Link]:
        """Return the plain ones of the pairs, against all that either end may be instead.

        fresh, left: all things of the category that turned up, and that were missed.
        """
        least = self._parameters.move_probability
        links = []
        for (new, old, place), weight in zip(pairs, self._weights(pairs, told), strict=True):
            if weight * (1.0 - least) < least:
                continue  # whatever the rivals are, it is not plain: nearly all pairs end here
            rivals = [(new, o, p) for o, p in left if p.last_ms < new.first_ms and o is not new]
            rivals += [
                (n, old, place) for n in fresh if place.last_ms < n.first_ms and n is not old
            ]
            others = sum(self._weights(rivals, told))
            chance = weight / (1.0 + others - weight)  # it is in both lists
            if chance >= least:
                links.append(Link(old, new, chance))
        return links

    def _weights(self, pairs: list[Pair], told: Alike) -> list[float]:
        return [math.exp(min(odds, 50.0)) for odds in self._odds(pairs, told)]

    def _likeness(self, one: Known, others: list[Known]) -> list[float]:
        """Return the cosines of a thing with those of some others whose looks are known."""
        known = [other for other in others if other.look_weight > 0]
        if one.look_weight == 0 or not known:
            return []
        looks = self._memory.looks
        alike = looks.units(known, self._space) @ looks.unit(one, self._space)
        return [float(each) for each in alike]

    def _compare(self, fresh: list[Known], confirmed: list[Known]) -> None:
        """Learn from those that were seen elsewhere since: they are other things."""
        for new in fresh:
            self.compared.add(new.number)
            others = [
                other
                for other in confirmed
                if other.category == new.category
                and other.last_ms >= new.first_ms
                and other is not new
            ]
            if others:
                self._dense.clear()
                counts = self.others.setdefault(new.category, [0.0] * BINS)
                for likeness in self._likeness(new, others):
                    counts[_bin(likeness)] += 1.0

    def _odds(self, pairs: list[Pair], told: Alike) -> list[float]:
        """Return the log-odds (n,) that `new` is `old`, which was last seen at `place`.

        One by one: there are three or four of them.
        """
        parameters, looks = self._parameters, self._memory.looks
        # Means vary less than the views that are compared with them.
        usual = math.sqrt(max(float(self._looks.sums[-1, SAME, 1]), 0.0))
        odds = []
        for new, old, place in pairs:
            look = -math.inf  # an empty place alone does not say what left it
            if new.look_weight > 0 and old.look_weight > 0:
                likeness = float(looks.unit(new, self._space) @ looks.unit(old, self._space))
                away = min((likeness - usual) / SAME_SIGMA, 0.0)
                bell = math.exp(-(away**2) / 2) / (SAME_SIGMA * math.sqrt(2 * math.pi))
                same = (1 - SAME_OUTLIERS) * bell + SAME_OUTLIERS / 2
                look = math.log(same / told.density[_bin(likeness)])
            left = min(place.evidence, GONE_MOST)
            is_alike = look >= told.least
            odds.append(look + left + parameters.move_odds if is_alike else -math.inf)
        return odds

    def _told(self, kind: str, known: int) -> Alike:
        """Return what a likeness tells of a category, of which so many confirmed things are known.

        The look has to tell the old thing from others that may have come instead. Where no other
        is known, the place that it left and a look no stranger than another's do.
        """
        least = self._parameters.plain_odds if known > 2 else 0.0
        return Alike(self._densities(kind), least)

    def _densities(self, kind: str) -> list[float]:
        """Return how dense different things of a category lie at likenesses (BINS,).

        From there up, smoothed. Chairs of a set look alike, and say little of the cups: what is
        usual is told by all categories, each by `OTHER_PRIOR` pairs at most, and is worth as many
        against the category's own.
        """
        if (known := self._dense.get(kind)) is not None:
            return known
        usual = _assumed()
        for category in sorted(self.others):
            counts = np.array(self.others[category])
            usual += counts * min(1.0, OTHER_PRIOR / max(float(counts.sum()), 1.0))
        pairs = usual * (OTHER_PRIOR / usual.sum()) + np.array(self.others.get(kind, 0.0))
        above = pairs[::-1].cumsum()[::-1]
        first = np.maximum(np.arange(BINS) - 1, 0)
        density: list[float] = (above[first] / above[0] / ((BINS - first) * 2 / BINS)).tolist()
        self._dense[kind] = density
        return density


def _assumed() -> Floats:
    middle = (np.arange(BINS) + 0.5) * 2 / BINS - 1
    bell = np.exp(-(((middle - OTHER_MEAN) / OTHER_SIGMA) ** 2) / 2)
    return np.asarray(OTHER_PRIOR * bell / bell.sum())


def _bin(likeness: float) -> int:
    """Return the bin of a likeness."""
    return min(max(int((likeness + 1.0) / 2.0 * BINS), 0), BINS - 1)


def _is_unexplained(thing: Known) -> bool:
    """Say whether it turned up at one place and is not known from another."""
    return len(thing.places) == 1 and not thing.names and thing.places[0].moved_from is None


def apply_link(link: Link, memory: Memory, ledger: Ledger, parameters: Parameters) -> Became:
    """Make `new` a further place of `old`, in the memory and in what is written already."""
    old, new = link.old, link.new
    left = old.latest
    place = new.places[0]
    _leave(left, new.first_ms)
    was: StayKey = (new.object_id, place.number)
    place.number = max(each.number for each in old.places) + 1
    place.moved_from = (left.number, link.score)
    becomes: StayKey = (old.object_id, place.number)
    sightings = ledger.sightings([new.object_id])
    encounters = ledger.encounters(new.object_id)
    _merge(old, new, memory, parameters)
    ledger.remove_objects({new.object_id})
    for sighting in sightings:
        ledger.put_sighting(replace(sighting, object_id=becomes[0], place=becomes[1]))
    for encounter in encounters:
        if (renamed := encounter.renamed({was: becomes})) is not None:
            ledger.put_encounter(renamed)
    return Became(entry_name(was), entry_name(becomes), "moved")


def _leave(left: Place, elsewhere_ms: int) -> None:
    """Note that a place was left: its thing is elsewhere, and the place was looked at in vain.

    The looks alone need not be enough for that, where a thing is hard to see.
    """
    if left.last_absent_ms is None:
        left.last_absent_ms = max([elsewhere_ms, *(looked_ms for _, looked_ms in left.missed_from)])


def _merge(old: Known, new: Known, memory: Memory, parameters: Parameters) -> None:
    place = new.places.pop()
    for category, weight in new.votes.items():
        old.vote(category, weight)
    old.weight += new.weight
    old.seen += new.seen
    old.last_ms = max(old.last_ms, new.last_ms)
    old.dirty = True
    look = memory.looks.of(new)
    if look is not None:
        memory.looks.blend(old, look, new.look_weight, parameters.looks_remembered)
    old.met |= new.met
    old.places.append(place)
    if place.row >= 0:
        memory.positions.give(place, old)
    memory.remove(new)
