"""What questions keep of a store for as long as nobody writes to it, and how much of it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

from d3a.answering.attributes import Looks
from d3a.answering.kept import Kept
from d3a.answering.landmarks import Landmarks
from d3a.answering.match import Candidate
from d3a.answering.moments import Found
from d3a.answering.spots import Spots
from d3a.answering.steps import FindObjects, Precision
from d3a.colours import Palette
from d3a.parameters import Parameters
from d3a.store.base import (
    Area,
    ObjectRecord,
    Positions,
    Region,
    Sighting,
    Spans,
    StayKey,
    StayRecord,
    TaughtName,
)
from grammar.forms import RelationKind

MOST_STAYS = 5_000
"""So many stays are kept between questions at most."""
MOST_WORDS = 100
"""And what so many nouns may mean."""
MOST_OBJECTS = 50_000
"""And so many records of objects, half a kilobyte each."""
MOST_LOOKS = 25_000
"""With their embeddings they are five times as large: 60 MB at most, and 15 MB for their pixels."""
MOST_SIGHTINGS = 20_000
MOST_SPANS = 500_000
"""Their times and places alone take 32 bytes each."""
MOST_PLACED = 250_000
"""And where stays are 48."""
_Seen = TypeVar("_Seen", Sighting, StayRecord)
_Asked = tuple[str, ...] | None
_Noun = tuple[str, str, Precision | None]
_Meant = tuple[FindObjects, tuple[tuple[str, float], ...], float]
_Counted = tuple[tuple[str, ...], int | None, int | None]
_Timed = tuple[tuple[str, ...], int | None, int | None, Area | None]
_Candidates = tuple[list[ObjectRecord], list[Candidate]]
_Pixels = tuple[Looks | None, bool]


def by_object(ids: Sequence[str], records: Iterable[_Seen]) -> dict[str, list[_Seen]]:
    """Return the records of each of these objects, also of those that have none."""
    found: dict[str, list[_Seen]] = {name: [] for name in ids}
    for record in records:
        found[record.object_id].append(record)
    return found


@dataclass(slots=True)
class Revision:
    """What was read of a store at one revision. crowded: it is not a home of few things."""

    categories: list[tuple[str, int]] | None = None
    names: list[TaughtName] | None = None
    regions: list[Region] | None = None
    palette: Palette | None = None
    landmarks: Landmarks | None = None
    carriers: Found = field(default_factory=Found)
    parameters: Parameters | None = None
    rungs: Kept[_Noun, tuple[Mapping[str, float], Mapping[str, float]]] = field(
        default_factory=lambda: Kept(MOST_WORDS)
    )
    usual: dict[RelationKind, frozenset[str]] = field(default_factory=dict)
    newest_ms: int | None = None
    spots: dict[tuple[bool, float], Spots] = field(default_factory=dict)
    meta: dict[str, Any] = field(default_factory=dict)
    objects: Kept[_Asked, list[ObjectRecord]] = field(default_factory=lambda: Kept(MOST_OBJECTS))
    seen: Kept[_Asked, list[ObjectRecord]] = field(default_factory=lambda: Kept(MOST_LOOKS))
    meant: Kept[_Meant, _Candidates] = field(default_factory=lambda: Kept(MOST_OBJECTS))
    looks: Kept[tuple[str, ...], _Pixels] = field(default_factory=lambda: Kept(MOST_LOOKS))
    stays: Kept[str, list[StayRecord]] = field(default_factory=lambda: Kept(MOST_STAYS))
    places: dict[StayKey, StayRecord] = field(default_factory=dict)
    counts: Kept[_Counted, int] = field(default_factory=lambda: Kept(MOST_OBJECTS))
    sightings: dict[str, list[Sighting]] = field(default_factory=dict)
    joined: Kept[tuple[str, ...], list[Sighting]] = field(
        default_factory=lambda: Kept(MOST_SIGHTINGS)
    )
    last: Kept[tuple[str, ...], list[Sighting]] = field(
        default_factory=lambda: Kept(MOST_SIGHTINGS)
    )
    spans: Kept[_Timed, Spans] = field(default_factory=lambda: Kept(MOST_SPANS))
    positions: Kept[tuple[str, ...], Positions] = field(default_factory=lambda: Kept(MOST_PLACED))
    kept: int = 0
    crowded: bool = False

    def room_for_places(self, keys: Sequence[StayKey]) -> dict[StayKey, StayRecord]:
        """Return the stays kept one by one, none where those of the keys would be too many more."""
        if len(self.places) + sum(key not in self.places for key in keys) > MOST_STAYS:
            self.places = {}  # whoever still reads the old ones has them
        return self.places

    def keeps(self, number: int) -> bool:
        """Whether so many more sightings may be kept; counts them where they may."""
        if self.kept + number > MOST_SIGHTINGS:
            return False
        self.kept += number
        return True
