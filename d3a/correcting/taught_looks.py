"""A thing that no detector knows, taught by a box on a picture: found again by its colours.

How it is found is told in `look_search`. Finds are ordinary records of OIc and STc, at the place of
the nearest thing that the detector knew in the same picture, and tentative but for the one that the
person drew. The look is kept with the correction: pictures that come later are searched for it too,
until it is undone, or something of the thing is forgotten.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from d3a.answer import BY_LOOK, is_by_look
from d3a.constraints import Correction, History, look_key
from d3a.correcting.committing import commit
from d3a.correcting.look_search import Find, Look, Searched, search
from d3a.model import BadInput, Box, Position
from d3a.store.base import (
    Batch,
    Expected,
    ObjectRecord,
    Sighting,
    StayRecord,
    Store,
    TaughtName,
)

SAME_PLACE_M = 1.0
NEAR_SIGMA_M = 0.7
"""Per axis: how far a thing may be from the nearest one that was placed in its picture."""
AT_ONCE = 16
"""Pictures that are searched before what was found in them is written."""


def teach_look(
    store: Store, image: str, box: Box, name: str, owner: str | None = None,
    *, at_ms: int | None = None, heard: str | None = None,
) -> Correction:  # fmt: skip
    """Call what is in a box of a stored picture by a name, and find its look in the others.

    image: key of a keyframe; box: pixels of the original frame. heard: as the name was said.
    `arguments["found"]` of the result
    counts the pictures with it, `arguments["new"]` is its id. `teaching.undo` takes all of it back.
    Raises UnknownThing for a picture that is not there, BadInput for a box without a look of its
    own, StoreError.
    """
    word = " ".join(name.split()).lower()
    if not word:
        raise BadInput("a name needs a letter or a digit")
    searched = {each.name: each.last_ms for each in store.recordings()}
    look, finds = search(store, image, box)
    scene = _Scene(store, store.sightings(), store.stays())

    def make(number: int) -> tuple[Correction, dict[str, Any]]:
        taught = TaughtName(word, owner)
        blank = ObjectRecord(f"{BY_LOOK}{number}", word, 0.0, 0, 0, names=(taught,))
        new, stays, sightings = _with_finds(blank, [], finds, scene)
        whose = "" if owner is None else "my " if owner == "me" else f"{owner}'s "
        said = f"{new.object_id}, shown by a box, is {whose or 'the '}{word}"
        key = look_key(number)
        arguments = {"ids": [new.object_id], "new": new.object_id, "found": len(finds), "look": key}
        arguments["heard"] = heard
        correction = Correction(number, "look", said, at_ms, arguments)
        meta = {key: {**look.to_json(), "searched": searched}}
        fields = {"objects": [new], "stays": stays, "sightings": sightings, "meta": meta}
        return correction, fields

    return commit(store, make)


@dataclass(slots=True)
class _Wanted:
    """A look that is searched for: its object's id, its key in the meta, since when."""

    object_id: str
    key: str
    look: Look
    since_ms: int


def search_later(
    store: Store, recording: str, until_ms: int, fence: int, at_most: int | None = None
) -> int:
    """Search the pictures of a recording that came after looks were taught; count the finds.

    Of the pictures of sightings that ended by until_ms, those that were not searched yet, in the
    order of these ends; at_most: about so many of them now. fence: of the ingest's lease.
    """
    wanted = _wanted(store, recording)
    since_ms = min((each.since_ms for each in wanted), default=until_ms)
    if since_ms >= until_ms:
        return 0
    ended = [
        each
        for each in store.sightings(start_ms=since_ms + 1, end_ms=until_ms)
        if each.recording == recording and each.image and not is_by_look(each.object_id)
        if since_ms < each.end_ms <= until_ms
    ]
    ends: dict[str, int] = {}
    for each in sorted(ended, key=lambda each: each.end_ms):
        ends[str(each.image)] = each.end_ms
    due = sorted((end_ms, image) for image, end_ms in ends.items())
    if at_most is not None and len(due) > at_most:
        until_ms = due[at_most - 1][0]
        due = [each for each in due if each[0] <= until_ms]
    scene = _Scene(store, ended, store.stays(object_ids=sorted({s.object_id for s in ended})))
    found = 0
    for at in range(0, max(len(due), 1), AT_ONCE):
        part, is_last = due[at : at + AT_ONCE], at + AT_ONCE >= len(due)
        finds = _finds(store, part, wanted)
        # others may have ended at the very moment of a part's last one
        searched_ms = until_ms if is_last else part[-1][0] - 1
        found += _put_later(store, wanted, finds, scene, (recording, searched_ms), fence)
    return found


def _finds(
    store: Store, due: Sequence[tuple[int, str]], wanted: Sequence[_Wanted]
) -> dict[str, list[Find]]:
    """Return where each look is in some pictures, by the look's key."""
    finds: dict[str, list[Find]] = {each.key: [] for each in wanted}
    for end_ms, image in due:
        picture = store.keyframe(image)
        if picture is None:  # cleaned away
            continue
        searched = Searched(picture)
        for each in wanted:
            find = searched.find(each.look) if end_ms > each.since_ms else None
            if find is not None:
                finds[each.key].append(find)
    return finds


