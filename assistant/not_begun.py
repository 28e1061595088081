"""What is said where a question is asked as of a time before anything was seen."""

from __future__ import annotations

from datetime import datetime

from assistant.english import clock, day_of


def not_begun_words(begins_ms: int, now: datetime) -> str:
    """Return that nothing had been seen by `now`, and since when there is a memory (UTC ms)."""
    begins = datetime.fromtimestamp(begins_ms / 1000, tz=now.tzinfo)
    return (
        f"I had not seen anything yet: my memory begins {day_of(begins, now)} at {clock(begins)}."
    )
