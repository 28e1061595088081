"""Questions over the whole memory: what moved, what is missing, where a thing usually is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from d3a.answering import columns
from d3a.answering.bounded import READ_A_KEYFRAME, worth_of
from d3a.answering.departures import Left, Looks, share_left
from d3a.answering.many import asked_rooms, note_elsewhere, place_stays, spans_asked
from d3a.answering.moments import Found, Moment, changes_of_place, entry_of, joined, single
from d3a.answering.run import Run, milliseconds
from d3a.answering.steps import KeepMissing, KeepMoved, KeepOften, KeepUsual
from d3a.store.base import Sighting, SightingKey, Spans, StayKey, StayRecord

Ints = NDArray[np.int64]
LEAST_STAY_MS = 1_000
"""A look in passing still says that the thing was there: it counts as this long."""
MOST_MOVES = 500
"""Changes of place that are told apart at most, the newest."""
COIN = 0.5
"""How sure it is that one thing was at two stays of an object that nothing links."""
LEAST_LEFT = 0.5
"""A thing went missing in a slice where that is more likely than not."""


@dataclass(frozen=True, slots=True)
class Slice:
    """A half-open slice in milliseconds, open ends None."""

    start_ms: int | None = None
    end_ms: int | None = None

    @classmethod
    def of(cls, step: KeepMissing | KeepMoved | KeepOften | KeepUsual) -> Self:
        """Return the slice of a step."""
        return cls(milliseconds(step.start), milliseconds(step.end))

    def holds(self, moment_ms: int) -> bool:
        """Whether a moment falls into the slice."""
        return (self.start_ms is None or moment_ms >= self.start_ms) and (
            self.end_ms is None or moment_ms < self.end_ms
        )


def by_object(sightings: Sequence[Sighting]) -> dict[str, list[Sighting]]:
    """Return the sightings of each object, by start, objects by id."""
    out: dict[str, list[Sighting]] = {}
    for sighting in sorted(sightings, key=lambda s: (s.object_id, s.start_ms, s.place)):
        out.setdefault(sighting.object_id, []).append(sighting)
    return out


def moved(run: Run, step: KeepMoved) -> list[Moment]:
    """Return the first sighting after each change of place within the slice.

    The association links an object's stays and says how sure it is (`moved_from`): a change is as
    sure as the links between its two stays; without any it has the chance of a coin. What was last
    seen before the slice may have
    moved before it: as likely as the time unseen lies outside.
    Of an asked room or relation: what came into it or left it, or moved within.
    """
    found, when = run.found[step.var], Slice.of(step)
    if step.var in run.spans:
        pairs = _newest_moves(run, step, when)
        run.came_from = {(after.stay, after.start_ms): before for before, after in pairs}
        return [_move(found, when, *pair) for pair in pairs]
    everywhere = run.before_place.get(step.var) or run.before_relation.get(step.var)
    out: list[Moment] = []
    inside = {s.stay for s in found.sightings}
    for sightings in by_object(found.sightings if everywhere is None else everywhere).values():
        for before, after in changes_of_place(sightings):
            if when.holds(after.start_ms) and not inside.isdisjoint((before.stay, after.stay)):
                out.append(_move(found, when, before, after))
                run.came_from[after.stay, after.start_ms] = before
    return out


def _move(found: Found, when: Slice, before: Sighting, after: Sighting) -> Moment:
    """Return the moment of a change of place, with how sure it is."""
    share = _share_within(when, before.end_ms, after.start_ms)
    place = max(found.place.get(s.stay, 1.0) for s in (before, after))
    held = max(found.held.get(s.stay, 1.0) for s in (before, after))
    entry = entry_of(found, after)._replace(place=place, held=held)
    sure = max(0.0, min(1.0, _of_one_thing(found, before.stay, after.stay)))
    within = None if share == 1.0 else share
    return Moment((entry,), after.start_ms, after.end_ms, relation=sure, share=within)


def _of_one_thing(found: Found, before: StayKey, after: StayKey) -> float:
    """Return how sure it is that one thing was at two stays of an object, by the links.

    What goes back and forth is linked but once: of a place that it came back to the links that
    first led to both tell.
    """
    led = dict(_ancestors(found, before))
    shared = (sure * led[place] for place, sure in _ancestors(found, after) if place in led)
    return next(shared, COIN)


def _ancestors(found: Found, key: StayKey) -> Iterator[tuple[int, float]]:
    """Yield the places that a stay was linked to, with how sure all links to it are; first it."""
    (name, place), sure, passed = key, 1.0, set[int]()
    while place not in passed:
        yield place, sure
        passed.add(place)
        stay = found.stays.get((name, place))
        if stay is None or stay.moved_from is None:
            return
        place, sure = stay.moved_from[0], sure * stay.moved_from[1]


def _newest_moves(run: Run, step: KeepMoved, when: Slice) -> list[tuple[Sighting, Sighting]]:
    """Return the newest changes of place within the slice, of too many to be read all."""
    found, spans = run.found[step.var], run.spans.pop(step.var)
    begins = columns.lasts(columns.parts(spans), [-spans.start_ms])
    begins = begins[np.lexsort((spans.place[begins], spans.start_ms[begins], spans.of[begins]))]
    every, spans = spans, spans.chosen(begins)
    changed = (np.diff(spans.of) == 0) & (np.diff(spans.place) != 0)
    after = np.flatnonzero(changed) + 1
    after = after[[when.holds(ms) for ms in spans.start_ms[after].tolist()]]
    if asked_rooms(run, step.var) is not None:
        inside = set(spans_asked(run, step.var).stays())
        stays = spans.stays()
        after = after[[not inside.isdisjoint(stays[row - 1 : row + 1]) for row in after.tolist()]]
    run.counted = len(np.unique(spans.of[after]))
    newest = after[np.argsort(-spans.start_ms[after], kind="stable")][:MOST_MOVES]
    run.cut = run.cut or len(newest) < len(after)
    rows = columns.whole(every, begins[np.concatenate([newest - 1, newest])])
    if not len(after):  # then it is told what was seen of them
        every = spans_asked(run, step.var)
        rows = np.arange(len(every))
    found.sightings = joined(run.store.sightings_at(every.chosen(rows).which()))
    found.stays = run.facts.stays_of(found.sightings)
    place_stays(run, step.var)
    starting = by_object(found.sightings)
    pairs = zip(spans.chosen(newest - 1).which(), spans.chosen(newest).which(), strict=True)
    return [(_holding(starting, before), _holding(starting, later)) for before, later in pairs]


def _holding(sightings: Mapping[str, Sequence[Sighting]], key: SightingKey) -> Sighting:
    """Return the sighting of an object that another was joined to; by object, by start."""
    name, place, start_ms = key
    there = [s for s in sightings[name] if s.place == place and s.start_ms <= start_ms]
    return there[-1]


def _share_within(when: Slice, start_ms: int, end_ms: int) -> float:
    """Return which share of an interval that ends in a slice lies in it."""
    if when.start_ms is None or start_ms >= when.start_ms:
        return 1.0
    return (end_ms - when.start_ms) / (end_ms - start_ms)


def missing(run: Run, step: KeepMissing) -> list[Moment]:
    """Return the last sighting of each object whose place was seen without it, in the slice.

    An object that was seen anywhere after that look is not missing. Nor may it be where another
    of its category turned up since it was seen last: a moved thing may have got a new id.
    In the slice means gone since it began and before it ended, not that it was gone then too: see
    `share_left`, which is asked where the last sighting or the look without it lies outside.
    """
    found, when = run.found[step.var], Slice.of(step)
    gone = left_places(run, step.var)
    settled = {
        one.stay.key for one in gone if when.holds(one.last_ms) and when.holds(one.absent_ms)
    }
    unsure = [one for one in gone if one.stay.key not in settled]
    shares = dict.fromkeys(settled, 1.0)
    if unsure:
        first, last = min(one.stay.first_ms for one in unsure), max(one.absent_ms for one in unsure)
        looks = Looks(run.store.views(start_ms=first, end_ms=last))
        start = first if when.start_ms is None else when.start_ms
        end = last + 1 if when.end_ms is None else when.end_ms
        for one in unsure:
            chance = run.parameters.detect_chance
            shares[one.stay.key] = share_left(one, looks, chance, start, end)
    out: list[Moment] = []
    for one in gone:
        share = shares[one.stay.key]
        if share >= LEAST_LEFT:
            moment = single(found, max(one.sightings, key=lambda s: (s.end_ms, s.start_ms)))
            out.append(moment if one.stay.key in settled else moment._replace(relation=share))
    return out


def left_places(run: Run, var: str) -> list[Left]:
    """Return what was last seen at a place that was then seen without it, by object."""
    found = run.found[var]
    if var in run.newest_alone or var in run.spans:
        return _many_left(run, var)
    objects = by_object(found.sightings)
    last = [max(sightings, key=lambda s: (s.end_ms, s.start_ms)) for sightings in objects.values()]
    first = {name: sightings[0].start_ms for name, sightings in objects.items()}
    return [
        Left([s for s in objects[last.object_id] if s.stay == last.stay], stay, absent)
        for last, stay, absent in _gone(found, last, first)
    ]


def _gone(
    found: Found, last: Sequence[Sighting], first_ms: Mapping[str, int]
) -> list[tuple[Sighting, StayRecord, int]]:
    """Return the last sightings of things whose places were seen without them later, and when.

    first_ms: when things were seen first: where one of its category was so later, it may be that.
    """
    newest: dict[str, int] = {}
    for name, start_ms in first_ms.items():
        category = found.candidates[name].record.category
        newest[category] = max(newest.get(category, 0), start_ms)
    out: list[tuple[Sighting, StayRecord, int]] = []
    for sighting in last:
        stay = found.stays.get(sighting.stay)
        absent = stay.last_absent_ms if stay is not None else None
        kind = found.candidates[sighting.object_id].record.category
        known = stay is not None and absent is not None and absent > sighting.end_ms
        if known and newest.get(kind, 0) <= sighting.end_ms:
            assert stay is not None
            assert absent is not None
            out.append((sighting, stay, absent))
    return out


def _many_left(run: Run, var: str) -> list[Left]:
    """Return what left its place, where too much was seen to read it all."""
    found, spans = run.found[var], run.spans.pop(var, None)
    if spans is None:  # each object's newest sighting was found
        likely = {s.object_id for s, *_ in _gone(found, found.sightings, {})}
        kinds = {found.candidates[name].record.category for name in likely}
        ids = [name for name in found.ids if found.candidates[name].record.category in kinds]
        first = {s.object_id: s.start_ms for s in run.store.edges(ids, "first")}
        newest = found.sightings
    else:
        rows = columns.lasts(spans.of, [spans.end_ms, spans.start_ms])
        newest = run.store.sightings_at(spans.chosen(rows).which())
        found.sightings, found.stays = newest, run.facts.stays_of(newest)
        place_stays(run, var)
        of, begins = np.unique(spans.of, return_index=True)
        starts = spans.start_ms[begins].tolist()
        first = {spans.ids[n]: start for n, start in zip(of.tolist(), starts, strict=True)}
    gone = _gone(found, newest, first)
    there: dict[StayKey, list[Sighting]] = {last.stay: [] for last, *_ in gone}
    every = run.store.spans([last.object_id for last, *_ in gone])
    keys = [key for key in every.which() if key[:2] in there]
    for sighting in joined(run.store.sightings_at(keys)):
        there[sighting.stay].append(sighting)
    return [Left(there[last.stay], stay, absent) for last, stay, absent in gone]


def usual(run: Run, step: KeepUsual) -> list[Moment]:
    """Return the newest sighting of each stay with its share of the object's time, see `_shares`.

    What others of its category, never seen in one round with it, were seen counts as its time
    too: they may be the same thing at another place. Whether it is usually at a place asks for the
    share of all the time that it was anywhere.
    """
    found, when = run.found[step.var], Slice.of(step)
    many = step.var in run.spans
    spans, there = _anywhere(run, step.var)
    spans = held_by(when, spans)
    stay = columns.stay_of(spans)
    newest = columns.lasts(stay, [spans.start_ms])
    if there is not None:
        newest = newest[[key in there for key in spans.chosen(newest).stays()]]
    once, told = columns.joined(spans), stay[newest]
    most = READ_A_KEYFRAME * run.limit
    share = _shares(found, once, columns.stay_of(once), when, told, most)[told]
    if many and not len(newest):
        note_elsewhere(run, step.var)
    elif many:
        run.counted = len(np.unique(spans.of[newest]))
        newest, share = read_best(run, step.var, spans, newest, share)
    return shared(found, spans, newest, share)


def held_by(when: Slice, spans: Spans) -> Spans:
    """Return of the sightings those that start or end in a slice."""
    ends = zip(*(each.tolist() for each in columns.occasions(spans)), strict=True)
    held = np.array([when.holds(start) or when.holds(end) for start, end in ends], dtype=np.bool_)
    return spans.chosen(held[columns.parts(spans)])


def read_best(
    run: Run, var: str, spans: Spans, rows: NDArray[np.intp], share: NDArray[np.float64]
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Find of these rows what is told, the greatest shares of the likeliest; return them so."""
    found = run.found[var]
    worth = np.array([worth_of(found.candidates[name]) for name in spans.ids])
    best = np.argsort(-share * worth[spans.of[rows]], kind="stable")
    best = best[: READ_A_KEYFRAME * run.limit]
    run.cut = run.cut or len(best) < len(rows)
    which = spans.chosen(columns.whole(spans, rows[best])).which()
    found.sightings = joined(run.store.sightings_at(which))
    found.stays = run.facts.stays_of(found.sightings)
    place_stays(run, var)
    return rows[best], share[best]


