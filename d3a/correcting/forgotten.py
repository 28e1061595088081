"""What a selection takes out of the records, and what it leaves changed; nothing is written."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, field, replace

from d3a.answering.places import room_of
from d3a.correcting.cutting import Slice, cut_sighting, cut_view, lessened_object, lessened_stay
from d3a.ledger import EncounterKey, Ledger, SightingKey, encounter_key, grouped
from d3a.store.base import (
    Area,
    Encounter,
    ObjectRecord,
    Region,
    Sighting,
    StayKey,
    StayRecord,
    Store,
    View,
)

UNSCRUBBED = "unscrubbed"
"""Key in the store's meta: true while bytes of what was removed may be left in the files."""
Span = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Selection:
    """What to forget; conditions are and-ed, None is no condition.

    object_ids: these things. categories: things and sightings so called, as the store spells
    them. region: what lay in this room, and the robot's views from inside of it. time: [start,
    end); with no other condition also every view.
    """

    object_ids: frozenset[str] | None = None
    categories: frozenset[str] | None = None
    region: Region | None = None
    time: Slice = field(default_factory=Slice)

    @property
    def is_everything(self) -> bool:
        """Whether there is no condition at all."""
        some = (self.object_ids, self.categories, self.region)
        return self.time.is_open and all(condition is None for condition in some)

    @property
    def takes_views(self) -> bool:
        """Whether views go too: of a place or a time, but not of a thing."""
        return self.object_ids is None and self.categories is None


@dataclass(slots=True)
class Removal:
    """What goes (by its key), what is put instead, and the spans in which something was forgotten.

    objects: the records as they were, of all that anything goes of. old_keys: of sightings that
    go or get another start. spans: closed, by stay.
    """

    objects: dict[str, ObjectRecord] = field(default_factory=dict)
    gone_objects: dict[str, ObjectRecord] = field(default_factory=dict)
    gone_stays: dict[StayKey, StayRecord] = field(default_factory=dict)
    gone_sightings: dict[SightingKey, Sighting] = field(default_factory=dict)
    gone_encounters: dict[EncounterKey, Encounter] = field(default_factory=dict)
    gone_views: list[View] = field(default_factory=list)
    changed_objects: dict[str, ObjectRecord] = field(default_factory=dict)
    changed_stays: dict[StayKey, StayRecord] = field(default_factory=dict)
    changed_sightings: dict[SightingKey, Sighting] = field(default_factory=dict)
    new_views: list[View] = field(default_factory=list)
    shortened: list[Sighting] = field(default_factory=list)
    old_keys: set[SightingKey] = field(default_factory=set)
    spans: dict[StayKey, list[Span]] = field(default_factory=dict)

    @property
    def touched(self) -> list[str]:
        """The ids of objects that lose an interval or a part of one."""
        return sorted({key[0] for key in self.spans})

    def reaches(self, stay: StayKey, start_ms: int, end_ms: int) -> bool:
        """Whether something of a stay was forgotten in a closed span."""
        return any(start <= end_ms and end >= start_ms for start, end in self.spans.get(stay, ()))

    def vanished_categories(self, store: Store, merged: Collection[str]) -> frozenset[str]:
        """Return the categories of which nothing is left once this is gone.

        merged: ids that are in the store, and will not be when its memory is flushed.
        """
        known = self.objects.keys() | set(merged)
        of_gone = {c for r in self.objects.values() for c in (r.category, *dict(r.categories))}
        left = {c for r in self.changed_objects.values() for c in (r.category, *dict(r.categories))}
        vanished = set()
        for category in of_gone - left:
            having = store.objects(categories=[category], votes=True, embeddings=False)
            if all(r.object_id in known for r in having):
                vanished.add(category)
        return frozenset(vanished)


