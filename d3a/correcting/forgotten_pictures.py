"""Which pictures go with what is forgotten: all that may show it, whoever's proof they are."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace

from d3a.correcting.cutting import Slice
from d3a.correcting.forgotten import Removal, Span
from d3a.correcting.forgotten_history import Said
from d3a.emptied import Emptied
from d3a.ledger import EncounterKey, Ledger, SightingKey, encounter_key
from d3a.store.base import Encounter, Sighting, Store

_WINDOW_MS = 86_400_000


@dataclass(slots=True)
class Pictures:
    """The pictures that go, and the records that stay without theirs.

    also_shown: those of `gone` that a record which stays had as its proof.
    """

    gone: set[str] = field(default_factory=set)
    also_shown: set[str] = field(default_factory=set)
    sightings: dict[SightingKey, Sighting] = field(default_factory=dict)
    encounters: dict[EncounterKey, Encounter] = field(default_factory=dict)


def pictures_of(
    memory: Emptied, store: Store, removal: Removal, said: Said, time: Slice
) -> Pictures:
    """Return the pictures that go with a removal.

    A picture goes when what is forgotten was found in it: it is the keyframe of a sighting or an
    encounter that goes, or that of another thing at a moment when both were seen in one frame
    (where the store keeps encounters; else at a moment when the forgotten thing was seen at all).
    """
    if not removal.spans and not memory.was_open:
        return Pictures()
    moments, pictures = _Moments(store), Pictures()
    for sighting in (*removal.gone_sightings.values(), *removal.shortened):
        moments.note(sighting)
    named_by_gone = _images(removal)
    pictures.gone |= {image for image in named_by_gone if time.holds(moments.of(image))}
    spans = _shared_spans(removal, keeps_encounters=bool(store.counts()["encounters"]))
    for record in _kept(memory.ledger, removal, *_range(removal)):
        if isinstance(record, Sighting):
            moments.note(record)
        at = -1 if record.image is None else moments.of(record.image)
        near = any(_within(at, spans.get(name, ())) for name in _things(record))
        if record.image is not None and near and time.holds(at):
            pictures.gone.add(record.image)
    asked = named_by_gone or pictures.gone or memory.was_open or said.meta
    named = _unlink(pictures, memory.ledger, removal) if asked else set()
    waited = set(store.keyframe_keys()) if memory.was_open else named_by_gone
    undoable = _undoable(moments, removal, said, time)
    waited |= said.lost_pictures | (said.kept_pictures - undoable)
    pictures.gone |= waited - named - undoable  # only what is forgotten referred to them
    pictures.gone &= set(store.keyframe_keys())
    return pictures


def _undoable(moments: _Moments, removal: Removal, said: Said, time: Slice) -> set[str]:
    """Return the pictures that an undo still needs, and that do not show what is forgotten."""
    spans = [span for each in removal.spans.values() for span in each]
    return {
        image
        for image in said.kept_pictures
        if not (time.holds(moments.of(image)) and _within(moments.of(image), spans))
    }


class _Moments:
    """When pictures were taken: as a sighting says, else as the stored picture does."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._known: dict[str, int] = {}

    def note(self, record: Sighting) -> None:
        if record.image is not None and record.keyframe_ms is not None:
            self._known[record.image] = record.keyframe_ms

    def of(self, image: str) -> int:
        if image not in self._known:
            picture = self._store.keyframe(image)
            self._known[image] = -1 if picture is None else picture.time_ms
        return self._known[image]


def _range(removal: Removal) -> tuple[int | None, int | None]:
    """Return the time in which something goes; none of it for no span at all."""
    spans = [span for each in removal.spans.values() for span in each]
    spans += [(each.start_ms, each.end_ms) for each in removal.gone_encounters.values()]
    return min((s for s, _ in spans), default=0), max((e for _, e in spans), default=-1)


def _kept(
    ledger: Ledger, removal: Removal, start_ms: int | None, end_ms: int | None
) -> Iterator[Sighting | Encounter]:
    """Yield the sightings and encounters that stay and touch a span, a day at a time."""
    gone = removal.gone_sightings.keys() | removal.old_keys
    begun = start_ms  # what starts before a later window was in the one before
    for start, end in _days(ledger, start_ms, end_ms):
        for sighting in ledger.sightings(None, start, end):
            fresh = start == begun or start is None or sighting.start_ms >= start
            if fresh and (*sighting.stay, sighting.start_ms) not in gone:
                yield sighting
        for met in ledger.encounters(None, start, end):
            fresh = start == begun or start is None or met.start_ms >= start
            if fresh and encounter_key(met) not in removal.gone_encounters:
                yield met
    yield from removal.changed_sightings.values()


def _days(
    ledger: Ledger, start_ms: int | None, end_ms: int | None
) -> Iterator[tuple[int | None, int | None]]:
    """Yield windows that make up a span: not all that a store holds fits in memory."""
    earliest, latest = ledger.span()
    at, last = start_ms, latest if end_ms is None else min(end_ms, latest)
    until = (earliest if at is None else max(at, earliest)) + _WINDOW_MS
    while until <= last:
        yield at, until - 1
        at, until = until, until + _WINDOW_MS
    yield at, end_ms


def _images(removal: Removal) -> set[str]:
    """Return the pictures that what goes names."""
    images = {record.image for record in removal.gone_sightings.values()}
    images |= {record.image for record in removal.gone_encounters.values()}
    return {image for image in images if image is not None}


def _shared_spans(removal: Removal, *, keeps_encounters: bool) -> dict[str, list[Span]]:
    """Return, by object, the spans in which it may share a frame with what is forgotten.

    The key "" stands for every object: a store of the paper's profile keeps no encounters.
    """
    spans: dict[str, list[Span]] = {}
    for each in removal.gone_encounters.values():
        for name in (each.object_a, each.object_b):
            spans.setdefault(name, []).append((each.start_ms, each.end_ms))
    if not keeps_encounters:
        spans[""] = [span for each in removal.spans.values() for span in each]
    return spans


def _things(record: Sighting | Encounter) -> tuple[str, ...]:
    """Return the keys of `_shared_spans` that a record may fall to."""
    if isinstance(record, Sighting):
        return record.object_id, ""
    return record.object_a, record.object_b, ""


def _within(time_ms: int, spans: Iterable[Span]) -> bool:
    return any(start <= time_ms <= end for start, end in spans)


def _unlink(pictures: Pictures, ledger: Ledger, removal: Removal) -> set[str]:
    """Let what stays no longer name a picture that goes; return the pictures that it names."""
    named = set()
    for record in _kept(ledger, removal, None, None):
        if record.image is None:
            continue
        if record.image not in pictures.gone:
            named.add(record.image)
            continue
        pictures.also_shown.add(record.image)
        if isinstance(record, Sighting):
            key = (*record.stay, record.start_ms)
            pictures.sightings[key] = replace(record, image=None)
        else:
            pictures.encounters[encounter_key(record)] = replace(record, image=None)
    return named
