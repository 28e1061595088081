"""Relations between two things as probabilities: geometry of boxes, positions and the viewer.

DESIGN, decision 7. A shared frame tells by its boxes, positions tell by their distance against
their own uncertainty, sides and depths are the viewer's in the keyframe. Whole arrays, no loop
over pairs. A pair that nothing can be said of gets NaN, which is not a no.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.parameters import Parameters
from grammar.forms import RelationKind

Floats = NDArray[np.float64]
SAME_SPOT_M = 1e-6
"""Positions closer than this are one estimate for a whole frame: they tell nothing of a pair."""
DEFAULT_SIGMA_M = 0.25
"""The deviation of a position whose covariance is unknown."""
REACH_M = 0.6
"""Half the width of a ground whose extent is unknown, and the slack of its edge."""
LEVEL_M = 0.1
"""How far a measured point may lie on the wrong side of another: the middle of a thing's front
is below its top."""
SIDE_M = 2.0
"""Left, right, behind and in front are said of things within this distance."""


@dataclass(frozen=True, slots=True)
class Pairs:
    """n pairs of a figure (a) and a ground (b); NaN where something is unknown.

    position_a, position_b (n, 3): metres. sigma (n,): deviation of their distance in metres.
    box_a, box_b (n, 4): pixels of a frame that shows both. viewer (n, 7): the camera's pose,
    x y z qx qy qz qw. width_b (n,): extent of the ground in metres.
    """

    position_a: Floats
    position_b: Floats
    sigma: Floats
    box_a: Floats
    box_b: Floats
    viewer: Floats
    width_b: Floats

    def __len__(self) -> int:
        return len(self.sigma)

    @property
    def shared(self) -> NDArray[np.bool_]:
        """Which pairs have a frame that shows both (n,)."""
        return ~(np.isnan(self.box_a[:, 0]) | np.isnan(self.box_b[:, 0]))


def probability(kind: RelationKind, pairs: Pairs, parameters: Parameters) -> Floats:
    """Return how likely the relation holds for each pair, 0..1, NaN where nothing tells it.

    `between` has two grounds: see `between`.
    """
    if len(pairs) == 0:
        return np.zeros(0)
    with np.errstate(invalid="ignore", divide="ignore"):
        result = _KINDS[kind](pairs, parameters)
        return np.where(np.isnan(result), np.nan, np.clip(result, 0.0, 1.0))


def between(first: Pairs, second: Pairs) -> Floats:
    """Return how likely a lies between b (of `first`) and c (of `second`), 0..1, (n,).

    By positions: the foot of a on the line b-c is between its ends, and a is near the line.
    By boxes of a frame that shows all three, where positions do not tell.
    """
    a, b, c = first.position_a, first.position_b, second.position_b
    line = c - b
    length = np.linalg.norm(line, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        along = ((a - b) * line).sum(axis=1) / length
        off = np.sqrt(np.maximum(((a - b) ** 2).sum(axis=1) - along**2, 0.0))
        sigma = np.maximum(first.sigma, second.sigma)
        by_place = (
            normal_cdf(along / sigma)
            * normal_cdf((length - along) / sigma)
            * normal_cdf((np.maximum(length / 2, REACH_M) - off) / sigma)
        )
        x_a, x_b, x_c = (_centre(box)[:, 0] for box in (first.box_a, first.box_b, second.box_b))
        scale = 0.25 * np.abs(x_c - x_b)
        low, high = np.minimum(x_b, x_c), np.maximum(x_b, x_c)
        by_box = normal_cdf((x_a - low) / scale) * normal_cdf((high - x_a) / scale)
        return np.where(np.isnan(by_place) | (length < SAME_SPOT_M), by_box, by_place)


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
    up = -_axis(known, 1).mean(axis=0)  # optical y points down
    axis = int(np.argmax(np.abs(up)))
    return axis, 1.0 if up[axis] >= 0 else -1.0


def _axis(viewer: Floats, column: int) -> Floats:
    """Return a column of each viewer's rotation matrix (n, 3): 0 right, 1 down, 2 forward."""
    x, y, z, w = viewer[:, 3], viewer[:, 4], viewer[:, 5], viewer[:, 6]
    if column == 0:
        return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)], 1)
    if column == 1:
        return np.stack([2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)], 1)
    return np.stack([2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)], 1)


def _centre(box: Floats) -> Floats:
    return np.stack([box[:, 0] + box[:, 2], box[:, 1] + box[:, 3]], axis=1) / 2


def _distance(pairs: Pairs, *, level: bool = False) -> Floats:
    """Return metres between figure and ground, NaN where unknown or one estimate for both.

    level: in the ground plane only.
    """
    apart = pairs.position_a - pairs.position_b
    full = np.linalg.norm(apart, axis=1)
    if level:
        axis, _ = up_axis(pairs.viewer)
        apart = np.delete(apart, axis, axis=1)
    return np.where(full < SAME_SPOT_M, np.nan, np.linalg.norm(apart, axis=1))


