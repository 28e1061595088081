"""A person says that one place of an object is another object's: on a portion of the store.

What the place has of the object's weight and votes is told by its own sightings; what each of the
two looks like is measured anew on the keyframes, where the store holds pictures of both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from d3a.correcting.portion import Portion, relabelled, rename_encounters
from d3a.correcting.same_thing import heaviest, mean_look, ranked, votes_of
from d3a.store.base import ObjectRecord, Sighting, StayKey, StayRecord, Store

Look = NDArray[np.float32]
PICTURES_LOOKED_AT = 12
"""So many keyframes of a place, the best, are measured at most."""


def split(
    portion: Portion, object_id: str, place: int, new_id: str, looks: Mapping[str, Look]
) -> Portion:
    """Give one place of an object to a new object, as its place 0.

    looks: embeddings measured for either id; an id without one keeps the look of both.
    """
    old = portion.objects[object_id]
    key, target = (object_id, place), (new_id, 0)
    parted = portion.stays[key]
    votes = _votes_at(portion, key, parted, old)
    left = {c: max(w - votes.get(c, 0.0), 0.0) for c, w in votes_of(old).items()}
    stays = [_without_move(stay, place) for stay in portion.stays.values() if stay.key != key]
    moved = replace(parted, object_id=new_id, place=0, moved_from=None, tentative=False)
    sightings = [
        relabelled(s, target if s.stay == key else s.stay) for s in portion.sightings.values()
    ]
    rest = [stay for stay in stays if stay.object_id == object_id]
    one = _object(old, object_id, left, max(old.weight - parted.weight, 0.0), rest, looks)
    two = _object(replace(old, names=()), new_id, votes, parted.weight, [moved], looks)
    encounters = rename_encounters(portion.encounters.values(), {key: target})
    return Portion.of([one, two], [*stays, moved], sightings, encounters.values())


def _without_move(stay: StayRecord, place: int) -> StayRecord:
    gone = stay.moved_from is not None and stay.moved_from[0] == place
    return replace(stay, moved_from=None) if gone else stay


def _votes_at(
    portion: Portion, key: StayKey, stay: StayRecord, record: ObjectRecord
) -> dict[str, float]:
    """Return the stay's weight by what its sightings were called; no more than there is."""
    seen: dict[str, float] = {}
    for sighting in portion.at(key):
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
    store: Store, portion: Portion, object_id: str, place: int, new_id: str
) -> dict[str, Look]:
    """Return what the place and the rest look like on their keyframes, where both have some.

    {} where the object's looks are no histograms, or no picture tells them apart.
    """
    from d3a.images import HISTOGRAM_MODEL  # OpenCV costs 0.15 s, which only a split need pay

    if portion.objects[object_id].embedding_model != HISTOGRAM_MODEL:
        return {}
    parts: dict[str, list[Sighting]] = {object_id: [], new_id: []}
    for sighting in portion.sightings.values():
        parts[new_id if sighting.stay == (object_id, place) else object_id].append(sighting)
    looks = {name: _look(store, seen) for name, seen in parts.items()}
    known = {name: look for name, look in looks.items() if look is not None}
    return known if len(known) == len(parts) else {}


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
