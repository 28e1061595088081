"""Taking back that two objects are one, when the robot has seen more of them since.

Nothing that was forgotten meanwhile comes back, and nothing that was seen is lost. Which of the
two a new view is of follows from its place (see `same_thing`); what the views since say of looks
cannot be told apart any more, so each has its look from before, and later views refine it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import reduce

from d3a.correcting.portion import Portion, joined_sightings, relabelled, rename_encounters
from d3a.correcting.same_thing import Origin, heaviest, mean_look, one_stay, ranked, votes_of
from d3a.parameters import Parameters
from d3a.store.base import Encounter, ObjectRecord, Sighting, StayKey, StayRecord


def unmerged(before: Portion, after: Portion, now: Portion, origin: Origin) -> Portion:
    """Return the two objects of `before`, with what was seen since they were made one.

    before, after: as `merged` took and gave them. now: the portion of today.
    """
    if now.same_as(after):
        return before
    kept = next(iter(after.objects))
    if kept not in now.objects:
        return now
    parts = _Parts(before, after, now, origin, kept)
    stays, sightings = parts.stays_and_sightings()
    encounters = parts.encounters(stays)
    objects = parts.objects(stays)
    found = Portion.of(objects, stays.values(), sightings, encounters)
    return Portion(  # an object of which nothing is left stays away
        found.objects,
        {k: r for k, r in found.stays.items() if k[0] in found.objects},
        {k: r for k, r in found.sightings.items() if k[0] in found.objects},
        found.encounters,
    )


class _Parts:
    """One taking back: by the stays of today, whose each is."""

    def __init__(
        self, before: Portion, after: Portion, now: Portion, origin: Origin, kept: str
    ) -> None:
        self._before, self._after, self._now = before, after, now
        self._kept = kept
        self._sources: dict[StayKey, list[StayKey]] = {}
        for source in sorted(origin, key=lambda key: (key[0] != kept, key)):
            self._sources.setdefault(origin[source], []).append(source)
        self._origin = origin

    def _home(self, stay: StayKey) -> StayKey:
        """Return whose a stay of today is: of two that were at one place, that of the kept id."""
        return self._sources.get(stay, [stay])[0]

    def stays_and_sightings(self) -> tuple[dict[StayKey, StayRecord], list[Sighting]]:
        stays: dict[StayKey, StayRecord] = {}
        sightings: list[Sighting] = []
        for stay in self._now.of_object(self._kept):
            sources = self._sources.get(stay.key, [stay.key])
            if len(sources) == 1:
                stays[sources[0]] = self._returned(stay, sources[0])
                sightings += [relabelled(s, sources[0]) for s in self._now.at(stay.key)]
            else:
                seen = self._parted(stay.key)
                sightings += seen
                stays |= self._parted_stays(stay, sources, seen)
        return stays, sightings

    def _returned(self, stay: StayRecord, source: StayKey) -> StayRecord:
        old, was = self._before.stays.get(source), self._after.stays.get(stay.key)
        if old is None or was is None:
            return stay
        came = old.moved_from if stay.moved_from == was.moved_from else stay.moved_from
        tentative = old.tentative and stay.seen == was.seen
        same = replace(stay, object_id=source[0], place=source[1], moved_from=came)
        return replace(same, tentative=tentative)

    def _parted(self, stay: StayKey) -> list[Sighting]:
        """Return the sightings of a stay that two were joined in, each with its own again."""
        known = {s.start_ms: s for s in self._after.at(stay)}
        old = [s for source in self._sources[stay] for s in self._before.at(source)]
        parts: dict[tuple[StayKey, int], Sighting] = {}
        for seen in self._now.at(stay):
            was = known.get(seen.start_ms)
            own = [] if was is None else [s for s in old if _overlap(s, was)]
            if was is None or not own:
                fresh = relabelled(seen, self._home(stay))
                parts.setdefault((fresh.stay, fresh.start_ms), fresh)
                continue
            last = max(own, key=lambda s: (s.end_ms, s.object_id == self._kept))
            for each in own:
                grown = _grown(each, was, seen) if each is last else each
                parts[each.stay, each.start_ms] = grown
        return [parts[key] for key in sorted(parts)]

    def _parted_stays(
        self, stay: StayRecord, sources: Sequence[StayKey], seen: Sequence[Sighting]
    ) -> dict[StayKey, StayRecord]:
        was = self._after.stays[stay.key]
        more = max(stay.seen - was.seen, 0)
        result = {}
        for source in sources:
            old = self._before.stays[source]
            own = [s for s in seen if s.stay == source]
            if not own and self._before.at(source):
                continue  # all of it was forgotten
            extra = sum(s.seen for s in own) - sum(s.seen for s in self._before.at(source))
            share = extra / more if more > 0 else 0.0
            last = max([old.last_ms, *(s.end_ms for s in own)])
            absent = stay.last_absent_ms
            result[source] = replace(
                old,
                last_ms=last,
                seen=old.seen + extra,
                weight=max(old.weight + (stay.weight - was.weight) * share, 0.0),
                last_absent_ms=absent if absent is not None and absent > last else None,
                tentative=old.tentative and extra <= 0,
            )
        return result

    def encounters(self, stays: Iterable[StayKey]) -> list[Encounter]:
        """Return today's encounters by whose they are, and those that the two had themselves."""
        known, joined = set(stays), {k for k, each in self._sources.items() if len(each) > 1}
        homes = {stay: self._home(stay) for stay in self._now.stays}
        fresh, kept = [], []
        for key, each in self._now.encounters.items():
            ends = {(key[0], key[2]), (key[1], key[3])}
            if not ends & joined or key not in self._after.encounters:
                fresh.append(each)
            else:
                kept.append(self._grown_encounter(key, each))
        result = list(rename_encounters(fresh, homes).values())
        for parts in kept:
            result += parts
        own = [e for e in self._before.encounters.values() if e.renamed(self._origin) is None]
        result += [e for e in own if {(e.object_a, e.place_a), (e.object_b, e.place_b)} <= known]
        there = {(e.object_a, e.place_a) for e in result} | {
            (e.object_b, e.place_b) for e in result
        }
        gone = {stay for stay in there if stay[0] in self._before.objects} - known
        ends_of = [({(e.object_a, e.place_a), (e.object_b, e.place_b)}, e) for e in result]
        return [each for ends, each in ends_of if not ends & gone]

    def _grown_encounter(
        self, key: tuple[str, str, int, int, int], today: Encounter
    ) -> list[Encounter]:
        """Return what an encounter at a joined stay was made of; the last one has its growth."""
        was = self._after.encounters[key]
        parts = [
            e
            for e in self._before.encounters.values()
            if (r := e.renamed(self._origin)) is not None
            and (r.object_a, r.object_b, r.place_a, r.place_b, r.start_ms) == key
        ]
        last = max(parts, key=lambda e: (e.end_ms, e.object_a, e.object_b))
        if today == was:
            return parts
        grown = replace(last, end_ms=today.end_ms, seen=last.seen + today.seen - was.seen)
        return [grown if each is last else each for each in parts]

    def objects(self, stays: dict[StayKey, StayRecord]) -> list[ObjectRecord]:
        """Return both objects, what was added since shared out by the growth of their stays."""
        today, was = self._now.objects[self._kept], self._after.objects[self._kept]
        growth = {name: self._growth(name, stays) for name in sorted(self._before.objects)}
        total = sum(growth.values())
        added = [n for n in today.names if n not in was.names]
        lost = [n for n in was.names if n not in today.names]
        result = []
        for name, old in sorted(self._before.objects.items()):
            own = [s for key, s in stays.items() if key[0] == name]
            if not own and any(key[0] == name for key in self._before.stays):
                continue  # all of it was forgotten
            share = growth[name] / total if total > 0 else float(name == self._kept)
            votes = votes_of(old)
            more, base = votes_of(today), votes_of(was)
            for category in sorted(more.keys() | base.keys()):
                gain = (more.get(category, 0.0) - base.get(category, 0.0)) * share
                if gain != 0.0:
                    votes[category] = max(votes.get(category, 0.0) + gain, 0.0)
            names = [n for n in old.names if n not in lost]
            votes = votes if share > 0 else votes_of(old)
            result.append(
                replace(
                    old,
                    category=heaviest(votes, old.category),
                    weight=max(old.weight + (today.weight - was.weight) * share, 0.0),
                    categories=ranked(votes) if old.categories else (),
                    first_ms=min([old.first_ms, *(s.first_ms for s in own)]),
                    last_ms=max([old.last_ms, *(s.last_ms for s in own)]),
                    names=(*names, *(added if name == self._kept else [])),
                    tentative=old.tentative and growth[name] <= 0,
                )
            )
        return result

    def _growth(self, name: str, stays: dict[StayKey, StayRecord]) -> float:
        """Return how much weight the stays of an object have now beyond what they had."""
        return sum(
            max(s.weight - (old.weight if (old := self._before.stays.get(key)) else 0.0), 0.0)
            for key, s in stays.items()
            if key[0] == name
        )


