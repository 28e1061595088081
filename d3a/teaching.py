"""What people say later, in one small API: these are my keys, this is the kitchen, the same cup.

Each function writes to the store at once, in one batch with the record by which it is undone, and
the next question uses it. Ingests keep it (`constraints`). `undo` takes back the last one.

    >>> store = open_store("memory.db")
    >>> teach_name(store, "o12", "key", owner="me")
    >>> name_place(store, "desk", around=(4.2, 1.0), radius_m=0.8)
    >>> merge(store, "o12", "o31")          # o31 is o12
    >>> undo(store).said
    'o31 is the same thing as o12'

All raise BadInput (UnknownThing for what is not there) and StoreError. at_ms: when said, UTC ms.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Sequence
from dataclasses import replace as with_changes
from typing import Any

from d3a.constraints import (
    SAID,
    Correction,
    History,
    history_meta,
    packed,
    removed,
    with_records,
)
from d3a.corrections import (
    UnknownThing,
    do_merge,
    do_split,
    parameters_of,
    taking_back,
)
from d3a.match import squash
from d3a.model import BadInput, Json
from d3a.portion import Portion, difference
from d3a.rooms import (
    Corner,
    checked_polygon,
    circle,
    region_json,
    robot_position,
)
from d3a.store.base import (
    Batch,
    ObjectRecord,
    Region,
    Store,
    TaughtName,
)
from d3a.two_things import measured_looks

_Made = tuple[Correction, dict[str, Any]]


def history(store: Store) -> tuple[Correction, ...]:
    """Return what people said that holds, oldest first; the last one is undone next."""
    return History.read(store).entries


def teach_name(
    store: Store, object_id: str, name: str, owner: str | None = None, *, at_ms: int | None = None
) -> Correction:
    """Call an object by a name: `teach_name(store, "o12", "key", "anna")`.

    name: singular, as formal queries have it (`objects[].word`). owner: "me" for the person who
    asks, a name, None for nobody's. Further names are added. A name that it has already changes
    nothing: the correction's number is 0.
    """
    taught = TaughtName(_name(name), _name(owner) if owner else None)

    def make(number: int) -> _Made:
        record = _object(store, object_id)
        said = f"{object_id} is {_called(taught)}"
        if taught in record.names:
            return _named(0, said, record, record.names, at_ms)
        return _named(number, said, record, (*record.names, taught), at_ms)

    return commit(store, make)


def forget_name(
    store: Store, object_id: str, name: str, owner: str | None = None, *, at_ms: int | None = None
) -> Correction:
    """Take a taught name back; owner None: whoever's. No question for the owner's means it then."""
    word = squash(_name(name))
    whose = _name(owner) if owner else None

    def make(number: int) -> _Made:
        record = _object(store, object_id)
        kept = tuple(
            n for n in record.names if squash(n.word) != word or whose not in (None, n.owner)
        )
        if kept == record.names:
            known = tuple(_called(n) for n in record.names)
            has = f"it is {', '.join(known)}" if known else "it has no name"
            raise UnknownThing(f"{object_id} is not called {name!r}; {has}", known[:3])
        return _named(number, f"{object_id} is not {name}", record, kept, at_ms)

    return commit(store, make)


def deny_name(
    store: Store, object_id: str, name: str, owner: str, *, at_ms: int | None = None
) -> Correction:
    """Say that an object is not somebody's: no question for "my keys" means it any more.

    `teach_name` of it is newer then, and holds. Denied already: the number is 0.
    """
    word, whose = _name(name), _name(owner)

    def make(number: int) -> _Made:
        _object(store, object_id)
        number = 0 if (object_id, word, whose) in History.read(store).denials() else number
        arguments: Json = {"ids": [object_id], "word": word, "owner": whose}
        said = f"{object_id} is not {_called(TaughtName(word, whose))}"
        return Correction(number, "deny", said, at_ms, arguments), {}

    return commit(store, make)


def _named(
    number: int,
    said: str,
    record: ObjectRecord,
    names: tuple[TaughtName, ...],
    at_ms: int | None,
) -> _Made:
    arguments: Json = {
        "ids": [record.object_id],
        "before": [[n.word, n.owner] for n in record.names],
        "after": [[n.word, n.owner] for n in names],
    }
    correction = Correction(number, "teach", said, at_ms, arguments)
    return correction, {"objects": [with_changes(record, names=names)]}


def merge(
    store: Store, kept: str, gone: str, *, force: bool = False, at_ms: int | None = None
) -> Correction:
    """Say that two objects are the same thing: `gone` becomes part of `kept`, which keeps its id.

    What both have at one place becomes one stay. force: also where one frame shows both. A later
    ingest neither takes them apart again nor makes either part of another thing.
    """

    def make(number: int) -> _Made:
        portion = Portion.read(store, [kept, gone])
        _known(store, portion, kept, gone)
        said = f"{gone} is the same thing as {kept}"
        arguments = {"kept": kept, "gone": gone, "force": force, "ids": [kept, gone]}
        correction = Correction(number, "merge", said, at_ms, arguments)
        made = do_merge(portion, correction, parameters_of(store), force=force)
        assert made.after is not None
        return made, difference(portion, made.after)

    return commit(store, make)


def split(store: Store, object_id: str, place: int, *, at_ms: int | None = None) -> Correction:
    """Say that what was seen at one place of an object is another thing, with an id of its own.

    The new id is `arguments["new"]` of the result. A later ingest does not make them one again.
    """

    def make(number: int) -> _Made:
        portion = Portion.read(store, [object_id])
        _known(store, portion, object_id)
        new_id = f"s{number}"
        said = f"{object_id} at place {place} is another thing, {new_id}"
        arguments = {"object": object_id, "place": place, "new": new_id, "ids": [object_id]}
        correction = Correction(number, "split", said, at_ms, arguments)
        looks = {}
        if (object_id, place) in portion.stays:
            looks = measured_looks(store, portion, object_id, place, new_id)
        made = do_split(portion, correction, looks)
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

    def make(number: int) -> _Made:
        said_name = _name(name)
        old = [r for r in store.regions() if squash(r.name) == squash(said_name)]
        if old and not replace:
            raise BadInput(f"there is a place {old[0].name!r} already: replace it, or remove it")
        corners = polygon or circle(around or robot_position(store), radius_m)
        region = Region(said_name, checked_polygon(corners), site)
        return _placed(number, f"{said_name} is a place", old, [region], at_ms)

    return commit(store, make)


def remove_place(store: Store, name: str, *, at_ms: int | None = None) -> Correction:
    """Take a named place away; the next recording does not bring it back."""

    def make(number: int) -> _Made:
        old = _region(store, name)
        return _placed(number, f"{old.name} is no place any more", [old], [], at_ms)

    return commit(store, make)


def rename_place(store: Store, name: str, new: str, *, at_ms: int | None = None) -> Correction:
    """Call a named place otherwise."""

    def make(number: int) -> _Made:
        old, called = _region(store, name), _name(new)
        taken = [r.name for r in store.regions() if r.name != old.name]
        if squash(called) in map(squash, taken):
            raise BadInput(f"there is a place {called!r} already")
        fresh = with_changes(old, name=called)
        return _placed(number, f"{old.name} is called {called}", [old], [fresh], at_ms)

    return commit(store, make)


def put_map(store: Store, record: Json, said: str, *, at_ms: int | None = None) -> Correction:
    """Keep a map of the home (see `floor_map`) in the place of the one before."""

    def make(number: int) -> _Made:
        key = f"map:{number}"
        arguments: Json = {"ids": [], "before": store.meta("map"), "after": key}
        return Correction(number, "map", said, at_ms, arguments), {
            "meta": {"map": key, key: record}
        }

    return commit(store, make)


def _placed(
    number: int, said: str, old: list[Region], new: list[Region], at_ms: int | None
) -> _Made:
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

    _apply(store, make)
    return last[0]


def commit(store: Store, make: Callable[[int], _Made]) -> Correction:
    """Write a correction and what it changes in one batch; `make` gets its number."""
    made: list[Correction] = []

    def batch(past: History) -> Batch | None:
        correction, fields = make(past.serial + 1)
        kept, parts = packed(correction)
        made[:] = [kept]
        if correction.number == 0:
            return None
        fresh = with_changes(past, serial=kept.number, entries=(*past.entries, kept))
        meta = {**fields.pop("meta", {}), **parts, **history_meta(fresh)}
        return Batch(**fields, meta=meta)

    _apply(store, batch)
    return made[0]


def _apply(store: Store, make: Callable[[History], Batch | None]) -> None:
    """Apply what `make` reads and makes; nobody writes in between."""
    with store.turn():
        batch = make(History.read(store))
        if batch is not None:
            meta = {**batch.meta, SAID: (store.meta(SAID) or 0) + 1}
            store.apply(with_changes(batch, meta=meta))


def _object(store: Store, object_id: str) -> ObjectRecord:
    found = store.objects(ids=[object_id])
    if not found:
        raise unknown_object(store, object_id)
    if found[0].volatile:
        raise BadInput(
            f"{object_id} is still being put together by an ingest; name it when that is done"
        )
    return found[0]


def _known(store: Store, portion: Portion, *ids: str) -> None:
    for object_id in ids:
        if object_id not in portion.objects:
            raise unknown_object(store, object_id)


def unknown_object(store: Store, said: str) -> UnknownThing:
    """Return the error for an id that no object has: the nearest ids, or those it is a word for."""
    records = store.objects(embeddings=False)
    word = squash(said)
    meant = [
        r.object_id
        for r in sorted(records, key=lambda r: (-r.weight, r.object_id))
        if word in {squash(r.category), *(squash(n.word) for n in r.names)}
    ]
    ids = [r.object_id for r in records]
    near = tuple((meant or difflib.get_close_matches(said, ids, n=3, cutoff=0.0))[:3])
    hint = f" The nearest are {', '.join(near)}." if near else " The store has no objects."
    return UnknownThing(f"There is no object {said!r}.{hint}", near)


def _region(store: Store, name: str) -> Region:
    regions = store.regions()
    found = next((r for r in regions if squash(r.name) == squash(name)), None)
    if found is None:
        names = [r.name for r in regions]
        near = tuple(difflib.get_close_matches(name, names, n=3, cutoff=0.0))
        hint = f" There are {', '.join(near)}." if near else " No place has a name yet."
        raise UnknownThing(f"There is no place {name!r}.{hint}", near)
    return found


def _name(text: str) -> str:
    words = " ".join(text.split()).lower()
    if not squash(words):
        raise BadInput(f"{text!r} is no name: it needs a letter or a digit")
    return words


def _called(name: TaughtName) -> str:
    if name.owner is None:
        return f"the {name.word}"
    owner = {"me": "my", "you": "your"}.get(name.owner, f"{name.owner.title()}'s")
    return f"{owner} {name.word}"


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
