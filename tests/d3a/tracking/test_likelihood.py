from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from d3a.parameters import DEFAULT
from d3a.tracking import likelihood
from d3a.tracking.likelihood import BESIDE, OTHER, SAME, UPPER, CategoryModel, LookModel, shares
from d3a.tracking.look_space import LookSpace
from d3a.tracking.neighbours import Neighbours
from tests.worlds.rounds import colour

SPACE = DEFAULT.space_m3


def test_a_position_that_could_be_anywhere_says_nothing_for() -> None:
    squared = np.array([0.0, 0.0])
    determinant = np.array([1e-6, 1e9])
    sharp, vague = likelihood.position_ratios(squared, determinant, (SPACE,), DEFAULT)[0]
    assert sharp > 3
    assert vague == 0.0


@given(st.floats(0, 1e4), st.floats(0, 1e4), st.floats(1e-9, 1e6))
def test_the_evidence_of_place_falls_with_the_distance(a: float, b: float, volume: float) -> None:
    near, far = sorted((a, b))
    squared, determinant = np.array([near, far]), np.full(2, volume)
    ratios = likelihood.position_ratios(squared, determinant, (SPACE,), DEFAULT)[0]
    assert ratios[0] >= ratios[1]


def test_the_adjugate_is_the_inverse() -> None:
    rng = np.random.default_rng(5)
    half = rng.normal(size=(7, 3, 3))
    matrices = half @ half.transpose(0, 2, 1) + 0.1 * np.eye(3)
    residuals = rng.normal(size=(7, 3))
    squared, determinant = likelihood.squared_distances(
        residuals.T, matrices.reshape(-1, 9).T[UPPER]
    )
    wanted = np.einsum("ni,nij,nj->n", residuals, np.linalg.inv(matrices), residuals)
    assert np.allclose(squared, wanted)
    assert np.allclose(determinant, np.linalg.det(matrices))


def test_the_look_model_learns_what_alike_means() -> None:
    model = LookModel(DEFAULT)
    before = model.against(np.array([[0.65]]), np.array([20.0]), (OTHER,))[0, 0, 0]
    rng = np.random.default_rng(2)
    for _ in range(500):
        model.add(SAME, float(rng.normal(0.95, 0.02)), 20.0)
        model.add(OTHER, float(rng.normal(0.7, 0.05)), 20.0)
    after = model.against(np.array([[0.65, 0.96]]), np.array([20.0, 20.0]), (OTHER,))[0, 0]
    assert before > -1
    assert after[0] < -5
    assert after[1] > 1
    untouched = model.against(np.array([[0.65]]), np.array([1.0]), (OTHER,))[0, 0, 0]
    assert untouched == pytest.approx(before)


def test_a_look_shared_by_what_stands_beside_says_little_for_a_wrong_name() -> None:
    model = LookModel(DEFAULT)
    for _ in range(300):
        model.add(SAME, 0.9, 20.0)
        model.add(OTHER, 0.3, 20.0)
        model.add(BESIDE, 0.85, 20.0)
    alike, views = np.array([[0.9]]), np.array([20.0])
    beside, other = model.against(alike, views, (BESIDE, OTHER))[:, 0, 0]
    assert beside < other


def taught(same: tuple[float, float], other: tuple[float, float], pairs: int) -> LookModel:
    """Return a model that has seen so many pairs of each kind, by mean and deviation."""
    model, rng = LookModel(DEFAULT), np.random.default_rng(4)
    for _ in range(pairs):
        model.add(SAME, float(rng.normal(*same)), 20.0)
        model.add(OTHER, float(rng.normal(*other)), 20.0)
    return model


def told(model: LookModel, *likeness: float) -> list[float]:
    alike = np.array([likeness])
    return [float(v) for v in model.against(alike, np.full(len(likeness), 20.0), (OTHER,))[0, 0]]


