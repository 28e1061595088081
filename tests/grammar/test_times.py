"""Spoken times: zones, the edges of the day, changes of offset, and what names no time."""

from __future__ import annotations

import contextlib
from datetime import datetime, timedelta
from zoneinfo import ZoneInfo

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grammar import Ambiguous, NotUnderstood, QuestionError, parse
from grammar.forms import TimeSlice

NEW_YORK = ZoneInfo("America/New_York")
BERLIN = ZoneInfo("Europe/Berlin")
LOCAL = st.integers(950_000_000, 2_200_000_000)
"""Seconds of a moment between 2000 and 2040."""
MONDAY = datetime(2016, 11, 7, 16, 12, tzinfo=NEW_YORK)


def slice_of(said: str, now: datetime = MONDAY) -> TimeSlice:
    """Return the slice of a spoken time."""
    time = parse(f"where was the cup {said}", now=now).time
    assert time is not None
    return time


def clock(moment: datetime | None) -> str:
    """Return a moment short enough for a table."""
    return f"{moment:%Y-%m-%d %H:%M}" if moment else "-"


@pytest.mark.parametrize(
    ("said", "start", "end"),
    [
        ("between 10 and 9 am today", "2016-11-06 22:00", "2016-11-07 09:00"),
        ("from 10 pm to 6 am today", "2016-11-06 22:00", "2016-11-07 06:00"),
        ("the night from saturday to sunday", "2016-11-05 22:00", "2016-11-06 05:00"),
        ("from saturday to sunday", "2016-11-05 00:00", "2016-11-07 00:00"),
        ("this past hour", "2016-11-07 15:12", "2016-11-07 16:12"),
        ("yesterday or the day before", "2016-11-05 00:00", "2016-11-07 00:00"),
        ("one evening last week", "2016-10-31 00:00", "2016-11-07 00:00"),
        ("a week last friday", "2016-10-28 00:00", "2016-10-29 00:00"),
        ("a week yesterday", "2016-10-30 00:00", "2016-10-31 00:00"),
        ("between now and noon", "2016-11-07 12:00", "2016-11-07 16:12"),
        ("at bedtime last night", "2016-11-06 21:00", "2016-11-07 00:00"),
        ("this morning at breakfast", "2016-11-07 06:00", "2016-11-07 09:00"),
        ("last tuesday but one", "2016-10-25 00:00", "2016-10-26 00:00"),
        ("last week but one", "2016-10-24 00:00", "2016-10-31 00:00"),
        ("last weekend but one", "2016-10-29 00:00", "2016-10-31 00:00"),
        ("an hour and a quarter ago", "2016-11-07 14:57", "2016-11-07 14:57"),
        ("in the last hour and three quarters", "2016-11-07 14:27", "2016-11-07 16:12"),
        ("at 9 h 15", "2016-11-07 09:15", "2016-11-07 09:15"),
        ("at 21 hours", "2016-11-06 21:00", "2016-11-06 21:00"),
        ("from 13:00 to 14:30 h", "2016-11-07 13:00", "2016-11-07 14:30"),
        ("since 3 hours", "2016-11-07 13:12", "-"),
        ("since i left at noon", "2016-11-07 12:00", "-"),
        ("before my wife went to bed at eleven last night", "-", "2016-11-06 23:00"),
        ("when we came home at 3 pm", "2016-11-07 15:00", "2016-11-07 15:00"),
        ("when i went to bed at eight", "2016-11-06 20:00", "2016-11-06 20:00"),
        ("since i got up at three", "2016-11-07 15:00", "-"),
        ("since we woke up at four", "2016-11-07 04:00", "-"),
        ("at noon when i left", "2016-11-07 12:00", "2016-11-07 12:00"),
        ("half an hour after i left at noon", "2016-11-07 12:30", "2016-11-07 12:30"),
        ("while i was out between 2 and 4", "2016-11-07 14:00", "2016-11-07 16:00"),
        ("late last night", "2016-11-06 23:30", "2016-11-07 05:00"),
        ("two nights ago", "2016-11-05 22:00", "2016-11-06 05:00"),
        ("on 2016-oct-05", "2016-10-05 00:00", "2016-10-06 00:00"),
        ("the day after last christmas", "2015-12-26 00:00", "2015-12-27 00:00"),
        ("the day before last christmas", "2015-12-24 00:00", "2015-12-25 00:00"),
        ("early on monday", "2016-11-07 00:00", "2016-11-07 12:00"),
        ("last night at 2", "2016-11-07 02:00", "2016-11-07 02:00"),
        ("at 11 last night", "2016-11-06 23:00", "2016-11-06 23:00"),
        ("from 10 pm to 2 am", "2016-11-06 22:00", "2016-11-07 02:00"),
        ("between 7 and 9:30 last night", "2016-11-06 19:00", "2016-11-06 21:30"),
        ("from 11 am to 3", "2016-11-07 11:00", "2016-11-07 15:00"),
        ("from 10:30 to 3", "2016-11-07 10:30", "2016-11-07 15:00"),
        ("from 2 to 10 october", "2016-10-02 00:00", "2016-10-11 00:00"),
        ("from dec 20 to jan 5", "2015-12-20 00:00", "2016-01-06 00:00"),
        ("the first monday of october", "2016-10-03 00:00", "2016-10-04 00:00"),
        ("the last day of october", "2016-10-31 00:00", "2016-11-01 00:00"),
        ("the last day of last month", "2016-10-31 00:00", "2016-11-01 00:00"),
        ("the last monday of last month", "2016-10-31 00:00", "2016-11-01 00:00"),
        ("the last week of last month", "2016-10-25 00:00", "2016-11-01 00:00"),
        ("month to date", "2016-11-01 00:00", "2016-12-01 00:00"),
        ("the past weekend", "2016-11-05 00:00", "2016-11-07 00:00"),
        ("yesterday at this time", "2016-11-06 16:12", "2016-11-06 16:12"),
        ("tue-thu", "2016-11-01 00:00", "2016-11-04 00:00"),
        ("between 13h and 15 h", "2016-11-07 13:00", "2016-11-07 15:00"),
        ("a week ago today", "2016-10-31 00:00", "2016-11-01 00:00"),
        ("since two days", "2016-11-05 00:00", "-"),
        ("9h ago", "2016-11-07 07:12", "2016-11-07 07:12"),
        ("sat morning", "2016-11-05 05:00", "2016-11-05 12:00"),
        ("at 7:20 yday", "2016-11-06 07:20", "2016-11-06 07:20"),
        ("ths mornin", "2016-11-07 05:00", "2016-11-07 12:00"),
        ("before nine, sorry, half past nine today", "-", "2016-11-07 09:30"),
        ("since monday, er, since last thursday", "2016-11-03 00:00", "-"),
        ("three hours ago, well, four hours ago", "2016-11-07 12:12", "2016-11-07 12:12"),
        ("over two hours ago", "-", "2016-11-07 14:12"),
        ("under an hour ago", "2016-11-07 15:12", "-"),
        ("after 9am but before 11am", "2016-11-07 09:00", "2016-11-07 11:00"),
        ("on tuesday of last week", "2016-11-01 00:00", "2016-11-02 00:00"),
        ("on monday october 31st", "2016-10-31 00:00", "2016-11-01 00:00"),
        ("on the 15th of last month", "2016-10-15 00:00", "2016-10-16 00:00"),
        ("on the twenty fifth of july twenty twelve", "2012-07-25 00:00", "2012-07-26 00:00"),
        ("on january first nineteen ninety nine", "1999-01-01 00:00", "1999-01-02 00:00"),
        ("in january twenty twelve", "2012-01-01 00:00", "2012-02-01 00:00"),
        ("on thanksgiving", "2015-11-26 00:00", "2015-11-27 00:00"),
        ("on easter sunday 2015", "2015-04-05 00:00", "2015-04-06 00:00"),
        ("last summer", "2016-06-01 00:00", "2016-09-01 00:00"),
        ("the week before last", "2016-10-24 00:00", "2016-10-31 00:00"),
        ("an hour and twenty minutes ago", "2016-11-07 14:52", "2016-11-07 14:52"),
        ("two and a half hours ago", "2016-11-07 13:42", "2016-11-07 13:42"),
        ("an hour before noon", "2016-11-07 11:00", "2016-11-07 11:00"),
        ("at five to twelve", "2016-11-07 11:55", "2016-11-07 11:55"),
        ("at nine oh five", "2016-11-07 09:05", "2016-11-07 09:05"),
        ("at twenty five past six", "2016-11-07 06:25", "2016-11-07 06:25"),
        ("from half past nine to quarter to eleven", "2016-11-07 09:30", "2016-11-07 10:45"),
        ("on tuesday after 3 pm", "2016-11-01 15:00", "2016-11-02 00:00"),
        ("around noon", "2016-11-07 11:30", "2016-11-07 12:30"),
        ("on the fourth of may at five to nine p m", "2016-05-04 20:55", "2016-05-04 20:55"),
        ("on the second of may at ten to three", "2016-05-02 14:50", "2016-05-02 14:50"),
        ("on the fourth of may at ten past eight", "2016-05-04 08:10", "2016-05-04 08:10"),
        ("from six to five", "2016-11-06 06:00", "2016-11-06 17:00"),
        ("between seven and five", "2016-11-06 07:00", "2016-11-06 17:00"),
        ("from 9 am to 5 pm", "2016-11-06 09:00", "2016-11-06 17:00"),
        ("from five to three today", "2016-11-07 05:00", "2016-11-07 15:00"),
        ("not yesterday but on friday", "2016-11-04 00:00", "2016-11-05 00:00"),
        ("not at nine but at ten", "2016-11-07 10:00", "2016-11-07 10:00"),
        ("on wensday", "2016-11-02 00:00", "2016-11-03 00:00"),
        ("from ten till three", "2016-11-07 10:00", "2016-11-07 15:00"),
        ("from ten thirty til three", "2016-11-07 10:30", "2016-11-07 15:00"),
        ("tuesday till thursday", "2016-11-01 00:00", "2016-11-04 00:00"),
        ("june till august", "2016-06-01 00:00", "2016-09-01 00:00"),
        ("march till may", "2016-03-01 00:00", "2016-06-01 00:00"),
        ("the first till the third of may", "2016-05-01 00:00", "2016-05-04 00:00"),
        ("friday at nine till saturday at ten", "2016-11-04 09:00", "2016-11-05 10:00"),
        ("yesterday until noon", "2016-11-06 00:00", "2016-11-06 12:00"),
        ("yesterday from five to three", "2016-11-06 05:00", "2016-11-06 15:00"),
        ("nine till noon", "2016-11-07 09:00", "2016-11-07 12:00"),
        ("after nine and before noon yesterday", "2016-11-06 09:00", "2016-11-06 12:00"),
        ("two till four", "2016-11-07 14:00", "2016-11-07 16:00"),
        ("before three and after one", "2016-11-07 13:00", "2016-11-07 15:00"),
        ("yesterday after one and before three", "2016-11-06 13:00", "2016-11-06 15:00"),
        ("the day before last friday", "2016-11-03 00:00", "2016-11-04 00:00"),
        ("the day before last", "2016-11-05 00:00", "2016-11-06 00:00"),
        ("in q2", "2016-04-01 00:00", "2016-07-01 00:00"),
        ("in Q4", "2016-10-01 00:00", "2017-01-01 00:00"),
        ("in q3 2015", "2015-07-01 00:00", "2015-10-01 00:00"),
        ("last q1", "2016-01-01 00:00", "2016-04-01 00:00"),
        ("in q2 of last year", "2015-04-01 00:00", "2015-07-01 00:00"),
        ("10am-noon", "2016-11-07 10:00", "2016-11-07 12:00"),
        ("yesterday noon-3pm", "2016-11-06 12:00", "2016-11-06 15:00"),
        ("on 3-5 may", "2016-05-03 00:00", "2016-05-06 00:00"),
        ("28 - 30 october 2015", "2015-10-28 00:00", "2015-10-31 00:00"),
        ("last may 29", "2016-05-29 00:00", "2016-05-30 00:00"),
        ("on fri 4 nov at 18h30", "2016-11-04 18:30", "2016-11-04 18:30"),
        ("between 0800 and 0930", "2016-11-07 08:00", "2016-11-07 09:30"),
        ("since 1430", "2016-11-07 14:30", "-"),
        ("since 2015", "2015-01-01 00:00", "-"),
        ("at eleven sharp", "2016-11-07 11:00", "2016-11-07 11:00"),
        ("from 3 pm", "2016-11-07 15:00", "-"),
        ("from noon on friday", "2016-11-04 12:00", "-"),
        ("from 7 a.m. onwards yesterday", "2016-11-06 07:00", "2016-11-07 00:00"),
        ("on the 4th, 5th or 6th", "2016-11-04 00:00", "2016-11-07 00:00"),
        ("on the 4th, the 5th and the 6th of may", "2016-05-04 00:00", "2016-05-07 00:00"),
        ("on tuesday, wednesday and thursday", "2016-11-01 00:00", "2016-11-04 00:00"),
        ("in may, june or july", "2016-05-01 00:00", "2016-08-01 00:00"),
        ("in 2013, 2014 or 2015", "2013-01-01 00:00", "2016-01-01 00:00"),
    ],
)
def test_spoken_time(said: str, start: str, end: str) -> None:
    found = slice_of(said)
    assert (clock(found.start), clock(found.end)) == (start, end)


