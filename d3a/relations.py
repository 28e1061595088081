"""Relations between two things as probabilities: geometry of boxes, positions and the viewer.

DESIGN, decision 7. A shared frame tells by its boxes, positions tell by their distance against
their own uncertainty, sides and depths are the viewer's in the keyframe. Whole arrays, no loop
over pairs. A pair that nothing can be said of gets NaN, which is not a no.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from d3a.answering.footprints import PART_M, WIDE_M, footprint
from d3a.answering.pairs import (
    EDGE_M,
    SAME_SPOT_M,
    Floats,
    Pairs,
    apart_sigma,
    as_factor,
    beside_within,
    box_area,
    box_middle,
    camera_axis,
    displaced_within,
    distance_of,
    height_in,
    longer_side,
    normal_cdf,
    overlap_x,
    rise_of,
    soft_step,
    swapped,
    within,
)
from d3a.answering.silhouettes import in_line
from d3a.parameters import Parameters
from grammar.forms import RelationKind

REACH_M = 0.6
"""What hangs over a thing is no higher than this, and half the width of a hollow one of unknown
size."""
LEVEL_M = 0.1
"""How far a measured point may lie on the wrong side of another: the middle of a thing's front
is below its top."""
SEAT_M = 0.15
"""How far above a measured top the underside of what lies on it may be."""
TEMPER = 0.15
"""What boxes may take from measured places: much of a table is hidden, and its box says little."""
TOP_SHARE = 0.25
"""What is above a table clears this share of the way from its middle to its measured top: the box
of a wide top that is looked down on reaches higher than the top, by the far edge, and that of a low
one most. Of other things it clears all."""
EYE_SHARE = 0.5
"""A wide top is looked down on from above this share of its measured height over the middle."""
SEAT_SHARE = 0.2
"""How far below its middle, as a share of its height, a thing may carry another: a couch's seat."""
FITS_SHARE = 0.8
"""What is in or under a thing is narrower than this share of its width."""
SOLID = 0.3
"""How likely a thing that is not known as hollow has room for what is measured inside of it."""
ROOF_M = 0.35
"""What is narrower has nothing under it that would be said to be there."""
FLOOR_SHARE = 0.3
"""What is under a thing stands no higher than this share of its height: on the floor with it."""
UPRIGHT_M, UPRIGHT_SHARE = 0.08, 0.06
"""Heights are known to this, whatever the error of the robot's place: it drives on a floor; and to
this share of what was measured of both."""
SIDE_M = 2.0
"""Left, right, behind and in front are said of things within this distance."""


GROUPED = 1.2
"""Things stand in groups: by how much this makes it likelier that two are at one place."""


def probability(kind: RelationKind, pairs: Pairs, parameters: Parameters) -> Floats:
    """Return how likely the relation holds for each pair, 0..1, NaN where nothing tells it.

    `between` has two grounds: see `between`.
    """
    if len(pairs) == 0:
        return np.zeros(0)
    with np.errstate(invalid="ignore", divide="ignore"):
        result = _KINDS[kind](pairs, parameters)
        return np.where(np.isnan(result), np.nan, np.clip(result, 0.0, 1.0))


def between(first: Pairs, second: Pairs, shared: NDArray[np.bool_]) -> Floats:
    """Return how likely a lies between b (of `first`) and c (of `second`), 0..1, (n,).

    By positions: from a, the two others are on opposite sides, so that the angle is obtuse: a lies
    in the ball around their middle that both are on.
    By boxes where positions do not tell. shared (n,): whether one frame shows all three.
    """
    b, c = first.position_b - first.position_a, second.position_b - second.position_a
    length = np.linalg.norm(c - b, axis=1)
    off = np.linalg.norm(b + c, axis=1) / 2
    with np.errstate(invalid="ignore", divide="ignore"):
        by_place = normal_cdf((length / 2 - off) / np.maximum(first.sigma, second.sigma))
        x_a, x_b, x_c = (box_middle(box)[:, 0] for box in (first.box_a, first.box_b, second.box_b))
        scale = 0.25 * np.abs(x_c - x_b)
        low, high = np.minimum(x_b, x_c), np.maximum(x_b, x_c)
        by_box = normal_cdf((x_a - low) / scale) * normal_cdf((high - x_a) / scale)
        by_box = np.where(shared, by_box, np.nan)
        return np.where(np.isnan(by_place) | (length < SAME_SPOT_M), by_box, by_place)


