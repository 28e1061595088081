"""The questions of a world are sentences that the grammar reads as they are meant."""

from __future__ import annotations

from collections import Counter
from datetime import datetime
from zoneinfo import ZoneInfo

import numpy as np
import pytest

from assistant.evaluation.questions import LEVELS, Question, draw, taught_name
from d3a.simulate import simulate
from d3a.truth import Truth, read_truth
from grammar import StoreWords, parse

ZONE = ZoneInfo("America/New_York")


@pytest.fixture(scope="module")
def truth(tmp_path_factory: pytest.TempPathFactory) -> Truth:
    folder = tmp_path_factory.mktemp("questions") / "world"
    simulate(folder, hours=1.5, seed=4, depth=False)
    return read_truth(folder)


@pytest.fixture(scope="module")
def questions(truth: Truth) -> list[Question]:
    return draw(truth, ZONE, np.random.default_rng(1), count=20)


def test_every_form_is_drawn_as_often_as_asked(questions: list[Question]) -> None:
    counts = Counter((q.form, q.negative) for q in questions)
    assert counts == {(f, n): 5 if n else 20 for f in ("Q1", "Q2", "Q3") for n in (False, True)}


def test_grammar_reads_what_is_meant(truth: Truth, questions: list[Question]) -> None:
    now = datetime.fromtimestamp(truth.span_ms[1] / 1000, ZONE)
    names = tuple((taught_name(k), None) for k in range(len(truth.objects)))
    words = StoreWords(categories=tuple(sorted(set(truth.category))), names=names)
    for question in questions:
        for level, text in question.texts.items():
            query = parse(text, now=now, words=words)
            assert query.form == question.form, text
            assert len(query.objects) == (2 if question.form == "Q2" else 1), text
            assert all(bool(t.attributes) == (level == "attribute") for t in query.objects), text
            for k, term in zip(question.targets, query.objects, strict=False):
                named = taught_name(k) if level == "perfect" else truth.objects[k].category
                assert term.category == named
            if question.slice_ms is not None:
                assert query.time is not None
                assert query.time.start is not None
                assert query.time.end is not None
                spoken = (query.time.start.timestamp() * 1000, query.time.end.timestamp() * 1000)
                assert spoken == question.slice_ms


def test_asked_object_is_among_its_alternatives(truth: Truth, questions: list[Question]) -> None:
    for question in questions:
        if not question.negative:
            counts = [question.alternatives[level] for level in LEVELS]
            assert counts[0] == 1
            assert 1 <= question.alternatives["attribute"] <= question.alternatives["category"]
            assert question.alternatives["category"] <= question.alternatives["any"]


def test_slice_holds_a_detection_of_the_asked(truth: Truth, questions: list[Question]) -> None:
    for question in questions:
        if question.slice_ms is not None and not question.negative:
            start, end = question.slice_ms
            times = truth.time_ms[list(truth.objects[question.targets[0]].detections)]
            assert ((times >= start) & (times < end)).any()


def test_pair_was_seen_in_one_frame(truth: Truth, questions: list[Question]) -> None:
    frames: dict[str, set[int]] = {}
    for frame, owner in zip(truth.frame, truth.owner.tolist(), strict=True):
        frames.setdefault(frame, set()).add(owner)
    for question in questions:
        if question.form == "Q2" and not question.negative:
            assert any(shown.issuperset(question.targets) for shown in frames.values())


def test_negative_is_true_of_nothing(truth: Truth, questions: list[Question]) -> None:
    terms = {f"{truth.objects[k].colour} {truth.objects[k].category}" for k in truth.seen()}
    for question in questions:
        if question.negative and question.form == "Q1":
            term = question.texts["attribute"].removeprefix("Did you ever see a")
            assert term.removeprefix("n").strip(" ?") not in terms


def test_same_generator_draws_the_same(truth: Truth, questions: list[Question]) -> None:
    assert draw(truth, ZONE, np.random.default_rng(1), count=20) == questions


def test_objects_are_asked_once_before_any_twice(truth: Truth) -> None:
    seen = len(truth.seen())
    asked = draw(truth, ZONE, np.random.default_rng(2), count=seen, negatives=0)
    targets = Counter(q.targets for q in asked if q.form == "Q1")
    assert set(targets.values()) == {1}


def test_taught_names_are_distinct() -> None:
    names = [taught_name(k) for k in range(400)]
    assert len(set(names)) == 400
    assert all(name.isalpha() for name in names)