def _rise(pairs: Pairs) -> Floats:
    """Return how far the figure's centre is above the ground's, metres."""
    axis, sign = up_axis(pairs.viewer)
    return sign * (pairs.position_a - pairs.position_b)[:, axis]


def _within(pairs: Pairs, limit_m: Floats | float, *, level: bool = False) -> Floats:
    """Return the probability that both are within the limit, NaN where positions do not tell."""
    return normal_cdf((limit_m - _distance(pairs, level=level)) / pairs.sigma)


def _known(evidence: Floats) -> Floats:
    """Return evidence as a factor: what is unknown does not count against the pair."""
    return np.where(np.isnan(evidence), 1.0, evidence)


def _step(x: Floats, at: float, width: float) -> Floats:
    """Return a soft step from 0 to 1 around `at`, half way there."""
    return 1.0 / (1.0 + np.exp(-np.clip((x - at) / width, -50.0, 50.0)))


def _overlap_x(pairs: Pairs) -> Floats:
    """Return the share of the narrower box's width that both cover."""
    left = np.maximum(pairs.box_a[:, 0], pairs.box_b[:, 0])
    right = np.minimum(pairs.box_a[:, 2], pairs.box_b[:, 2])
    width_a = pairs.box_a[:, 2] - pairs.box_a[:, 0]
    width_b = pairs.box_b[:, 2] - pairs.box_b[:, 0]
    return np.asarray(np.clip(right - left, 0.0, None) / np.minimum(width_a, width_b))


def _height_in(pairs: Pairs, edge: Floats) -> Floats:
    """Return where a row lies in the ground's box: 0 its top, 1 its bottom, below 0 above it."""
    return (edge - pairs.box_b[:, 1]) / (pairs.box_b[:, 3] - pairs.box_b[:, 1])


def _footprint(pairs: Pairs) -> Floats:
    """Return the probability that the figure stands within the ground's width, in the plane."""
    half = np.where(np.isnan(pairs.width_b), REACH_M, pairs.width_b / 2)
    return _within(pairs, half + REACH_M / 2, level=True)


def _box_or_place(pairs: Pairs, by_box: Floats, by_place: Floats, sign: float = 0.0) -> Floats:
    """Return what the boxes say, checked by the positions; the positions alone where no frame.

    sign: +1 where the figure must not be lower than the ground, -1 not higher, 0 for either: a
    chair behind a table is seen over its edge, but stands below its top.
    """
    rise = np.where(np.isnan(_distance(pairs)), np.nan, _rise(pairs))
    level = _known(normal_cdf((sign * rise + LEVEL_M) / pairs.sigma)) if sign else 1.0
    return np.where(pairs.shared, by_box * _known(_footprint(pairs)) * level, by_place)


def _vertical(pairs: Pairs, sign: float) -> Floats:
    """Return the probability by positions that the figure is above (+1) or below (-1)."""
    rise = np.where(np.isnan(_distance(pairs)), np.nan, _rise(pairs))
    return normal_cdf(sign * rise / pairs.sigma) * _footprint(pairs)


def _together(pairs: Pairs, parameters: Parameters) -> Floats:
    near = _within(pairs, parameters.together_m)
    near = np.where(np.linalg.norm(pairs.position_a - pairs.position_b, axis=1) == 0, 1.0, near)
    return np.where(pairs.shared, 1.0, near)


def _near(pairs: Pairs, parameters: Parameters) -> Floats:
    by_place = _within(pairs, parameters.near_m)
    gap_x = np.maximum(pairs.box_a[:, 0], pairs.box_b[:, 0]) - np.minimum(
        pairs.box_a[:, 2], pairs.box_b[:, 2]
    )
    gap_y = np.maximum(pairs.box_a[:, 1], pairs.box_b[:, 1]) - np.minimum(
        pairs.box_a[:, 3], pairs.box_b[:, 3]
    )
    gap = np.hypot(np.maximum(gap_x, 0), np.maximum(gap_y, 0))
    size = np.maximum(_size(pairs.box_a), _size(pairs.box_b))
    by_box = np.exp(-gap / size)  # a picture has no metres: things are near at their own size
    return np.where(np.isnan(by_place), by_box, by_place)


def _size(box: Floats) -> Floats:
    return np.maximum(box[:, 2] - box[:, 0], box[:, 3] - box[:, 1])


def _on(pairs: Pairs, _: Parameters) -> Floats:
    foot = _height_in(pairs, pairs.box_a[:, 3])
    head = _height_in(pairs, pairs.box_a[:, 1])
    by_box = (
        _step(_overlap_x(pairs), 0.4, 0.08)
        * _step(foot, -0.15, 0.04)
        * (1 - _step(foot, 0.75, 0.06))
        * (1 - _step(head, 0.5, 0.08))
    )
    return _box_or_place(pairs, by_box, _vertical(pairs, 1.0), 1.0)


