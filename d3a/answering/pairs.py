"""Pairs of a figure and a ground as arrays, and what geometry tells of each pair.

Relations are made of these. What is unknown of a pair is NaN, and stays so.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Rows = NDArray[np.intp]
SAME_SPOT_M = 1e-6
"""Positions closer than this are one estimate for a whole frame: they tell nothing of a pair."""
DEFAULT_SIGMA_M = 0.25
"""The deviation of a position whose covariance is unknown."""
EDGE_M = 0.1
EDGE_SHARE = 0.15
"""How far beyond a measured width a figure's middle may be: of things a part is seen."""


VISIT_ERROR = 1.65
"""By how much things never seen together are further off each other than their covariances say:
these take looks for independent, but the looks of one visit share the error of the robot's place.
Between things of one frame that error cancels. So measured in worlds of two simulators."""
SURE_M = 0.05
"""No mean of frames is surer than this: they share the error of the robot's heading."""
THIN_M = 0.8
"""No furniture is less deep."""
SURFACE_SHARE = 0.25
"""What is measured of a thing lies so far before its middle, as a share of its depth: it is between
the middle, where a detector may put it, and the surface, which a depth camera measures."""
_NODES = 24  # of Gauss's rule
_TAIL = 6.0  # deviations, beyond which a bell is nothing


@dataclass(frozen=True, slots=True)
class Pairs:
    """n pairs of a figure (a) and a ground (b); NaN where something is unknown.

    position_a, position_b (n, 3): metres. sigma (n,): deviation of how far apart they are along any
    line of the ground plane, metres.
    box_a, box_b (n, 4): pixels of a frame that shows both. viewer (n, 7): the camera's pose,
    x y z qx qy qz qw. extent_a, extent_b (n, 2): width and height in metres. sigma_up (n,):
    deviation of their difference in height, metres. usual_b (n,): whether the ground is of a
    kind that is usual for the relation: things lie on tables, stand under furniture. up: the map's
    axis that points up and its sign.
    """

    position_a: Floats
    position_b: Floats
    sigma: Floats
    box_a: Floats
    box_b: Floats
    viewer: Floats
    extent_a: Floats
    extent_b: Floats
    sigma_up: Floats
    usual_b: NDArray[np.bool_]
    up: tuple[int, float] = field(init=False)

    def __post_init__(self) -> None:
        """Find which way is up, which most of what is asked of pairs needs."""
        object.__setattr__(self, "up", up_axis(self.viewer))

    def at(self, rows: slice | Rows) -> Pairs:
        """Return some of the pairs, in that order."""
        return Pairs(*(getattr(self, each.name)[rows] for each in fields(self) if each.init))

    def __len__(self) -> int:
        return len(self.sigma)

    @property
    def shared(self) -> NDArray[np.bool_]:
        """Which pairs have a frame that shows both (n,)."""
        return ~(np.isnan(self.box_a[:, 0]) | np.isnan(self.box_b[:, 0]))


def placed_together(pairs: Pairs, apart: Floats) -> Pairs:
    """Return the pairs with places as far apart as frames that show both measured it.

    apart (n, 4): from figure to ground and the deviation of that, NaN where no frame tells. It has
    no error of the robot's place in it, which all the looks of one visit share; but of what is wide
    a frame shows one side, and places are means over all sides: both count, as they are sure.
    Heights stay: a robot drives on a floor, and the more looks the surer they are.
    """
    known = ~np.isnan(apart[:, 3])
    width = np.nan_to_num(np.hypot(pairs.extent_a[:, 0], pairs.extent_b[:, 0]))
    error = np.maximum(np.nan_to_num(apart[:, 3]), SURE_M)
    own = np.hypot(error, EDGE_SHARE * width) ** 2
    places = (VISIT_ERROR * pairs.sigma) ** 2
    share = np.where(known, places / (places + own), 0.0)
    missing = np.nan_to_num(apart[:, :3] - (pairs.position_b - pairs.position_a))
    moved = share[:, None] * missing / 2
    moved[:, pairs.up[0]] = 0.0
    return replace(
        pairs,
        position_a=pairs.position_a - moved,
        position_b=pairs.position_b + moved,
        sigma=np.sqrt((share * error) ** 2 + (1 - share) ** 2 * places),
    )


def with_middles(pairs: Pairs, group: Rows) -> Pairs:
    """Return the pairs with the things' middles: what is measured of a thing is before it.

    group (n,): a number for each two things at their places. They are looked at from where the
    viewers of their shared frames stand on average: what is seen from all around was measured
    around its middle, and what no frame shows together stays as it was measured.
    """
    if not pairs.shared.any():
        return pairs
    line = pairs.position_a - pairs.position_b
    told = (np.einsum("ik,ik->i", line, line) >= SAME_SPOT_M**2)[:, None]
    moved = [
        place + np.where(told, _behind(pairs, place, extent, group), 0.0)
        for place, extent in (
            (pairs.position_a, pairs.extent_a),
            (pairs.position_b, pairs.extent_b),
        )
    ]
    return replace(pairs, position_a=moved[0], position_b=moved[1])


