"""Each relation with a case where it holds and one where it does not, by box and by place."""

from __future__ import annotations

import math
from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from d3a.answering.pairs import Pairs, normal_cdf, up_axis
from d3a.parameters import DEFAULT
from d3a.relations import GROUPED, between, probability
from grammar.forms import RELATION_KINDS, RelationKind

NAN2, NAN3, NAN4, NAN7 = (np.nan,) * 2, (np.nan,) * 3, (np.nan,) * 4, (np.nan,) * 7
Point = tuple[float, ...]
FACING_X = (-3.0, 0.0, 1.0, -0.5, 0.5, -0.5, 0.5)
"""A camera 3 m back on the x axis that looks along +x: its right is -y, its down is -z."""


def pair(
    a: Point = NAN3,
    b: Point = NAN3,
    box_a: Point = NAN4,
    box_b: Point = NAN4,
    viewer: Point = NAN7,
    size_a: Point = NAN2,
    size_b: Point = NAN2,
    sigma: float = 0.1,
    usual: bool = True,
) -> Pairs:
    rows = (
        np.array([row], dtype=np.float64) for row in (a, b, box_a, box_b, viewer, size_a, size_b)
    )
    place_a, place_b, picture_a, picture_b, camera, extent_a, extent_b = rows
    sigmas = np.array([sigma])
    return Pairs(
        place_a,
        place_b,
        sigmas,
        picture_a,
        picture_b,
        camera,
        extent_a,
        extent_b,
        sigmas,
        np.array([usual]),
    )


def holds(kind: RelationKind, one: Pairs) -> float:
    return float(probability(kind, one, DEFAULT)[0])


TABLE = (100.0, 200.0, 300.0, 400.0)  # a box in pixels: x1 y1 x2 y2
CASES: list[tuple[RelationKind, Point, Point]] = [
    # kind, a box for which it holds, a box for which it does not; the ground is TABLE
    ("on", (180, 170, 220, 230), (180, 360, 220, 430)),
    ("on", (180, 150, 220, 205), (400, 150, 440, 205)),
    ("under", (180, 330, 220, 395), (180, 150, 220, 210)),
    ("above", (180, 40, 220, 120), (180, 330, 220, 395)),
    ("in", (150, 250, 200, 300), (20, 250, 90, 300)),
    ("near", (310, 250, 350, 300), (1500, 250, 1540, 300)),
    ("left_of", (20, 250, 60, 300), (340, 250, 380, 300)),
    ("right_of", (340, 250, 380, 300), (20, 250, 60, 300)),
    ("in_front_of", (150, 380, 250, 480), (150, 100, 250, 300)),
    ("behind", (150, 100, 250, 300), (150, 380, 250, 480)),
]


@pytest.mark.parametrize(("kind", "good", "bad"), CASES)
def test_boxes_of_one_frame(kind: RelationKind, good: Point, bad: Point) -> None:
    assert holds(kind, pair(box_a=good, box_b=TABLE)) > 0.7
    assert holds(kind, pair(box_a=bad, box_b=TABLE)) < 0.3


PLACES: list[tuple[RelationKind, Point, Point]] = [
    # kind, where the figure is when it holds, where when not; the ground is at 2, 0, 1
    ("together", (2.5, 0.0, 1.0), (4.0, 0.0, 1.0)),
    ("near", (2.0, 1.2, 1.0), (2.0, 2.2, 1.0)),
    ("on", (2.1, 0.1, 1.4), (2.1, 0.1, 0.4)),
    ("on", (2.1, 0.1, 1.4), (2.1, 3.0, 1.4)),
    ("under", (2.1, 0.1, 0.4), (2.1, 0.1, 1.4)),
    ("above", (2.0, 0.0, 1.8), (2.0, 0.0, 0.5)),
    ("in", (2.1, 0.0, 1.1), (2.9, 0.9, 1.0)),
    ("left_of", (2.0, 0.8, 1.0), (2.0, -0.8, 1.0)),
    ("right_of", (2.0, -0.8, 1.0), (2.0, 0.8, 1.0)),
    ("in_front_of", (1.4, 0.0, 1.0), (2.6, 0.0, 1.0)),
    ("behind", (2.6, 0.0, 1.0), (1.4, 0.0, 1.0)),
    ("same_place", (2.1, 0.1, 1.0), (3.0, 0.0, 1.0)),
]