def _under(pairs: Pairs, _: Parameters) -> Floats:
    head = _height_in(pairs, pairs.box_a[:, 1])
    foot = _height_in(pairs, pairs.box_a[:, 3])
    by_box = _step(_overlap_x(pairs), 0.4, 0.08) * _step(head, 0.3, 0.06) * _step(foot, 0.65, 0.06)
    return _box_or_place(pairs, by_box, _vertical(pairs, -1.0), -1.0)


def _above(pairs: Pairs, _: Parameters) -> Floats:
    foot = _height_in(pairs, pairs.box_a[:, 3])
    by_box = _step(_overlap_x(pairs), 0.4, 0.08) * (1 - _step(foot, 0.1, 0.05))
    return _box_or_place(pairs, by_box, _vertical(pairs, 1.0), 1.0)


def _in(pairs: Pairs, _: Parameters) -> Floats:
    width = np.minimum(pairs.box_a[:, 2], pairs.box_b[:, 2]) - np.maximum(
        pairs.box_a[:, 0], pairs.box_b[:, 0]
    )
    height = np.minimum(pairs.box_a[:, 3], pairs.box_b[:, 3]) - np.maximum(
        pairs.box_a[:, 1], pairs.box_b[:, 1]
    )
    inside = np.clip(width, 0, None) * np.clip(height, 0, None) / _area(pairs.box_a)
    by_box = _step(inside, 0.75, 0.06) * (
        1 - _step(_area(pairs.box_a) / _area(pairs.box_b), 0.8, 0.05)
    )
    half = np.where(np.isnan(pairs.width_b), REACH_M, pairs.width_b / 2)
    return _box_or_place(pairs, by_box, _within(pairs, half))


def _area(box: Floats) -> Floats:
    return (box[:, 2] - box[:, 0]) * (box[:, 3] - box[:, 1])


def _left_of(pairs: Pairs, _: Parameters) -> Floats:
    half_widths = (
        pairs.box_a[:, 2] - pairs.box_a[:, 0] + pairs.box_b[:, 2] - pairs.box_b[:, 0]
    ) / 4
    by_box = normal_cdf((_centre(pairs.box_b) - _centre(pairs.box_a))[:, 0] / half_widths)
    side = ((pairs.position_b - pairs.position_a) * _axis(pairs.viewer, 0)).sum(axis=1)
    by_place = normal_cdf(side / pairs.sigma)
    return np.where(pairs.shared, by_box, by_place) * _known(_within(pairs, SIDE_M))


def _right_of(pairs: Pairs, parameters: Parameters) -> Floats:
    return _left_of(_swapped(pairs), parameters)


def _swapped(pairs: Pairs) -> Pairs:
    return Pairs(
        pairs.position_b,
        pairs.position_a,
        pairs.sigma,
        pairs.box_b,
        pairs.box_a,
        pairs.viewer,
        pairs.width_b,
    )


def _in_front_of(pairs: Pairs, _: Parameters) -> Floats:
    nearer = ((pairs.position_b - pairs.position_a) * _axis(pairs.viewer, 2)).sum(axis=1)
    by_place = np.where(np.isnan(_distance(pairs)), np.nan, normal_cdf(nearer / pairs.sigma))
    height = np.minimum(
        pairs.box_a[:, 3] - pairs.box_a[:, 1], pairs.box_b[:, 3] - pairs.box_b[:, 1]
    )
    # things stand on a common floor or top: what is nearer ends lower in the picture
    by_box = normal_cdf((pairs.box_a[:, 3] - pairs.box_b[:, 3]) / (0.5 * height))
    front = np.where(np.isnan(by_place), by_box, by_place)
    aligned = np.where(pairs.shared, _step(_overlap_x(pairs), 0.15, 0.08), 1.0)
    return front * aligned * _known(_within(pairs, SIDE_M))


def _behind(pairs: Pairs, parameters: Parameters) -> Floats:
    return _in_front_of(_swapped(pairs), parameters)


def _same_place(pairs: Pairs, parameters: Parameters) -> Floats:
    here = np.linalg.norm(pairs.position_a - pairs.position_b, axis=1)
    return normal_cdf((parameters.d_thresh_m - here) / pairs.sigma)


def _between_alone(pairs: Pairs, parameters: Parameters) -> Floats:
    """Return nearness: between one ground and an unknown other, nothing more can be said."""
    return _near(pairs, parameters)


_KINDS: dict[RelationKind, Callable[[Pairs, Parameters], Floats]] = {
    "together": _together,
    "near": _near,
    "on": _on,
    "under": _under,
    "in": _in,
    "above": _above,
    "left_of": _left_of,
    "right_of": _right_of,
    "in_front_of": _in_front_of,
    "behind": _behind,
    "same_place": _same_place,
    "between": _between_alone,
}