def _behind(pairs: Pairs, place: Floats, extent: Floats, group: Rows) -> Floats:
    """Return from what was measured of things to their middles (n, 3), metres."""
    away = place - pairs.viewer[:, :3]
    away[:, pairs.up[0]] = 0.0
    far = np.sqrt(np.einsum("ik,ik->i", away, away))
    seen = pairs.shared & (far > SAME_SPOT_M)  # False for NaN
    away = np.where(seen[:, None], away, 0.0) / np.where(seen, far, 1.0)[:, None]
    looks = np.maximum(np.bincount(group, seen), 1.0)
    sides = np.stack([np.bincount(group, away[:, k]) / looks for k in range(3)], axis=1)
    deep = SURFACE_SHARE * np.nan_to_num(np.minimum(extent[:, 0], THIN_M))
    return np.asarray(sides[group] * deep[:, None])


def normal_cdf(z: Floats) -> Floats:
    """Return the standard normal distribution function, to 1e-7, without scipy.

    Abramowitz and Stegun 26.2.17: `ask` must not pay for the import of scipy.
    """
    t = 1.0 / (1.0 + 0.2316419 * np.abs(z))
    poly = t * (
        0.319381530 + t * (-0.356563782 + t * (1.781477937 + t * (-1.821255978 + t * 1.330274429)))
    )
    upper = np.exp(-0.5 * np.minimum(z * z, 700.0)) / np.sqrt(2 * np.pi) * poly
    return np.asarray(np.where(z >= 0, 1.0 - upper, upper))


def up_axis(viewers: Floats) -> tuple[int, float]:
    """Return the map's axis that points up and its sign, by where the cameras' tops point.

    viewers (n, 7). A camera is carried upright: the mean of its own up is nearest to the map's.
    Without any viewer, z (REP 103).
    """
    known = viewers[~np.isnan(viewers[:, 0])] if len(viewers) else viewers
    if len(known) == 0:
        return 2, 1.0
    up = -camera_axis(known, 1).mean(axis=0)  # optical y points down
    axis = int(np.argmax(np.abs(up)))
    return axis, 1.0 if up[axis] >= 0 else -1.0


def camera_axis(viewer: Floats, column: int) -> Floats:
    """Return a column of each viewer's rotation matrix (n, 3): 0 right, 1 down, 2 forward."""
    x, y, z, w = viewer[:, 3], viewer[:, 4], viewer[:, 5], viewer[:, 6]
    if column == 0:
        return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)], 1)
    if column == 1:
        return np.stack([2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)], 1)
    return np.stack([2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)], 1)


def box_middle(box: Floats) -> Floats:
    """Return the middle of each box (n, 2)."""
    return np.stack([box[:, 0] + box[:, 2], box[:, 1] + box[:, 3]], axis=1) / 2


def distance_of(pairs: Pairs, *, level: bool = False) -> Floats:
    """Return metres between figure and ground, NaN where unknown or one estimate for both.

    level: in the ground plane only.
    """
    apart = pairs.position_a - pairs.position_b
    full = np.einsum("ik,ik->i", apart, apart)
    told = full
    if level:
        apart[:, pairs.up[0]] = 0.0
        told = np.einsum("ik,ik->i", apart, apart)
    return np.where(full < SAME_SPOT_M**2, np.nan, np.sqrt(told))


def spread_out(pairs: Pairs) -> tuple[Floats, Floats]:
    """Return how far figure and ground are apart across the view and along it, in the plane.

    Metres (n,), NaN without a viewer or where `distance_of` is.
    """
    apart = distance_of(pairs, level=True)
    across = np.abs(((pairs.position_a - pairs.position_b) * camera_axis(pairs.viewer, 0)).sum(1))
    across = np.minimum(across, apart)
    return across, np.sqrt(apart**2 - across**2)


def rise_of(pairs: Pairs) -> Floats:
    """Return how far the figure's centre is above the ground's, metres."""
    axis, sign = pairs.up
    return sign * (pairs.position_a - pairs.position_b)[:, axis]


def within(pairs: Pairs, limit_m: Floats | float, *, level: bool = False) -> Floats:
    """Return the probability that both are within the limit, NaN where positions do not tell."""
    return normal_cdf((limit_m - distance_of(pairs, level=level)) / pairs.sigma)


def displaced_within(pairs: Pairs, limit_m: float, spread: Floats) -> Floats:
    """Return the probability that both are truly within the limit (n,), NaN without positions.

    spread (n,): deviation of their displacement along each line of the plane; heights are taken as
    measured. Of all displacements that may have been measured so, more are longer: there is more
    room. The integral of the round bell over the disc, by Gauss's rule.
    """
    off = distance_of(pairs, level=True)
    radius = np.sqrt(np.maximum(limit_m**2 - rise_of(pairs) ** 2, 0.0))
    low = np.maximum(-radius, off - _TAIL * spread)
    span = np.maximum(np.minimum(radius, off + _TAIL * spread) - low, 0.0)
    total = np.zeros(len(pairs))
    with np.errstate(invalid="ignore"):
        for node, weight in _rule():
            x = low + span * (node + 1) / 2
            half = np.sqrt(np.maximum(radius**2 - x**2, 0.0)) / spread
            bell = np.exp(-(((x - off) / spread) ** 2) / 2) / np.sqrt(2 * np.pi)
            total += weight * bell * (2 * normal_cdf(half) - 1)
        return np.asarray(total * span / (2 * spread))