@pytest.mark.parametrize(("kind", "good", "bad"), PLACES)
def test_places_without_a_shared_frame(kind: RelationKind, good: Point, bad: Point) -> None:
    ground = (2.0, 0.0, 1.0)
    assert holds(kind, pair(good, ground, viewer=FACING_X)) > 0.7
    assert holds(kind, pair(bad, ground, viewer=FACING_X)) < 0.3


def test_a_shared_frame_is_together_whatever_the_distance() -> None:
    far = pair((0, 0, 0), (9, 0, 0), box_a=(0, 0, 9, 9), box_b=(20, 0, 29, 9))
    assert holds("together", far) == 1.0


def test_a_picture_that_deceives_is_corrected_by_the_place() -> None:
    boxes = ((180.0, 170.0, 220.0, 230.0), TABLE)
    assert holds("on", pair((2, 0, 1.4), (2, 0, 1), *boxes)) > 0.7
    assert holds("on", pair((6, 0, 1.4), (2, 0, 1), *boxes)) < 0.1


def test_a_chair_seen_over_the_table_s_edge_is_not_on_it() -> None:
    boxes = ((180.0, 170.0, 220.0, 230.0), TABLE)
    assert holds("on", pair((2.1, 0, 0.4), (2, 0, 0.8), *boxes)) < 0.1
    assert holds("on", pair((2.1, 0, 0.9), (2, 0, 0.8), *boxes)) > 0.7


def test_one_estimate_for_the_whole_frame_says_nothing_of_a_pair() -> None:
    here = (1.5, 2.7, 0.4)
    boxes = ((180.0, 170.0, 220.0, 230.0), TABLE)
    assert holds("on", pair(here, here, *boxes)) == holds("on", pair(NAN3, NAN3, *boxes))


def test_uncertain_places_are_said_with_less_certainty() -> None:
    near, ground = (2.0, 1.2, 1.0), (2.0, 0.0, 1.0)
    sure, unsure = (holds("near", pair(near, ground, sigma=s)) for s in (0.05, 1.0))
    assert sure > 0.99 > unsure > 0.5


def test_nothing_known_is_not_a_no() -> None:
    assert math.isnan(holds("near", pair()))
    assert math.isnan(holds("left_of", pair((0, 0, 0), (1, 0, 0))))


def test_between_by_places_and_by_boxes() -> None:
    b, c = (0.0, 0.0, 1.0), (2.0, 0.0, 1.0)
    for a, expected in (
        ((1.0, 0.1, 1.0), True),
        ((3.0, 0.0, 1.0), False),
        ((1.0, 2.5, 1.0), False),
    ):
        assert bool(between(pair(a, b), pair(a, c), ONE)[0] > 0.5) is expected
    left, right = (0.0, 0.0, 10.0, 10.0), (100.0, 0.0, 110.0, 10.0)
    for x, expected in ((50.0, True), (150.0, False)):
        box = (x, 0.0, x + 10, 10.0)
        p = between(pair(box_a=box, box_b=left), pair(box_a=box, box_b=right), ONE)
        assert bool(p[0] > 0.5) is expected


def test_up_follows_the_cameras() -> None:
    upright = np.array([FACING_X])
    assert up_axis(upright) == (2, 1.0)
    y_down = np.array([(0, 0, 0, 0, 0, 0, 1.0)])  # the map is the first camera's own frame
    assert up_axis(y_down) == (1, -1.0)
    assert up_axis(np.full((1, 7), np.nan)) == (2, 1.0)


def test_normal_cdf() -> None:
    z = np.linspace(-6, 6, 101)
    true = [0.5 * math.erfc(-x / math.sqrt(2)) for x in z]
    assert np.allclose(normal_cdf(z), true, atol=1e-7)


