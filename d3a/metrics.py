"""How good a store and its answers are, against a recording's truth (paper, "Metric Definitions").

Identity is judged from assignments, the row-by-row record of an ingest: which object and place a
detection went to, or that it was left out. Answers are judged from their ranked keyframes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

import numpy as np

from d3a.model import Box, Json
from d3a.store.base import StayKey, StayRecord
from d3a.truth import Truth

K = TypeVar("K")
V = TypeVar("V", int, tuple[int, int])
CUT = 50
"""MRR@50: the rank of a keyframe beyond this counts as a miss."""
Assignments = Sequence[StayKey | None]
"""For each row of detections.jsonl the (object_id, place) it went to, None where left out."""


@dataclass(frozen=True, slots=True)
class Score:
    """One query judged: rank of the first right keyframe (None: none at all), and counts.

    rank is over all that was returned; a miss is a rank beyond the cut. frames: keyframes
    returned; ids: distinct ObjectIDs.
    """

    rank: int | None
    frames: int
    ids: int

    def reciprocal(self, cut: int = CUT) -> float:
        """Return 1 / rank, 0 beyond the cut (MRR@50)."""
        return 1.0 / self.rank if self.rank is not None and self.rank <= cut else 0.0

    def missed(self, cut: int = CUT) -> bool:
        """Whether no right keyframe is among the first `cut`."""
        return self.reciprocal(cut) == 0.0


@dataclass(frozen=True, slots=True)
class BCubed:
    """B-cubed over true detections: precision over kept ones, recall over all of them.

    A detection that was left out has a recall of 0: dropping what is hard does not help.
    """

    precision: float
    recall: float

    @property
    def f(self) -> float:
        """The harmonic mean, 0 where both are 0."""
        both = self.precision + self.recall
        return 2 * self.precision * self.recall / both if both else 0.0


@dataclass(frozen=True, slots=True)
class Rate:
    """Right ones among those given (precision) and among those there are (recall).

    hits may differ between the two, as one truth can be met by several finds.
    """

    right: int
    given: int
    met: int
    wanted: int

    @property
    def precision(self) -> float:
        """Right among given, 1 where nothing was given."""
        return self.right / self.given if self.given else 1.0

    @property
    def recall(self) -> float:
        """Met among wanted, 1 where nothing was wanted."""
        return self.met / self.wanted if self.wanted else 1.0

    def to_json(self) -> Json:
        """Return both rates and the counts they come from."""
        return {
            "precision": self.precision,
            "recall": self.recall,
            "given": self.given,
            "wanted": self.wanted,
        }


@dataclass(frozen=True, slots=True)
class Duplicates:
    """ObjectIDs per true object, over the objects that have one (paper, Table 4)."""

    mean: float
    sd: float
    most: int
    without: int  # seen objects to which no ObjectID belongs


def b_cubed(owner: Sequence[int], assignments: Assignments) -> BCubed:
    """Judge the ObjectIDs of detections; owner: true object of each row, -1 for a false positive.

    False positives are nobody's: they spoil the precision of the cluster they are in.
    """
    ids = [stay[0] if stay is not None else None for stay in assignments]
    together = Counter((o, i) for o, i in zip(owner, ids, strict=True) if i is not None)
    clusters = Counter(i for i in ids if i is not None)
    classes = Counter(o for o in owner if o >= 0)
    precision, recall, kept = 0.0, 0.0, 0
    for (o, i), count in together.items():
        if o >= 0:
            precision += count * count / clusters[i]
            recall += count * count / classes[o]
            kept += count
    real = sum(classes.values())
    return BCubed(precision / kept if kept else 0.0, recall / real if real else 0.0)


def id_owners(owner: Sequence[int], assignments: Assignments) -> dict[str, int]:
    """Return the true object that most of each ObjectID's detections show; -1 for none.

    Ties go to the lower object number.
    """
    return _majorities((stay[0], o) for stay, o in _kept(owner, assignments))


def best_ids(owner: Sequence[int], assignments: Assignments) -> dict[int, str]:
    """Return for each true object the ObjectID that holds most of its detections, ties by id."""
    counts: dict[int, Counter[str]] = {}
    for stay, o in _kept(owner, assignments):
        if o >= 0:
            counts.setdefault(o, Counter())[stay[0]] += 1
    return {o: min(c, key=lambda i: (-c[i], i)) for o, c in counts.items()}


def duplicates(truth: Truth, assignments: Assignments, ids: Iterable[str]) -> Duplicates:
    """Count ObjectIDs per true object among `ids`, an id belonging to its majority."""
    owners = id_owners(truth.owner.tolist(), assignments)
    per = Counter(owners[i] for i in ids if owners.get(i, -1) >= 0)
    counts = np.array(list(per.values()), dtype=float)
    without = sum(k not in per for k in truth.seen())
    if not len(counts):
        return Duplicates(0.0, 0.0, 0, without)
    return Duplicates(float(counts.mean()), float(counts.std()), int(counts.max()), without)


def stay_truths(truth: Truth, assignments: Assignments) -> dict[StayKey, tuple[int, int]]:
    """Return for each stay the (object, place number) that most of its detections show.

    (-1, -1) for a stay made mostly of false positives, or of things in somebody's hand.
    """
    pairs = []
    for row, stay in enumerate(assignments):
        if stay is not None:
            number = truth.place_of(row)
            shown = (int(truth.owner[row]), number) if number is not None else (-1, -1)
            pairs.append((stay, shown))
    return _majorities(pairs)


def move_links(truth: Truth, assignments: Assignments, stays: Iterable[StayRecord]) -> Rate:
    """Judge the identity of what moved: consecutive stays of one ObjectID against true moves.

    Wanted: pairs of consecutive places of an object that were both detected at least twice.
    Met: the ObjectIDs that hold most detections of either are the same. Given: consecutive stays
    of an id that show different truths; right: the same object at different places. A second stay
    at the same true place is a split, not a move, and is not counted here.
    """
    shown = stay_truths(truth, assignments)
    per_id: dict[str, list[StayRecord]] = {}
    for stay in stays:
        if stay.key in shown:
            per_id.setdefault(stay.object_id, []).append(stay)
    right = given = 0
    for group in per_id.values():
        group.sort(key=lambda stay: (stay.first_ms, stay.place))
        for a, b in pairwise(group):
            one, other = shown[a.key], shown[b.key]
            if one != other:
                given += 1
                right += one[0] == other[0] >= 0
    wanted, met = _true_links(truth, assignments)
    return Rate(right, given, met, wanted)


def _true_links(truth: Truth, assignments: Assignments) -> tuple[int, int]:
    held: dict[tuple[int, int], Counter[str | None]] = {}
    for row, stay in enumerate(assignments):
        number = truth.place_of(row)
        if number is not None:
            place = (int(truth.owner[row]), number)
            held.setdefault(place, Counter())[stay[0] if stay else None] += 1
    wanted = met = 0
    for k, one in enumerate(truth.objects):
        seen = [n for n in range(len(one.places)) if sum(held.get((k, n), Counter()).values()) >= 2]
        for a, b in pairwise(seen):
            first, second = _heaviest(held[k, a]), _heaviest(held[k, b])
            wanted += 1
            met += first is not None and first == second
    return wanted, met


def _heaviest(counts: Counter[str | None]) -> str | None:
    ids = [i for i in counts if i is not None]
    return min(ids, key=lambda i: (-counts[i], i)) if ids else None


def last_absent(truth: Truth, assignments: Assignments, stays: Iterable[StayRecord]) -> Rate:
    """Judge `last_absent`: the thing was not there then, and empty places were noticed.

    Wanted: places whose end the robot saw, that have a stay. Stays that show nothing real are
    left out: nobody can say when a thing that never was went away.
    """
    shown = stay_truths(truth, assignments)
    right = given = 0
    told: dict[tuple[int, int], bool] = {}
    for stay in stays:
        object_place = shown.get(stay.key, (-1, -1))
        if object_place[0] < 0:
            continue
        place = truth.objects[object_place[0]].places[object_place[1]]
        noticed = stay.last_absent_ms is not None
        if stay.last_absent_ms is not None:
            given += 1
            noticed = not place.start_ms <= stay.last_absent_ms <= place.end_ms
            right += noticed
        if place.seen_empty_ms is not None:
            told[object_place] = told.get(object_place, False) or noticed
    return Rate(right, given, sum(told.values()), len(told))


def true_stays(truth: Truth, least: int = 2) -> int:
    """Return how many places of objects were detected at least `least` times."""
    held = Counter(
        (int(truth.owner[row]), number)
        for row in range(len(truth.owner))
        if (number := truth.place_of(row)) is not None
    )
    return sum(count >= least for count in held.values())


class Rows:
    """Finds the detection that a keyframe's frame and box are: boxes agree to half a pixel."""

    def __init__(self, truth: Truth) -> None:
        self._truth = truth
        self._of_frame: dict[str, list[int]] = {}
        for row, frame in enumerate(truth.frame):
            self._of_frame.setdefault(frame, []).append(row)

    def row(self, frame: str, box: Box | None) -> int | None:
        """Return the row of a keyframe, None where no detection of the frame has its box."""
        rows = self._of_frame.get(frame, [])
        if box is None or not rows:
            return None
        apart = np.abs(self._truth.box[rows] - np.array(box)).max(axis=1)
        return rows[int(apart.argmin())] if apart.min() <= 0.5 else None

    def owner(self, frame: str, box: Box | None) -> int:
        """Return the true object that a keyframe's box shows, -1 for none."""
        row = self.row(frame, box)
        return int(self._truth.owner[row]) if row is not None else -1

    def shown(self, frame: str) -> set[int]:
        """Return the true objects detected in a frame."""
        return {int(self._truth.owner[row]) for row in self._of_frame.get(frame, [])} - {-1}


