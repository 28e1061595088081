"""How long a follower waits for what: for more, for what belongs to a frame, for the end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from time import monotonic, sleep


@dataclass(slots=True)
class Patience:
    """The clock of a follower.

    idle_s: the recording is over when nothing came for so long; None: it never is. settle_s: what
    belongs to a frame (boxes, picture, pose) is waited for so long, where nothing proves sooner
    that it is all there. poll_s: between two looks. should_stop: asked at each look.
    """

    idle_s: float | None = None
    settle_s: float = 1.0
    poll_s: float = 0.1
    should_stop: Callable[[], bool] = lambda: False
    clock: Callable[[], float] = monotonic
    sleep: Callable[[float], None] = sleep
    _grew: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        self.grew()

    def grew(self) -> None:
        """Note that something came."""
        self._grew = self.clock()

    def is_over(self) -> bool:
        """Say whether nothing came for so long that nothing will."""
        return self.idle_s is not None and self.clock() - self._grew >= self.idle_s

    def has_settled(self, since: float) -> bool:
        """Say whether what came at `since` was waited for long enough."""
        return self.clock() - since >= self.settle_s

    def pause(self) -> None:
        """Wait until the next look."""
        self.sleep(self.poll_s)