def shared(
    found: Found, spans: Spans, rows: NDArray[np.intp], share: NDArray[np.float64]
) -> list[Moment]:
    """Return the found sightings that these rows are of, each with its share."""
    starting = by_object(found.sightings)
    told = zip(spans.chosen(rows).which(), share.tolist(), strict=True)
    return [single(found, _holding(starting, key))._replace(share=part) for key, part in told]


def _anywhere(run: Run, var: str) -> tuple[Spans, set[StayKey] | None]:
    """Return when the objects of a variable were seen, and where of that is asked; None: all.

    Whether something is usually somewhere is judged by all the time that it was seen anywhere.
    """
    found, whether = run.found[var], run.query.ask == "whether"
    many = run.spans.pop(var, None)
    if many is not None:
        placed = whether and asked_rooms(run, var) is not None
        return (run.facts.spans(found.ids, None, None), {*many.stays()}) if placed else (many, None)
    anywhere = run.before_place.get(var) or run.before_relation.get(var)
    if anywhere is None or not whether:
        return Spans.of_sightings(found.ids, found.sightings), None
    return Spans.of_sightings(found.ids, anywhere), {s.stay for s in found.sightings}


def _shares(
    found: Found,
    spans: Spans,
    stay: Ints,
    when: Slice,
    asked: Ints,
    most: int,
) -> NDArray[np.float64]:
    """Return the share of its object's time that each stay has (stays,), in their order.

    How long a robot looked at a thing says little of how long it lay there. So each moment from
    the first sighting of a thing to the last counts for the sighting that is nearest to it in
    time: of the thing, or of what may be it, which takes its share with it.
    asked: the numbers of the stays that are told. Where there are more objects than `most`, those
    that were seen there most often are told, and the share of others is left at 0.
    """
    number = int(stay.max(initial=-1)) + 1
    often = np.bincount(stay, minlength=number)
    worth = np.array([worth_of(found.candidates[name]) for name in spans.ids])
    of = np.zeros(number, dtype=np.int64)
    of[stay] = spans.of
    best = np.zeros(len(spans.ids))
    np.maximum.at(best, of[asked], often[asked] * worth[of[asked]])
    looked_at = np.argsort(-best, kind="stable")[:most]
    share = np.zeros(number)
    for one, rows in _that_may_be(found, spans, looked_at.tolist()):
        mine = spans.of[rows] == one
        among = _stood_ms(spans.start_ms[rows], spans.end_ms[rows], when)
        part = np.bincount(stay[rows[mine]], among[mine], minlength=number)
        share += part / among.sum()
    return share


