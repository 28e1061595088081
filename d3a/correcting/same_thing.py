"""A person says that two objects are one, and takes it back: on portions of the store.

To take it back after the robot has seen more is to say which of the two the new views are of. A
view at a place that came from one of them is that one's; a place found since, and what was seen at
a place of both, is of the object that kept its id.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from d3a.correcting.portion import Portion, joined_sightings, relabelled, rename_encounters
from d3a.parameters import Parameters
from d3a.store.base import Encounter, ObjectRecord, Sighting, StayKey, StayRecord

SURE = 1.0
"""The score of a move that a person has told."""
SAME_PLACE_SIGMAS = 2.0
"""Two stays so near, by what is known of both, are at one place."""
_Numbers = tuple[float, ...]
Origin = dict[StayKey, StayKey]
"""A stay before -> the stay that it is part of after."""


def shared_frame(portion: Portion, a: str, b: str) -> Encounter | None:
    """Return where one frame shows both, so that they are two things; None where none does."""
    pair = (a, b) if a < b else (b, a)
    met = [e for k, e in sorted(portion.encounters.items()) if k[:2] == pair]
    return max(met, key=lambda e: e.seen, default=None)


def doubts(portion: Portion, one: str, other: str, parameters: Parameters) -> list[str]:
    """Return what speaks against two objects being one, a clause each.

    They may be one for all that: detectors err, and so do maps. So it is told and not refused.
    """
    a, b = portion.objects[one], portion.objects[other]
    found = []
    if a.category not in votes_of(b) and b.category not in votes_of(a):
        found.append(f"{one} was never called {b.category}, nor {other} {a.category}")
    if a.site != b.site:
        found.append(f"{one} is of the site {a.site!r}, {other} of {b.site!r}")
    metres = _apart_at_one_time(portion, one, other, parameters)
    if metres is not None:
        found.append(f"both were seen at one time, {metres:.1f} m apart")
    return found


def _apart_at_one_time(
    portion: Portion, one: str, other: str, parameters: Parameters
) -> float | None:
    """Return the most metres between places where two objects were meanwhile, None for none."""
    metres = []
    for a, b in product(portion.of_object(one), portion.of_object(other)):
        if a.position is None or b.position is None or a.site != b.site:
            continue
        if _apart(a, b, parameters) is None and _overlap(portion.at(a.key), portion.at(b.key)):
            metres.append(math.dist(a.position, b.position))
    return max(metres, default=None)


def _overlap(some: Sequence[Sighting], others: Sequence[Sighting]) -> bool:
    """Say whether an interval of some, by time, shares a moment with one of the others."""
    ends = sorted((each.end_ms, each.start_ms) for each in others)
    for each in some:
        after = bisect_left(ends, (each.start_ms, -1))
        if any(start_ms <= each.end_ms for _, start_ms in ends[after:]):
            return True
    return False


def merged(
    portion: Portion, kept: str, gone: str, parameters: Parameters
) -> tuple[Portion, Origin]:
    """Make two objects one, under the id `kept`; what is at one place becomes one stay.

    Returns the portion, and what each stay has become.
    """
    origin = _origin(portion, kept, gone, parameters)
    stays: dict[StayKey, StayRecord] = {}
    sightings: list[Sighting] = []
    for target in sorted(set(origin.values())):
        sources = [portion.stays[key] for key in sorted(origin) if origin[key] == target]
        stay = _moved_within(sources[0], target, origin)
        for other in sources[1:]:
            stay = one_stay(stay, _moved_within(other, target, origin))
        seen = [s for source in sources for s in portion.at(source.key)]
        if len(sources) > 1:
            seen = joined_sightings(seen, target, parameters)
        stays[target] = stay
        sightings += [relabelled(each, target) for each in seen]
    one = _one_object(portion.objects[kept], portion.objects[gone])
    last = {kept: portion.of_object(kept), gone: portion.of_object(gone)}
    stays |= _told_move(stays, origin, last[kept], last[gone])
    stays = {k: replace(s, tentative=one.tentative) for k, s in stays.items()}
    encounters = rename_encounters(portion.encounters.values(), origin)
    return Portion.of([one], stays.values(), sightings, encounters.values()), origin


def _origin(portion: Portion, kept: str, gone: str, parameters: Parameters) -> Origin:
    mine, theirs = portion.of_object(kept), portion.of_object(gone)
    origin = {stay.key: stay.key for stay in mine}
    free = max((stay.place for stay in mine), default=-1) + 1
    for stay in sorted(theirs, key=lambda s: (s.first_ms, s.place)):
        near = [(d, m.key) for m in mine if (d := _apart(m, stay, parameters)) is not None]
        if near:
            origin[stay.key] = min(near)[1]
        else:
            origin[stay.key] = (kept, free)
            free += 1
    return origin


def _apart(one: StayRecord, other: StayRecord, parameters: Parameters) -> float | None:
    """Return the metres between two stays, None where they are at different places."""
    if one.position is None or other.position is None:
        return 0.0 if one.position is other.position else None
    steps = np.subtract(one.position, other.position)
    metres = float(np.linalg.norm(steps))
    if metres <= parameters.d_thresh_m:
        return metres
    if one.covariance is None or other.covariance is None:
        return None
    spread = np.reshape(np.add(one.covariance, other.covariance), (3, 3))
    away = math.sqrt(max(float(steps @ np.linalg.pinv(spread) @ steps), 0.0))
    return metres if away <= SAME_PLACE_SIGMAS else None


def _moved_within(stay: StayRecord, target: StayKey, origin: Origin) -> StayRecord:
    """Return the stay under its new key; where it was moved from is renamed likewise."""
    came = stay.moved_from
    if came is not None:
        place = origin.get((stay.object_id, came[0]))
        came = None if place is None or place == target else (place[1], came[1])
    return replace(stay, object_id=target[0], place=target[1], moved_from=came)


def one_stay(a: StayRecord, b: StayRecord) -> StayRecord:
    """Return two stays at one place as one, with the key of the first."""
    first, last = min(a.first_ms, b.first_ms), max(a.last_ms, b.last_ms)
    absent = max((a.last_absent_ms, b.last_absent_ms), key=lambda ms: -1 if ms is None else ms)
    return replace(
        a,
        position=_mean(a.position, a.weight, b.position, b.weight),
        covariance=_mean(a.covariance, a.weight, b.covariance, b.weight),
        first_ms=first,
        last_ms=last,
        weight=a.weight + b.weight,
        seen=a.seen + b.seen,
        moved_from=a.moved_from or b.moved_from,
        last_absent_ms=absent if absent is not None and absent > last else None,
        volatile=a.volatile or b.volatile,
    )


def _mean(a: _Numbers | None, weight_a: float, b: _Numbers | None, weight_b: float) -> Any:
    if a is None or b is None:
        return b if a is None else a
    total = weight_a + weight_b
    share = weight_a / total if total > 0 else 0.5
    return tuple(x * share + y * (1 - share) for x, y in zip(a, b, strict=True))


def votes_of(*records: ObjectRecord) -> dict[str, float]:
    """Return the weight that each category has of an object, or of several together."""
    votes: dict[str, float] = {}
    for record in records:
        for category, weight in record.categories or ((record.category, record.weight),):
            votes[category] = votes.get(category, 0.0) + weight
    return votes


def ranked(votes: Mapping[str, float]) -> tuple[tuple[str, float], ...]:
    """Return votes as a record keeps them: the heaviest first."""
    return tuple(sorted(votes.items(), key=lambda vote: (-vote[1], vote[0])))


def heaviest(votes: Mapping[str, float], before: str) -> str:
    """Return the category with most weight; where it is one of those, what it was before."""
    return before if votes.get(before, 0.0) >= max(votes.values()) else ranked(votes)[0][0]


def mean_look(looks: Sequence[tuple[NDArray[np.float32], float]]) -> NDArray[np.float32] | None:
    """Return the weighted mean of looks at unit length, None for no look."""
    if not looks:
        return None
    mean = sum((look * np.float32(weight) for look, weight in looks), np.zeros_like(looks[0][0]))
    length = float(np.linalg.norm(mean))
    return np.asarray(mean / np.float32(length) if length > 0 else looks[0][0], dtype=np.float32)


def _one_object(a: ObjectRecord, b: ObjectRecord) -> ObjectRecord:
    votes = votes_of(a, b)
    looks = [(r.embedding, r.weight) for r in (a, b) if r.embedding is not None]
    return replace(
        a,
        category=heaviest(votes, a.category),
        weight=a.weight + b.weight,
        first_ms=min(a.first_ms, b.first_ms),
        last_ms=max(a.last_ms, b.last_ms),
        categories=ranked(votes),
        names=tuple(dict.fromkeys([*a.names, *b.names])),
        embedding=mean_look(looks),
        embedding_model=a.embedding_model or b.embedding_model,
        extent_m=_mean(a.extent_m, a.weight, b.extent_m, b.weight),
        tentative=False,  # a person has confirmed it
        volatile=a.volatile or b.volatile,
    )


def _told_move(
    stays: Mapping[StayKey, StayRecord],
    origin: Origin,
    mine: Iterable[StayRecord],
    theirs: Iterable[StayRecord],
) -> dict[StayKey, StayRecord]:
    """Link the two by a move where one was last seen before the other was seen first."""

    def ends(those: Iterable[StayRecord]) -> tuple[StayRecord, StayRecord] | None:
        ordered = sorted(those, key=lambda s: (s.last_ms, s.place))
        return (min(ordered, key=lambda s: (s.first_ms, s.place)), ordered[-1]) if ordered else None

    a, b = ends(mine), ends(theirs)
    if a is None or b is None:
        return {}
    for (_, left), (came, _) in ((a, b), (b, a)):
        was, at = origin[left.key], origin[came.key]
        if left.last_ms < came.first_ms and was != at and stays[at].moved_from is None:
            return {at: replace(stays[at], moved_from=(was[1], SURE))}
    return {}
