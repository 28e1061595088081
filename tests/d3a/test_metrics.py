"""The metrics on cases that can be reckoned by hand."""

from __future__ import annotations

import numpy as np
import pytest

from d3a import metrics
from d3a.metrics import Rows, Score
from d3a.store.base import StayRecord
from d3a.truth import TrueObject, TruePlace, Truth

A, B = ("a", 0), ("b", 0)


def truth_of(
    owners: list[int],
    times: list[int],
    places: list[list[tuple[int, int, tuple[int, int] | None]]],
) -> Truth:
    """A truth of objects 0, 1, ... with places (start, end, seen empty); a frame per time."""
    objects = tuple(
        TrueObject(
            name=f"cup-{k}",
            category="cup",
            colour="red",
            places=tuple(
                TruePlace(f"cup-{k}", (float(n), float(k), 0.0), start, end, empty)
                for n, (start, end, empty) in enumerate(spans)
            ),
            detections=tuple(row for row, owner in enumerate(owners) if owner == k),
        )
        for k, spans in enumerate(places)
    )
    n = len(owners)
    return Truth(
        objects=objects,
        owner=np.array(owners, dtype=np.intp),
        time_ms=np.array(times, dtype=np.int64),
        frame=tuple(f"f{time}" for time in times),
        category=("cup",) * n,
        probability=np.full(n, 0.9),
        box=np.array([[10.0 * row, 0, 10.0 * row + 8, 8] for row in range(n)]),
        position=np.zeros((n, 3)),
        frames=n,
    )


def stay(key: tuple[str, int], first: int, absent: int | None = None) -> StayRecord:
    return StayRecord(key[0], key[1], (0.0, 0.0, 0.0), first, first, 1.0, last_absent_ms=absent)


def test_perfect_identity_is_one() -> None:
    judged = metrics.b_cubed([0, 0, 1], [A, A, B])
    assert (judged.precision, judged.recall, judged.f) == (1.0, 1.0, 1.0)


def test_dropped_detections_cost_recall_and_not_precision() -> None:
    judged = metrics.b_cubed([0, 0, 0, 0], [A, A, None, None])
    assert judged.precision == 1.0
    assert judged.recall == pytest.approx(2 * (2 / 4) / 4)


def test_mixing_and_false_positives_cost_precision() -> None:
    assert metrics.b_cubed([0, 1], [A, A]).precision == pytest.approx(0.5)
    assert metrics.b_cubed([0, -1], [A, A]).precision == pytest.approx(0.5)
    assert metrics.b_cubed([0, -1], [A, B]).f == 1.0


def test_nothing_kept_is_zero_and_nothing_there_does_not_fail() -> None:
    assert metrics.b_cubed([0], [None]).f == 0.0
    assert metrics.b_cubed([], []).f == 0.0


def test_duplicates_count_the_ids_of_an_object() -> None:
    truth = truth_of([0, 0, 0, 1, 2, -1], [0] * 6, [[(0, 9, None)]] * 3)
    got = metrics.duplicates(truth, [A, B, ("c", 0), ("d", 0), None, ("e", 0)], "abcde")
    assert got.mean == pytest.approx(2.0)
    assert (got.most, got.without) == (3, 1)


def test_best_id_holds_most_detections_and_ties_go_to_the_first_name() -> None:
    assert metrics.best_ids([0, 0, 0, 1, 1], [B, B, A, B, A]) == {0: "b", 1: "a"}
    assert metrics.id_owners([0, 0, 1, -1], [A, A, A, B]) == {"a": 0, "b": -1}


MOVED = truth_of(
    [0, 0, 0, 0, 1, 1],
    [0, 1, 20, 21, 0, 20],
    [[(0, 10, (15, 30)), (12, 40, None)], [(0, 40, None)]],
)


def test_moved_object_with_one_id_is_a_link() -> None:
    kept = [("a", 0), ("a", 0), ("a", 1), ("a", 1), B, B]
    got = metrics.move_links(MOVED, kept, [stay(("a", 0), 0), stay(("a", 1), 20), stay(B, 0)])
    assert (got.precision, got.recall, got.given, got.wanted) == (1.0, 1.0, 1, 1)


