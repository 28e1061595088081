"""Default profile: the identity of things that were moved.

A thing that turns up at a new place is an old one, or none that is known. Three things speak for
one that is known: the place that it left was looked at in vain since; the new place was looked at
in vain before; and they look alike. How alike different things look is learned from things that
cannot be one, as both were seen since. To inherit an id from whatever is most alike, as the paper
does, is right once in ten times.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from d3a.absence import SURE_SEEN, Absence
from d3a.arrivals import CAME_MOST
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
"""How the likeness of two means of one thing varies in one light, and the share that follows
nothing: another side."""
LIGHT_SHARE, LIGHT_LESS, LIGHT_SIGMA = 0.5, 0.15, 0.17
"""The share of moves into another light, before another background; by how much less alike that
makes the looks, and how much that varies."""
GONE_MOST = 5.0
"""Log-odds that looks in vain count for at most."""
LOOK_LEAST = -1.0
"""Log-odds of looks that speak against a move: below, places alone do not say what came."""
PLAIN_LOOK, LEFT_LEAST = 3.0, 3.0
"""A look whose log-odds tell a thing from all others of its category; and log-odds of its absence
from which a thing may be elsewhere, whatever it looks like. A link needs one of them."""
Pair = tuple[Known, Known, Place]
"""What may be a move: what turned up, what left, and the place that it left."""


@dataclass(frozen=True, slots=True)
class Link:
    """`new` is `old`, moved; score: how likely that is, 0..1."""

    old: Known
    new: Known
    score: float


@dataclass(frozen=True, slots=True)
class Kind:
    """A category while its moves are looked for.

    things: its confirmed ones; fresh: those of them that turned up. density: how dense different
    ones lie at likenesses (BINS,). came: what is known of arrivals, by number, as it is asked for.
    """

    things: list[Known]
    fresh: list[Known]
    density: list[float]
    came: dict[int, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Told:
    """What is known of a pair. look: log-odds of the looks alone; odds: of all that is known."""

    look: float
    odds: float


class Moves:
    """Finds the moves that are plain, and learns how alike different things look."""

    def __init__(
        self,
        memory: Memory,
        space: LookSpace,
        looks: LookModel,
        absence: Absence,
        parameters: Parameters,
    ) -> None:
        self._memory = memory
        self._absence = absence
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
            pairs = [
                (new, old, place)
                for old in each
                if (place := old.latest).misses > 0
                for new in fresh[kind]
                if place.last_ms < new.first_ms
                and new is not old
                and (new.number in changed or old.number in changed)
            ]
            if pairs:
                links += self._links(pairs, Kind(each, fresh[kind], self._densities(kind)))
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

    def _links(self, pairs: list[Pair], kind: Kind) -> list[Link]:
        """Return the plain ones of the pairs, against all that either end may be instead."""
        least = self._parameters.move_probability
        links = []
        for (new, old, place), told in zip(pairs, self._told(pairs, kind), strict=True):
            if told.odds * (1.0 - least) < least:
                continue  # whatever the rivals are, it is not plain: nearly all pairs end here
            left = place.evidence >= LEFT_LEAST and old.seen >= SURE_SEEN
            if not left and told.look < PLAIN_LOOK:
                continue
            # what nobody looked for may have left too
            lasts = [(o, o.latest) for o in kind.things if o is not new]
            rivals = [(new, o, p) for o, p in lasts if p.last_ms < new.first_ms]
            rivals += [
                (n, old, place) for n in kind.fresh if place.last_ms < n.first_ms and n is not old
            ]
            others = sum(rival.odds for rival in self._told(rivals, kind))
            chance = told.odds / (1.0 + others - told.odds)  # it is in both lists
            if chance >= least:
                links.append(Link(old, new, chance))
        return links

    def _told(self, pairs: list[Pair], kind: Kind) -> list[Told]:
        """Return what is known of pairs (n,), one by one: there are three or four of them."""
        parameters = self._parameters
        # Any other of the category may have come, or one that is not known.
        brought = parameters.move_odds - math.log(len(kind.things) - 1)
        found = []
        for new, old, place in pairs:
            look = self._look(new, old, kind.density)
            if look < LOOK_LEAST:
                found.append(Told(look, 0.0))
                continue
            odds, prior = look + min(place.evidence, GONE_MOST), brought
            if odds + prior > -CAME_MOST:  # else it is neither a link, nor much of a rival to one
                if new.number not in kind.came:
                    kind.came[new.number] = self._absence.came(new.places[0])
                prior += kind.came[new.number]
            if look >= PLAIN_LOOK:
                prior = max(prior, parameters.alike_odds)
            found.append(Told(look, math.exp(min(odds + prior, 50.0))))
        return found

    def _look(self, new: Known, old: Known, density: list[float]) -> float:
        """Return the log-odds of the looks of two things, minus infinity where one is unknown."""
        if new.look_weight == 0 or old.look_weight == 0:
            return -math.inf
        looks = self._memory.looks
        # Means vary less than the views that are compared with them.
        usual = math.sqrt(max(float(self._looks.sums[-1, SAME, 1]), 0.0))
        likeness = float(looks.unit(new, self._space) @ looks.unit(old, self._space))
        return math.log(_same(likeness - usual) / density[_bin(likeness)])

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


def _same(above: float) -> float:
    """Return how dense the looks of a thing at two places lie so much above what is usual."""
    alike = _bell(min(above, 0.0), SAME_SIGMA)
    light = _bell(above + LIGHT_LESS, LIGHT_SIGMA)
    follow = (1 - LIGHT_SHARE) * alike + LIGHT_SHARE * light
    return (1 - SAME_OUTLIERS) * follow + SAME_OUTLIERS / 2


def _bell(away: float, sigma: float) -> float:
    return math.exp(-((away / sigma) ** 2) / 2) / (sigma * math.sqrt(2 * math.pi))


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