@given(
    st.tuples(st.floats(0.3, 0.95), st.floats(0.01, 0.3)),
    st.tuples(st.floats(-0.3, 0.9), st.floats(0.01, 0.4)),
    st.lists(st.floats(-1, 1), min_size=2, max_size=8),
)
def test_more_alike_never_counts_less(
    same: tuple[float, float], other: tuple[float, float], likeness: list[float]
) -> None:
    found = told(taught(same, other, 60), *sorted(likeness))
    assert all(a <= b + 1e-9 for a, b in pairwise(found))
    assert DEFAULT.look_least <= found[0] <= found[-1] <= DEFAULT.look_most


def test_what_looks_alike_every_time_is_another_thing_where_it_does_not() -> None:
    """Though others are spread as wide as can be: each kind has a spread of its own."""
    steady = taught((0.9, 0.03), (0.5, 0.3), 400)
    varied = taught((0.9, 0.2), (0.5, 0.3), 400)
    assert told(steady, 0.5)[0] < 2 * told(varied, 0.5)[0] < 0


def test_few_pairs_do_not_tell_how_unlike_views_of_one_thing_may_be() -> None:
    few, many = (taught((0.8, 0.05), (0.3, 0.25), pairs) for pairs in (8, 400))
    assert told(few, 0.4)[0] > told(many, 0.4)[0] + 1


def test_looks_that_tell_nothing_apart_weigh_nothing() -> None:
    model = LookModel(DEFAULT)
    for _ in range(1000):
        model.add(SAME, 0.5, 1.0)
        model.add(OTHER, 0.6, 1.0)
    assert abs(model.against(np.array([[0.9]]), np.array([1.0]), (OTHER,))[0, 0, 0]) < 0.2


def test_a_rare_category_is_better_evidence_than_a_common_one() -> None:
    model = CategoryModel(DEFAULT)
    for name in ["cup"] * 50 + ["kettle"] * 2:
        model.add(name, 0.9)
    names = [("cup", 0.9), ("kettle", 0.9)]
    agreed, differing = model.evidence(names, [shares({"cup": 3.0}), shares({"kettle": 3.0})])
    assert agreed[1, 1] > agreed[0, 0] > 0
    assert differing[0, 1] < 0
    assert differing[1, 0] < 0
    both = np.logaddexp(agreed, differing)
    assert both[0, 1] == pytest.approx(differing[0, 1])


def test_a_sure_name_is_wrong_less_often_than_a_doubtful_one() -> None:
    model = CategoryModel(DEFAULT)
    for probability in [0.95] * 200 + [0.6] * 50:
        model.add("cup", probability)
    assert model.wrong(0.95) < DEFAULT.confusion < model.wrong(0.6) < 1


def test_a_detector_that_is_always_certain_is_wrong_as_often_as_any() -> None:
    model = CategoryModel(DEFAULT)
    for _ in range(5000):
        model.add("cup", 1.0)
    assert model.wrong(1.0) == pytest.approx(DEFAULT.confusion, rel=0.05)


def test_what_stands_side_by_side_is_learned_from_frames() -> None:
    model = Neighbours(DEFAULT)
    before = model.space_m3(np.array([0.2, 5.0]) ** 2)
    for _ in range(300):
        model.add(3, [0.2, 2.5])
    after = model.space_m3(np.array([0.2, 5.0]) ** 2)
    assert after[0] < before[0] == DEFAULT.beside_m3
    assert after[1] == before[1] == pytest.approx(SPACE)


def test_alone_in_the_room_there_are_no_neighbours() -> None:
    model = Neighbours(DEFAULT)
    for _ in range(2000):
        model.add(1, [])
    assert model.space_m3(np.array([0.2]) ** 2) == pytest.approx(SPACE, rel=0.5)


