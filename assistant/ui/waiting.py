"""What was said and waits for its answer, in the order in which it was said."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from d3a.answer import RankedKeyframe


@dataclass(frozen=True, slots=True)
class Saying:
    """Something said. number: grows with each; chosen: the row that was under the mark then."""

    number: int
    text: str
    chosen: RankedKeyframe | None


class WaitingLine:
    """Sayings that are to be answered one after the other, by whichever thread comes next.

    teaches: whether a saying is to be done, whatever was said after it.
    """

    def __init__(self, teaches: Callable[[str], bool]) -> None:
        self._teaches = teaches
        self._sayings: deque[Saying] = deque()

    def add(self, saying: Saying) -> None:
        """Let a saying wait behind the others."""
        self._sayings.append(saying)

    def take(self, newest: int) -> Saying | None:
        """Return what has waited longest, None where nobody waits for its answer any more.

        newest: the number of what was said last, or of its being stopped. A question is overtaken
        by that, unless what was taught next may be about its answer.
        """
        said = self._sayings.popleft()
        following = self._sayings[0].text if self._sayings else ""
        is_wanted = said.number == newest or any(map(self._teaches, (said.text, following)))
        return said if is_wanted else None
