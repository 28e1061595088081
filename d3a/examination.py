"""What a store as a whole is: examined on any backend, by reading it, and told of.

`Store.check` knows its own tables or documents; this knows what records must say of each other.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from d3a.checkpoint import unpack
from d3a.correcting.forgotten import UNSCRUBBED
from d3a.model import Json
from d3a.store.base import (
    SCHEMA,
    Batch,
    Sighting,
    StayKey,
    StayRecord,
    Store,
    StoreDamaged,
    StoreError,
)
from d3a.store.errors import DAMAGED_PAGES

_SHOWN = 5


def examine(store: Store) -> list[str]:
    """Return what is wrong with a store, a sentence each: its own check, then the records."""
    found = store.check()
    for what, look in (("records", _records), ("pictures", _pictures), ("the rest", _rest)):
        try:
            found += look(store)
        except StoreDamaged as error:
            found.append(f"{what} cannot all be read: {error.__cause__ or error}")
    return found


def is_beyond(damage: Sequence[str]) -> bool:
    """Say whether `mend` would refuse this damage as a whole: pages of the file are hit."""
    return any(sentence.startswith(DAMAGED_PAGES) for sentence in damage)


def mend(store: Store) -> list[str]:
    """Mend what `examine` finds, where it can be; return a sentence for each change."""
    said = store.repair()
    stays = [stay for _, stay in _outgrown(store, store.sightings())]
    if stays:
        store.apply(Batch(stays=stays))
        said.append(f"widened {len(stays)} stays to the sightings that they have")
    broken = list(_broken_pictures(store))
    if broken:
        store.apply(Batch(removed_keyframes=broken))
        said += [f"removed {len(broken)} pictures that are no JPEG", *store.repair()]
    if store.meta(UNSCRUBBED):
        store.scrub()
        store.apply(Batch(meta={UNSCRUBBED: None}))
        said.append("left no byte of what was forgotten in the files")
    return said


def _sentence(what: str, names: list[str]) -> list[str]:
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return [what.format(", ".join(names[:_SHOWN]) + more)] if names else []


def _records(store: Store) -> list[str]:
    sightings = store.sightings()
    backwards = [_name(s) for s in sightings if s.end_ms < s.start_ms]
    overlapping = [_name(s) for s in _overlapping(sightings)]
    outgrown = [f"{was.object_id} at {was.place}" for was, _ in _outgrown(store, sightings)]
    return [
        *_sentence("sighting of {} ends before it starts", backwards),
        *_sentence("sighting of {} begins before the one before it has ended", overlapping),
        *_sentence("stay {} does not span its sightings", outgrown),
    ]


def _name(sighting: Sighting) -> str:
    return f"{sighting.object_id} at {sighting.place} from {sighting.start_ms}"


def _overlapping(sightings: Sequence[Sighting]) -> Iterator[Sighting]:
    """Yield the sightings of a stay that are not in order: one thing is seen once at a time.

    In each recording, that is: two of one hour may both show it.
    """
    last: dict[tuple[StayKey, str], Sighting] = {}
    for sighting in sightings:
        before = last.get((sighting.stay, sighting.recording))
        if before is not None and sighting.start_ms <= before.end_ms:
            yield sighting
        last[sighting.stay, sighting.recording] = sighting


def _outgrown(store: Store, sightings: Sequence[Sighting]) -> list[tuple[StayRecord, StayRecord]]:
    """Return the stays that do not span their sightings, as they are and as they should be."""
    spans: dict[StayKey, tuple[int, int]] = {}
    for s in sightings:
        first, last = spans.get(s.stay, (s.start_ms, s.end_ms))
        spans[s.stay] = min(first, s.start_ms), max(last, s.end_ms)
    found = []
    for stay in store.stays():
        first, last = spans.get(stay.key, (stay.first_ms, stay.last_ms))
        if first < stay.first_ms or last > stay.last_ms:
            wider = min(first, stay.first_ms), max(last, stay.last_ms)
            found.append((stay, replace(stay, first_ms=wider[0], last_ms=wider[1])))
    return found


def _broken_pictures(store: Store) -> Iterator[str]:
    for key in store.keyframe_keys():
        picture = store.keyframe(key)
        if picture is not None and not _is_jpeg(picture.jpeg):
            yield key


def _is_jpeg(content: bytes) -> bool:
    """Whether the bytes begin and end as a JPEG does."""
    return content.startswith(b"\xff\xd8") and content.rstrip(b"\0").endswith(b"\xff\xd9")


def _pictures(store: Store) -> list[str]:
    return _sentence("picture {} is no whole JPEG", list(_broken_pictures(store)))


def _rest(store: Store) -> Iterator[str]:
    """Yield what is wrong with the checkpoint, the zone, and what was forgotten."""
    try:
        state = store.state()
        record = None if state is None else unpack(state)[0]
    except (StoreError, ValueError) as error:
        yield f"the checkpoint cannot be read: {error}"
    else:
        known = {recording.key for recording in store.recordings()}
        if record is not None and record["recording"] not in {None, *known}:
            yield f"the checkpoint is of {record['recording']!r}, a recording that is not stored"
    zone = store.meta("zone")
    if zone is not None:
        try:
            ZoneInfo(str(zone))
        except (ZoneInfoNotFoundError, ValueError):
            yield f"the home's time zone {zone!r} is not known"
    if store.meta(UNSCRUBBED):
        yield "something was forgotten, and bytes of it may be left in the files: scrub the store"


def facts_of(store: Store) -> Json:
    """Return what a store is and holds, as one record."""
    profile, model = store.meta("profile"), store.meta("embedding_model")
    retention = store.meta("retention")
    first = store.sightings(limit=1)
    return {
        "address": store.uri,
        "schema": SCHEMA,
        "holds": store.counts(),
        "zone": store.meta("zone"),
        "profile": profile,
        "embedding": model,
        "retain_seconds": retention["seconds"] if isinstance(retention, dict) else None,
        "forgotten": bool(store.meta("forgotten")),
        "first_ms": first[0].start_ms if first else None,
        "last_ms": store.last_view_ms(),
        "categories": dict(store.categories()),
        "recordings": [
            {"name": r.name, "site": r.site, "frames": r.frames, "done": r.done}
            for r in store.recordings()
        ],
    }
