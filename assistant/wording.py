"""Short words for times, places and how sure: the rows of a table, a list and a map.

The sentence of an answer is composed in `reply`; this is what stands beside it, and it is the
same in the chat, in line mode and on the command line.
"""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING

from assistant.terminal import clean, table

if TYPE_CHECKING:
    from d3a.answer import Answer, RankedKeyframe

WEEKDAYS = ("Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun")
MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")
FAIRLY_SURE, NOT_SURE = 0.5, 0.25
"""Scores are probabilities: "fairly sure" is more likely right than wrong."""


def short_time(moment: datetime, now: datetime, *, brief: bool = False) -> str:
    """Return the clock time and the day as `now` would call it: "9:42 today", "17:05 Fri".

    Both are said in the zone of `now`; days are calendar days of that zone. brief: yesterday is
    its weekday too, for a narrow column.
    """
    local = moment.astimezone(now.tzinfo)
    clock = f"{local.hour}:{local.minute:02d}"
    days = (now.date() - local.date()).days
    if days == 0:
        return f"{clock} today"
    if days == 1 and not brief:
        return f"{clock} yesterday"
    if 0 < days < 7:
        return f"{clock} {WEEKDAYS[local.weekday()]}"
    date = f"{local.day} {MONTHS[local.month - 1]}"
    return f"{clock} {date}" if local.year == now.year else f"{clock} {date} {local.year}"


def place_words(keyframe: RankedKeyframe, *, brief: bool = False) -> str:
    """Return where a keyframe's object was: the room, the landmark beside it, else metres.

    brief: without the words between room and landmark, for a narrow column.
    """
    parts = []
    if keyframe.place:
        parts.append(keyframe.place)
    if keyframe.near and keyframe.near != keyframe.place:
        parts.append(keyframe.near if brief and parts else f"by the {keyframe.near}")
    if not parts and keyframe.position is not None:
        x, y, _ = keyframe.position
        return f"x {x:.1f} m, y {y:.1f} m"
    return ", ".join(parts) or "place unknown"


def is_sure(keyframe: RankedKeyframe) -> bool:
    """Whether a keyframe is rather right than wrong, and its thing was seen more than once."""
    return keyframe.score >= FAIRLY_SURE and "tentative" not in keyframe.why


def how_sure(keyframe: RankedKeyframe) -> str:
    """Return the band of the score, in words: never a bare number for a person.

    A thing that was seen but once may be a mistake of the detector, however good it looks.
    """
    if is_sure(keyframe):
        return "fairly sure"
    return "not sure" if keyframe.score >= NOT_SURE else "a guess"


def seen_words(keyframe: RankedKeyframe) -> str:
    """Return how often the object was seen in that interval."""
    return "seen once" if keyframe.seen == 1 else f"seen {keyframe.seen} times"


def keyframe_row(keyframe: RankedKeyframe, now: datetime) -> tuple[str, ...]:
    """Return category, time, place, how sure, seen: the columns of a row, data made harmless."""
    return (
        clean(keyframe.category),
        short_time(keyframe.last, now),
        clean(place_words(keyframe)),
        how_sure(keyframe),
        seen_words(keyframe),
    )


def more_words(answer: Answer) -> str:
    """Return what lies below the best keyframe, and whether the list was cut."""
    below = len(answer.keyframes) - 1
    words = f"{below} more below." if below > 0 else ""
    if answer.truncated:
        words += f" The list stops at {len(answer.keyframes)}; there are more."
    return words.strip()


def answer_lines(answer: Answer, now: datetime, *, rows: int | None = None) -> list[str]:
    """Return an answer as lines: the sentence, the ranked keyframes as a table, a way on.

    rows: how many keyframes at most, None for all of the answer's.
    """
    sentence, reason = told(answer)
    lines = [sentence, *([reason] if reason else [])]
    if answer.keyframes or answer.instead:
        header = ["#", "what", "last seen", "where", "how sure", "seen", "score", "frame"]
        listed = answer.keyframes or answer.instead
        shown = listed[:rows]
        cells = [[str(k.rank), *keyframe_row(k, now), f"{k.score:.2f}", k.frame] for k in shown]
        lines += ["", *table([header, *cells], limits={1: 24, 3: 34, 7: 24})]
        if len(shown) < len(listed):
            lines.append(f"({len(listed) - len(shown)} more)")
        elif answer.truncated:
            lines.append(f"(the first {len(shown)}; --limit shows more)")
    lines += [f"Did you mean: {clean(suggestion)}" for suggestion in answer.suggestions]
    return lines


def told(answer: Answer) -> tuple[str, str]:
    """Return the sentence of an answer and what is to be added to it, each said once.

    What is offered stands below as a list, so the sentence that names one of it gives way.
    """
    sentence, reason = answer.answer or answer.message or "", answer.message or ""
    if answer.suggestions and reason and sentence.startswith(reason):
        return reason, ""
    return sentence, reason if reason != sentence else ""


def from_ms(milliseconds: int, now: datetime) -> datetime:
    """Return a store's time as a datetime in the zone of `now`."""
    moment = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(milliseconds=milliseconds)
    return moment.astimezone(now.tzinfo)
