"""A person says that one place of an object is another object's: on a portion of the store.

Of all of time, or from a moment on: what is put where a thing like it stood keeps that one's id.
What the place has of the object's weight and votes is told by its own sightings; what each of the
two looks like is measured anew on the keyframes, where the store holds pictures of both.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from d3a.correcting.cutting import Slice, lessened_stay, share
from d3a.correcting.portion import Portion, relabelled, rename_encounters
from d3a.correcting.same_thing import heaviest, mean_look, ranked, votes_of
from d3a.store.base import Encounter, ObjectRecord, Sighting, StayKey, StayRecord, Store

Look = NDArray[np.float32]
PICTURES_LOOKED_AT = 12
"""So many keyframes of a place, the best, are measured at most."""


def split(
    portion: Portion, key: StayKey, new_id: str, looks: Mapping[str, Look], from_ms: int | None
) -> Portion:
    """Give one place of an object to a new object, as its place 0.

    from_ms: only what was seen there from then on; None: all. looks: embeddings measured for either
    id; an id without one keeps the look of both.
    """
    (object_id, place), target = key, (new_id, 0)
    old = portion.objects[object_id]
    early, late = parted(portion, key, from_ms)
    left, moved = _stays(portion.stays[key], target, early, late, from_ms)
    votes = _votes(late, moved, old)
    kept = {c: max(w - votes.get(c, 0.0), 0.0) for c, w in votes_of(old).items()}
    stays = [_without_move(stay, place) for stay in portion.stays.values() if stay.key != key]
    stays += left
    others = [seen for seen in portion.sightings.values() if seen.stay != key]
    sightings = [*others, *early, *(relabelled(seen, target) for seen in late)]
    rest = [stay for stay in stays if stay.object_id == object_id]
    one = _object(old, object_id, kept, max(old.weight - moved.weight, 0.0), rest, looks)
    two = _object(replace(old, names=()), new_id, votes, moved.weight, [moved], looks)
    before, since = _encounters(portion, key, from_ms)
    encounters = [*before, *rename_encounters(since, {key: target}).values()]
    return Portion.of([one, two], [*stays, moved], sightings, encounters)


def parted(
    portion: Portion, key: StayKey, from_ms: int | None
) -> tuple[list[Sighting], list[Sighting]]:
    """Return a stay's sightings of before a moment, and those from then on; None: all are.

    One that goes on over it is in both. Its picture stays with the part of its time; the other is
    known by the person's word alone, and needs a view of its own to be.
    """
    seen = portion.at(key)
    if from_ms is None:
        return [], seen
    early: list[Sighting] = []
    late: list[Sighting] = []
    for each in seen:
        if each.end_ms < from_ms:
            early.append(each)
        elif each.start_ms >= from_ms:
            late.append(each)
        else:
            first, then = _cut(each, from_ms)
            early += first
            late += then
    return early, late


def _cut(seen: Sighting, from_ms: int) -> tuple[list[Sighting], list[Sighting]]:
    """Return the parts of a sighting before and from a moment within; its views are shared out."""
    parts = (seen.start_ms, from_ms - 1), (from_ms, seen.end_ms)
    shown = int(_keyframe_ms(seen) >= from_ms)
    views = share(seen.seen, parts[shown], (seen.start_ms, seen.end_ms))
    views = min(views, max(seen.seen - 1, 1))
    rest = seen.seen - views
    cut: list[list[Sighting]] = [[], []]
    cut[shown] = [replace(seen, start_ms=parts[shown][0], end_ms=parts[shown][1], seen=views)]
    if rest > 0:
        start_ms, end_ms = parts[1 - shown]
        # no frame's own name, as none of that part is known: so long after the one that is shown
        frame = f"{seen.frame}{(start_ms - _keyframe_ms(seen)) / 1000:+g}s"
        unseen = replace(seen, start_ms=start_ms, end_ms=end_ms, seen=rest, frame=frame)
        cut[1 - shown] = [replace(unseen, image=None, viewer=None, keyframe_ms=None)]
    return cut[0], cut[1]


def _stays(
    stay: StayRecord,
    target: StayKey,
    early: Sequence[Sighting],
    late: Sequence[Sighting],
    from_ms: int | None,
) -> tuple[list[StayRecord], StayRecord]:
    """Return what is left of a stay, nothing where all of it goes, and the new object's."""
    left: list[StayRecord] = []
    moved = stay
    if from_ms is not None:
        was = lessened_stay(stay, early, Slice(start_ms=from_ms), ())
        # another thing stood there from then on: this one did not
        left = [replace(was, last_absent_ms=late[0].start_ms, tentative=False)]
        moved = lessened_stay(stay, late, Slice(end_ms=from_ms), ())
    object_id, place = target
    gone = replace(moved, object_id=object_id, place=place, moved_from=None, tentative=False)
    return left, gone