@pytest.mark.parametrize("said", ["right now", "currently", "now", "at the moment"])
def test_the_present_is_no_slice_but_the_newest_sighting(said: str) -> None:
    query = parse(f"is the cup on the table {said}", now=MONDAY)
    assert (query.time, query.select) == (None, "last")


@pytest.mark.parametrize(
    "said",
    ["last tuesday the cup was", "on monday", "at 5 pm", "in december", "on the 31st", "last fall"],
)
@given(seconds=LOCAL)
def test_a_time_begins_in_the_past(said: str, seconds: int) -> None:
    moment = datetime.fromtimestamp(seconds, BERLIN)
    found = slice_of(said.removesuffix(" the cup was"), moment)
    assert found.start is not None
    assert found.start <= moment


@given(seconds=LOCAL)
def test_a_day_is_midnight_to_midnight_in_the_homes_zone(seconds: int) -> None:
    found = slice_of("yesterday", datetime.fromtimestamp(seconds, NEW_YORK))
    assert found.start is not None
    assert found.end is not None
    assert (found.start.hour, found.end.hour) == (0, 0)
    assert found.end.date() - found.start.date() == timedelta(days=1)


def test_a_day_of_23_hours_is_a_day() -> None:
    now = datetime(2026, 3, 9, 12, tzinfo=NEW_YORK)
    found = slice_of("yesterday", now)
    assert found.start is not None
    assert found.end is not None
    assert found.end.timestamp() - found.start.timestamp() == 23 * 3600


