"""Default profile: how much more likely a detection is of a known thing than of a new one.

Natural log-likelihood ratios of position, look and category, added up. Zero is "as likely as
not"; each part says nothing (0) where its input is missing, and none can outvote all others.
"""

from __future__ import annotations

import math
from bisect import bisect
from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from d3a.parameters import Parameters

Floats = NDArray[np.float64]
Features = NDArray[np.float32]


def position_ratios(
    squared: Floats,
    determinant: Floats,
    spaces_m3: Sequence[Floats | float],
    parameters: Parameters,
) -> Floats:
    """Return the evidence of place from squared Mahalanobis distance and |S|, m^6, alike shaped.

    Student's t, for outliers, against "one other thing in each" of some spaces: (spaces, ...).
    Where the position could be nearly anywhere itself (S as large as that space) its peak says
    nothing, and only the distance counts: so the gates follow the covariance, and look and
    category decide where positions are useless.
    """
    dof = parameters.outlier_dof
    tail = -(dof + 3) / 2 * np.log1p(squared / dof)
    volume = np.sqrt(np.maximum(determinant, 1e-18)) * (2 * math.pi) ** 1.5
    ratios = np.empty((len(spaces_m3), *np.shape(squared)))
    for k, space_m3 in enumerate(spaces_m3):
        ratios[k] = space_m3
    ratios /= volume
    np.log(ratios, out=ratios)
    np.maximum(ratios, 0.0, out=ratios)
    ratios += tail
    return ratios


def feature(embedding: NDArray[np.float32], is_histogram: bool) -> Features:
    """Return the vectors (..., d), unit length, whose dot product is the likeness of two looks.

    Of a histogram the square root of each colour's share (then the product is Bhattacharyya's
    coefficient: one dominant colour of the background cannot decide alone); else the embedding.
    """
    if not is_histogram:
        return embedding
    mass = np.maximum(embedding, np.float32(0.0))
    total = mass.sum(axis=-1, keepdims=True)
    total[total <= 0] = 1.0
    mass /= total
    return np.sqrt(mass, out=mass)


def embedding_of(look: Features, is_histogram: bool) -> NDArray[np.float32]:
    """Return the embedding (d,), unit length, that a mean feature stands for."""
    values = np.square(look, dtype=np.float64) if is_histogram else look.astype(np.float64)
    length = float(np.sqrt(np.sum(values**2)))
    return (values / length if length > 0 else values).astype(np.float32)


LOOK_BINS = (1.5, 4.0, 12.0)
"""Views in a mean look, at which it counts as another kind: a mean is more like its views than
they are like each other."""
_LOOK_BINS = np.array(LOOK_BINS)
SAME, OTHER, BESIDE = 0, 1, 2
"""Kinds of pairs: views of one thing; of two of one category; of two that stand side by side and
have different categories, which share their background more than two of a kind across the room."""
LOOK_COMMON = 100.0
"""Pairs for which the spread of both kinds together counts in that of each: few tell little of it,
and least of what is rare, how unlike two views of one thing may be."""
LOOK_VARIANCE_LEAST = 1e-3
"""Variance of likeness that each kind has at least."""


