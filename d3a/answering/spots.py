"""Where stays were, in words: the room that holds one, the large thing that it is next to.

Worked out once a stay for as long as the store's revision stands: people ask of the same things.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from d3a.answering.landmarks import FAR_M, Landmarks
from d3a.answering.places import holders_of, sigma_of, smallest
from d3a.store.base import Region, StayKey, StayRecord

MOST_SPOTS = 20_000
"""So many are kept between questions at most."""
RuledOut = frozenset[int]
"""The rows of the landmarks that a question's figures may be themselves."""


class Spot(NamedTuple):
    """Where a stay was, in words: see the fields of `d3a.answer.RankedKeyframe`."""

    place: str | None = None
    near: str | None = None
    vague: str | None = None
    beyond: tuple[str, float] | None = None


@dataclass(slots=True)
class Spots:
    """The spots of a store's stays at one revision.

    landmarks: None where a question tells no more than rooms. near_m: how near is next to it.
    """

    regions: Sequence[Region]
    landmarks: Landmarks | None
    near_m: float
    _kept: dict[tuple[RuledOut, StayKey], Spot] = field(default_factory=dict)

    def ruled_out(self, ids: Collection[str], categories: Collection[str]) -> RuledOut:
        """Return the landmarks that are one of the ids or of a category."""
        if self.landmarks is None:
            return frozenset()
        named = zip(self.landmarks.stays, self.landmarks.categories, strict=True)
        return frozenset(
            row for row, ((name, _), kind) in enumerate(named) if name in ids or kind in categories
        )

    def tell(self, stays: Iterable[StayRecord], without: RuledOut) -> dict[StayKey, Spot]:
        """Return the spot of each stay. without: landmarks that none is told by."""
        asked = {stay.key: stay for stay in stays}
        kept = self._kept
        fresh = [stay for key, stay in asked.items() if (without, key) not in kept]
        if len(kept) + len(fresh) > MOST_SPOTS:
            kept, fresh = {}, [*asked.values()]
            self._kept = kept  # whoever still reads the old ones has them
        if fresh:
            kept |= {(without, stay.key): spot for stay, spot in self._worked_out(fresh, without)}
        return {key: kept[without, key] for key in asked}

    def _worked_out(
        self, stays: Sequence[StayRecord], without: RuledOut
    ) -> Iterable[tuple[StayRecord, Spot]]:
        held = holders_of(self.regions, [(stay.position, stay.site) for stay in stays])
        near: list[tuple[str, float] | None] = [None] * len(stays)
        if self.landmarks is not None:
            rooms = [tuple([room.name for room in each]) for each in held]
            near = self.landmarks.nearest(stays, FAR_M, rooms, without=without)
        for stay, rooms_of_it, landmark in zip(stays, held, near, strict=True):
            yield stay, self._spot(stay, smallest(rooms_of_it), landmark)

    def _spot(self, stay: StayRecord, room: str | None, landmark: tuple[str, float] | None) -> Spot:
        if landmark is None:
            return Spot(room)
        sigma = sigma_of(stay)
        if sigma > self.near_m:
            return Spot(room, vague=landmark[0] if landmark[1] <= sigma else None)
        near = landmark[1] <= self.near_m
        return Spot(room, near=landmark[0]) if near else Spot(room, beyond=landmark)
