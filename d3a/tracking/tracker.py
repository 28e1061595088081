"""The `default` profile: the same three tiers, by likelihood instead of gates.

Tier 1 names each thing of a frame once; tier 2 assigns them one-to-one to the things in memory;
tier 3 keeps the memory bounded, links moves and lets tentative things expire. A thing seen once is
kept as tentative, and confirmed by its second sighting ever, however much later.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from d3a.checkpoint import Arrays
from d3a.constraints import Constraints
from d3a.correcting.reconcile import Corrected
from d3a.ledger import Ledger
from d3a.model import Detection, Json
from d3a.parameters import Parameters
from d3a.sightings import Became, Event, FrameRef, Interval, Scene, entry_name, seen_as
from d3a.store.base import StayKey, TaughtName
from d3a.symmetric import added, minus
from d3a.tier1 import Thing, things
from d3a.tier3 import Stored
from d3a.tracking.absence import Absence, Judged
from d3a.tracking.depths import Doubts
from d3a.tracking.encounters import Encounters
from d3a.tracking.frame_offset import FrameOffset
from d3a.tracking.known import Known, Place, goes_on
from d3a.tracking.likelihood import CategoryModel
from d3a.tracking.linking import apply_link
from d3a.tracking.matching import Matcher
from d3a.tracking.memory import Memory
from d3a.tracking.merging import Evidence, merge, never_together
from d3a.tracking.moves import Moves
from d3a.tracking.observed import Observed
from d3a.tracking.positions import Row
from d3a.tracking.recall import FIRST_NUMBER, Recall, is_histogram
from d3a.tracking.singles import Singles

NOTHING_SEEN = np.empty((0, 3)), np.empty((0, 6))
"""The places of a frame without detections, and their noise."""
EXPIRED = "never seen again where it should have been"


class TrackerPipeline:
    """Tier 1 to 3 of the default profile over a ledger."""

    def __init__(
        self, ledger: Ledger, stored: Stored, parameters: Parameters, outside: int
    ) -> None:
        self._parameters = parameters
        self._ledger = ledger
        self._is_histogram = is_histogram(stored.embedding_model)
        self._memory = Memory()
        self._categories = CategoryModel(parameters)
        self._matcher = Matcher(self._memory, self._categories, parameters, self._is_histogram)
        looks, space = self._matcher.looks, self._matcher.space
        self._absence = Absence(self._memory, parameters)
        self._moves = Moves(self._memory, space, looks, self._absence, parameters)
        neighbours = self._matcher.neighbours
        self._evidence = Evidence(
            self._memory, space, looks, self._categories, neighbours, parameters
        )
        self._recall = Recall(self._memory, ledger, stored, parameters, outside)
        self._doubts = Doubts(parameters)
        self._encounters = Encounters(parameters)
        self._singles = Singles()
        self._next_number = FIRST_NUMBER
        self._fixed: frozenset[str] = frozenset()
        self._doubtful: set[int] = set()
        """Numbers of things in memory that may be no things; asked before they are told so."""
        self._events: list[Event] = []
        self._now_ms = 0

    def observe(self, scene: Scene) -> None:
        """Take a frame through the tiers."""
        self._now_ms = scene.ref.time_ms
        if self._absence.is_due(self._now_ms):
            self._judge()
        self._matcher.offset.predict(scene.ref.time_ms, scene.pose)
        found = things(scene.detections, self._parameters)
        observed = Observed.of(found, self._is_histogram) if found else None
        self._fetch(observed, scene)
        seen = [] if observed is None else self._recognise(scene, found, observed)
        self._absence.watch(scene, seen, self._matcher.offset)
        self._absence.forget(self._recall.evict())

    def _recognise(
        self, scene: Scene, found: list[Thing], observed: Observed
    ) -> list[tuple[Known, Place]]:
        """Return what each thing of a frame is, and where; take in all that its views tell."""
        boxes = [thing.detection.box for thing in found]
        said = self._doubts.judge(scene, observed.places.T, boxes)
        matches = self._matcher.match(observed, scene.ref.time_ms, scene.pose)
        seen: list[tuple[Known, Place]] = []
        moved: list[tuple[int, Place]] = []
        for i, match in enumerate(matches):
            if match is None:
                thing, place = self._born(scene.ref)
            else:
                thing, place = match.thing, match.place or match.thing.latest
                if not match.in_range:
                    found[i] = found[i].unplaced()
                    observed.spots[i] = None
            if match is None:
                thing.places[0].doubt = self._doubts.odds(said[i])
                self._doubtful.add(thing.number)
            elif thing.seen >= self._parameters.confirm_sightings:
                self._doubts.learn(said[i])
            if place.row < 0:
                self._settle(thing, place, observed, i)
            elif match is not None and observed.spots[i] is not None:
                moved.append((i, place))
            self._view(thing, place, found[i], observed, i, scene.ref)
            seen.append((thing, place))
        numbers = {thing.number for thing, _ in seen}
        for thing, _ in seen:
            thing.met |= numbers
        self._matcher.update(observed, moved, scene.pose)
        self._meet(scene.ref, seen, found)
        return seen

    def _fetch(self, observed: Observed | None, scene: Scene) -> None:
        """Bring back what a frame may show; an empty one what a person has changed."""
        shared = 0.0 if scene.pose is None else self._parameters.pose_sigma_m**2
        around = (observed.places.T, observed.noise.T) if observed is not None else NOTHING_SEEN
        back = self._recall.fetch(*around, shared, scene.ref.time_ms)
        self._doubtful.update(thing.number for thing in back if self._is_doubtful(thing))

    def _born(self, ref: FrameRef) -> tuple[Known, Place]:
        thing = Known(self._next_number, {}, ref.time_ms, ref.time_ms)
        self._next_number += 1
        self._singles.born()
        place = Place(0, ref.time_ms, ref.time_ms)
        thing.places.append(place)
        self._memory.add(thing)
        return thing, place

    def _settle(self, thing: Known, place: Place, observed: Observed, i: int) -> None:
        """Give a place its first position, where this frame knows one."""
        where = observed.spots[i]
        if where is not None:
            offset = self._matcher.offset
            mean, error = minus(where, offset.mean), added(observed.errors[i], offset.covariance)
            row = Row.of(mean, where, error, (0.0, 0.0), self._parameters)
            self._memory.positions.add([(thing, place, row)])

    def _view(
        self, thing: Known, place: Place, found: Thing, observed: Observed, i: int, ref: FrameRef
    ) -> None:
        """Count a sighting of a thing: votes, look, size, interval."""
        detection = found.detection
        for category, weight in found.votes:
            thing.vote(category, weight)
            self._categories.add(category, weight)
        if observed.pictured[i]:
            weight = max(detection.probability, 1e-6)
            most = self._parameters.looks_remembered
            self._memory.looks.blend(thing, observed.looks[i], weight, most)
        if detection.extent_m is not None:
            (width, height), (wide, high) = thing.extent_m or (0.0, 0.0), detection.extent_m
            n = thing.extents
            thing.extent_m = (width * n + wide) / (n + 1), (height * n + high) / (n + 1)
            thing.extents = n + 1
        if thing.seen + 1 == self._parameters.confirm_sightings:
            self._singles.seen_again(ref.time_ms - thing.last_ms)
        for each in (thing, place):
            each.weight += detection.probability
            each.seen += 1
            each.last_ms = max(each.last_ms, ref.time_ms)
            each.first_ms = min(each.first_ms, ref.time_ms)
        thing.dirty = True
        self._memory.touch(thing)
        key = (thing.object_id, place.number)
        self._grow(place, ref, detection, key)
        name = entry_name(key)
        self._events += [seen_as(row.row, ref.name, row.box, name) for row in found.rows]

    def _grow(self, place: Place, ref: FrameRef, detection: Detection, key: StayKey) -> None:
        """Extend the open interval, or close it and begin another."""
        old = place.open
        if old is not None and goes_on(place, old, ref.time_ms, self._parameters):
            place.open = old.grown(ref, detection)
            return
        place.open = view = Interval.of(ref, detection)
        if old is None:
            return
        if old.follows_on(view, self._parameters):  # it got too long, and readers join it again
            place.open = replace(view, start_ms=min(old.end_ms + 1, view.end_ms))
        self._ledger.put_sighting(old.sighting(key))

    def _meet(self, ref: FrameRef, seen: list[tuple[Known, Place]], found: list[Thing]) -> None:
        shown = [
            ((thing.object_id, place.number), each.detection)
            for (thing, place), each in zip(seen, found, strict=True)
        ]
        self._encounters.add(ref, shown, self._ledger)

    def end_look(self) -> None:
        """Let the next frame begin a look."""
        self._absence.end_look()

    def _judge(self) -> None:
        """Judge the looks that ended: what was missing, what expires, what was moved."""
        looks = self._absence.judge()
        changed = {thing.number for look in looks for thing in (*look.found, *look.missed)}
        self._expire([*self._merge(looks), *self._doubted()])
        self._link(changed)

    def _merge(self, looks: list[Judged]) -> list[Known]:
        """Make one of what a look did not show and found there; return what is still missed."""
        for thing, each in self._evidence.likely(looks):
            likely = [other for other in each if other.row >= 0]
            if thing.row < 0 or not likely:  # one of the found ones was it
                continue
            self._write_some([thing, *likely])
            same = never_together(thing, likely, self._ledger)
            if same is not None and not self._must_stay(thing, same):
                kept, gone = sorted((thing, same), key=lambda each: each.number)
                self._absence.became(gone.places[0], kept.places[0], kept)
                was, becomes = merge(thing, same, self._memory, self._ledger, self._parameters)
                self._encounters.rename(was, becomes)
                self._events.append(Became(entry_name(was), entry_name(becomes), "the same thing"))
        return [thing for look in looks for thing in look.missed if thing.row >= 0]

    def _doubted(self) -> list[Known]:
        """Return what depth spoke against when it was seen, and nobody saw again for long."""
        closed_ms = self._now_ms - self._parameters.interval_gap_s * 1000
        found = []
        for number in sorted(self._doubtful):
            thing = self._memory.things.get(number)
            if thing is None or not self._is_doubtful(thing):
                self._doubtful.discard(number)
            elif thing.last_ms < closed_ms:
                found.append(thing)
        return found

    def _is_doubtful(self, thing: Known) -> bool:
        """Say whether nobody saw it again, and depth spoke against it."""
        parameters = self._parameters
        is_tentative = thing.seen < parameters.confirm_sightings
        return is_tentative and thing.places[0].doubt >= parameters.doubt_odds

    def _expire(self, missed: list[Known]) -> None:
        """Drop tentative things that were not there in several looks that should show them."""
        over = {thing.object_id: thing for thing in missed if self._is_over(thing)}
        if not over:
            return
        told = self._fixed | self._ledger.named(sorted(over))
        gone = {name: thing for name, thing in over.items() if name not in told and not thing.names}
        self._encounters.forget(gone.keys())
        self._absence.forget(gone.values())
        self._ledger.remove_objects(gone.keys())
        for name, thing in gone.items():
            entry = entry_name((name, thing.places[0].number))
            self._events.append(Became(entry, None, EXPIRED))
            self._memory.remove(thing)

    def _is_over(self, thing: Known) -> bool:
        """Say whether a thing was most likely none."""
        parameters = self._parameters
        if thing.row < 0 or thing.seen >= parameters.confirm_sightings:
            return False
        place = thing.places[0]
        closed_ms = self._now_ms - parameters.interval_gap_s * 1000
        if place.doubt >= parameters.doubt_odds and place.last_ms < closed_ms:
            return True
        least = parameters.expire_odds - self._singles.odds(self._now_ms - thing.last_ms)
        return all(p.evidence + p.doubt >= least for p in thing.places)

    def _link(self, changed: set[int]) -> None:
        for link in self._moves.find(changed, self._now_ms):
            if link.old.row < 0 or self._is_told(link.new):
                continue  # the old one was itself linked just now: the next look tells
            self._write_some([link.new, link.old])
            self._absence.became(link.new.places[0], link.new.places[0], link.old)
            became = apply_link(link, self._memory, self._ledger, self._parameters)
            for was, becomes in became.items():
                self._encounters.rename(was, becomes)
                self._events.append(Became(entry_name(was), entry_name(becomes), "moved"))

    def take_names(self, taught: Mapping[str, tuple[TaughtName, ...]]) -> None:
        """Learn the names of objects, by id: what has a name is not made part of another."""
        for thing in self._recall.things():
            names = taught.get(thing.object_id, ())
            if names != thing.names:
                thing.names = names
                self._memory.touch(thing)

    def take_constraints(self, constraints: Constraints) -> None:
        """Keep what people said from here on."""
        self._fixed = constraints.fixed
        self._matcher.one = frozenset(constraints.one)

    def correct(self, changed: Corrected) -> None:
        """Take in what people changed in the store; all of the memory is written."""
        if not changed.before | changed.after:
            return
        gone = self._recall.refetch(changed.before, changed.after)
        self._encounters.write(self._ledger)
        self._encounters.forget(changed.before | changed.after)
        self._absence.forget(gone)
        for thing in gone:
            self._moves.compared.discard(thing.number)

    def _must_stay(self, one: Known, other: Known) -> bool:
        """Say whether two things may not be made one: names, and what a person told, stay."""
        newer = max(one, other, key=lambda thing: thing.number)
        return self._is_named(one) or self._is_named(other) or self._is_told(newer)

    def _is_told(self, thing: Known) -> bool:
        """Say whether a person told what the thing is: a name, a merge or a split."""
        return thing.object_id in self._fixed or self._is_named(thing)

    def _is_named(self, thing: Known) -> bool:
        """Say whether a thing has a name, also since the last checkpoint."""
        return bool(thing.names) or bool(self._ledger.named([thing.object_id]))

    def write(self) -> None:
        """Put what changed into the ledger, as ordinary records."""
        self._recall.write()
        self._encounters.write(self._ledger)
        self._encounters.prune()

    def _write_some(self, things: list[Known]) -> None:
        """Put all of some things into the ledger, as what is made of them is told there."""
        self._recall.write_some(things)
        self._encounters.write_some({thing.object_id for thing in things}, self._ledger)

    def flush(self) -> None:
        """End a recording: everything is written, the memory is emptied."""
        self.end_look()
        self._judge()
        self.write()
        self._recall.forget_all()
        self._matcher.offset = FrameOffset.unknown(self._parameters)
        self._absence.looked.clear()
        self._encounters = Encounters(self._parameters)

    def take_events(self) -> list[Event]:
        """Return what became of detections and entries since the last call."""
        events, self._events = self._events, []
        return events

    def images(self) -> set[str]:
        """Return the pictures needed beside those of written records: none."""
        return set()

    def to_state(self) -> tuple[Json, Arrays]:
        """Return everything that `restore` needs."""
        record, arrays = self._recall.to_state()
        learned, parts = self._matcher.to_state()
        arrays |= parts
        arrays["doubts"] = self._doubts.counts
        arrays["asked_moves"] = self._moves.asked_rows()
        arrays["doubt"] = np.array(self._categories.doubt)
        looking, parts = self._absence.to_state()
        arrays |= parts
        record |= learned
        record |= {
            "next": self._next_number,
            "now_ms": self._now_ms,
            "singles": [self._singles.once, self._singles.again],
            "categories": dict(self._categories.counts),
            "compared": sorted(self._moves.compared),
            "others": self._moves.others,
            "absence": looking,
            "encounters": self._encounters.to_state(),
        }
        return record, arrays

    def restore(self, record: Json, arrays: Arrays) -> None:
        """Go on where `to_state` was called."""
        self._recall.restore(record, arrays)
        self._matcher.restore(record, arrays)
        self._doubtful = {t.number for t in self._memory.things.values() if self._is_doubtful(t)}
        self._next_number = record["next"]
        self._doubts.counts = np.array(arrays["doubts"])
        self._now_ms = record["now_ms"]
        self._singles.once, self._singles.again = record["singles"]
        others = record.get("others", {})  # stores of earlier releases are forgotten from too
        self._moves.others = {kind: list(counts) for kind, counts in others.items()}
        self._moves.compared = set(record["compared"])
        if "asked_moves" in arrays:  # older checkpoints have none: all is asked once more
            self._moves.restore_asked(arrays["asked_moves"])
        self._categories.doubt = (float(arrays["doubt"][0]), float(arrays["doubt"][1]))
        self._categories.counts.update(record["categories"])
        self._absence.restore(record["absence"], arrays)
        self._encounters.restore(record["encounters"])