class LookModel:
    """How alike views of one thing are, and views of others: learned while the robot looks.

    Light, lens and embedding decide that, so no fixed threshold serves two recordings. Other
    things: those of the same frame, which are never one. The same thing: what place and category
    alone have recognised. Each kind is normal with a variance of its own up to its mean on the
    side of the other, and level beyond: no view is too like a thing to be of it, and none too
    unlike it to be of another. Assumed values count as much as `look_prior` views.
    """

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters
        count, squares = parameters.look_prior, parameters.look_prior * parameters.look_sigma**2
        means = (parameters.look_same, parameters.look_other, parameters.look_beside)
        # plain numbers, as they are taken one by one
        self._sums = [[[count, mean, squares] for mean in means] for _ in range(len(LOOK_BINS) + 1)]
        self._bells = np.empty((len(means), len(self._sums), 5))
        """By kind and bin, see `Bell`: what both kinds are made of."""
        self._stale = set(range(len(self._sums)))
        """Bins in which more is known than their bells tell."""

    @property
    def sums(self) -> Floats:
        """(bins, SAME | OTHER | BESIDE, count | mean | summed squared deviations)."""
        return np.array(self._sums)

    @sums.setter
    def sums(self, sums: Floats) -> None:
        self._sums = sums.tolist()
        self._stale.update(range(len(self._sums)))

    def mean(self, kind: int) -> float:
        """Return how alike such pairs are on average, of looks of as many views as there are."""
        return self._sums[-1][kind][1]

    def add(self, kind: int, likeness: float, views: float) -> None:
        """Learn from a pair; views: of the mean look. kind: SAME, OTHER or BESIDE."""
        at = bisect(LOOK_BINS, views)
        self._stale.add(at)
        row = self._sums[at][kind]
        if row[0] >= self._parameters.look_memory:
            keep = 1.0 - 1.0 / row[0]
            row[0] *= keep
            row[2] *= keep
        row[0] += 1.0
        delta = likeness - row[1]
        row[1] += delta / row[0]
        row[2] += delta * (likeness - row[1])

    def against(self, likeness: Floats, views: Floats, kinds: Sequence[int]) -> Floats:
        """Return the evidence (kinds, n, m) for SAME against each of some kinds.

        likeness: cosines (n, m) with looks of so many views (m,).
        """
        for at in self._stale:
            rows = self._sums[at]
            for kind in (OTHER, BESIDE):
                self._bells[kind, at] = _bell(*rows[SAME], *rows[kind])
        self._stale.clear()
        bins = _LOOK_BINS.searchsorted(views, side="right")
        bells = self._bells[list(kinds)].take(bins, axis=1).transpose(2, 0, 1)
        same, sharp, other, blunt, even = bells[:, :, None]
        short = np.minimum(likeness - same, 0.0)
        short *= short
        short *= sharp
        raw = np.maximum(likeness - other, 0.0)
        raw *= raw
        raw *= blunt
        raw -= short
        raw += even
        np.maximum(raw, self._parameters.look_least, out=raw)
        return np.asarray(np.minimum(raw, self._parameters.look_most, out=raw))


Bell = tuple[float, float, float, float, float]
"""The mean of the same and half its precision, the mean of the others and half theirs, and the
logarithm of how much denser the same is at its mean than the others at theirs."""


def _bell(n: float, same: float, squares: float, m: float, other: float, more: float) -> Bell:
    """Return what two kinds are made of, from the count, mean and squared deviations of each."""
    if same <= other:  # likeness does not tell them apart
        return (0.0, 0.0, 0.0, 0.0, 0.0)
    common = LOOK_COMMON * (squares + more) / (n + m)  # so few numbers go quicker one by one
    own = max((squares + common) / (n + LOOK_COMMON), LOOK_VARIANCE_LEAST)
    theirs = max((more + common) / (m + LOOK_COMMON), LOOK_VARIANCE_LEAST)
    return same, 0.5 / own, other, 0.5 / theirs, 0.5 * math.log(theirs / own)


DOUBT_LEAST = 0.02
"""What is added to a detector's doubts: one that is always certain is still wrong at times."""
DOUBT_PRIOR = (2.0, 20.0)
"""Summed doubt, and detections, before any was seen: 0.1 each."""
WRONG_LEAST, WRONG_MOST = 0.002, 0.5
"""Bounds of the chance that a label is wrong."""


def shares(votes: Mapping[str, float]) -> dict[str, float]:
    """Return how likely a thing with such votes is of each category; empty where none counts.

    By squares: what a thing is follows from its votes ever more surely. By plain shares one stray
    vote for a rare category would open the door to all of that category around.
    """
    total = sum(weight**2 for weight in votes.values())
    return {name: weight**2 / total for name, weight in votes.items()} if total > 0 else {}


class CategoryModel:
    """How often each category is named, how sure its names are, and so what agreement is worth."""

    def __init__(self, parameters: Parameters) -> None:
        self.parameters = parameters
        self.counts: Counter[str] = Counter()
        self.doubt = DOUBT_PRIOR
        """Summed doubt, and detections."""

    def add(self, category: str, probability: float = 1.0) -> None:
        """Count a detection, by the detector's own probability."""
        self.counts[category] += 1
        summed, number = self.doubt
        self.doubt = summed + (1.0 - probability), number + 1.0

    def wrong(self, probability: float) -> float:
        """Return the chance that a label of this probability is wrong.

        `confusion` on average, and in proportion to the detector's doubt by what is usual for it:
        detectors differ in how they boast, but all are wrong most where they doubt most.
        """
        usual = self.doubt[0] / self.doubt[1] + DOUBT_LEAST
        share = self.parameters.confusion * (1.0 - probability + DOUBT_LEAST) / usual
        return min(WRONG_MOST, max(WRONG_LEAST, share))

    def evidence(
        self, names: Sequence[tuple[str, float]], kinds: Sequence[Mapping[str, float]]
    ) -> tuple[Floats, Floats]:
        """Return the evidence of each name for each thing, (n, m), in two parts.

        names: category and probability. kinds: how likely each thing is of each category, see
        `shares`. First, that the thing is of this category; then, that it is of another and was
        named wrongly, by a name drawn by frequency. The parts exclude each other, so their
        evidence with all else that depends on them adds up as odds.
        """
        prior = self.parameters.category_prior
        total = self.counts.total() + prior * self.parameters.category_kinds
        common = [(self.counts[category] + prior) / total for category, _ in names]
        share = np.array([[kind.get(category, 0.0) for kind in kinds] for category, _ in names])
        if not all(kinds):  # of what was never named all is as usual
            share[:, [not kind for kind in kinds]] = np.array(common)[:, None]
        wrong = np.array([[self.wrong(probability)] for _, probability in names])
        parts = np.empty((2, *share.shape))
        parts[0] = (1 - wrong) * share / np.array(common)[:, None]
        parts[1] = wrong * (1 - share)
        np.maximum(parts, 1e-12, out=parts)
        np.log(parts, out=parts)
        return parts[0], parts[1]