def _overlap(one: Sighting, other: Sighting) -> bool:
    return one.start_ms <= other.end_ms and one.end_ms >= other.start_ms


def _grown(part: Sighting, was: Sighting, today: Sighting) -> Sighting:
    """Return the last part of an interval with what was added to the whole since."""
    if today == was:
        return part
    best = today if today.probability > was.probability else part
    return replace(
        best,
        object_id=part.object_id,
        place=part.place,
        start_ms=part.start_ms,
        end_ms=max(part.end_ms, today.end_ms),
        seen=part.seen + max(today.seen - was.seen, 0),
    )


def unsplit(
    before: Portion,
    after: Portion,
    now: Portion,
    key: StayKey,
    parted: str,
    parameters: Parameters,
) -> Portion:
    """Return the one object that was split, with what was seen of both parts since.

    key: the object, and its place of which all or what was seen from a time on became another one;
    parted: the id that this was given.
    """
    kept, place_of_both = key
    if now.same_as(after):
        return before
    if kept not in now.objects or parted not in now.objects:
        return now
    is_shared = key in after.stays  # only what was seen there from a time on was parted
    taken = {stay.place for stay in now.of_object(kept)}
    becomes: dict[StayKey, StayKey] = {}
    for stay in now.of_object(parted):
        place = place_of_both if stay.place == 0 else -1
        if place < 0 or (place in taken and not is_shared):
            place = max(taken, default=-1) + 1
        taken.add(place)
        becomes[stay.key] = (kept, place)
    stays = [_back(stay, becomes.get(stay.key, stay.key), becomes) for stay in now.stays.values()]
    stays = [_came_again(stay, before, after) for stay in stays]
    sightings = [relabelled(s, becomes.get(s.stay, s.stay)) for s in now.sightings.values()]
    if is_shared:
        stays, sightings = _at_one_place(stays, sightings, key, parameters)
    encounters = rename_encounters(now.encounters.values(), becomes)
    one = _rejoined(before.objects[kept], after, now.objects[kept], now.objects[parted])
    return Portion.of([one], stays, sightings, encounters.values())