ONE = np.ones(1, dtype=np.bool_)
numbers = st.floats(-20, 20)
points = st.tuples(numbers, numbers, numbers) | st.just(NAN3)
boxes = st.tuples(st.floats(0, 500), st.floats(0, 500), st.floats(1, 300), st.floats(1, 300)).map(
    lambda b: (b[0], b[1], b[0] + b[2], b[1] + b[3])
)
pictures = st.tuples(boxes, boxes) | st.just((NAN4, NAN4))


@given(st.sampled_from(RELATION_KINDS), points, points, pictures, st.booleans(), st.floats(0.02, 5))
def test_every_probability_is_one_or_unknown(
    kind: RelationKind,
    a: Point,
    b: Point,
    shown: tuple[Point, Point],
    has_viewer: bool,
    sigma: float,
) -> None:
    viewer = FACING_X if has_viewer else NAN7
    p = holds(kind, pair(a, b, *shown, viewer=viewer, sigma=sigma))
    assert math.isnan(p) or 0 <= p <= 1


@given(boxes, boxes)
def test_left_and_right_are_each_other_s_opposite(box_a: Point, box_b: Point) -> None:
    one, other = pair(box_a=box_a, box_b=box_b), pair(box_a=box_b, box_b=box_a)
    assert holds("left_of", one) == pytest.approx(holds("right_of", other))
    assert holds("left_of", one) + holds("right_of", one) == pytest.approx(1.0, abs=1e-6)


def test_pairs_are_judged_row_by_row() -> None:
    one = pair((2.1, 0.1, 1.4), (2, 0, 1))
    other = pair(box_a=TABLE)
    names = [each.name for each in fields(one) if each.init]
    both = Pairs(*(np.concatenate([getattr(one, n), getattr(other, n)]) for n in names))
    p = probability("on", both, DEFAULT)
    assert p[0] == pytest.approx(holds("on", one))
    assert math.isnan(p[1])
    assert len(both) == 2


CUP, CHAIR, COUCH, TABLE_SIZE = (0.1, 0.1), (0.5, 0.9), (1.9, 0.9), (1.2, 0.8)
BOX = (0.5, 0.4)
SHELF = (1.5, 1.25)
HIGH_TABLE, FRIDGE = (1.0, 1.1), (0.8, 1.8)


