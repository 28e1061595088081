"""The paper's figures as typed, checked against what its own text says of them."""

from __future__ import annotations

import pytest

from assistant.evaluation import paper


def test_table_has_27_rows_each_once() -> None:
    keys = {(row.form, row.precision, row.method) for row in paper.rows()}
    assert len(paper.rows()) == len(keys) == 27


def test_accuracies_follow_from_the_misses() -> None:
    assert paper.accuracies("d3a+d")[0] == pytest.approx(81.98, abs=0.1)
    assert paper.accuracies("naive")[0] == pytest.approx(48.85, abs=0.1)
    six = [paper.accuracies(method)[1] for method in ("d3a+d", "d3a+p", "naive")]
    assert six == pytest.approx([72.8, 77.2, 23.2], abs=0.05)


@pytest.mark.parametrize("method", ["naive", "d3a+d"])
@pytest.mark.parametrize("precision", ["perfect", "category", "any"])
def test_summary_is_the_mean_of_the_table(method: str, precision: str) -> None:
    said = paper.record()["summary"][method]
    assert paper.mean(method, "frames", precision) == pytest.approx(
        said[f"frames_{precision}"], rel=0.005
    )
    assert paper.mean(method, "mrr", precision) == pytest.approx(
        said[f"mrr_{precision}"], abs=0.0101
    )


def test_contradictions_are_reckoned_from_the_tables() -> None:
    said = " ".join(paper.contradictions())
    for figure in ("72.8", "17 %", "13.6x", "37x", "18x", "5.5 a minute", "62.6", "1,724"):
        assert figure in said


def test_row_that_the_paper_lacks_is_none() -> None:
    assert paper.row("Q1", "attribute", "d3a+d") is None
    assert paper.row("Q1", "category", "naive+") is None