def _encounters(
    portion: Portion, key: StayKey, from_ms: int | None
) -> tuple[list[Encounter], list[Encounter]]:
    """Return the encounters of before a moment, or of other stays, and a stay's from then on.

    One that goes on over it is the part with its picture, where a sighting tells when that was
    taken: nobody knows else which of the two it shows.
    """
    taken = {seen.frame: _keyframe_ms(seen) for seen in portion.at(key)}
    before: list[Encounter] = []
    since: list[Encounter] = []
    for each in portion.encounters.values():
        ends = (each.object_a, each.place_a), (each.object_b, each.place_b)
        if key not in ends or (from_ms is not None and each.end_ms < from_ms):
            before.append(each)
        elif from_ms is None or each.start_ms >= from_ms:
            since.append(each)
        elif each.frame in taken:
            whole = each.start_ms, each.end_ms
            is_late = taken[each.frame] >= from_ms
            part = (from_ms, each.end_ms) if is_late else (each.start_ms, from_ms - 1)
            seen = share(each.seen, part, whole)
            cut = replace(each, start_ms=part[0], end_ms=part[1], seen=seen)
            (since if is_late else before).append(cut)
    return before, since


def _keyframe_ms(seen: Sighting) -> int:
    return seen.start_ms if seen.keyframe_ms is None else seen.keyframe_ms


def _without_move(stay: StayRecord, place: int) -> StayRecord:
    gone = stay.moved_from is not None and stay.moved_from[0] == place
    return replace(stay, moved_from=None) if gone else stay


def _votes(
    sightings: Iterable[Sighting], stay: StayRecord, record: ObjectRecord
) -> dict[str, float]:
    """Return a stay's weight by what its sightings were called; no more than there is."""
    seen: dict[str, float] = {}
    for sighting in sightings:
        name = sighting.category or record.category
        seen[name] = seen.get(name, 0.0) + sighting.seen
    total = sum(seen.values())
    if total <= 0:
        return {record.category: stay.weight}
    return {name: stay.weight * count / total for name, count in seen.items()}


def _object(
    old: ObjectRecord,
    object_id: str,
    votes: dict[str, float],
    weight: float,
    stays: list[StayRecord],
    looks: Mapping[str, Look],
) -> ObjectRecord:
    held = {c: w for c, w in votes.items() if w > 0} or {old.category: weight}
    return replace(
        old,
        object_id=object_id,
        category=heaviest(held, old.category),
        categories=ranked(held),
        weight=weight,
        first_ms=min(stay.first_ms for stay in stays),
        last_ms=max(stay.last_ms for stay in stays),
        embedding=looks.get(object_id, old.embedding),
        tentative=False,
    )


def measured_looks(
    store: Store, portion: Portion, key: StayKey, new_id: str, from_ms: int | None
) -> dict[str, Look]:
    """Return what `split` gives the new object and the rest look like on their keyframes.

    {} where the object's looks are no histograms, or no picture tells the two apart.
    """
    from d3a.images import HISTOGRAM_MODEL  # OpenCV costs 0.15 s, which only a split need pay

    if portion.objects[key[0]].embedding_model != HISTOGRAM_MODEL:
        return {}
    early, late = parted(portion, key, from_ms)
    rest = [seen for seen in portion.sightings.values() if seen.stay != key]
    looks = {key[0]: _look(store, [*early, *rest]), new_id: _look(store, late)}
    known = {name: look for name, look in looks.items() if look is not None}
    return known if len(known) == len(looks) else {}


def _look(store: Store, seen: list[Sighting]) -> Look | None:
    best = sorted(seen, key=lambda s: (-s.probability, s.start_ms))[:PICTURES_LOOKED_AT]
    found = [(look, s.probability) for s in best if (look := _look_in(store, s)) is not None]
    return mean_look(found)


def _look_in(store: Store, sighting: Sighting) -> Look | None:
    """Return the histogram of the sighting's thing, None without a picture that can be read."""
    from d3a import figure, images
    from d3a.model import BadInput

    keyframe = None if sighting.image is None else store.keyframe(sighting.image)
    if keyframe is None:
        return None
    try:
        pixels = images.decode(keyframe.jpeg)
    except BadInput:  # then the picture tells nothing; the others may
        return None
    scale = pixels.shape[1] / keyframe.width, pixels.shape[0] / keyframe.height
    x1, y1, x2, y2 = sighting.box
    box = (x1 * scale[0], y1 * scale[1], x2 * scale[0], y2 * scale[1])
    return figure.own_histogram(pixels, box)