@pytest.mark.parametrize(
    ("kind", "figure", "ground", "size_a", "size_b", "usual", "expected"),
    [
        ("on", (2.0, 0.4, 0.85), (2.0, 0.0, 0.4), CUP, TABLE_SIZE, True, True),
        ("on", (2.0, 0.5, 0.5), (2.0, 0.0, 0.45), CUP, COUCH, True, True),  # on its seat
        ("on", (1.1, 0.0, 0.5), (2.0, 0.0, 0.45), CUP, COUCH, True, False),  # before it
        ("on", (2.0, 0.6, 0.85), (2.0, 0.0, 0.4), CUP, CHAIR, False, False),  # on the next table
        ("on", (2.0, 0.0, 0.05), (2.0, 0.0, 0.4), CUP, TABLE_SIZE, True, False),
        ("on", (2.0, 0.0, 1.5), (2.0, 0.0, 0.4), CUP, TABLE_SIZE, True, False),
        ("under", (2.0, 0.2, 0.1), (2.0, 0.0, 0.4), CUP, TABLE_SIZE, True, True),
        ("under", (2.0, 0.2, 0.45), (2.0, 0.0, 0.45), CUP, COUCH, True, False),
        ("under", (1.8, 0.0, 0.8), (2.0, 0.0, 0.95), CUP, (0.6, 0.4), False, False),  # before a tv
        ("under", (2.0, 0.0, 0.4), (2.0, 0.0, 0.95), CUP, (0.6, 0.4), False, True),
        ("in", (2.0, 0.1, 0.45), (2.0, 0.0, 0.4), CUP, BOX, True, True),
        ("in", (2.0, 0.1, 0.45), (2.0, 0.0, 0.4), CUP, BOX, False, False),  # a block, not a box
        ("in", (2.0, 0.6, 0.45), (2.0, 0.0, 0.4), CUP, BOX, True, False),  # beside it
        ("in", (2.0, 0.1, 0.8), (2.0, 0.0, 0.4), CUP, BOX, True, False),  # over it
        ("in", (2.0, 0.1, 0.45), (2.0, 0.0, 0.4), BOX, CUP, True, False),  # wider than it
        ("under", (2.0, 0.2, 0.1), (2.0, 0.0, 0.4), TABLE_SIZE, CHAIR, True, False),
        ("above", (2.0, 0.2, 1.4), (2.0, 0.0, 0.4), CUP, TABLE_SIZE, True, True),
        ("above", (2.0, 0.2, 0.5), (2.0, 0.0, 0.45), CUP, COUCH, True, False),
        ("above", (2.0, 0.2, 1.0), (2.0, 0.0, 0.6), CUP, SHELF, False, False),  # on its upper board
        ("above", (2.0, 0.2, 1.35), (2.0, 0.0, 0.6), CUP, SHELF, False, True),
        ("above", (2.0, 0.2, 0.8), (2.0, 0.0, 0.5), CUP, HIGH_TABLE, True, True),  # by its far edge
        ("above", (2.0, 0.2, 1.1), (2.0, 0.0, 0.95), CUP, FRIDGE, True, False),  # before its door
        ("on", (2.75, 0.0, 0.85), (2.0, 0.0, 0.4), CUP, (0.8, 0.8), True, True),  # at its far end
        ("on", (3.3, 0.0, 0.85), (2.0, 0.0, 0.4), CUP, (0.8, 0.8), True, False),  # on the next one
        ("under", (2.0, 0.0, 0.05), (2.0, 0.0, 0.45), CUP, (0.25, 0.1), False, False),  # no roof
        ("under", (2.0, 1.0, 0.1), (2.0, 0.0, 0.4), CUP, CHAIR, True, False),  # beside it
        ("under", (1.0, 0.0, 0.1), (2.0, 0.0, 0.45), CUP, COUCH, True, False),  # before it
        ("under", (2.0, 0.8, 0.47), (2.0, 0.0, 0.5), CHAIR, (1.3, 0.7), True, False),  # its back
        (
            "under",
            (2.3, 0.0, 0.42),
            (2.0, 0.0, 0.7),
            (0.2, 0.05),
            (1.0, 0.6),
            False,
            False,
        ),  # level
        ("in", (2.0, 0.0, 0.9), (2.0, 0.0, 0.35), (0.5, 0.5), (1.5, 0.8), True, False),  # on top
    ],
)
def test_measured_things(
    kind: RelationKind,
    figure: Point,
    ground: Point,
    size_a: Point,
    size_b: Point,
    usual: bool,
    expected: bool,
) -> None:
    one = pair(
        figure, ground, viewer=FACING_X, size_a=size_a, size_b=size_b, usual=usual, sigma=0.08
    )
    assert (holds(kind, one) > 0.5) is expected


@pytest.mark.parametrize(("sigma", "expected"), [(0.02, True), (0.3, False)])
def test_of_a_narrow_thing_s_outline_most_places_are_outside(sigma: float, expected: bool) -> None:
    one = pair((2, 0, 0.8), (2, 0, 0.05), viewer=FACING_X, size_a=CUP, size_b=CUP, sigma=sigma)
    assert (holds("above", one) > 0.5) is expected


def test_a_table_that_is_mostly_hidden_still_carries_what_is_beside_its_box() -> None:
    boxes = (40.0, 80.0, 50.0, 100.0), (60.0, 100.0, 100.0, 180.0)
    one = pair((2, 0.4, 0.85), (2, 0, 0.4), *boxes, FACING_X, (0.1, 0.2), (1.2, 0.8), sigma=0.08)
    assert holds("on", one) > 0.5


def test_what_shows_its_whole_width_has_nothing_under_what_is_beside_it() -> None:
    wide, beside = (120.0, 130.0, 410.0, 285.0), (400.0, 190.0, 490.0, 285.0)
    one = pair((1.7, -1.0, 0.3), (2, 0, 0.5), beside, wide, FACING_X, (0.5, 0.6), (2.0, 1.1))
    assert holds("under", one) < 0.5
    amid = (300.0, 220.0, 370.0, 270.0)
    within = pair((1.9, -0.3, 0.2), (2, 0, 0.5), amid, wide, FACING_X, (0.5, 0.4), (2.0, 1.1))
    assert holds("under", within) > 0.5


