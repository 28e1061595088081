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

from d3a.ledger import Ledger
from d3a.likelihood import SAME, LookModel
from d3a.look_space import LookSpace
from d3a.memory import Known, Memory, Place
from d3a.parameters import Parameters
from d3a.sightings import Became, entry_name
from d3a.store.base import Encounter, StayKey

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


@dataclass(frozen=True, slots=True)
class Link:
    """`new` is `old`, moved; score: how likely that is, 0..1."""

    old: Known
    new: Known
    score: float


class Moves:
    """Finds the moves that are plain, and learns how alike different things look."""

    def __init__(
        self, memory: Memory, space: LookSpace, looks: LookModel, parameters: Parameters
    ) -> None:
        self._memory = memory
        self._space = space
        self._looks = looks
        self._parameters = parameters
        self.others: Floats = _assumed()
        """(BINS,): how often two different things of a category were so much alike."""
        self.compared: set[int] = set()
        """Numbers of the things that `others` has learned from."""

    def find(self, changed: set[int]) -> list[Link]:
        """Return the moves that are likelier than all else that either thing may be, together.

        changed: numbers of the things that were seen, or missed, since the last call.
        """
        things = self._memory.things
        kinds = {things[number].category for number in changed if number in things}
        confirmed = [
            each for each in _confirmed(self._memory, self._parameters) if each.category in kinds
        ]
        fresh = [thing for thing in confirmed if _is_unexplained(thing)]
        self._compare([new for new in fresh if new.number not in self.compared], confirmed)
        by_category: dict[str, list[Known]] = {}
        for new in fresh:
            by_category.setdefault(new.category, []).append(new)
        pairs = [
            (new, old, place)
            for old in confirmed
            if (place := old.latest).misses > 0
            for new in by_category.get(old.category, ())
            if place.last_ms < new.first_ms and new is not old
        ]
        if not any(new.number in changed or old.number in changed for new, old, _ in pairs):
            return []
        return self._links(pairs)

    def _links(self, pairs: list[tuple[Known, Known, Place]]) -> list[Link]:
        """Return the plain ones of the pairs that may be moves."""
        news = sorted({new.number for new, _, _ in pairs})
        olds = sorted({old.number for _, old, _ in pairs})
        things = self._memory.things
        likeness = self._likeness([things[n] for n in news], [things[n] for n in olds])
        row, column = ({n: k for k, n in enumerate(each)} for each in (news, olds))
        odds = np.full(likeness.shape, -np.inf)
        for new, old, place in pairs:
            i, j = row[new.number], column[old.number]
            if not math.isnan(likeness[i, j]):
                odds[i, j] = self._odds(float(likeness[i, j]), new, old, place)
        return [
            Link(things[olds[j]], things[news[i]], score)
            for i, j, score in _plain(odds, self._parameters.move_probability)
        ]

    def _likeness(self, ones: list[Known], others: list[Known]) -> Floats:
        """Return the cosines (ones, others), NaN where a look is unknown."""
        looks = self._memory.looks
        left, right = (self._space.of(looks.rows(each)) for each in (ones, others))
        known = [np.array([thing.look_weight > 0 for thing in each]) for each in (ones, others)]
        cosines = (left @ right.T).astype(np.float64)
        return np.where(known[0][:, None] & known[1], cosines, np.nan)

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
                for likeness in self._likeness([new], others)[0].tolist():
                    if not math.isnan(likeness):
                        self.others[_bin(likeness)] += 1.0

    def _odds(self, likeness: float, new: Known, old: Known, place: Place) -> float:
        """Return the log-odds that `new` is `old`, which was last seen at `place`."""
        # Means vary less than the views that are compared with them.
        usual = math.sqrt(max(float(self._looks.sums[-1, SAME, 1]), 0.0))
        away = (likeness - usual) / SAME_SIGMA
        bell = math.exp(-(min(away, 0.0) ** 2) / 2) / (SAME_SIGMA * math.sqrt(2 * math.pi))
        same = (1 - SAME_OUTLIERS) * bell + SAME_OUTLIERS / 2
        other = self._density(likeness)
        look = math.log(same / other)
        if look < self._parameters.plain_odds:  # an empty place alone does not say what left it
            return -math.inf
        return look + min(place.evidence, GONE_MOST) + self._parameters.move_odds

    def _density(self, likeness: float) -> float:
        """Return how dense different things lie at a likeness, from there up, smoothed."""
        near = self.others[max(0, _bin(likeness) - 1) :]
        return float(near.sum() / self.others.sum()) / (len(near) * 2 / BINS)


def _assumed() -> Floats:
    middle = (np.arange(BINS) + 0.5) * 2 / BINS - 1
    bell = np.exp(-(((middle - OTHER_MEAN) / OTHER_SIGMA) ** 2) / 2)
    return np.asarray(OTHER_PRIOR * bell / bell.sum())


def _bin(likeness: float) -> int:
    return min(BINS - 1, max(0, int((likeness + 1.0) / 2.0 * BINS)))


def _plain(odds: Floats, least: float) -> list[tuple[int, int, float]]:
    """Return pairs whose probability is at least so much, among all that either end may be."""
    weight = np.exp(np.minimum(odds, 50.0))
    rivals = weight.sum(axis=0, keepdims=True) + weight.sum(axis=1, keepdims=True) - weight
    chance = weight / (1.0 + rivals)
    return [(i, j, float(chance[i, j])) for i, j in np.argwhere(chance >= least).tolist()]


def _confirmed(memory: Memory, parameters: Parameters) -> list[Known]:
    least = parameters.confirm_sightings
    found = [thing for thing in memory.things.values() if thing.seen >= least]
    return sorted(found, key=lambda thing: thing.number)


def _is_unexplained(thing: Known) -> bool:
    """Say whether it turned up at one place and is not known from another."""
    return len(thing.places) == 1 and not thing.names and thing.places[0].moved_from is None


def apply_link(link: Link, memory: Memory, ledger: Ledger, parameters: Parameters) -> Became:
    """Make `new` a further place of `old`, in the memory and in what is written already."""
    old, new = link.old, link.new
    left = old.latest
    place = new.places[0]
    was: StayKey = (new.object_id, place.number)
    place.number = max(each.number for each in old.places) + 1
    place.moved_from = (left.number, link.score)
    becomes: StayKey = (old.object_id, place.number)
    sightings = ledger.sightings([new.object_id])
    encounters = ledger.encounters(new.object_id)
    _merge(old, new, memory, parameters)
    ledger.remove_object(new.object_id)
    for sighting in sightings:
        ledger.put_sighting(replace(sighting, object_id=becomes[0], place=becomes[1]))
    for encounter in encounters:
        if (renamed := rename(encounter, was, becomes)) is not None:
            ledger.put_encounter(renamed)
    return Became(entry_name(was), entry_name(becomes), "moved")


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
        memory.positions.owners[place.row] = (old, place)
    memory.remove(new)


def rename(encounter: Encounter, was: StayKey, becomes: StayKey) -> Encounter | None:
    """Return the encounter with a stay renamed; None where a thing would meet itself."""
    e = encounter
    ends = [((e.object_a, e.place_a), e.box_a), ((e.object_b, e.place_b), e.box_b)]
    renamed = sorted((becomes if stay == was else stay, box) for stay, box in ends)
    (a, box_a), (b, box_b) = renamed
    if a[0] == b[0]:
        return None
    return replace(
        e, object_a=a[0], place_a=a[1], box_a=box_a, object_b=b[0], place_b=b[1], box_b=box_b
    )
