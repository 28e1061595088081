"""What is in the home, and how three days of its life move it about.

A thing's `stays` say where it is from when; None is away: worn, carried out, in a cupboard, eaten.
The person leaves at about nine and is back at half past five on the first two days, and is at home
on the third. The keys lie on the hall shelf at night and on the kitchen table at breakfast, until
the last evening, when they are put down on the coffee table.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from zoneinfo import ZoneInfo

from assistant.home.model import Model, placed
from assistant.home.plan import SURFACES

ZONE = "Europe/London"
FIRST_DAY = (2026, 5, 12)
NOW = datetime(2026, 5, 14, 20, 30, tzinfo=ZoneInfo(ZONE))


@dataclass(frozen=True, slots=True)
class Place:
    """Where a thing is put: on a surface, at an offset from its point in metres, turned by yaw."""

    surface: str
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    z: float = 0.0

    def position(self) -> tuple[float, float, float]:
        """Return the point that the thing stands on, in the map frame."""
        surface = SURFACES[self.surface]
        return surface.x + self.x, surface.y + self.y, surface.z + self.z


Stays = tuple[tuple[datetime, Place | None], ...]


@dataclass(frozen=True, slots=True)
class Thing:
    """One object: its name, category, colour in words, solids, and (from when, where) in order."""

    name: str
    category: str
    colour: str
    model: Model
    stays: Stays

    def place_at(self, moment: datetime) -> Place | None:
        """Return where the thing is at a moment, None while it is away."""
        return next((place for since, place in reversed(self.stays) if since <= moment), None)

    def model_at(self, moment: datetime) -> Model:
        """Return the thing's solids where they are at a moment; nothing while it is away."""
        place = self.place_at(moment)
        return () if place is None else placed(self.model, place.position(), place.yaw)

    @property
    def moves(self) -> bool:
        """Whether the thing is ever put elsewhere."""
        return len({place for _, place in self.stays}) > 1


def when(text: str) -> datetime:
    """Return the moment of "2 17:40", the second day at 17:40 by the home's clock."""
    day, clock = text.split()
    hour, minute = clock.split(":")
    year, month, first = FIRST_DAY
    zone = ZoneInfo(ZONE)
    return datetime(year, month, first + int(day) - 1, int(hour), int(minute), tzinfo=zone)
