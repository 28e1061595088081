"""So many things were seen as a question says, or not, or nobody can tell."""

from __future__ import annotations

from dataclasses import replace

import pytest

from assistant.amounts import amount_words, holds, other_amount_words
from d3a.answer import Answer
from grammar.forms import Bound, FormalQuery, ObjectTerm

CASES: list[tuple[Bound, int, int, int, bool | None, str]] = [
    ("least", 2, 3, 3, True, ""),
    ("least", 2, 2, 4, True, "Yes. I saw at least two cups, then."),
    ("least", 4, 2, 4, None, "I cannot be sure: I saw at least two cups, then."),
    ("least", 5, 2, 4, False, "No. I saw at most four cups, then."),
    ("most", 4, 2, 4, True, "Yes. I saw at least two and at most four cups, then."),
    ("most", 4, 4, 4, True, "Yes. I saw four cups, then."),
    ("most", 3, 2, 4, None, "I cannot be sure: I saw at least two and at most four cups, then."),
    ("most", 1, 2, 4, False, "No. I saw at least two cups, then."),
    ("exactly", 4, 4, 4, True, ""),
    ("exactly", 4, 2, 4, None, "I cannot be sure: I saw at least two and at most four cups, then."),
    ("exactly", 1, 2, 4, False, "No. I saw at least two cups, then."),
    ("exactly", 1, 2, 2, False, "No. I saw two cups, then."),
    ("exactly", 5, 2, 4, False, "No. I saw at most four cups, then."),
]


@pytest.mark.parametrize(("bound", "number", "least", "count", "held", "said"), CASES)
def test_a_number_is_told_as_far_as_it_is_known(
    bound: Bound, number: int, least: int, count: int, held: bool | None, said: str
) -> None:
    query = FormalQuery("", "Q1", "whether", (ObjectTerm("cup", quantity=number, bound=bound),))
    answer = Answer(least=least if held is not False or count > number else 0, count=count)
    assert held is False or holds(answer, query) is held
    words = other_amount_words if held is False else amount_words
    told = words(answer, query, "", "then")
    assert told.removesuffix(" More that I saw may be the same at another place.") == said
    denied = words(answer, replace(query, negated=True), "", "then")
    assert denied == told.replace("Yes. ", "No, there was: ").replace("No. ", "That is right: ")
