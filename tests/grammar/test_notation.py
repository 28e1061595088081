"""The formal notation: printing and reading are inverse, and the paper's strings are read."""

from __future__ import annotations

import contextlib
from dataclasses import fields as dataclass_fields
from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grammar import NotUnderstood, notation, parse
from grammar.forms import (
    ASKS,
    BOUNDS,
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


def plain_terms() -> st.SearchStrategy[ObjectTerm]:
    """Draw what else will do, or what a thing must not be: no more than a noun and its looks."""
    looks = st.lists(WORDS, max_size=2).map(tuple)
    owner = st.none() | WORDS
    return st.builds(ObjectTerm, WORDS, WORDS, looks, looks, owner, not_owner=owner)


@st.composite
def terms(draw: st.DrawFn, depth: int = 2) -> ObjectTerm:
    """Draw an object, with a description by a relation up to `depth` deep."""
    where = None
    if depth and draw(st.booleans()):
        kind = draw(st.sampled_from(RELATION_KINDS))
        where = Where(kind, draw(terms(depth - 1)), draw(st.booleans()))
    several = draw(st.integers(0, 3)) == 0
    others = st.lists(plain_terms(), max_size=2 if several else 0).map(tuple)
    return ObjectTerm(
        category=draw(WORDS),
        word=draw(WORDS),
        attributes=tuple(draw(st.lists(WORDS, max_size=3))),
        without=tuple(draw(st.lists(WORDS, max_size=2))),
        owner=draw(st.none() | WORDS),
        quantity=(quantity := draw(st.none() | st.integers(0, 99))),
        where=where,
        bound="least" if quantity is None else draw(st.sampled_from(BOUNDS)),
        not_owner=draw(st.none() | WORDS),
        or_else=draw(others),
        other_than=draw(others),
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
        ask=(ask := draw(st.sampled_from(ASKS))),
        objects=tuple(draw(st.lists(terms(), max_size=len(VARIABLES)))),
        relation=(related := draw(st.none() | relation)),
        place=(place := draw(st.none() | WORDS)),
        time=draw(st.none() | slices()),
        outside=place is not None and draw(st.booleans()),
        or_places=() if place is None else tuple(draw(st.lists(WORDS, max_size=2))),
        select=draw(st.sampled_from(SELECTS)),
        negated=(negated := draw(st.booleans())),
        contrary=negated and ask == "whether" and bool(place or related) and draw(st.booleans()),
        now=draw(st.booleans()),
    )


@st.composite
def changed(draw: st.DrawFn) -> tuple[FormalQuery, FormalQuery]:
    """Draw two queries that differ in one field, of the query or of one of its objects."""
    query, other = draw(queries()), draw(queries())
    query = replace(query, contrary=False)  # what it is said of changes
    fields = ("form", "objects", "relation", "select", "negated")
    field = draw(st.sampled_from((*fields, "ask", "place", "term")))
    if field == "place":
        where = other.place, other.or_places, other.outside
        return query, replace(query, place=where[0], or_places=where[1], outside=where[2])
    if field == "ask":
        return query, replace(query, ask=other.ask)
    if field != "term":
        return query, replace(query, **{field: getattr(other, field)})
    one, another = draw(terms()), draw(terms())
    name = draw(st.sampled_from([f.name for f in dataclass_fields(ObjectTerm) if f.name != "var"]))
    change = {name: getattr(another, name)}
    if name in ("quantity", "bound"):
        change = {"quantity": another.quantity, "bound": another.bound}
    return replace(query, objects=(one,)), replace(query, objects=(replace(one, **change),))


def test_the_contrary_is_told_in_the_notation_for_people() -> None:
    cup = ObjectTerm("cup")
    query = FormalQuery("", "Q3", "whether", (cup,), place="hall", negated=True, contrary=True)
    assert query.formal.endswith("negated, contrary")


def vars_unset(query: FormalQuery) -> FormalQuery:
    """Return the query as JSON gives it back: the inner variables play no part in it."""
    return FormalQuery.from_json(query.to_json())


@given(queries())
def test_reading_what_was_written_gives_the_query_back(query: FormalQuery) -> None:
    written = notation.write(query)
    assert notation.looks_formal(written)
    assert notation.read(written, now=NOW) == query
    assert notation.write(notation.read(written, now=NOW)) == written


@given(changed())
def test_different_queries_have_different_notations_for_people(
    pair: tuple[FormalQuery, FormalQuery],
) -> None:
    first, second = pair
    assert (first.formal == second.formal) == (replace(first, text=second.text) == second)


def in_utc(time: TimeSlice) -> TimeSlice:
    """Return the slice as one zone has it, as the times of a query are."""
    return TimeSlice(
        time.start.astimezone(UTC) if time.start else None,
        time.end.astimezone(UTC) if time.end else None,
    )


@given(slices().map(in_utc), slices().map(in_utc))
def test_different_times_have_different_notations_for_people(
    first: TimeSlice, second: TimeSlice
) -> None:
    def written(time: TimeSlice) -> str:
        return FormalQuery("", "Q3", "where", time=time).formal

    def local(time: TimeSlice) -> list[datetime | None]:
        """Return the ends as clocks show them; of two minutes of one day, without their day."""
        ends = [m.replace(tzinfo=None) if m is not None else None for m in (time.start, time.end)]
        days = {m.date() if m is not None else None for m in ends}
        whole = all(m is not None and m.second == m.microsecond == 0 for m in ends)
        if len(days) == 1 and whole:
            return [m.replace(1, 1, 1) if m is not None else None for m in ends]
        return ends

    assert (written(first) == written(second)) == (local(first) == local(second))


@pytest.mark.parametrize(
    ("text", "formal"),
    [
        (
            "Where did you see the pink cup between 1:00pm and 4:00pm on 1st Jan, 2020?",
            "pink(x), cup(y), time(t) | STc.find(OIc.find(x, y), 1600 >= t >= 1300)",
        ),
        ("did you see a mug", 'cup(x), said(x, "mug") | OIc.find(x)'),
        (
            "where is the light-blue cup",
            "light-blue(x), cup(y) | STc.find(OIc.find(x, y)) | select last",
        ),
        ("did you see a dark blue cup", "dark_blue(x), cup(y) | OIc.find(x, y)"),
        ("did you see a cup that is not red", "cup(x), not red(x) | OIc.find(x)"),
        ("did you see Anna's cup", 'cup(x), of(x, "anna") | OIc.find(x)'),
        ("did you see two cups", "cup(x), count(x, 2) | OIc.find(x)"),
        ("how many cups did you see", "cup(x) | OIc.find(x) | ask count"),
        (
            "is there no cup in the hall",
            "cup(x) | STc.find(OIc.find(x), in hall) | ask whether, negated, now",
        ),
        (
            "when were the cup and the bowl together",
            "cup(x), bowl(y) | STc.find(OIc.find(x), OIc.find(y), together)",
        ),
        (
            "is the cup on the desk near the door",
            "cup(x), desk(y), door(y1), near(y, y1) | STc.find(OIc.find(x), OIc.find(y), on) "
            "| ask whether, now",
        ),
        (
            "did you see the cup since yesterday",
            "cup(x), time(t) | STc.find(OIc.find(x), t >= 2019-12-31T00:00) | ask whether",
        ),
    ],
)
def test_the_notation_for_people_says_all(text: str, formal: str) -> None:
    query = parse(text, now=NOW)
    assert query.formal == formal
    assert replace(notation.read(formal, now=NOW), text=text) == query


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


def test_objects_are_walked_with_what_describes_them() -> None:
    lamp = ObjectTerm("lamp")
    table = ObjectTerm("table", where=Where("near", ObjectTerm("door", where=Where("on", lamp))))
    query = FormalQuery("", "Q2", "whether", (ObjectTerm("cup"), table), Relation("on"))
    assert [term.category for term in query.terms] == ["cup", "table", "door", "lamp"]


def test_a_parsed_question_survives() -> None:
    query = parse("were Anna's keys next to the blue bag in the hall on tuesday evening", now=NOW)
    assert notation.read(notation.write(query), now=NOW) == query