def _at_one_place(
    stays: list[StayRecord], sightings: list[Sighting], key: StayKey, parameters: Parameters
) -> tuple[list[StayRecord], list[Sighting]]:
    """Return the records with the stays of one key joined, and their sightings, if there are."""
    one = sorted((stay for stay in stays if stay.key == key), key=lambda stay: stay.first_ms)
    there = joined_sightings([s for s in sightings if s.stay == key], key, parameters)
    stays = [stay for stay in stays if stay.key != key]
    sightings = [seen for seen in sightings if seen.stay != key]
    return [*stays, *([reduce(one_stay, one)] if one else [])], [*sightings, *there]


def _back(stay: StayRecord, target: StayKey, becomes: dict[StayKey, StayKey]) -> StayRecord:
    came = stay.moved_from
    if came is not None:
        came = becomes.get((stay.object_id, came[0]), (target[0], came[0]))[1], came[1]
    return replace(stay, object_id=target[0], place=target[1], moved_from=came)


def _came_again(stay: StayRecord, before: Portion, after: Portion) -> StayRecord:
    """Give a stay the move back that the split took from it."""
    old, kept = before.stays.get(stay.key), after.stays.get(stay.key)
    if old is not None and stay.moved_from is None and (kept is None or kept.moved_from is None):
        return replace(stay, moved_from=old.moved_from)
    return stay


def _rejoined(
    old: ObjectRecord, after: Portion, today: ObjectRecord, other: ObjectRecord
) -> ObjectRecord:
    votes = votes_of(today, other)
    looks = [(r.embedding, r.weight) for r in (today, other) if r.embedding is not None]
    grown = today.weight + other.weight > sum(r.weight for r in after.objects.values())
    return replace(
        today,
        category=heaviest(votes, old.category),
        weight=today.weight + other.weight,
        first_ms=min(today.first_ms, other.first_ms),
        last_ms=max(today.last_ms, other.last_ms),
        categories=ranked(votes) if old.categories else (),
        names=tuple(dict.fromkeys([*today.names, *other.names])),
        embedding=mean_look(looks) if grown else old.embedding,
        tentative=old.tentative and today.tentative and other.tentative,
    )
