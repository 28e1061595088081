"""What people say later, in one small API: these are my keys, this is the kitchen, the same cup.

Each function writes to the store at once, in one batch with the record by which it is undone, and
the next question uses it. Ingests keep it (`constraints`). `undo` takes back the last one.

    >>> store = open_store("memory.db")
    >>> teach_name(store, "o12", "key", owner="me")
    >>> name_place(store, "desk", around=(4.2, 1.0), radius_m=0.8)
    >>> merge(store, "o12", "o31")          # o31 is o12
    >>> undo(store).said
    'o31 is the same thing as o12'

All raise BadInput (UnknownThing for what is not there) and StoreError. at_ms: when it was said, UTC
milliseconds, for the history.
"""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import replace as with_changes
from datetime import UTC, datetime

from d3a.answering.match import squash
from d3a.constraints import (
    Correction,
    History,
    history_meta,
    packed,
    removed,
    with_records,
)
from d3a.correcting.committing import Made, apply_change, checked_name, commit, unknown_object
from d3a.correcting.corrections import (
    UnknownThing,
    do_merge,
    do_split,
    parameters_of,
    taking_back,
)
from d3a.correcting.naming import deny_name, forget_name, teach_name
from d3a.correcting.portion import Portion, difference
from d3a.correcting.rooms import (
    Corner,
    checked_polygon,
    circle,
    region_json,
    robot_position,
)
from d3a.correcting.two_things import measured_looks
from d3a.model import BadInput, Json
from d3a.store.base import (
    Batch,
    Region,
    Store,
)


def history(store: Store) -> tuple[Correction, ...]:
    """Return what people said that holds, oldest first; the last one is undone next."""
    return History.read(store).entries


def merge(
    store: Store, kept: str, gone: str, *, force: bool = False, at_ms: int | None = None
) -> Correction:
    """Say that two objects are the same thing: `gone` becomes part of `kept`, which keeps its id.

    What both have at one place becomes one stay. force: also where one frame shows both. A later
    ingest neither takes them apart again nor makes either part of another thing.
    """

    def make(number: int) -> Made:
        portion = Portion.read(store, [kept, gone])
        _known(store, portion, kept, gone)
        said = f"{gone} is the same thing as {kept}"
        arguments = {"kept": kept, "gone": gone, "force": force, "ids": [kept, gone]}
        correction = Correction(number, "merge", said, at_ms, arguments)
        made = do_merge(portion, correction, parameters_of(store), force=force)
        assert made.after is not None
        return made, difference(portion, made.after)

    return commit(store, make)


def split(
    store: Store,
    object_id: str,
    place: int,
    *,
    since: datetime | None = None,
    at_ms: int | None = None,
) -> Correction:
    """Say that what was seen at one place of an object is another thing, with an id of its own.

    since: only what was seen there from then on. The new id is
    `arguments["new"]` of the result. A later ingest does not make them one again.
    """

    def make(number: int) -> Made:
        portion = Portion.read(store, [object_id])
        _known(store, portion, object_id)
        new_id = f"s{number}"
        then = "" if since is None else f" since {since.isoformat(' ', timespec='minutes')}"
        said = f"{object_id} at place {place} is another thing{then}, {new_id}"
        arguments: Json = {"object": object_id, "place": place, "new": new_id, "ids": [object_id]}
        from_ms = None if since is None else round(since.timestamp() * 1000)
        if from_ms is not None:
            arguments["from_ms"] = from_ms
        correction = Correction(number, "split", said, at_ms, arguments)
        looks = {}
        if (object_id, place) in portion.stays:
            looks = measured_looks(store, portion, (object_id, place), new_id, from_ms)
        made = do_split(portion, correction, looks, (since and since.tzinfo) or UTC)
        assert made.after is not None
        return made, difference(portion, made.after)

    return commit(store, make)