def removal_of(ledger: Ledger, store: Store, selection: Selection) -> Removal:
    """Find the records that a selection takes; `ledger` reads like the store without a memory."""
    removal = Removal()
    ids = sorted(_candidates(ledger, store, selection))
    stays: dict[str, list[StayRecord]] = {object_id: [] for object_id in ids}
    for stay in ledger.stays(object_ids=ids):
        stays[stay.object_id].append(stay)
    sightings = grouped(ledger.sightings(ids))
    for record in ledger.objects(ids=ids):
        _take(removal, record, stays[record.object_id], sightings, selection)
    _take_encounters(removal, ledger, selection)
    if selection.takes_views:
        _take_views(removal, store, selection)
    return removal


def _candidates(ledger: Ledger, store: Store, selection: Selection) -> set[str]:
    """Return the objects that may lose something."""
    written = ledger.batch_fields()
    if selection.object_ids is not None:
        return set(selection.object_ids)
    if selection.categories is not None:
        names = sorted(selection.categories)
        found = store.objects(categories=names, votes=True, embeddings=False)
        ids = {record.object_id for record in (*found, *written["objects"])}
        return ids | {r.object_id for r in written["sightings"]}
    if selection.region is not None:
        return {stay.object_id for stay in ledger.stays(area=_box(selection.region))}
    time = selection.time
    last = None if time.end_ms is None else time.end_ms - 1
    ids = {s.object_id for s in ledger.sightings(None, time.start_ms, last)}
    if time.start_ms is not None:  # its absence may have been seen in the slice
        absent = ((s.object_id, s.last_absent_ms) for s in ledger.stays())
        ids |= {name for name, at in absent if at is not None and time.holds(at)}
    return ids


def _box(region: Region) -> Area:
    xs, ys = zip(*region.polygon, strict=True)
    return Area(min(xs), min(ys), max(xs), max(ys))


def _take(
    removal: Removal,
    record: ObjectRecord,
    stays: list[StayRecord],
    sightings: dict[StayKey, list[Sighting]],
    selection: Selection,
) -> None:
    """Take what is chosen of one object."""
    left: dict[StayKey, list[Sighting]] = {}
    for stay in stays:
        seen = sightings.get(stay.key, [])
        chosen = _is_chosen(stay, selection)
        starts = {sighting.start_ms for sighting in seen}
        kept = [_cut(removal, s, selection, record, starts) for s in seen] if chosen else seen
        left[stay.key] = [sighting for sighting in kept if sighting is not None]
        if chosen and not left[stay.key] and (seen or selection.time.is_open):
            removal.gone_stays[stay.key] = stay
            removal.spans.setdefault(stay.key, []).append((stay.first_ms, stay.last_ms))
    unsought = {stay.key for stay in stays if _lost_absence(stay, record, selection)}
    if not any(stay.key in removal.spans or stay.key in unsought for stay in stays):
        plain = _without_votes(record, selection)
        if plain != record:
            removal.objects[record.object_id] = record
            removal.changed_objects[record.object_id] = plain
        return
    removal.objects[record.object_id] = record
    after = _lessened(removal, stays, left, selection, unsought)
    if after:
        lessened = lessened_object(record, stays, after)
        removal.changed_objects[record.object_id] = _without_votes(lessened, selection)
    else:
        removal.gone_objects[record.object_id] = record


def _lessened(
    removal: Removal,
    stays: list[StayRecord],
    left: dict[StayKey, list[Sighting]],
    selection: Selection,
    unsought: set[StayKey],
) -> list[StayRecord]:
    """Return the stays that are left of an object, and note those that are changed."""
    gone = [key[1] for key in removal.gone_stays if key[0] == stays[0].object_id]
    after = []
    for stay in stays:
        if stay.key in removal.gone_stays:
            continue
        chosen = stay.key in removal.spans or stay.key in unsought
        came_from_gone = stay.moved_from is not None and stay.moved_from[0] in gone
        if left[stay.key] and (chosen or came_from_gone):
            time = selection.time if chosen else Slice()
            stay = lessened_stay(stay, left[stay.key], time, gone)
            removal.changed_stays[stay.key] = stay
        elif stay.key in unsought:
            stay = replace(stay, last_absent_ms=None)
            removal.changed_stays[stay.key] = stay
        after.append(stay)
    return after