def _put_later(
    store: Store,
    wanted: Sequence[_Wanted],
    finds: dict[str, list[Find]],
    scene: _Scene,
    searched: tuple[str, int],
    fence: int,
) -> int:
    """Write finds, and up to when a recording was searched; not of a look that was undone."""
    objects, stays, sightings = list[ObjectRecord](), list[StayRecord](), list[Sighting]()
    meta: dict[str, Any] = {}
    with store.turn():
        for each in wanted:
            record, known = store.meta(each.key), store.objects(ids=[each.object_id])
            if record is None or not known:
                continue
            times = record["searched"]
            meta[each.key] = record | {
                "searched": times | {searched[0]: max(searched[1], times.get(searched[0]) or 0)}
            }
            had = {s.image for s in store.sightings(object_ids=[each.object_id])}
            fresh = [find for find in finds[each.key] if find.image not in had]
            if fresh:
                places = store.stays(object_ids=[each.object_id])
                grown, changed, added = _with_finds(known[0], places, fresh, scene)
                objects.append(grown)
                stays += changed
                sightings += added
        batch = Batch(objects=objects, stays=stays, sightings=sightings, meta=meta)
        store.apply(replace(batch, expects=Expected(fence=fence)))
    return len(sightings)


def _wanted(store: Store, recording: str) -> list[_Wanted]:
    """Return the looks that people taught and that still hold."""
    found = []
    for each in History.read(store).entries:
        key = str(each.arguments.get("look"))
        record = store.meta(key) if each.kind == "look" else None
        if record is not None:
            since_ms = record["searched"].get(recording) or 0
            found.append(_Wanted(each.arguments["new"], key, Look.of_json(record), since_ms))
    return found


class _Scene:
    """What else is known of pictures: when they were taken, what is where in them."""

    def __init__(
        self, store: Store, sightings: Iterable[Sighting], stays: Iterable[StayRecord]
    ) -> None:
        self._store = store
        self._seen: dict[str, list[Sighting]] = {}
        for sighting in sightings:
            if sighting.image is not None and not is_by_look(sighting.object_id):
                self._seen.setdefault(sighting.image, []).append(sighting)
        self._stays = {stay.key: stay for stay in stays}

    def sighting(self, find: Find, key: tuple[str, int]) -> Sighting:
        """Return a find as a sighting of a stay, with the words of its picture."""
        picture = self._store.keyframe(find.image)
        beside = self._seen.get(find.image, [])
        time_ms = picture.time_ms if picture else 0
        base = beside[0] if beside else None
        return Sighting(
            *key, time_ms, time_ms,
            frame=base.frame if base else find.image,
            probability=find.likeness, box=find.box, image=find.image,
            recording=base.recording if base else "",
            keyframe_ms=time_ms, viewer=base.viewer if base else None,
        )  # fmt: skip

    def position(self, find: Find) -> tuple[Position | None, str]:
        """Return where the nearest thing in the picture is, and the site; None where none has."""
        near: list[tuple[float, StayRecord]] = []
        for other in self._seen.get(find.image, []):
            stay = self._stays.get(other.stay)
            if stay is not None and stay.position is not None:
                near.append((_apart(find.box, other.box), stay))
        if not near:
            return None, ""
        stay = min(near, key=lambda each: (each[0], each[1].key))[1]
        return stay.position, stay.site


def _apart(a: Box, b: Box) -> float:
    """Return the pixels between the middles of two boxes' lower edges: where things stand."""
    return math.hypot((a[0] + a[2] - b[0] - b[2]) / 2, a[3] - b[3])


def _with_finds(
    record: ObjectRecord, known: Sequence[StayRecord], finds: Sequence[Find], scene: _Scene
) -> tuple[ObjectRecord, list[StayRecord], list[Sighting]]:
    """Return an object with finds, its stays with them, and a sighting for each.

    record: with a weight of 0 the first find is what the person drew.
    """
    stays = {stay.place: stay for stay in known}
    sightings: dict[tuple[int, int], Sighting] = {}
    for find in finds:
        position, site = scene.position(find)
        near = (s.place for s in stays.values() if _is_near(s.position, position))
        place = next(near, max(stays, default=-1) + 1)
        sighting = scene.sighting(find, (record.object_id, place))
        at = sighting.start_ms
        old = stays.get(place) or _new_stay(
            (record.object_id, place), position, at, site, tentative=bool(stays)
        )
        stays[place] = replace(
            old, first_ms=min(old.first_ms, at), last_ms=max(old.last_ms, at),
            weight=old.weight + find.likeness, seen=old.seen + 1,
        )  # fmt: skip
        sightings.setdefault((place, at), replace(sighting, category=record.category))
    weight = record.weight + sum(find.likeness for find in finds)
    grown = replace(
        record,
        weight=weight,
        first_ms=min(s.first_ms for s in stays.values()),
        last_ms=max(s.last_ms for s in stays.values()),
        site=record.site if known else stays[0].site,
        categories=((record.category, weight),),
    )
    return grown, list(stays.values()), list(sightings.values())


def _new_stay(
    key: tuple[str, int], position: Position | None, at_ms: int, site: str, *, tentative: bool
) -> StayRecord:
    """Return a stay that nothing was seen at yet."""
    spread = NEAR_SIGMA_M**2
    covariance = (spread, 0.0, 0.0, 0.0, spread, 0.0, 0.0, 0.0, spread)
    return StayRecord(
        *key, position, at_ms, at_ms, 0.0, site, seen=0,
        covariance=None if position is None else covariance, tentative=tentative,
    )  # fmt: skip


def _is_near(a: Position | None, b: Position | None) -> bool:
    if a is None or b is None:
        return a is b
    return math.dist(a, b) <= SAME_PLACE_M
