"""Default profile: the confirmed things by category, as moves are looked for among them.

A look asks for a handful of categories, and changes little of what their things are: the lists are
made anew only where a thing came or left, was confirmed, was called otherwise, or is elsewhere now.
"""

from __future__ import annotations

from dataclasses import dataclass

from d3a.tracking.known import Known, Place
from d3a.tracking.memory import Memory

Last = tuple[Known, Place]
"""A thing, and the place where it was seen last."""


@dataclass(slots=True)
class Kind:
    """The confirmed things of a category by number, with the place that each was seen at last.

    fresh: those of them of which nobody knows where they were before they turned up. is_compared:
    whether all of these were compared with the others, see `Moves`.
    """

    lasts: list[Last]
    fresh: list[Known]
    is_compared: bool = False


_NONE = Kind([], [], is_compared=True)
_Told = tuple[str, Place, bool]
"""What of a confirmed thing decides where it is listed: category, last place, whether fresh."""


class Kinds:
    """Lists of the things of a memory that were seen so often at least."""

    def __init__(self, memory: Memory, least: int) -> None:
        self._memory = memory
        self._least = least
        self._told: dict[int, _Told] = {}
        self._of: dict[str, dict[int, Known]] = {}
        self._kinds: dict[str, Kind] = {}
        """Those of the lists that are as they were when they were asked for."""

    def of(self, category: str) -> Kind:
        """Return the things of a category."""
        for number in self._memory.take_touched():
            self._update(number)
        kind = self._kinds.get(category)
        if kind is None and (known := self._of.get(category)):
            kind = self._kinds[category] = self._made([known[number] for number in sorted(known)])
        return kind or _NONE

    def _made(self, things: list[Known]) -> Kind:
        told = self._told
        lasts = [(thing, told[thing.number][1]) for thing in things]
        return Kind(lasts, [thing for thing in things if told[thing.number][2]])

    def _update(self, number: int) -> None:
        """List a thing anew, if anything that decides where it is listed has changed."""
        thing = self._memory.things.get(number)
        was, told = self._told.get(number), None
        if thing is not None and thing.seen >= self._least:
            place = thing.latest
            told = thing.category, place, _is_unexplained(thing)
        # another thing may have come back under the number
        if was == told and (told is None or self._of[told[0]][number] is thing):
            return
        if was is not None:
            del self._told[number], self._of[was[0]][number]
            self._kinds.pop(was[0], None)
        if told is not None and thing is not None:
            self._told[number] = told
            self._of.setdefault(told[0], {})[number] = thing
            self._kinds.pop(told[0], None)


def _is_unexplained(thing: Known) -> bool:
    """Say whether it is not known where it was before it turned up."""
    return thing.head.moved_from is None and not thing.names