def first_right(groups: Iterable[Sequence[bool]]) -> int | None:
    """Return the rank of the first group of keyframes with a right one, from 1; None for none."""
    for rank, group in enumerate(groups, start=1):
        if any(group):
            return rank
    return None


def ceiling(alternatives: int, cut: int = CUT) -> float:
    """Return the mean reciprocal rank of a perfect store that has to guess among look-alikes.

    alternatives: how many things (pairs, ...) fit the question equally, the asked one among them;
    a perfect store shows each once, in random order.
    """
    if alternatives < 1:
        return 0.0
    return sum(1.0 / rank for rank in range(1, min(alternatives, cut) + 1)) / alternatives


def accuracy(misses: Mapping[tuple[str, str], float], perfect: float | None = None) -> float:
    """Return the mean of 1 - miss over cells (form, precision).

    perfect: what the cells of perfect precision count as (0 is the paper's), None as they are.
    """
    values = [
        perfect if perfect is not None and precision == "perfect" else miss
        for (_, precision), miss in misses.items()
    ]
    return float(1.0 - np.mean(values)) if values else 0.0


def _kept(owner: Sequence[int], assignments: Assignments) -> Iterable[tuple[StayKey, int]]:
    pairs = zip(owner, assignments, strict=True)
    return ((stay, o) for o, stay in pairs if stay is not None)


def _majorities(pairs: Iterable[tuple[K, V]]) -> dict[K, V]:
    """Return each key's most frequent value, ties to the lower one."""
    counts: dict[K, Counter[V]] = {}
    for key, value in pairs:
        counts.setdefault(key, Counter())[value] += 1
    return {key: min(c, key=lambda v: (-c[v], v)) for key, c in counts.items()}
