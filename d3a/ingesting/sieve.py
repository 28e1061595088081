"""Which frames of a recording are taken in: in time order, none twice, none with a slip of a stamp.

The verdict on a frame rests on the frames before it and on the few that follow, never on when
they came: an ingest, one that goes on, and one that follows a growing recording agree.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from d3a.ingesting.intake import Intake
from d3a.model import Frame
from d3a.store.limits import MAX_TIME_MS

DUPLICATE = "duplicate frame"
BACKWARDS = "time runs backwards or stands still"
JUMP = "time jumps ahead, and the frames after it come before"
NO_DATE = "time outside of 1970 to 2199"
JUMP_MS = 600_000
"""A frame this long after the one before is compared with those that follow; a smaller slip costs
no more than so much of the recording, and slow cameras need not wait."""
LOOK_AHEAD = 5
"""Frames to compare with; a stamp that more than half of them contradict is a slip."""


@dataclass(frozen=True, slots=True)
class Sifted:
    """A frame and the verdict on it.

    number: from 0 in the recording. why: what it is left out for, None for one to take in.
    is_known: the store has it from before, so that it is neither taken nor counted.
    """

    number: int
    frame: Frame
    why: str | None = None
    is_known: bool = False


class Sieve:
    """Judges the frames of one recording, from where the store has it."""

    def __init__(
        self, intake: Intake, *, consumed: int = 0, last_ms: int | None = None, was_done: bool
    ) -> None:
        """consumed: frames judged before. last_ms: the last that was taken in, None without.

        was_done: the recording was ended before, and has grown since: what is new comes after
        its last time. One that is going on is continued by the number of frames.
        """
        self._intake = intake
        self._consumed = consumed
        self._last_ms = last_ms
        self._had_ms = last_ms if was_done else None
        self._names: set[str] = set()
        self._waiting: deque[tuple[int, Frame, bool]] = deque()

    def sift(self, frames: Iterable[Frame | None]) -> Iterator[Sifted | None]:
        """Yield a verdict for each frame that was not judged before, in order.

        A None among the frames says that there is nothing new for now; it is passed on. Frames
        that wait for those after them are judged when the frames end.
        """
        number = 0
        for frame in frames:
            if frame is None:
                yield None
                continue
            is_duplicate = frame.name in self._names
            self._names.add(frame.name)
            if number >= self._consumed:
                self._waiting.append((number, frame, is_duplicate))
                yield from self._judged(is_end=False)
            number += 1

    def rest(self) -> Iterator[Sifted]:
        """Yield the verdicts on frames that waited for others, where none will come."""
        yield from self._judged(is_end=True)

    def _judged(self, *, is_end: bool) -> Iterator[Sifted]:
        """Yield verdicts while they need no more frames; is_end: no more will come."""
        while self._waiting:
            number, frame, is_duplicate = self._waiting[0]
            if self._had_ms is not None and frame.time_ms <= self._had_ms:
                verdict = Sifted(number, frame, is_known=True)
            elif (why := self._amiss(frame, is_duplicate)) is not None:
                verdict = Sifted(number, frame, why)
            else:
                is_slip = self._is_slip(frame, is_end=is_end)
                if is_slip is None:
                    return
                verdict = Sifted(number, frame, JUMP if is_slip else self._why_not(number, frame))
                if verdict.why is None:
                    self._last_ms = frame.time_ms
            self._waiting.popleft()
            yield verdict

    def _amiss(self, frame: Frame, is_duplicate: bool) -> str | None:
        if not 0 <= frame.time_ms < MAX_TIME_MS:
            return NO_DATE
        if is_duplicate:
            return DUPLICATE
        if self._last_ms is not None and frame.time_ms <= self._last_ms:
            return BACKWARDS
        return None

    def _is_slip(self, frame: Frame, *, is_end: bool) -> bool | None:
        """Say whether most frames that follow come well before this one, and after the last.

        None: that takes more frames than there are.
        """
        if self._last_ms is not None and frame.time_ms - self._last_ms <= JUMP_MS:
            return False
        low = -1 if self._last_ms is None else self._last_ms
        high = frame.time_ms - (JUMP_MS if self._last_ms is None else 0)
        following = [self._waiting[n][1].time_ms for n in range(1, len(self._waiting))]
        following = following[:LOOK_AHEAD]
        against = sum(low < time_ms < high for time_ms in following)
        most = LOOK_AHEAD // 2 + 1
        if max(against, len(following) - against) < most and not is_end:
            return None
        return 2 * against > len(following)

    def _why_not(self, number: int, frame: Frame) -> str | None:
        why = self._intake.why_not(number, frame.time_ms)
        return why or self._intake.why_off_limits(frame)