def squared_distances(residuals: Floats, numbers: Floats) -> tuple[Floats, Floats]:
    """Return the squared Mahalanobis distances and |S|, (k,) each.

    residuals: (3, k). numbers: xx xy xz yy yz zz of each S, (6, k).
    By the adjugate: NumPy's general inverse costs ten times as much on so many so small matrices.
    The six numbers of a symmetric matrix are rows of one array, as calls cost more than numbers.
    """
    s, r = numbers, residuals
    cofactors = s.take(_LEFT, axis=0)
    cofactors *= s.take(_RIGHT, axis=0)
    minus = s.take(_LESS, axis=0)
    minus *= s.take(_TIMES, axis=0)
    cofactors -= minus
    determinant = np.maximum(_SUM((s[:3] * cofactors[:3]), axis=0), 1e-18)
    cofactors *= r.take(_FIRST, axis=0)
    cofactors *= r.take(_SECOND, axis=0)
    cofactors *= _TWICE
    return _SUM(cofactors, axis=0) / determinant, determinant


_SUM = np.add.reduce
"""`ndarray.sum` goes a long way to this."""
UPPER = np.array([0, 1, 2, 4, 5, 8])
"""The numbers xx xy xz yy yz zz of a flat symmetric matrix; below, its cofactors by them."""
VARIANCES = np.array([0, 3, 5])
"""Those on its diagonal."""
_LEFT, _RIGHT = np.array([3, 2, 1, 0, 1, 0]), np.array([5, 4, 4, 5, 2, 3])
_LESS, _TIMES = np.array([4, 1, 2, 2, 0, 1]), np.array([4, 5, 3, 2, 4, 1])
_FIRST, _SECOND = np.array([0, 0, 0, 1, 1, 2]), np.array([0, 1, 2, 1, 2, 2])
_TWICE = np.array([[1.0], [2.0], [2.0], [1.0], [2.0], [1.0]])


def load_solver() -> None:
    """Import what `assign` needs: a fifth of a second, which the first frame should not wait."""
    import scipy.optimize  # noqa: F401


def is_settled(scores: Floats, taken: list[int], new_score: float, by: float) -> bool:
    """Say whether each row of scores is better off by so much as `assign` has it than otherwise."""
    rows = range(len(taken))
    own = scores[rows, taken].tolist()  # of a new thing the last column's, which does not count
    least = [(s if c >= 0 else new_score) - by for s, c in zip(own, taken, strict=True)]
    known = [level for level, c in zip(least, taken, strict=True) if c >= 0]
    near = int(np.count_nonzero(scores > np.array(least)[:, None]))
    return near == len(known) and all(level >= new_score for level in known)


def assign(scores: Floats, new_score: float) -> list[int]:
    """Return for each row of scores (n, m) the column it goes to, or -1 for a new thing.

    The assignment with the largest sum, where each column is taken once at most and "new" is
    always free at `new_score`. No row goes to a column that scores less than "new".
    """
    n, m = scores.shape
    if n == 0 or m == 0:
        return [-1] * n
    best: list[int] = scores.argmax(axis=1).tolist()
    top: list[float] = scores.max(axis=1).tolist()
    first = [c if score > new_score else -1 for c, score in zip(best, top, strict=True)]
    wanted = [column for column in first if column >= 0]
    if len(set(wanted)) == len(wanted):  # no two want the same: each has its best
        return first
    from scipy.optimize import linear_sum_assignment

    gain = np.maximum(scores - new_score, 0.0)
    rows, columns = linear_sum_assignment(gain, maximize=True)
    taken = [-1] * n
    for row, column in zip(rows.tolist(), columns.tolist(), strict=True):
        if gain[row, column] > 0:
            taken[row] = column
    return taken
