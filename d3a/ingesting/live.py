"""An ingest of a recording that grows: how fresh the store is kept, and when to stop."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from time import monotonic


@dataclass(frozen=True, slots=True)
class Live:
    """How an ingest goes on as its recording grows.

    fresh_s: how old the store may be, where there is something new to write; None: checkpoints are
    by the number of frames alone. should_stop: asked after each frame; once it says so, what was
    seen is written, and the recording is left open. A reader may then yield None while it waits.
    """

    fresh_s: float | None = None
    should_stop: Callable[[], bool] = lambda: False


WHOLE = Live()


class Pulse:
    """Says when the store has got too old; a slow one is written to less often."""

    SHARE = 10
    """At most one part in so many of the time goes into such checkpoints."""

    def __init__(self, live: Live) -> None:
        self._fresh_s = live.fresh_s
        self._last = monotonic()
        self._cost = 0.0

    def is_due(self) -> bool:
        """Say whether it has."""
        if self._fresh_s is None:
            return False
        return monotonic() - self._last >= max(self._fresh_s, self.SHARE * self._cost)

    @contextmanager
    def beat(self) -> Iterator[None]:
        """Write in the `with`: the store is fresh then."""
        start = monotonic()
        yield
        self._last = monotonic()
        self._cost = self._last - start