def test_hours_ago_are_elapsed_hours() -> None:
    now = datetime(2026, 3, 8, 4, 0, tzinfo=NEW_YORK)  # two in the morning was left out
    found = slice_of("three hours ago", now)
    assert found.start is not None
    assert now.timestamp() - found.start.timestamp() == 3 * 3600
    assert found.start.hour == 0


@pytest.mark.parametrize(("hour", "day"), [(0, 6), (3, 6), (4, 7), (12, 7)])
def test_this_morning_belongs_to_the_day_that_ended_until_four(hour: int, day: int) -> None:
    found = slice_of("this morning", MONDAY.replace(hour=hour, minute=30))
    assert found.start is not None
    assert found.start.day == day


def test_a_weekday_said_on_that_day_is_today() -> None:
    assert clock(slice_of("on monday").start) == "2016-11-07 00:00"
    assert clock(slice_of("last monday").start) == "2016-10-31 00:00"


@pytest.mark.parametrize("said", ["on the 4th or 6th", "on the 4th or on the 6th"])
def test_days_that_lie_apart_are_offered_one_at_a_time(said: str) -> None:
    with pytest.raises(Ambiguous) as caught:
        slice_of(said)
    assert caught.value.suggestions == (
        "where was the cup on the 4th",
        "where was the cup on the 6th",
    )