def _measured(pairs: Pairs) -> NDArray[np.bool_]:
    """Return for which pairs places and sizes tell what is on or under what (n,)."""
    sized = ~(np.isnan(pairs.extent_a).any(axis=1) | np.isnan(pairs.extent_b).any(axis=1))
    return sized & ~np.isnan(distance_of(pairs))


def _heights(pairs: Pairs) -> tuple[Floats, Floats]:
    """Return the figure's underside and the ground's top above the ground's middle, metres."""
    return rise_of(pairs) - pairs.extent_a[:, 1] / 2, pairs.extent_b[:, 1] / 2


def _tempered(
    pairs: Pairs, by_box: Floats, by_size: Floats, otherwise: Callable[[], Floats]
) -> Floats:
    """Return what measured places say, tempered by the boxes of a shared frame; else `otherwise`.

    by_size: by places and sizes, where both are known.
    """
    tempered = by_size * np.where(pairs.shared, 1 - TEMPER + TEMPER * by_box, 1.0)
    measured = _measured(pairs)
    return tempered if measured.all() else np.where(measured, tempered, otherwise())


def _box_or_place(pairs: Pairs, by_box: Floats, by_place: Floats, sign: float = 0.0) -> Floats:
    """Return what the boxes say, checked by the positions; the positions alone where no frame.

    sign: +1 where the figure must not be lower than the ground, -1 not higher, 0 for either: a
    chair behind a table is seen over its edge, but stands below its top.
    """
    rise = np.where(np.isnan(distance_of(pairs)), np.nan, rise_of(pairs))
    level = as_factor(normal_cdf((sign * rise + LEVEL_M) / pairs.sigma)) if sign else 1.0
    return np.where(pairs.shared, by_box * as_factor(footprint(pairs)) * level, by_place)


def _over_or_below(pairs: Pairs, by_box: Floats, sign: float) -> Floats:
    """Return the probability that the figure is over (+1) or below (-1), without any sizes."""
    return _box_or_place(pairs, by_box, _vertical(pairs, sign), sign)


def _vertical(pairs: Pairs, sign: float) -> Floats:
    """Return the probability by positions that the figure is above (+1) or below (-1)."""
    rise = np.where(np.isnan(distance_of(pairs)), np.nan, rise_of(pairs))
    return normal_cdf(sign * rise / pairs.sigma) * footprint(pairs)


def _together(pairs: Pairs, parameters: Parameters) -> Floats:
    near = within(pairs, parameters.together_m)
    near = np.where(np.linalg.norm(pairs.position_a - pairs.position_b, axis=1) == 0, 1.0, near)
    return np.where(pairs.shared, 1.0, near)


def _near(pairs: Pairs, parameters: Parameters) -> Floats:
    by_place = within(pairs, parameters.near_m) * as_factor(beside_within(pairs, parameters.near_m))
    gap_x = np.maximum(pairs.box_a[:, 0], pairs.box_b[:, 0]) - np.minimum(
        pairs.box_a[:, 2], pairs.box_b[:, 2]
    )
    gap_y = np.maximum(pairs.box_a[:, 1], pairs.box_b[:, 1]) - np.minimum(
        pairs.box_a[:, 3], pairs.box_b[:, 3]
    )
    gap = np.hypot(np.maximum(gap_x, 0), np.maximum(gap_y, 0))
    size = np.maximum(longer_side(pairs.box_a), longer_side(pairs.box_b))
    by_box = np.exp(-gap / size)  # a picture has no metres: things are near at their own size
    return np.where(np.isnan(by_place), by_box, by_place)