def _that_may_be(
    found: Found, spans: Spans, wanted: Sequence[int]
) -> Iterator[tuple[int, NDArray[np.intp]]]:
    """Yield of each wanted object, by number, the rows of it and of what may be it, by start."""
    kinds: dict[str, list[int]] = {}
    for number, name in enumerate(spans.ids):
        kinds.setdefault(found.candidates[name].record.category, []).append(number)
    for numbers in kinds.values():
        chosen = sorted({*numbers} & {*wanted})
        if not chosen:
            continue
        place = np.full(len(spans.ids), -1, dtype=np.int64)
        place[numbers] = np.arange(len(numbers))
        rows = np.flatnonzero(place[spans.of] >= 0)
        rows = rows[np.argsort(spans.start_ms[rows], kind="stable")]
        of = place[spans.of[rows]]
        met = columns.met(of, spans.start_ms[rows], spans.end_ms[rows], len(numbers))
        for number in chosen:
            own = int(place[number])
            if (of == own).any():
                yield number, rows[~met[own][of] | (of == own)]


def _stood_ms(start_ms: Ints, end_ms: Ints, when: Slice) -> NDArray[np.float64]:
    """Return how much of the time in a slice is nearest to each sighting (n,), by start."""
    reached = np.maximum.accumulate(np.maximum(end_ms, start_ms + LEAST_STAY_MS))
    before = np.append(start_ms[:1], reached[:-1])
    begin = (np.maximum(start_ms, before) + before) / 2
    end = np.append(begin[1:], reached[-1:])
    low = -np.inf if when.start_ms is None else when.start_ms
    high = np.inf if when.end_ms is None else when.end_ms
    return np.asarray(np.maximum(np.clip(end, low, high) - np.clip(begin, low, high), 1.0))
