"""Default profile: a thing with all its places, as the memory holds it.

Ids are stable from birth, so that what a question sees while an ingest runs keeps its name.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from d3a.model import Position
from d3a.parameters import Parameters
from d3a.sightings import Interval
from d3a.store.base import TaughtName
from d3a.tracking.likelihood import shares


def object_id_of(number: int) -> str:
    """Return the id of a thing by its number; what a person split off has one below 0."""
    return f"o{number}" if number >= 0 else f"s{-number}"


@dataclass(slots=True, eq=False)
class Place:
    """One location of a thing. row: in the table of positions, -1 where the position is unknown.

    evidence: log-odds that it has left, from looks since it was last seen. there: logarithm of how
    likely its thing is still there by those looks, 0 when it was just seen. doubt: log-odds that it
    never was, by the depth around its first view. hits of chances: looks
    that found it of looks that could have; misses: looks in a row that did not, throughs: those of
    them that saw what is behind. seen_from: where the camera was when it was seen; missed_from:
    where it was lately, and when, when it was not. looks: x y z of the camera in the latest looks,
    their shares, and whether they found it, the next over the oldest; looked: how many there were.
    """

    number: int
    first_ms: int
    last_ms: int
    weight: float = 0.0
    seen: int = 0
    moved_from: tuple[int, float] | None = None
    last_absent_ms: int | None = None
    open: Interval | None = None
    evidence: float = 0.0
    there: float = 0.0
    doubt: float = 0.0
    hits: int = 0
    chances: float = 0.0
    misses: int = 0
    throughs: int = 0
    seen_from: list[Position] = field(default_factory=list)
    missed_from: list[tuple[Position, int]] = field(default_factory=list)
    looks: list[tuple[float, float, float, float, bool]] = field(default_factory=list)
    looked: int = 0
    row: int = -1


@dataclass(slots=True, eq=False)
class Known:
    """A thing in memory. votes: weight by category; seen: frames it was detected in, ever.

    compared_ms: when a detection was compared with it last, or it came back to be.
    met: numbers of the things seen beside it in a frame while it was in memory, so other things.
    look_weight: of the mean look, 0 without one. row: in the table of looks.
    """

    number: int
    votes: dict[str, float]
    first_ms: int
    last_ms: int
    compared_ms: int = 0
    weight: float = 0.0
    seen: int = 0
    look_weight: float = 0.0
    extent_m: tuple[float, float] | None = None
    extents: int = 0
    names: tuple[TaughtName, ...] = ()
    places: list[Place] = field(default_factory=list)
    met: set[int] = field(default_factory=set)
    row: int = -1
    dirty: bool = True
    object_id: str = field(init=False, repr=False)
    """The id in the store."""
    _named: str | None = field(default=None, init=False, repr=False)
    _shares: dict[str, float] | None = field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        self.object_id = object_id_of(self.number)

    def vote(self, category: str, weight: float) -> None:
        """Add the weight of a detection that was named so."""
        self.votes[category] = self.votes.get(category, 0.0) + weight
        self._named = self._shares = None

    @property
    def category(self) -> str:
        """The category with most weight, the first by name of equals."""
        if self._named is None:
            self._named = min(self.votes, key=lambda name: (-self.votes[name], name))
        return self._named

    @property
    def shares(self) -> dict[str, float]:
        """What the votes say of the category, see `likelihood.shares`."""
        if self._shares is None:
            self._shares = shares(self.votes)
        return self._shares

    @property
    def latest(self) -> Place:
        """The place where it was seen last."""
        if len(self.places) == 1:
            return self.places[0]
        return max(self.places, key=lambda place: (place.last_ms, place.number))

    @property
    def head(self) -> Place:
        """The place where it was seen first."""
        if len(self.places) == 1:
            return self.places[0]
        return min(self.places, key=lambda place: (place.first_ms, place.number))

    def place(self, number: int) -> Place:
        """Return the place with this number."""
        return next(place for place in self.places if place.number == number)


def goes_on(place: Place, old: Interval, now_ms: int, parameters: Parameters) -> bool:
    """Say whether a place's interval goes on to a view: short, and after a short pause only.

    Or after a longer one in which no look saw the thing gone.
    """
    pause_s = parameters.interval_gap_s
    if place.last_absent_ms is None:
        pause_s = max(pause_s, parameters.unbroken_gap_s)
    is_short = now_ms - old.start_ms <= parameters.max_interval_s * 1000
    return is_short and (now_ms - old.end_ms) / 1000 <= pause_s