def _on(pairs: Pairs, _: Parameters) -> Floats:
    foot = height_in(pairs, pairs.box_a[:, 3])
    head = height_in(pairs, pairs.box_a[:, 1])
    by_box = (
        soft_step(overlap_x(pairs), 0.4, 0.08)
        * soft_step(foot, -0.15, 0.04)
        * (1 - soft_step(foot, 0.75, 0.06))
        * (1 - soft_step(head, 0.5, 0.08))
    )
    underside, top = _heights(pairs)
    spread = _upright(pairs)
    by_size = (
        footprint(pairs, _wide_from(pairs))
        * normal_cdf((underside + 2 * SEAT_SHARE * top) / spread)
        * normal_cdf((top + SEAT_M - underside) / spread)
    )
    return _tempered(pairs, by_box, by_size, lambda: _over_or_below(pairs, by_box, 1.0))


def _wide_from(pairs: Pairs) -> Floats:
    """Return from which width grounds are wider than they measure (n,), metres."""
    return np.where(pairs.usual_b, PART_M, WIDE_M)


def _upright(pairs: Pairs) -> Floats:
    """Return the deviation of heights against each other: of the points, and of the sizes."""
    sizes = np.hypot(pairs.extent_a[:, 1], pairs.extent_b[:, 1])
    return np.hypot(np.minimum(pairs.sigma_up, UPRIGHT_M), UPRIGHT_SHARE * sizes)


def _fits(pairs: Pairs) -> Floats:
    """Return the probability that the figure is narrower than the ground: in or under it."""
    return 1 - soft_step(pairs.extent_a[:, 0] / pairs.extent_b[:, 0], FITS_SHARE, 0.05)


def _under(pairs: Pairs, _: Parameters) -> Floats:
    head = height_in(pairs, pairs.box_a[:, 1])
    foot = height_in(pairs, pairs.box_a[:, 3])
    by_box = (
        soft_step(overlap_x(pairs), 0.4, 0.08)
        * soft_step(head, 0.3, 0.06)
        * soft_step(foot, 0.65, 0.06)
    )
    underside, top = _heights(pairs)
    spread = _upright(pairs)
    below_middle, own_top = -rise_of(pairs), rise_of(pairs) + pairs.extent_a[:, 1] / 2
    on_its_floor = np.minimum(below_middle, (2 * FLOOR_SHARE - 1) * top - underside)
    on_its_floor = np.minimum(on_its_floor, top - own_top)
    # what hangs has nothing under it but what is clear of it: beside what stands, things lie level
    below_all = np.minimum(-top - own_top, REACH_M - (below_middle - top))
    by_size = (
        footprint(pairs)
        * normal_cdf(np.where(pairs.usual_b, on_its_floor, below_all) / spread)
        * _fits(pairs)
        * soft_step(pairs.extent_b[:, 0], ROOF_M, 0.03)
    )
    return _tempered(pairs, by_box, by_size, lambda: _over_or_below(pairs, by_box, -1.0))


def _above(pairs: Pairs, _: Parameters) -> Floats:
    foot = height_in(pairs, pairs.box_a[:, 3])
    by_box = soft_step(overlap_x(pairs), 0.4, 0.08) * (1 - soft_step(foot, 0.75, 0.06))
    underside, top = _heights(pairs)
    axis, sign = pairs.up
    eye = sign * (pairs.viewer[:, :3] - pairs.position_b)[:, axis]
    looked_down_on = pairs.usual_b & ~(EYE_SHARE * top >= eye)
    clear = np.where(looked_down_on, TOP_SHARE, 1.0)
    by_size = footprint(pairs, _wide_from(pairs)) * normal_cdf(
        (underside - clear * top) / _upright(pairs)
    )
    return _tempered(pairs, by_box, by_size, lambda: _over_or_below(pairs, by_box, 1.0))


