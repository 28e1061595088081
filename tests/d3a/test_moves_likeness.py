"""How alike different things look is a matter of their category."""

from __future__ import annotations

import numpy as np

from d3a.likelihood import LookModel
from d3a.look_space import LookSpace
from d3a.memory import Memory
from d3a.moves import BINS, Moves
from d3a.parameters import DEFAULT

ALIKE, UNLIKE = int(0.95 * BINS), int(0.6 * BINS)


def _moves(others: dict[str, list[float]]) -> Moves:
    moves = Moves(Memory(), LookSpace(DEFAULT), LookModel(DEFAULT), DEFAULT)
    moves.others = others
    return moves


def _pairs(bin_: int, count: float) -> list[float]:
    counts = [0.0] * BINS
    counts[bin_] = count
    return counts


def test_chairs_of_a_set_say_little_of_the_cups() -> None:
    cups = _pairs(UNLIKE, 30.0)
    alone = _moves({"cup": cups})._densities("cup")[ALIKE]
    few, many = (
        _moves({"cup": cups, "chair": _pairs(ALIKE, n)})._densities("cup")[ALIKE]
        for n in (10.0, 1000.0)
    )
    assert np.isclose(few, many)  # beyond the prior's pairs more of them change nothing
    assert alone < many < _moves({"chair": _pairs(ALIKE, 1000.0)})._densities("chair")[ALIKE] / 5


def test_a_category_without_pairs_of_its_own_takes_what_is_usual() -> None:
    moves = _moves({"chair": _pairs(ALIKE, 10.0), "cup": _pairs(UNLIKE, 10.0)})
    assert moves._densities("cup")[ALIKE] < moves._densities("vase")[ALIKE]
    assert moves._densities("vase")[ALIKE] < moves._densities("chair")[ALIKE]
