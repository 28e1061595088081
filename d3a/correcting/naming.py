"""What a person calls a thing, and whose it is: taught, taken back, denied."""

from __future__ import annotations

from dataclasses import replace

from d3a.answering.match import squash
from d3a.constraints import Correction, History
from d3a.correcting.committing import Made, checked_name, commit, unknown_object
from d3a.correcting.corrections import UnknownThing
from d3a.model import BadInput, Json
from d3a.store.base import ObjectRecord, Store, TaughtName


def teach_name(
    store: Store,
    object_id: str,
    name: str,
    owner: str | None = None,
    *,
    at_ms: int | None = None,
    heard: str | None = None,
) -> Correction:
    """Call an object by a name: `teach_name(store, "o12", "key", "anna")`.

    name: singular, as formal queries have it (`objects[].word`). owner: "me" for the person who
    asks, a name, None for nobody's. heard: in the person's own words ("Anna's keys"), to be said
    back. Further names are added. A name that it has already changes nothing: the correction's
    number is 0.
    """
    taught = TaughtName(checked_name(name), checked_name(owner) if owner else None)

    def make(number: int) -> Made:
        record = _object(store, object_id)
        said = f"{object_id} is {_called(taught)}"
        if taught in record.names:
            return _named(0, said, record, record.names, at_ms, heard)
        return _named(number, said, record, (*record.names, taught), at_ms, heard)

    return commit(store, make)


def forget_name(
    store: Store,
    object_id: str,
    name: str,
    owner: str | None = None,
    *,
    at_ms: int | None = None,
    heard: str | None = None,
) -> Correction:
    """Take a taught name back; owner None: whoever's. No question for the owner's means it then.

    heard: as for `teach_name`.
    """
    word = squash(checked_name(name))
    whose = checked_name(owner) if owner else None

    def make(number: int) -> Made:
        record = _object(store, object_id)
        kept = tuple(
            n for n in record.names if squash(n.word) != word or whose not in (None, n.owner)
        )
        if kept == record.names:
            known = tuple(_called(n) for n in record.names)
            has = f"it is {', '.join(known)}" if known else "it has no name"
            raise UnknownThing(f"{object_id} is not called {name!r}; {has}", known[:3])
        return _named(number, f"{object_id} is not {name}", record, kept, at_ms, heard)

    return commit(store, make)


def deny_name(
    store: Store,
    object_id: str,
    name: str,
    owner: str,
    *,
    at_ms: int | None = None,
    heard: str | None = None,
) -> Correction:
    """Say that an object is not somebody's: no question for "my keys" means it any more.

    `teach_name` of it is newer then, and holds. Denied already: the number is 0. heard: as there.
    """
    word, whose = checked_name(name), checked_name(owner)

    def make(number: int) -> Made:
        _object(store, object_id)
        number = 0 if (object_id, word, whose) in History.read(store).denials() else number
        arguments: Json = {"ids": [object_id], "word": word, "owner": whose, "heard": heard}
        said = f"{object_id} is not {_called(TaughtName(word, whose))}"
        return Correction(number, "deny", said, at_ms, arguments), {}

    return commit(store, make)


def _named(
    number: int,
    said: str,
    record: ObjectRecord,
    names: tuple[TaughtName, ...],
    at_ms: int | None,
    heard: str | None,
) -> Made:
    arguments: Json = {
        "ids": [record.object_id],
        "before": [[n.word, n.owner] for n in record.names],
        "after": [[n.word, n.owner] for n in names],
        "heard": heard,
    }
    correction = Correction(number, "teach", said, at_ms, arguments)
    return correction, {"objects": [replace(record, names=names)]}


def _object(store: Store, object_id: str) -> ObjectRecord:
    found = store.objects(ids=[object_id])
    if not found:
        raise unknown_object(store, object_id)
    if found[0].volatile:
        raise BadInput(
            f"{object_id} is still being put together by an ingest; name it when that is done"
        )
    return found[0]


def _called(name: TaughtName) -> str:
    if name.owner is None:
        return f"the {name.word}"
    owner = {"me": "my", "you": "your"}.get(name.owner, f"{name.owner.title()}'s")
    return f"{owner} {name.word}"