def test_what_all_looks_have_in_common_fades() -> None:
    """Two things before one wall: most of each box is wall, in a light that changes."""
    rng = np.random.default_rng(3)
    space = LookSpace(DEFAULT)

    def view(number: int) -> NDArray[np.float32]:
        light = rng.uniform(0.5, 1.5)
        mixed = 1.0 * colour(7) + 0.8 * light * colour(8) + 0.3 * colour(number)
        return np.asarray(mixed / np.linalg.norm(mixed), dtype=np.float32)

    means = np.stack([np.mean([view(k) for _ in range(20)], axis=0) for k in (1, 2)])
    plain = view(1) @ means.T
    for _ in range(300):
        for k in (0, 1):
            seen = view(k + 1)
            space.add(seen[None], [True])
            space.add_same(seen, means[k], 20.0)
    learned = space.of(view(1)[None]) @ space.of(means).T
    assert plain[0] - plain[1] < 0.1
    assert learned[0, 0] - learned[0, 1] > 0.8


def test_before_anything_is_learned_looks_are_compared_as_they_are() -> None:
    space = LookSpace(DEFAULT)
    looks = np.stack([colour(1), colour(2)])
    assert np.array_equal(space.of(looks), looks)
    space.add(looks, [True, True])
    assert np.array_equal(space.of(looks, are_known=True), space.of(looks))
    assert np.allclose(space.of(looks) @ space.of(looks).T, looks @ looks.T, atol=0.1)


def test_no_picture_stays_no_picture() -> None:
    space = LookSpace(DEFAULT)
    space.add(np.stack([colour(1), np.zeros(512, dtype=np.float32)]), [True, False])
    assert space.counts[0] == 1
    space.add(np.zeros((1, 512), dtype=np.float32), [False])
    assert space.counts[0] == 1
    assert not space.of(np.zeros((1, 512), dtype=np.float32)).any()


@given(st.lists(st.lists(st.floats(-5, 5), min_size=3, max_size=3), min_size=1, max_size=4))
def test_an_assignment_is_one_to_one_beats_new_and_is_the_best(rows: list[list[float]]) -> None:
    scores = np.array(rows)
    taken = likelihood.assign(scores, 0.5)
    columns = [column for column in taken if column >= 0]
    assert len(columns) == len(set(columns))
    assert all(scores[i, column] > 0.5 for i, column in enumerate(taken) if column >= 0)
    gain = np.maximum(scores - 0.5, 0.0)
    best = gain[linear_sum_assignment(gain, maximize=True)].sum()
    assert sum(gain[i, column] for i, column in enumerate(taken) if column >= 0) == pytest.approx(
        best
    )


@given(
    st.lists(
        st.lists(st.integers(-4, 9).map(float), min_size=4, max_size=4), min_size=1, max_size=4
    ),
    st.integers(0, 99),
)
def test_what_is_settled_stands_though_every_score_may_be_a_little_off(
    rows: list[list[float]], seed: int
) -> None:
    scores, by = np.array(rows), 3.0
    taken = likelihood.assign(scores, 0.5)
    if likelihood.is_settled(scores, taken, 0.5, by):
        off = np.random.default_rng(seed).uniform(-by / 2, by / 2, scores.shape)
        assert likelihood.assign(scores + off, 0.5) == taken


def test_a_frame_is_settled_where_nothing_comes_near() -> None:
    scores = np.array([[5.0, -9.0], [-9.0, -9.0]])
    assert likelihood.assign(scores, 0.0) == [0, -1]
    assert likelihood.is_settled(scores, [0, -1], 0.0, 3.0)
    for near in (
        [[5.0, 2.1], [-9.0, -9.0]],
        [[2.9, -9.0], [-9.0, -9.0]],
        [[5.0, -9.0], [-9.0, -2.9]],
    ):
        assert not likelihood.is_settled(np.array(near), [0, -1], 0.0, 3.0)


def test_the_best_sum_wins_over_the_best_pair() -> None:
    scores = np.array([[5.0, 4.9], [4.8, -9.0]])
    assert likelihood.assign(scores, 0.0) == [1, 0]


def test_a_histogram_feature_and_its_embedding_belong_together() -> None:
    embedding = colour(4)
    feature = likelihood.feature(embedding, True)
    assert np.linalg.norm(feature) == pytest.approx(1.0, abs=1e-5)
    assert np.allclose(likelihood.embedding_of(feature, True), embedding, atol=1e-5)
    assert likelihood.feature(embedding, False) is embedding
