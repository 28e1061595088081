"""Corrections as operations on portions of the store: done, done again on newer records, undone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime, timedelta, tzinfo
from typing import Any

from d3a.constraints import Correction
from d3a.correcting.portion import Portion, difference
from d3a.correcting.rooms import region_of
from d3a.correcting.same_thing import Origin, doubts, merged, shared_frame, votes_of
from d3a.correcting.taken_back import unmerged, unsplit
from d3a.correcting.two_things import Look, parted, split
from d3a.model import BadInput, Json
from d3a.parameters import PROFILES, Parameters
from d3a.store.base import StayRecord, Store, TaughtName


class UnknownThing(BadInput):
    """An id, place or name that the store does not have; suggestions: the nearest that it has."""

    def __init__(self, message: str, suggestions: tuple[str, ...] = ()) -> None:
        super().__init__(message)
        self.suggestions = suggestions


def parameters_of(store: Store) -> Parameters:
    """Return the numbers by which the store was filled."""
    recorded = store.meta("parameters") or {}
    known = {name: value for name, value in recorded.items() if hasattr(Parameters(), name)}
    base = PROFILES.get(str(known.get("profile")), Parameters())
    return base.with_changes(**known)


def do_merge(
    portion: Portion, correction: Correction, parameters: Parameters, *, force: bool
) -> Correction:
    """Return the correction carried out on a portion: two objects made one.

    Raises UnknownThing for an id that is not in the portion, BadInput for two that are one already,
    that an ingest is still putting together, or (without `force`) that one frame shows both of.
    """
    kept, gone = correction.arguments["kept"], correction.arguments["gone"]
    if kept == gone:
        raise BadInput(f"{kept} and {gone} are one object already")
    for object_id in (kept, gone):
        _settled(portion, object_id)
    both = None if force else shared_frame(portion, kept, gone)
    if both is not None:
        raise BadInput(
            f"frame {both.frame} shows both {kept} and {gone}, so they are two things; "
            "force it where the detector drew two boxes around one thing"
        )
    after, origin = merged(portion, kept, gone, parameters)
    called = {name for each in portion.objects.values() for name in votes_of(each)}
    arguments = correction.arguments | {
        "doubts": doubts(portion, kept, gone, parameters),
        "categories": sorted(called),
        "origin": [[*was, becomes[1]] for was, becomes in sorted(origin.items())],
    }
    return replace(correction, arguments=arguments, before=portion, after=after)


def do_split(
    portion: Portion, correction: Correction, looks: Mapping[str, Look], zone: tzinfo = UTC
) -> Correction:
    """Return the correction carried out on a portion: a place given to an object of its own.

    zone: of the times in messages. Raises UnknownThing for an id or a place that is not there,
    BadInput where it is the only one, or was seen only before or after the moment from which on it
    is another thing.
    """
    object_id, place = correction.arguments["object"], correction.arguments["place"]
    from_ms = correction.arguments.get("from_ms")  # older stores have none
    _settled(portion, object_id)
    places = [stay.place for stay in portion.of_object(object_id)]
    if place not in places:
        named = tuple(map(str, sorted(places, key=lambda each: (abs(each - place), each))))
        raise UnknownThing(
            f"{object_id} has no place {place}; it has {', '.join(map(str, places))}", named[:3]
        )
    key = object_id, place
    if from_ms is not None:
        early, late = parted(portion, key, from_ms)
        if not early or not late:
            stay = portion.stays[key]
            raise BadInput(_parts_nothing(stay, from_ms, zone, is_early=bool(early)))
    elif len(places) == 1:
        raise BadInput(
            f"{object_id} was seen at one place only: there is nothing to split but by time, --from"
        )
    after = split(portion, key, correction.arguments["new"], looks, from_ms)
    return replace(correction, before=portion, after=after)


def _parts_nothing(stay: StayRecord, from_ms: int, zone: tzinfo, *, is_early: bool) -> str:
    """Say that all of a stay was seen on one side of a moment, and what would part it."""
    seen = f"{stay.object_id} was seen at place {stay.place}"
    if stay.first_ms == stay.last_ms:
        return f"{seen} at {_iso(stay.first_ms, zone)} alone: there is nothing to split"
    span = f"from {_iso(stay.first_ms, zone)} to {_iso(stay.last_ms, zone)}"
    side, would = ("before", "an earlier") if is_early else ("since", "a later")
    return f"{seen} {span}, all of it {side} {_iso(from_ms, zone)}: {would} time would do"


def _iso(milliseconds: int, zone: tzinfo) -> str:
    moment = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(milliseconds=milliseconds)
    return moment.astimezone(zone).isoformat(timespec="seconds")


def _settled(portion: Portion, object_id: str) -> None:
    if object_id not in portion.objects:
        raise UnknownThing(f"there is no object {object_id}")
    of_stm = any(stay.volatile for stay in portion.of_object(object_id))
    if of_stm or portion.objects[object_id].volatile:
        raise BadInput(
            f"{object_id} is still being put together by an ingest; correct it when that is done"
        )


def undone(correction: Correction, now: Portion, parameters: Parameters) -> Portion:
    """Return the portion without a merge or a split; exactly that of before where nothing came."""
    before, after = correction.before, correction.after
    if before is None or after is None:
        return now
    said = correction.arguments
    if correction.kind == "merge":
        return unmerged(before, after, now, origin_of(said))
    return unsplit(before, after, now, (said["object"], said["place"]), said["new"], parameters)


def origin_of(arguments: Json) -> Origin:
    """Return what each stay became by a merge."""
    kept = arguments["kept"]
    return {(was, place): (kept, becomes) for was, place, becomes in arguments["origin"]}


def taking_back(store: Store, correction: Correction) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the fields of the batch that undoes a correction, and its meta entries."""
    said = correction.arguments
    if correction.kind == "teach":
        before, after = (
            [TaughtName(word, owner) for word, owner in said[when]] for when in ("before", "after")
        )
        found = store.objects(ids=said["ids"])
        added, lost = [n for n in after if n not in before], [n for n in before if n not in after]
        names = [
            (r, (*(n for n in r.names if n not in added), *(n for n in lost if n not in r.names)))
            for r in found
        ]
        ordered = [(r, tuple(before) if set(kept) == set(before) else kept) for r, kept in names]
        return {"objects": [replace(r, names=kept) for r, kept in ordered]}, {}
    if correction.kind == "place":
        regions = [region_of(each) for each in said["before"]]
        gone = {each["name"] for each in said["after"]} - {region.name for region in regions}
        return {"regions": regions, "removed_regions": sorted(gone)}, {}
    if correction.kind == "look":
        return {"removed_objects": [said["new"]]}, {}
    if correction.kind == "deny":
        return {}, {}
    if correction.kind == "map":
        return {}, {"map": said["before"], said["after"]: None}
    now = Portion.read(store, correction.ids())
    back = undone(correction, now, parameters_of(store))
    if correction.lost:
        back = back.with_images(set(store.keyframe_keys()))
    return difference(now, back), {}