def test_a_day_that_only_begins_a_time_is_refused_with_what_to_say() -> None:
    with pytest.raises(NotUnderstood, match="say since when"):
        slice_of("from monday")


@pytest.mark.parametrize("said", ["where is the q1 report", "where is my q3"])
def test_a_quarter_is_a_time_where_one_is_due(said: str) -> None:
    assert parse(said, now=MONDAY).time is None


def test_a_clock_time_that_has_not_come_is_yesterdays() -> None:
    assert clock(slice_of("at 11 pm").start) == "2016-11-06 23:00"


@pytest.mark.parametrize("said", ["at any time", "at some point", "at any point"])
def test_any_time_narrows_nothing_and_is_no_thing(said: str) -> None:
    query = parse(f"did you see the cup {said}", now=MONDAY)
    assert (query.time, query.select) == (None, "all")
    assert [thing.category for thing in query.objects] == ["cup"]


@pytest.mark.parametrize("said", ["before i left", "before i left yesterday", "while i was out"])
def test_what_happened_is_no_time_without_a_clock(said: str) -> None:
    with pytest.raises(QuestionError):
        parse(f"where was the cup {said}", now=MONDAY)


def test_what_happened_may_be_told_first() -> None:
    query = parse("when i came home at three where was my bag", now=MONDAY)
    assert (query.ask, query.objects[0].category) == ("where", "bag")
    assert query.time is not None
    assert clock(query.time.start) == "2016-11-07 15:00"


