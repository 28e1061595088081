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


def position_ratio(
    squared: Floats, determinant: Floats, space_m3: Floats | float, parameters: Parameters
) -> Floats:
    """Return the evidence of place from squared Mahalanobis distance and |S|, m^6, alike shaped.

    Student's t, for outliers, against "one other thing in each `space_m3`". Where the position
    could be nearly anywhere itself (S as large as that space) its peak says nothing, and only the
    distance counts: so the gates follow the covariance, and look and category decide where
    positions are useless.
    """
    return np.asarray(position_ratios(squared, determinant, (space_m3,), parameters)[0])


def position_ratios(
    squared: Floats,
    determinant: Floats,
    spaces_m3: Sequence[Floats | float],
    parameters: Parameters,
) -> Floats:
    """Return what `position_ratio` does for each of some spaces, (spaces, ...)."""
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
    """Return the vector (d,), unit length, whose dot product is the likeness of two looks.

    Of a histogram the square root of each colour's share (then the product is Bhattacharyya's
    coefficient: one dominant colour of the background cannot decide alone); else the embedding.
    """
    if not is_histogram:
        return embedding
    mass = np.maximum(embedding, 0.0)
    total = float(mass.sum())
    return np.sqrt(mass / total).astype(np.float32) if total > 0 else mass


def embedding_of(look: Features, is_histogram: bool) -> NDArray[np.float32]:
    """Return the embedding (d,), unit length, that a mean feature stands for."""
    values = np.square(look, dtype=np.float64) if is_histogram else look.astype(np.float64)
    length = float(np.sqrt(np.sum(values**2)))
    return (values / length if length > 0 else values).astype(np.float32)


LOOK_BINS = (1.5, 4.0, 12.0)
"""Views in a mean look, at which it counts as another kind: a mean is more like its views than
they are like each other."""
SAME, OTHER, BESIDE = 0, 1, 2
"""Kinds of pairs: views of one thing; of two of one category; of two that stand side by side and
have different categories, which share their background more than two of a kind across the room."""


class LookModel:
    """How alike views of one thing are, and views of others: learned while the robot looks.

    Light, lens and embedding decide that, so no fixed threshold serves two recordings. Other
    things: those of the same frame, which are never one. The same thing: what place and category
    alone have recognised. All are normal with one variance, so the evidence is a straight line;
    assumed values count as much as `look_prior` views.
    """

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters
        # (bins, SAME | OTHER | BESIDE, count | mean | summed squared deviations)
        self.sums = np.zeros((len(LOOK_BINS) + 1, 3, 3))
        mean = (parameters.look_same, parameters.look_other, parameters.look_beside)
        self.sums[:, :, 0] = parameters.look_prior
        self.sums[:, :, 1] = mean
        self.sums[:, :, 2] = parameters.look_prior * parameters.look_sigma**2

    def add(self, kind: int, likeness: float, views: float) -> None:
        """Learn from a pair; views: of the mean look. kind: SAME, OTHER or BESIDE."""
        row = self.sums[bisect(LOOK_BINS, views), kind]
        if row[0] >= self._parameters.look_memory:
            row[[0, 2]] *= 1.0 - 1.0 / row[0]
        row[0] += 1.0
        delta = likeness - row[1]
        row[1] += delta / row[0]
        row[2] += delta * (likeness - row[1])

    def ratios(self, likeness: Floats, views: Floats, kind: int = OTHER) -> Floats:
        """Return the evidence (n, m) for SAME against `kind`.

        likeness: cosines (n, m) with looks of so many views (m,).
        """
        slope, even = self._lines(kind)
        bins = np.searchsorted(LOOK_BINS, views, side="right")
        raw = slope[bins] * (likeness - even[bins])
        least, most = self._parameters.look_least, self._parameters.look_most
        return np.asarray(np.minimum(np.maximum(raw, least), most))

    def _lines(self, kind: int) -> tuple[Floats, Floats]:
        """Return the slope of the evidence in each bin, and the likeness that says nothing."""
        sums: list[list[list[float]]] = self.sums.tolist()
        slope, even = [], []
        for rows in sums:  # so few numbers go quicker one by one
            (n, same, squares), (m, other, more) = rows[SAME], rows[kind]
            variance = max((squares + more) / (n + m), 1e-4)
            slope.append(max(same - other, 0.0) / variance)
            even.append((same + other) / 2)
        return np.array(slope), np.array(even)


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
        self.doubt = np.array(DOUBT_PRIOR)

    def add(self, category: str, probability: float = 1.0) -> None:
        """Count a detection, by the detector's own probability."""
        self.counts[category] += 1
        self.doubt += (1.0 - probability, 1.0)

    def frequency(self, category: str) -> float:
        """Return the share of detections with this category, smoothed; never 0."""
        prior, kinds = self.parameters.category_prior, self.parameters.category_kinds
        total = self.counts.total() + prior * kinds
        return (self.counts[category] + prior) / total

    def wrong(self, probability: float) -> float:
        """Return the chance that a label of this probability is wrong.

        `confusion` on average, and in proportion to the detector's doubt by what is usual for it:
        detectors differ in how they boast, but all are wrong most where they doubt most.
        """
        usual = float(self.doubt[0] / self.doubt[1]) + DOUBT_LEAST
        share = self.parameters.confusion * (1.0 - probability + DOUBT_LEAST) / usual
        return min(WRONG_MOST, max(WRONG_LEAST, share))

    def ratios(
        self, names: Sequence[tuple[str, float]], votes: Sequence[Mapping[str, float]]
    ) -> tuple[Floats, Floats]:
        """Return the evidence of each name for each thing, (n, m), in two parts.

        names: category and probability. First, that the thing is of this category; then, that it
        is of another and was named wrongly, by a name drawn by frequency. The parts exclude each
        other, so their evidence with all else that depends on them adds up as odds.
        """
        return self.evidence(names, [shares(each) for each in votes])

    def evidence(
        self, names: Sequence[tuple[str, float]], kinds: Sequence[Mapping[str, float]]
    ) -> tuple[Floats, Floats]:
        """Return what `ratios` does, of things that are of each category with these shares."""
        common = [self.frequency(category) for category, _ in names]
        share = np.array(
            [
                [kind.get(category, 0.0) if kind else usual for kind in kinds]
                for (category, _), usual in zip(names, common, strict=True)
            ]
        )
        wrong = np.array([[self.wrong(probability)] for _, probability in names])
        agreed = (1 - wrong) * share / np.array(common)[:, None]
        return np.log(np.maximum(agreed, 1e-12)), np.log(np.maximum(wrong * (1 - share), 1e-12))