def _in(pairs: Pairs, _: Parameters) -> Floats:
    width = np.minimum(pairs.box_a[:, 2], pairs.box_b[:, 2]) - np.maximum(
        pairs.box_a[:, 0], pairs.box_b[:, 0]
    )
    height = np.minimum(pairs.box_a[:, 3], pairs.box_b[:, 3]) - np.maximum(
        pairs.box_a[:, 1], pairs.box_b[:, 1]
    )
    inside = np.clip(width, 0, None) * np.clip(height, 0, None) / box_area(pairs.box_a)
    by_box = soft_step(inside, 0.75, 0.06) * (
        1 - soft_step(box_area(pairs.box_a) / box_area(pairs.box_b), 0.8, 0.05)
    )
    half = np.where(np.isnan(pairs.extent_b[:, 0]), REACH_M, pairs.extent_b[:, 0] / 2)
    spread, rise, top = _upright(pairs), rise_of(pairs), pairs.extent_b[:, 1] / 2
    by_size = (
        footprint(pairs)
        * normal_cdf((top + EDGE_M - rise) / spread)  # of what is in a box the head may show
        * normal_cdf((top + rise) / spread)
        * _fits(pairs)
        * np.where(pairs.usual_b, 1.0, SOLID)
    )
    foot = height_in(pairs, pairs.box_a[:, 3])
    sunk = soft_step(overlap_x(pairs), 0.75, 0.06) * soft_step(foot, 0.1, 0.04)
    return _tempered(
        pairs,
        sunk * (1 - soft_step(foot, 1.1, 0.04)),
        by_size,
        lambda: _box_or_place(pairs, by_box, within(pairs, half)),
    )


def _left_of(pairs: Pairs, _: Parameters) -> Floats:
    half_widths = (
        pairs.box_a[:, 2] - pairs.box_a[:, 0] + pairs.box_b[:, 2] - pairs.box_b[:, 0]
    ) / 4
    by_box = normal_cdf((box_middle(pairs.box_b) - box_middle(pairs.box_a))[:, 0] / half_widths)
    side = ((pairs.position_b - pairs.position_a) * camera_axis(pairs.viewer, 0)).sum(axis=1)
    by_place = normal_cdf(side / pairs.sigma)
    return np.where(pairs.shared, by_box, by_place) * as_factor(within(pairs, SIDE_M))


def _right_of(pairs: Pairs, parameters: Parameters) -> Floats:
    return _left_of(swapped(pairs), parameters)


def _in_front_of(pairs: Pairs, _: Parameters) -> Floats:
    nearer = ((pairs.position_b - pairs.position_a) * camera_axis(pairs.viewer, 2)).sum(axis=1)
    by_place = np.where(np.isnan(distance_of(pairs)), np.nan, normal_cdf(nearer / pairs.sigma))
    height = np.minimum(
        pairs.box_a[:, 3] - pairs.box_a[:, 1], pairs.box_b[:, 3] - pairs.box_b[:, 1]
    )
    # things stand on a common floor or top: what is nearer ends lower in the picture
    by_box = normal_cdf((pairs.box_a[:, 3] - pairs.box_b[:, 3]) / (0.5 * height))
    front = np.where(np.isnan(by_place), by_box, by_place)
    return front * as_factor(in_line(pairs)) * as_factor(within(pairs, SIDE_M))


def _behind(pairs: Pairs, parameters: Parameters) -> Floats:
    return _in_front_of(swapped(pairs), parameters)


def _same_place(pairs: Pairs, parameters: Parameters) -> Floats:
    beside = as_factor(beside_within(pairs, parameters.d_thresh_m))
    near = displaced_within(pairs, parameters.d_thresh_m, apart_sigma(pairs))
    one_spot = np.linalg.norm(pairs.position_a - pairs.position_b, axis=1) < SAME_SPOT_M
    near = GROUPED * near / (1.0 + (GROUPED - 1.0) * near)
    return np.where(one_spot, 1.0, near) * beside


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