def test_link_to_another_object_is_wrong_and_a_lost_link_is_missed() -> None:
    kept = [("a", 0), ("a", 0), ("b", 1), ("b", 1), ("b", 0), ("b", 0)]
    stays = [stay(("a", 0), 0), stay(("b", 0), 0), stay(("b", 1), 20)]
    got = metrics.move_links(MOVED, kept, stays)
    assert (got.right, got.given) == (0, 1)
    assert got.recall == 0.0


def test_split_at_the_same_place_is_no_move() -> None:
    kept = [("a", 0), ("a", 1), None, None, None, None]
    got = metrics.move_links(MOVED, kept, [stay(("a", 0), 0), stay(("a", 1), 1)])
    assert got.given == 0


def test_absence_is_right_after_the_end_and_wrong_before() -> None:
    kept = [("a", 0), ("a", 0), ("a", 1), ("a", 1), B, B]
    stays = [stay(("a", 0), 0, absent=16), stay(("a", 1), 20), stay(B, 0)]
    got = metrics.last_absent(MOVED, kept, stays)
    assert (got.precision, got.recall, got.wanted) == (1.0, 1.0, 1)
    early = [stay(("a", 0), 0, absent=5), stay(("a", 1), 20), stay(B, 0, absent=30)]
    got = metrics.last_absent(MOVED, kept, early)
    assert (got.precision, got.recall) == (0.0, 0.0)


def test_true_stays_are_places_seen_often_enough() -> None:
    assert metrics.true_stays(MOVED) == 3
    assert metrics.true_stays(MOVED, least=3) == 0


def test_keyframe_is_known_by_frame_and_box() -> None:
    rows = Rows(MOVED)
    assert rows.owner("f0", (0.0, 0.2, 8.0, 8.0)) == 0
    assert rows.owner("f0", (40.0, 0.0, 48.0, 8.0)) == 1
    assert rows.owner("f0", (20.0, 0.0, 28.0, 8.0)) == -1  # a box of another frame
    assert rows.owner("f0", None) == -1
    assert rows.shown("f20") == {0, 1}


def test_rank_is_that_of_the_first_right_group() -> None:
    assert metrics.first_right([[False, False], [False, True], [True]]) == 2
    assert metrics.first_right([[False]]) is None


@pytest.mark.parametrize(
    ("rank", "reciprocal", "missed"),
    [(1, 1.0, False), (50, 0.02, False), (51, 0.0, True), (None, 0.0, True)],
)
def test_ranks_beyond_fifty_are_misses(rank: int | None, reciprocal: float, missed: bool) -> None:
    score = Score(rank, frames=60, ids=3)
    assert score.reciprocal() == pytest.approx(reciprocal)
    assert score.missed() is missed


def test_ceiling_is_the_mean_reciprocal_rank_of_a_random_order() -> None:
    rng = np.random.default_rng(0)
    ranks = np.array([rng.permutation(7)[0] + 1 for _ in range(40_000)])
    assert metrics.ceiling(7) == pytest.approx(float((1 / ranks).mean()), abs=0.01)
    assert metrics.ceiling(1) == 1.0
    assert metrics.ceiling(0) == 0.0
    assert metrics.ceiling(200) == pytest.approx(metrics.ceiling(50) * 50 / 200)


def test_accuracy_of_the_papers_table_is_its_headline() -> None:
    misses = {("Q1", "category"): 0.20, ("Q1", "any"): 0.13, ("Q2", "category"): 0.38}
    misses |= {("Q2", "any"): 0.38, ("Q3", "category"): 0.47, ("Q3", "any"): 0.07}
    assert metrics.accuracy(misses) == pytest.approx(0.728, abs=0.001)
    for form in ("Q1", "Q2", "Q3"):
        misses[form, "perfect"] = 0.5
    assert metrics.accuracy(misses, perfect=0.0) == pytest.approx(0.819, abs=0.001)
    assert metrics.accuracy(misses) == pytest.approx(1 - (1.63 + 1.5) / 9)