def mahalanobis(residuals: Floats, covariances: Floats) -> tuple[Floats, Floats]:
    """Return the squared distances and determinants for residuals (..., 3) and S (..., 3, 3).

    By the adjugate: NumPy's general inverse costs ten times as much on so many so small matrices.
    The six numbers of a symmetric matrix are rows of one array, as calls cost more than numbers.
    """
    shape = residuals.shape[:-1]
    s = covariances.reshape(-1, 9).T[_UPPER]
    cofactors = s[_LEFT] * s[_RIGHT] - s[_LESS] * s[_TIMES]
    determinant = np.maximum((s[:3] * cofactors[:3]).sum(axis=0), 1e-18)
    r = residuals.reshape(-1, 3).T
    squared = (cofactors * r[_FIRST] * r[_SECOND] * _TWICE).sum(axis=0) / determinant
    return squared.reshape(shape), determinant.reshape(shape)


_UPPER = np.array([0, 1, 2, 4, 5, 8])
"""The numbers xx xy xz yy yz zz of a flat symmetric matrix; below, its cofactors by them."""
_LEFT, _RIGHT = np.array([3, 2, 1, 0, 1, 0]), np.array([5, 4, 4, 5, 2, 3])
_LESS, _TIMES = np.array([4, 1, 2, 2, 0, 1]), np.array([4, 5, 3, 2, 4, 1])
_FIRST, _SECOND = np.array([0, 0, 0, 1, 1, 2]), np.array([0, 1, 2, 1, 2, 2])
_TWICE = np.array([[1.0], [2.0], [2.0], [1.0], [2.0], [1.0]])


def load_solver() -> None:
    """Import what `assign` needs: a fifth of a second, which the first frame should not wait."""
    import scipy.optimize  # noqa: F401


def assign(scores: Floats, new_score: float) -> list[int]:
    """Return for each row of scores (n, m) the column it goes to, or -1 for a new thing.

    The assignment with the largest sum, where each column is taken once at most and "new" is
    always free at `new_score`. No row goes to a column that scores less than "new".
    """
    n, m = scores.shape
    if n == 0 or m == 0:
        return [-1] * n
    gain = np.maximum(scores - new_score, 0.0)
    best = gain.argmax(axis=1)
    wanted = [column for i, column in enumerate(best.tolist()) if gain[i, column] > 0]
    if len(set(wanted)) == len(wanted):  # no two want the same: each has its best
        return [column if gain[i, column] > 0 else -1 for i, column in enumerate(best.tolist())]
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(gain, maximize=True)
    taken = [-1] * n
    for row, column in zip(rows.tolist(), columns.tolist(), strict=True):
        if gain[row, column] > 0:
            taken[row] = column
    return taken