@lru_cache(maxsize=1)
def _rule() -> tuple[tuple[float, float], ...]:
    """Return Gauss's rule, (node, weight) each; what solves for it is loaded when it is used."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    return tuple(zip(nodes.tolist(), weights.tolist(), strict=True))


def as_factor(evidence: Floats) -> Floats:
    """Return evidence as a factor: what is unknown does not count against the pair."""
    return np.where(np.isnan(evidence), 1.0, evidence)


def soft_step(x: Floats, at: Floats | float, width: float) -> Floats:
    """Return a soft step from 0 to 1 around `at`, half way there."""
    return 1.0 / (1.0 + np.exp(-np.clip((x - at) / width, -50.0, 50.0)))


def overlap_x(pairs: Pairs) -> Floats:
    """Return the share of the narrower box's width that both cover."""
    left = np.maximum(pairs.box_a[:, 0], pairs.box_b[:, 0])
    right = np.minimum(pairs.box_a[:, 2], pairs.box_b[:, 2])
    width_a = pairs.box_a[:, 2] - pairs.box_a[:, 0]
    width_b = pairs.box_b[:, 2] - pairs.box_b[:, 0]
    return np.asarray(np.clip(right - left, 0.0, None) / np.minimum(width_a, width_b))


def apart_sigma(pairs: Pairs) -> Floats:
    """Return the deviation of a pair's displacement in the plane, metres (n,).

    The point that was measured of a wide thing is anywhere on what was seen of it.
    """
    width = np.nan_to_num(np.hypot(pairs.extent_a[:, 0], pairs.extent_b[:, 0]))
    return np.hypot(pairs.sigma, EDGE_SHARE * width)


def height_in(pairs: Pairs, edge: Floats) -> Floats:
    """Return where a row lies in the ground's box: 0 its top, 1 its bottom, below 0 above it."""
    return (edge - pairs.box_b[:, 1]) / (pairs.box_b[:, 3] - pairs.box_b[:, 1])


def beside_within(pairs: Pairs, limit_m: Floats | float) -> Floats:
    """Return the probability that both are within the limit across the picture, NaN if untold.

    Their own sizes are the scale, and the finer of the two counts. Where a box shows less than the
    width, its middle may be off by half of the rest. What one frame
    shows has no error of the robot's place in it.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        scales, hidden = [], []
        for extent, box in ((pairs.extent_a, pairs.box_a), (pairs.extent_b, pairs.box_b)):
            scale = metres_a_pixel(extent, box)
            scales.append(scale)
            hidden.append(np.clip(extent[:, 0] - (box[:, 2] - box[:, 0]) * scale, 0.0, None) / 2)
        apart = np.abs(box_middle(pairs.box_a) - box_middle(pairs.box_b))[:, 0] * np.fmin(*scales)
        apart = np.clip(apart - np.nan_to_num(hidden[0]) - np.nan_to_num(hidden[1]), 0.0, None)
        return normal_cdf((limit_m - apart) / (0.1 * apart + EDGE_M))


def metres_a_pixel(extent: Floats, box: Floats) -> Floats:
    """Return how many metres a pixel is at a thing (n,), by its size (n, 2) and its box (n, 4).

    The finer of its sides counts: a box that is cut makes it coarser. NaN without either.
    """
    width, height = box[:, 2] - box[:, 0], box[:, 3] - box[:, 1]
    return np.asarray(np.fmin(extent[:, 0] / width, extent[:, 1] / height))


def longer_side(box: Floats) -> Floats:
    """Return the longer side of each box (n,), pixels."""
    return np.maximum(box[:, 2] - box[:, 0], box[:, 3] - box[:, 1])


def box_area(box: Floats) -> Floats:
    """Return the area of each box (n,), square pixels."""
    return (box[:, 2] - box[:, 0]) * (box[:, 3] - box[:, 1])


def swapped(pairs: Pairs, usual: NDArray[np.bool_] | None = None) -> Pairs:
    """Return the pairs with figure and ground the other way round.

    usual (n,): whether what is now the ground is of a usual kind; None: of none it is known.
    """
    return Pairs(
        pairs.position_b,
        pairs.position_a,
        pairs.sigma,
        pairs.box_b,
        pairs.box_a,
        pairs.viewer,
        pairs.extent_b,
        pairs.extent_a,
        pairs.sigma_up,
        np.zeros_like(pairs.usual_b) if usual is None else usual,
    )