def _is_chosen(stay: StayRecord, selection: Selection) -> bool:
    region = selection.region
    return region is None or room_of([region], stay.position, stay.site) is not None


def _lost_absence(stay: StayRecord, record: ObjectRecord, selection: Selection) -> bool:
    """Whether the slice takes that the thing was looked for in vain at a chosen stay."""
    names = selection.categories
    if (names is not None and record.category not in names) or not _is_chosen(stay, selection):
        return False
    return stay.last_absent_ms is not None and selection.time.cuts(stay.last_absent_ms)


def _cut(
    removal: Removal,
    sighting: Sighting,
    selection: Selection,
    record: ObjectRecord,
    starts: set[int],
) -> Sighting | None:
    """Return what is left of a sighting at a chosen stay, and note what went.

    starts: of the stay's sightings; what would begin with another one goes altogether.
    """
    names = selection.categories
    if names is not None and not {record.category, sighting.category} & names:
        return sighting
    time = selection.time
    if not time.touches(sighting.start_ms, sighting.end_ms):
        return sighting
    key = (*sighting.stay, sighting.start_ms)
    spans = removal.spans.setdefault(sighting.stay, [])
    left = cut_sighting(sighting, time)
    removal.old_keys.add(key)
    if left is not None and left.start_ms != sighting.start_ms:
        left = None if left.start_ms in starts else left
        starts.update(() if left is None else (left.start_ms,))
    if left is None:
        removal.gone_sightings[key] = sighting
        spans.append((sighting.start_ms, sighting.end_ms))
        return None
    removal.shortened.append(sighting)
    removal.changed_sightings[*left.stay, left.start_ms] = left
    if left.start_ms > sighting.start_ms:
        spans.append((sighting.start_ms, left.start_ms - 1))
    if left.end_ms < sighting.end_ms:
        spans.append((left.end_ms + 1, sighting.end_ms))
    return left


def _without_votes(record: ObjectRecord, selection: Selection) -> ObjectRecord:
    """Take the chosen words out of an object that was also called so."""
    names = selection.categories
    if names is None or not selection.time.is_open or selection.region is not None:
        return record
    votes = tuple(vote for vote in record.categories if vote[0] not in names)
    return replace(record, categories=votes)


def _take_encounters(removal: Removal, ledger: Ledger, selection: Selection) -> None:
    """Take the encounters of what is forgotten, where they reach into what is forgotten of it."""
    found: list[Encounter] = []
    touched: Iterable[str] = removal.touched
    if selection.object_ids is None and not selection.time.is_open:
        time = selection.time
        last = None if time.end_ms is None else time.end_ms - 1
        found = ledger.encounters(None, time.start_ms, last)
        touched = sorted({key[0] for key in removal.gone_stays})  # what is left of those goes too
    found += [e for object_id in touched for e in ledger.encounters(object_id)]
    for each in found:
        ends = ((each.object_a, each.place_a), (each.object_b, each.place_b))
        gone = any(end in removal.gone_stays for end in ends)
        if gone or any(removal.reaches(end, each.start_ms, each.end_ms) for end in ends):
            removal.gone_encounters[encounter_key(each)] = each


def _take_views(removal: Removal, store: Store, selection: Selection) -> None:
    """Take the views of a time, or those from inside of a place."""
    time, region = selection.time, selection.region
    last = None if time.end_ms is None else time.end_ms - 1
    for view in store.views(start_ms=time.start_ms, end_ms=last):
        if region is None or _is_inside(view, region):
            removal.gone_views.append(view)
            removal.new_views += cut_view(view, time)


def _is_inside(view: View, region: Region) -> bool:
    known = view.x is not None and view.y is not None
    return known and room_of([region], (view.x or 0.0, view.y or 0.0, 0.0), view.site) is not None
