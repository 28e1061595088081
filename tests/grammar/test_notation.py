"""The formal notation: printing and reading are inverse, and the paper's strings are read."""

from __future__ import annotations

import contextlib
from datetime import UTC, datetime, timedelta, timezone

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grammar import NotUnderstood, notation, parse
from grammar.forms import (
    ASKS,
    FORMS,
    RELATION_KINDS,
    SELECTS,
    VARIABLES,
    FormalQuery,
    ObjectTerm,
    Relation,
    TimeSlice,
    Where,
)

NOW = datetime.fromisoformat("2020-01-01T18:00:00-05:00")
WORDS = st.one_of(
    st.sampled_from(["cup", "red", "light-blue", "living room", "time", "not", "in", "t", "x"]),
    st.text(min_size=1, max_size=12),
)
ZONES = st.integers(-14 * 60, 14 * 60).map(lambda m: timezone(timedelta(minutes=m)))
MOMENTS = st.builds(
    lambda seconds, zone: datetime.fromtimestamp(seconds, zone),
    st.integers(600_000_000, 3_700_000_000) | st.floats(6e8, 3.7e9),
    ZONES,
)


@st.composite
def terms(draw: st.DrawFn, depth: int = 2) -> ObjectTerm:
    """Draw an object, with a description by a relation up to `depth` deep."""
    where = None
    if depth and draw(st.booleans()):
        kind = draw(st.sampled_from(RELATION_KINDS))
        where = Where(kind, draw(terms(depth - 1)), draw(st.booleans()))
    return ObjectTerm(
        category=draw(WORDS),
        word=draw(WORDS),
        attributes=tuple(draw(st.lists(WORDS, max_size=3))),
        without=tuple(draw(st.lists(WORDS, max_size=2))),
        owner=draw(st.none() | WORDS),
        quantity=draw(st.none() | st.integers(0, 99)),
        where=where,
    )


@st.composite
def slices(draw: st.DrawFn) -> TimeSlice:
    """Draw a slice: open at either end, a point, or whole."""
    start, end = draw(st.none() | MOMENTS), draw(st.none() | MOMENTS)
    if start is not None and end is not None and end < start:
        start, end = end, start
    return TimeSlice(start, end)


@st.composite
def queries(draw: st.DrawFn) -> FormalQuery:
    """Draw any formal query."""
    relation = st.builds(Relation, st.sampled_from(RELATION_KINDS), st.booleans())
    return FormalQuery(
        text=draw(st.text(max_size=40)),
        form=draw(st.sampled_from(FORMS)),
        ask=draw(st.sampled_from(ASKS)),
        objects=tuple(draw(st.lists(terms(), max_size=len(VARIABLES)))),
        relation=draw(st.none() | relation),
        place=draw(st.none() | WORDS),
        time=draw(st.none() | slices()),
        select=draw(st.sampled_from(SELECTS)),
        negated=draw(st.booleans()),
    )


def vars_unset(query: FormalQuery) -> FormalQuery:
    """Return the query as JSON gives it back: the inner variables play no part in it."""
    return FormalQuery.from_json(query.to_json())


@given(queries())
def test_reading_what_was_written_gives_the_query_back(query: FormalQuery) -> None:
    written = notation.write(query)
    assert notation.looks_formal(written)
    assert notation.read(written, now=NOW) == query
    assert notation.write(notation.read(written, now=NOW)) == written


@given(queries())
def test_json_gives_the_query_back(query: FormalQuery) -> None:
    assert vars_unset(query) == query


@pytest.mark.parametrize(
    ("text", "form", "ask", "categories", "kind"),
    [
        ("orange(x), bowl(y) | OIc.find(x, y)", "Q1", "whether", ["bowl"], None),
        (
            "cup(x), bowl(y) | STc.find(OIc.find(x), OIc.find(y))",
            "Q2",
            "when",
            ["cup", "bowl"],
            "together",
        ),
        (
            "cup(x), bowl(y) | STc.find(OIc.find(x, y), together)",
            "Q2",
            "when",
            ["cup", "bowl"],
            "together",
        ),
        (
            "pink(x), cup(y), time(t) | STc.find(OIc.find(x, y), 1600 >= t >= 1300)",
            "Q3",
            "where",
            ["cup"],
            None,
        ),
    ],
)
def test_the_papers_strings_are_read(
    text: str, form: str, ask: str, categories: list[str], kind: str | None
) -> None:
    query = notation.read(text, now=NOW)
    assert (query.form, query.ask) == (form, ask)
    assert [term.category for term in query.objects] == categories
    assert (query.relation.kind if query.relation else None) == kind


def test_the_papers_attribute_belongs_to_the_next_category() -> None:
    query = notation.read("pink(x), cup(y) | OIc.find(x, y)", now=NOW)
    assert query.objects == (ObjectTerm("cup", attributes=("pink",)),)


@pytest.mark.parametrize(
    ("now", "day"), [("2020-01-01T18:00:00-05:00", 1), ("2020-01-02T12:59:00-05:00", 1)]
)
def test_a_clock_time_is_the_last_one_gone_by(now: str, day: int) -> None:
    text = "cup(x), time(t) | STc.find(OIc.find(x), 1600 >= t >= 1300)"
    slice_ = notation.read(text, now=datetime.fromisoformat(now)).time
    assert slice_ is not None
    assert slice_.start is not None
    assert slice_.end is not None
    assert (slice_.start.day, slice_.start.hour) == (day, 13)
    assert (slice_.end.day, slice_.end.hour) == (day, 16)


@pytest.mark.parametrize(
    "text",
    [
        "cup(x | OIc.find(x)",
        "cup(x) | OIc.find(y)",
        "cup(x) | STc.find(OIc.find(x), 2500 >= t >= 1300)",
        "cup(x) | STc.find(OIc.find(x), beside)",
        "cup(x), near(x, x) | OIc.find(x)",
        "cup(x) | OIc.find(x) | ask why",
        "cup(x), colour(x, 'red') | OIc.find(x)",
        "| STc.find(",
    ],
)
def test_what_is_no_notation_is_refused_with_its_place(text: str) -> None:
    assert notation.looks_formal(text)
    with pytest.raises(NotUnderstood) as caught:
        notation.read(text, now=NOW)
    assert 0 <= caught.value.position <= len(text)


@given(st.text(max_size=60))
def test_no_text_raises_anything_else(text: str) -> None:
    for said in (text, f"cup(x) | OIc.find({text})", f"{text} | STc.find(OIc.find(x))"):
        with contextlib.suppress(NotUnderstood):
            notation.read(said, now=datetime(2020, 1, 1, tzinfo=UTC))


def test_a_question_does_not_look_formal() -> None:
    assert not notation.looks_formal("where did you see the cup | or the bowl")
    assert not notation.looks_formal("Where is the cup?")


def test_a_parsed_question_survives() -> None:
    query = parse("were Anna's keys next to the blue bag in the hall on tuesday evening", now=NOW)
    assert notation.read(notation.write(query), now=NOW) == query
