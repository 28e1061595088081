"""A time slice keeps fixed offsets: JSON gives back the same record, in every hour of a year."""

from __future__ import annotations

from datetime import datetime
from zoneinfo import ZoneInfo

import pytest

from grammar import parse
from grammar.errors import NotUnderstood
from grammar.forms import FormalQuery, ObjectTerm, TimeSlice

NEW_YORK = ZoneInfo("America/New_York")


@pytest.mark.parametrize(
    ("moment", "kept"),
    [
        (datetime(2026, 3, 8, 2, 30, tzinfo=NEW_YORK), "2026-03-08T03:30:00-04:00"),  # skipped
        (datetime(2026, 11, 1, 1, 30, tzinfo=NEW_YORK), "2026-11-01T01:30:00-04:00"),  # the first
        (datetime(2026, 11, 1, 1, 30, fold=1, tzinfo=NEW_YORK), "2026-11-01T01:30:00-05:00"),
    ],
)
def test_an_hour_that_is_twice_or_never_survives_json(moment: datetime, kept: str) -> None:
    query = FormalQuery("", "Q3", "where", (ObjectTerm("cup"),), time=TimeSlice(moment, moment))
    assert query.to_json()["time"]["start"] == kept
    assert FormalQuery.from_json(query.to_json()) == query


def test_a_relation_without_a_figure_is_an_error_of_its_own() -> None:
    with pytest.raises(NotUnderstood):
        parse("what was together next to cup", now=datetime(2026, 3, 1, tzinfo=NEW_YORK))