def test_things_apart_in_one_picture_are_apart_whatever_the_places_say() -> None:
    close = (2.0, 0.1, 0.5), (2.0, 0.0, 0.5)
    boxes = (0.0, 100.0, 50.0, 150.0), (500.0, 100.0, 550.0, 150.0)  # ten widths of 0.1 m apart
    assert holds("same_place", pair(*close, sigma=0.1)) > 0.7
    apart = pair(*close, *boxes, NAN7, (0.1, 0.1), (0.1, 0.1), sigma=0.1)
    assert holds("same_place", apart) < 0.05
    cut = (500.0, 100.0, 501.0, 150.0)  # most of the other is beyond the picture
    hidden = pair(*close, boxes[0], cut, NAN7, (0.1, 0.1), (0.9, 0.1), sigma=0.1)
    assert holds("same_place", hidden) > 10 * holds("same_place", apart)


@pytest.mark.parametrize("far", [0.0, 0.3, 0.5, 0.9])
@pytest.mark.parametrize("sigma", [0.02, 0.2, 0.7])
def test_same_place_counts_where_the_other_may_truly_be(far: float, sigma: float) -> None:
    rise = 0.3
    one = pair((2.0, far, 0.5 + rise), (2.0, 0.0, 0.5), sigma=sigma)
    draw = np.random.default_rng(7).normal((far, 0.0), sigma, size=(200_000, 2))
    share = (np.hypot(np.hypot(*draw.T), rise) <= DEFAULT.d_thresh_m).mean()
    grouped = GROUPED * share / (GROUPED * share + 1.0 - share)
    assert holds("same_place", one) == pytest.approx(grouped, abs=0.01)


def test_boxes_that_show_things_whole_say_what_is_before_what() -> None:
    whole, aside = (100.0, 100.0, 160.0, 200.0), (180.0, 110.0, 234.0, 200.0)
    places, sizes = ((3.0, 0.0, 0.5), (2.0, 0.0, 0.5)), ((0.6, 1.0), (0.6, 1.0))
    assert holds("behind", pair(*places, aside, whole, FACING_X, *sizes)) < 0.5
    unseen = pair((3.0, 1.5, 0.5), places[1], NAN4, NAN4, FACING_X, *sizes)
    assert holds("behind", unseen) < 0.5  # and without a picture its place alone
    assert holds("behind", pair(*places, NAN4, NAN4, FACING_X, *sizes)) > 0.5
    cut = (180.0, 110.0, 205.0, 200.0)  # by what hides it: then its place tells too
    assert holds("behind", pair(*places, cut, whole, FACING_X, *sizes)) > 0.5


def test_what_another_hides_in_part_is_still_behind_it() -> None:
    whole, cut = (100.0, 100.0, 160.0, 200.0), (160.0, 100.0, 175.0, 160.0)
    sizes = (0.6, 1.0), (0.6, 0.8)
    behind = pair((3.0, -0.2, 0.5), (2.0, 0.0, 0.5), cut, whole, FACING_X, sizes[1], sizes[0])
    assert holds("behind", behind) > 0.5
    aside = (300.0, 100.0, 345.0, 160.0)
    apart = pair((3.0, -1.8, 0.5), (2.0, 0.0, 0.5), aside, whole, FACING_X, sizes[1], sizes[0])
    assert holds("behind", apart) < 0.3


def test_between_keeps_to_the_line_of_close_things() -> None:
    b, c = (0.0, 0.0, 1.0), (0.4, 0.0, 1.0)
    for a, expected in (((0.2, 0.0, 1.0), True), ((0.2, 0.45, 1.0), False)):
        assert (
            bool(between(pair(a, b, sigma=0.05), pair(a, c, sigma=0.05), ONE)[0] > 0.5) is expected
        )
