"""Default profile: how often what was seen once, long ago, is seen again.

A detector's mistakes are seen once and look like things that are hard to see: looks in vain alone
take dozens to tell. In a home that is known nearly all that turns up once is one of them, and how
nearly all is counted.
"""

from __future__ import annotations

import math

LONG_MS = 4 * 3_600_000
"""After so long a robot has come by again, several times; before, one view is worth what it is."""
PRIOR = 10.0
"""Things as many of which are assumed to be seen again, and not, before any were counted."""
REMEMBERED = 200.0
"""Things after which the oldest fade: most of a home turns up in its first hours."""


class Singles:
    """Counts things that were seen once, and those that were seen again a long time later."""

    def __init__(self) -> None:
        self.once, self.again = 0.0, 0.0
        """Not seen again for so long, and those of them that were seen again at last."""

    def born(self) -> None:
        """Count a thing that was seen for the first time."""
        if self.once >= REMEMBERED:
            keep = 1.0 - 1.0 / REMEMBERED
            self.once, self.again = self.once * keep, self.again * keep
        self.once += 1.0

    def seen_again(self, after_ms: int) -> None:
        """Count the second sighting of a thing, so long after the first."""
        if after_ms > LONG_MS:
            self.again += 1.0
        else:
            self.once -= 1.0

    def odds(self, since_ms: int) -> float:
        """Return the log-odds, 0 at least, that what was seen once so long ago never is again."""
        if since_ms <= LONG_MS:
            return 0.0
        never = max(self.once - self.again, 0.0)
        return max(0.0, math.log((never + PRIOR) / (self.again + PRIOR)))