def name_place(
    store: Store,
    name: str,
    *,
    polygon: Sequence[Corner] | None = None,
    around: Corner | None = None,
    radius_m: float = 1.5,
    site: str = "",
    replace: bool = False,
    at_ms: int | None = None,
) -> Correction:
    """Name a place: a polygon (x, y) in metres of the map, or a circle around a point.

    With neither it is around the robot, where it stood last ("this is the kitchen"). replace: draw
    a place of that name anew, where it is an error else.
    """
    if polygon is not None and around is not None:
        raise BadInput("a place is a polygon or a circle around a point, not both")

    def make(number: int) -> Made:
        said_name = checked_name(name)
        old = [r for r in store.regions() if squash(r.name) == squash(said_name)]
        if old and not replace:
            raise BadInput(f"there is a place {old[0].name!r} already: replace it, or remove it")
        corners = polygon or circle(around or robot_position(store), radius_m)
        region = Region(said_name, checked_polygon(corners), site)
        return _placed(number, f"{said_name} is a place", old, [region], at_ms)

    return commit(store, make)


def remove_place(store: Store, name: str, *, at_ms: int | None = None) -> Correction:
    """Take a named place away; the next recording does not bring it back."""

    def make(number: int) -> Made:
        old = _region(store, name)
        return _placed(number, f"{old.name} is no place any more", [old], [], at_ms)

    return commit(store, make)


def rename_place(store: Store, name: str, new: str, *, at_ms: int | None = None) -> Correction:
    """Call a named place otherwise."""

    def make(number: int) -> Made:
        old, called = _region(store, name), checked_name(new)
        taken = [r.name for r in store.regions() if r.name != old.name]
        if squash(called) in map(squash, taken):
            raise BadInput(f"there is a place {called!r} already")
        fresh = with_changes(old, name=called)
        return _placed(number, f"{old.name} is called {called}", [old], [fresh], at_ms)

    return commit(store, make)


def put_map(store: Store, record: Json, said: str, *, at_ms: int | None = None) -> Correction:
    """Keep a map of the home (see `floor_map`) in the place of the one before."""

    def make(number: int) -> Made:
        key = f"map:{number}"
        arguments: Json = {"ids": [], "before": store.meta("map"), "after": key}
        return Correction(number, "map", said, at_ms, arguments), {
            "meta": {"map": key, key: record}
        }

    return commit(store, make)


def _placed(
    number: int, said: str, old: list[Region], new: list[Region], at_ms: int | None
) -> Made:
    arguments: Json = {
        "ids": [],
        "before": [region_json(each) for each in old],
        "after": [region_json(each) for each in new],
    }
    gone = {each.name for each in old} - {each.name for each in new}
    correction = Correction(number, "place", said, at_ms, arguments)
    return correction, {"regions": new, "removed_regions": sorted(gone)}


def undo(store: Store) -> Correction:
    """Take back the last correction that holds, and return it.

    Where no ingest came since, the store is exactly that of before, its history aside. Else what
    was seen since is kept, and shared out by place (`taken_back`). Raises UnknownThing where
    nothing is left to undo.
    """
    last: list[Correction] = []

    def make(past: History) -> Batch:
        open_ones = [each for each in past.entries if not each.is_sealed]
        if not open_ones:
            raise UnknownThing("there is nothing to undo")
        correction = with_records(store, open_ones[-1])
        last[:] = [correction]
        entries = tuple(each for each in past.entries if each.number != correction.number)
        fields, meta = taking_back(store, correction)
        kept = with_changes(past, entries=entries)
        if correction.before is not None and correction.number <= past.seen:
            now = Portion.read(store, correction.ids())
            known, parts = packed(with_changes(correction, undoing=now))
            kept = with_changes(kept, undone=(*past.undone, known))
            meta |= parts
        else:
            meta |= removed(correction)
        return Batch(**fields, meta=meta | history_meta(kept))

    apply_change(store, make)
    return last[0]


def _known(store: Store, portion: Portion, *ids: str) -> None:
    for object_id in ids:
        if object_id not in portion.objects:
            raise unknown_object(store, object_id)


def _region(store: Store, name: str) -> Region:
    regions = store.regions()
    found = next((r for r in regions if squash(r.name) == squash(name)), None)
    if found is None:
        names = [r.name for r in regions]
        near = tuple(difflib.get_close_matches(name, names, n=3, cutoff=0.0))
        hint = f" There are {', '.join(near)}." if near else " No place has a name yet."
        raise UnknownThing(f"There is no place {name!r}.{hint}", near)
    return found


__all__ = [
    "Correction",
    "UnknownThing",
    "commit",
    "deny_name",
    "forget_name",
    "history",
    "merge",
    "name_place",
    "put_map",
    "remove_place",
    "rename_place",
    "split",
    "teach_name",
    "undo",
    "unknown_object",
]
