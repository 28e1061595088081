"""Frozen records made quickly are what their own constructor makes."""

from __future__ import annotations

import copy
import pickle
from dataclasses import FrozenInstanceError, fields, replace

import pytest

from d3a.answer import RankedKeyframe
from d3a.answering.match import Candidate
from d3a.frozen import maker
from d3a.store.base import Encounter, ObjectRecord, Sighting, StayRecord

RECORDS = (Sighting, StayRecord, Encounter, ObjectRecord, RankedKeyframe, Candidate)
BOX = (1.0, 2.0, 3.0, 4.0)
CUP = ("c", 1, 2, 3, "f", 0.5, BOX, None, 1, "cup", "r", None, None)


def test_it_is_what_the_constructor_makes() -> None:
    made = maker(Sighting)(*CUP)
    assert type(made) is Sighting
    assert made == Sighting(*CUP)
    assert hash(made) == hash(Sighting(*CUP))
    assert repr(made) == repr(Sighting(*CUP))
    assert made.stay == ("c", 1)
    assert replace(made, place=2) == replace(Sighting(*CUP), place=2)
    assert pickle.loads(pickle.dumps(made)) == copy.copy(made) == made


@pytest.mark.parametrize("record", RECORDS)
def test_every_field_is_set_by_position_and_by_name(record: type[object]) -> None:
    names = [field.name for field in fields(record)]  # type: ignore[arg-type]  # a dataclass
    by_position = maker(record)(*range(len(names)))
    by_name = maker(record)(**{name: k for k, name in enumerate(names)})
    assert type(by_position) is type(by_name) is record
    for k, name in enumerate(names):
        assert getattr(by_position, name) == getattr(by_name, name) == k


def test_it_is_frozen() -> None:
    with pytest.raises(FrozenInstanceError):
        maker(Sighting)(*CUP).place = 3  # type: ignore[misc]  # that is what is tried


def test_a_field_left_out_is_an_error() -> None:
    with pytest.raises(TypeError):
        maker(Sighting)(*CUP[:-1])