def test_a_time_denied_at_the_end_is_refused() -> None:
    with pytest.raises(NotUnderstood, match="it says when not"):
        slice_of("not yesterday")


@pytest.mark.parametrize(
    ("zone", "start"),
    [
        ("America/Chicago", "2018-03-04"),
        ("Europe/Berlin", "2018-04-03"),
        ("Asia/Tokyo", "2018-04-03"),
    ],
)
def test_the_home_says_how_a_date_in_digits_is_read(zone: str, start: str) -> None:
    now = datetime(2019, 1, 1, tzinfo=ZoneInfo(zone))
    assert clock(slice_of("on 3/4/2018", now).start).startswith(start)


def test_a_date_in_digits_is_ambiguous_where_the_home_says_nothing() -> None:
    now = datetime.fromisoformat("2019-01-01T00:00:00+00:00")
    with pytest.raises(Ambiguous) as caught:
        parse("where was the cup on 3/4/2018", now=now)
    first, second = caught.value.readings
    assert first.time is not None
    assert second.time is not None
    assert {clock(first.time.start)[:10], clock(second.time.start)[:10]} == {
        "2018-03-04",
        "2018-04-03",
    }
    for suggestion in caught.value.suggestions:
        assert parse(suggestion, now=now).time in (first.time, second.time)
    assert caught.value.position == len("where was the cup on ")


def test_a_date_of_one_order_only_needs_no_home() -> None:
    now = datetime.fromisoformat("2019-01-01T00:00:00+00:00")
    assert clock(slice_of("on 25/12/2018", now).start) == "2018-12-25 00:00"
    assert clock(slice_of("on 5/5/2018", now).start) == "2018-05-05 00:00"


@pytest.mark.parametrize(
    "said",
    [
        "on the 30th of february",
        "on 2019-02-30",
        "yesterday today",
        "at 3 pm last week",
        "every morning",
        "every monday at nine",
        "every other evening",
        "every two hours",
        "each day",
        "on weekdays",
        "on weekday mornings",
        "on sundays",
        "in the evenings",
        "at weekends",
        "daily",
        "at a quarter past",
        "at half past yesterday",
        "at ten to the hour",
        "monday week",
    ],
)
def test_what_names_no_time_is_said_with_its_place(said: str) -> None:
    with pytest.raises(NotUnderstood) as caught:
        slice_of(said)
    assert caught.value.position == len("where was the cup ")


@pytest.mark.parametrize(
    ("said", "category"),
    [
        ("where is the sun hat", "hat"),
        ("where is the minute hand", "minute hand"),
        ("where is the date palm", "date palm"),
        ("where is the spring mattress", "mattress"),
        ("did you see a second cup", "cup"),
        ("is there a sunday newspaper in the hall", "sunday newspaper"),
        ("may i see the cup", "cup"),
        ("where is the alarm clock", "alarm clock"),
        ("where is the night stand", "nightstand"),
        ("where is the march calendar", "march calendar"),
        ("where is the daily planner", "daily planner"),
    ],
)
def test_false_friends_stay_nouns(said: str, category: str) -> None:
    query = parse(said, now=MONDAY)
    assert query.time is None
    assert query.objects[0].category == category


@given(st.text(alphabet="0123456789/-.: apmth", max_size=20))
def test_no_digits_break_the_clock(said: str) -> None:
    with contextlib.suppress(QuestionError):
        parse(f"where was the cup at {said}", now=MONDAY)
