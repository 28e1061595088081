"""Articles, plurals, times and slices as a person says them."""

from __future__ import annotations

from datetime import datetime, timedelta
from zoneinfo import ZoneInfo

import pytest

from assistant.english import (
    ago,
    article,
    counted,
    duration,
    listed,
    neither,
    slice_words,
    times,
    when,
)
from assistant.phrases import at_place
from grammar.forms import TimeSlice

ZONE = ZoneInfo("America/New_York")
NOW = datetime(2024, 5, 14, 19, 0, tzinfo=ZONE)  # a Tuesday


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("orange bowl", "an orange bowl"),
        ("cup", "a cup"),
        ("umbrella", "an umbrella"),
        ("unicycle", "a unicycle"),
        ("hourglass", "an hourglass"),
        ("scissors", "a pair of scissors"),
        ("scissors that are not red", "a pair of scissors that are not red"),
        ("red reading glasses", "a pair of red reading glasses"),
        ("groceries", "some groceries"),
    ],
)
def test_article(words: str, said: str) -> None:
    assert article(words) == said


@pytest.mark.parametrize(
    ("number", "words", "said"),
    [
        (1, "cup", "one cup"),
        (2, "knife", "two knives"),
        (12, "box", "12 boxes"),
        (3, "cup that is not red", "three cups that are not red"),
        (1, "cup that is not red", "one cup that is not red"),
        (2, "glasses that are not red", "two pairs of glasses that are not red"),
        (0, "cup", "no cups"),
        (1, "scissors", "one pair of scissors"),
        (3, "red glasses", "three pairs of red glasses"),
        (0, "glasses", "no glasses"),
    ],
)
def test_counted(number: int, words: str, said: str) -> None:
    assert counted(number, words) == said


def test_times_and_lists() -> None:
    assert [times(n) for n in (1, 2, 3, 12)] == ["once", "twice", "three times", "12 times"]
    assert listed(["a"]) == "a"
    assert listed(["a", "b", "c"]) == "a, b and c"
    assert neither(["red"]) == "not red"
    assert neither(["red", "blue"]) == "neither red nor blue"


@pytest.mark.parametrize(
    ("seconds", "said"),
    [
        (1, "1 second"),
        (59.9, "1 minute"),
        (90, "2 minutes"),
        (3599, "1 hour"),
        (3600 * 9, "9 hours"),
        (3600 * 47, "47 hours"),
        (86400 * 3, "3 days"),
        (86400 * 70, "2 months"),
        (86400 * 800, "2 years"),
    ],
)
def test_duration(seconds: float, said: str) -> None:
    assert duration(seconds) == said


@pytest.mark.parametrize(
    ("moment", "said"),
    [
        (NOW - timedelta(seconds=20), "today at 18:59, just now"),
        (NOW - timedelta(minutes=20), "today at 18:40, 20 minutes ago"),
        (NOW - timedelta(hours=9), "today at 10:00, 9 hours ago"),
        (NOW - timedelta(days=1), "yesterday at 19:00, 24 hours ago"),
        (NOW - timedelta(days=4), "on Friday at 19:00, 4 days ago"),
        (NOW - timedelta(days=20), "on Wednesday 24 April at 19:00, 20 days ago"),
        (NOW - timedelta(days=700), "on Tuesday 14 June 2022 at 19:00, 23 months ago"),
    ],
)
def test_when_has_clock_and_distance(moment: datetime, said: str) -> None:
    assert when(moment, NOW) == said


@pytest.mark.parametrize(
    ("days", "said"),
    [
        (59, "59 days ago"),
        (62, "2 months ago"),
        (75, "over 2 months ago"),
        (85, "almost 3 months ago"),
        (90, "3 months ago"),
        (731, "2 years ago"),
        (2283, "over 6 years ago"),
        (2466, "almost 7 years ago"),
        (2550, "7 years ago"),
    ],
)
def test_months_and_years_are_told_roughly(days: int, said: str) -> None:
    assert ago(NOW - timedelta(days=days), NOW) == said


def test_when_is_said_in_the_zone_of_now() -> None:
    moment = datetime(2024, 5, 14, 22, 30, tzinfo=ZoneInfo("UTC"))
    assert when(moment, NOW) == "today at 18:30, 30 minutes ago"


def test_a_change_of_the_clocks_does_not_count() -> None:
    now = datetime(2024, 11, 3, 9, 0, tzinfo=ZONE)  # the clocks went back at two
    assert ago(datetime(2024, 11, 3, 0, 30, tzinfo=ZONE), now) == "10 hours ago"


def day(number: int, hour: int = 0, minute: int = 0) -> datetime:
    return datetime(2024, 5, number, hour, minute, tzinfo=ZONE)


@pytest.mark.parametrize(
    ("start", "end", "said"),
    [
        (day(14, 13), day(14, 16), "between 13:00 and 16:00 today"),
        (day(13), day(14), "yesterday"),
        (day(10), day(13), "from Friday to Sunday"),
        (day(13, 18), day(14), "between 18:00 and midnight yesterday"),
        (day(13, 22), day(14, 5), "between yesterday at 22:00 and today at 5:00"),
        (day(13, 9), None, "since yesterday at 9:00"),
        (None, day(14, 12), "before today at 12:00"),
        (day(14, 12), day(14, 12), "today at 12:00"),
    ],
)
def test_slices_are_echoed_as_taken(
    start: datetime | None, end: datetime | None, said: str
) -> None:
    assert slice_words(TimeSlice(start, end), NOW) == said


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("kitchen", "in the kitchen"),
        ("anna's bedroom", "in Anna's bedroom"),
        ("charging corner", "in the charging corner"),
        ("lounge", "in the lounge"),
        ("desk", "at the desk"),
        ("my desk", "at your desk"),
        ("the desk", "at the desk"),
        ("Anna's desk", "at Anna's desk"),
        ("balcony", "on the balcony"),
        ("upstairs", "upstairs"),
    ],
)
def test_a_place_has_its_preposition(name: str, told: str) -> None:
    assert at_place(name) == told
