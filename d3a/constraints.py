"""What people said of the store: a history that can be undone, and constraints on later ingests.

Each correction is a record of the store, kept with what it replaced. Constraints follow from the
history: what a person made one is not taken apart, what a person split is not made one again, and
a room that was taken away does not come back with the next recording.
"""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal, Protocol

from d3a.answering.match import squash
from d3a.correcting.portion import Portion
from d3a.model import Json
from d3a.store.base import Store, StoreError

HISTORY = "corrections"
"""Key of the store's meta with the history; what a correction replaced has keys of its own."""
SAID = "said"
"""Key of the store's meta that counts what people said: equal counts, equal histories."""
CHUNK = 700_000
"""Characters of a part: a store keeps a million bytes under one key."""
Kind = Literal["merge", "split", "teach", "place", "map", "look", "deny"]
Denial = tuple[str, str, str]
"""An object, and the word and the owner that it is not: o12, key, me."""


class HasMeta(Protocol):
    """A store, or what was read of one."""

    def meta(self, key: str) -> Any | None:
        """Return a JSON value, None where it is not set."""


@dataclass(frozen=True, slots=True)
class Correction:
    """One thing that a person said.

    number: unique in the store, never given again. said: as a phrase, for the history. at_ms: when
    it was said, None where nobody told. arguments: of the kind. before, after: what it made of
    what, for "merge" and "split"; None in a list of the history. undoing: what the store held when
    it was undone. lost: pictures that `before` alone refers to, which must not be cleaned away
    while it can be undone.
    """

    number: int
    kind: Kind
    said: str
    at_ms: int | None
    arguments: Json
    before: Portion | None = None
    after: Portion | None = None
    undoing: Portion | None = None
    lost: tuple[str, ...] = ()

    def ids(self) -> set[str]:
        """Return the objects that it concerns."""
        return {str(each) for each in self.arguments.get("ids", ())}

    @property
    def is_sealed(self) -> bool:
        """Whether what it replaced was forgotten, so that it cannot be undone."""
        return bool(self.arguments.get("sealed"))

    def header(self) -> Json:
        """Return it as JSON without its records."""
        return {
            "number": self.number,
            "kind": self.kind,
            "said": self.said,
            "at_ms": self.at_ms,
            "arguments": self.arguments,
            "lost": list(self.lost),
        }

    @classmethod
    def of_header(cls, record: Json) -> Correction:
        """Return what `header` wrote."""
        return cls(**(record | {"lost": tuple(record["lost"])}))


@dataclass(frozen=True, slots=True)
class History:
    """The corrections that hold, oldest first.

    serial: the last number that was given. seen: the serial that an ingest which is under way has
    taken in, 0 where none is. undone: what it had taken in and was undone since, for it to learn.
    """

    serial: int = 0
    seen: int = 0
    entries: tuple[Correction, ...] = ()
    undone: tuple[Correction, ...] = ()

    @classmethod
    def read(cls, store: HasMeta) -> History:
        """Return the store's history, without the records of the corrections."""
        value = store.meta(HISTORY)
        return cls() if value is None else cls.of_json(value)

    @classmethod
    def of_json(cls, value: Json) -> History:
        """Return what `to_json` wrote."""
        entries, undone = (
            tuple(Correction.of_header(each) for each in value[name])
            for name in ("entries", "undone")
        )
        return cls(value["serial"], value["seen"], entries, undone)

    def to_json(self) -> Json:
        """Return it as JSON."""
        return {
            "serial": self.serial,
            "seen": self.seen,
            "entries": [each.header() for each in self.entries],
            "undone": [each.header() for each in self.undone],
        }

    def moving(self) -> frozenset[int]:
        """Return the numbers of the corrections that change what an ingest holds in memory."""
        return frozenset(each.number for each in self.entries if each.kind in ("merge", "split"))

    def news(self, known: frozenset[int]) -> tuple[Correction, ...]:
        """Return what one who knows some corrections must learn: the undone, then the new."""
        undone = (each for each in self.undone if each.number in known)
        moving = self.moving() - known
        return (*undone, *(each for each in self.entries if each.number in moving))

    def pictures(self) -> set[str]:
        """Return pictures that only an undo refers to."""
        return {key for each in (*self.entries, *self.undone) for key in each.lost}

    def denials(self) -> frozenset[Denial]:
        """Return what things were said not to be, and were not said to be since."""
        held: set[Denial] = set()
        for each in self.entries:
            said = each.arguments
            if each.kind == "deny":
                held.add((said["ids"][0], said["word"], said["owner"]))
            elif each.kind == "teach":
                was, is_ = (
                    {(said["ids"][0], word, owner) for word, owner in said[when] if owner}
                    for when in ("before", "after")
                )
                held = (held | (was - is_)) - is_
            elif each.kind == "merge":
                held |= {(said["kept"], *rest) for name, *rest in held if name == said["gone"]}
        return frozenset(held)

    def constraints(self) -> Constraints:
        """Return what later ingests keep."""
        found = Constraints()
        for each in self.entries:
            found = found.after(each)
        return found


@dataclass(frozen=True, slots=True)
class Constraints:
    """What an ingest keeps. fixed: ids that are not made part of another, and do not expire.

    one: ids that a person made one of several, with the categories that those had. no_places:
    names of rooms, squashed, that a person took away or renamed.
    """

    fixed: frozenset[str] = frozenset()
    one: Mapping[str, frozenset[str]] = field(default_factory=dict)
    no_places: frozenset[str] = frozenset()

    def after(self, correction: Correction) -> Constraints:
        """Return the constraints with one more correction."""
        said = correction.arguments
        if correction.kind == "merge":
            kept, gone = said["kept"], said["gone"]
            one = {name: each for name, each in self.one.items() if name != gone}
            was = self.one.get(kept, frozenset()) | self.one.get(gone, frozenset())
            one[kept] = was | frozenset(said["categories"])
            return replace(self, fixed=(self.fixed - {gone}) | {kept}, one=one)
        if correction.kind == "split":
            kept, parted = said["object"], said["new"]
            one = dict(self.one)
            if kept in one:
                one[parted] = one[kept]
            return replace(self, fixed=self.fixed | {kept, parted}, one=one)
        if correction.kind == "place":
            gone_names = {squash(each["name"]) for each in said["before"]}
            held = {squash(each["name"]) for each in said["after"]}
            return replace(self, no_places=(self.no_places | gone_names) - held)
        return self


def with_records(store: Store, correction: Correction) -> Correction:
    """Return a correction of the history with the records that it replaced.

    Raises StoreError where parts of them are missing.
    """
    if not correction.arguments.get("parts"):
        return correction
    texts = []
    for part in range(correction.arguments["parts"]):
        text = store.meta(part_key(correction.number, part))
        if text is None:
            raise StoreError(f"{store.uri}: what correction {correction.number} replaced is lost")
        texts.append(str(text))
    content = json.loads(zlib.decompress(base64.b64decode("".join(texts))))
    portions: Any = {name: Portion.from_json(each) for name, each in content.items()}
    return replace(correction, **portions)


def part_key(number: int, part: int) -> str:
    """Return the key of the store's meta for a part of what a correction replaced."""
    return f"correction:{number}:{part}"


def look_key(number: int) -> str:
    """Return the key of the store's meta for the look that a correction taught."""
    return f"look:{number}"


def packed(correction: Correction) -> tuple[Correction, dict[str, Any]]:
    """Return the correction as the history keeps it, and the meta entries of its records."""
    before, after = correction.before, correction.after
    if before is None or after is None:
        return correction, {}
    content = {"before": before.to_json(), "after": after.to_json()}
    if correction.undoing is not None:
        content["undoing"] = correction.undoing.to_json()
    plain = json.dumps(content, ensure_ascii=False, sort_keys=True).encode("utf-8")
    text = base64.b64encode(zlib.compress(plain, 6)).decode("ascii")
    chunks = [text[at : at + CHUNK] for at in range(0, len(text), CHUNK)]
    kept = replace(
        correction,
        arguments=correction.arguments
        | {"parts": len(chunks), "ids": sorted(before.ids() | after.ids())},
        before=None,
        after=None,
        undoing=None,
        lost=tuple(sorted(before.images() - after.images())),
    )
    return kept, {part_key(kept.number, n): chunk for n, chunk in enumerate(chunks)}


def removed(correction: Correction) -> dict[str, Any]:
    """Return the meta entries that remove what a correction replaced, or a look that it keeps."""
    parts = correction.arguments.get("parts", 0)
    keys = [part_key(correction.number, part) for part in range(parts)]
    if correction.kind == "look":
        keys.append(look_key(correction.number))
    return dict.fromkeys(keys)


def history_meta(history: History) -> dict[str, Any]:
    """Return the meta entry of a history."""
    return {HISTORY: history.to_json()}


def forgetting(store: Store, object_ids: Iterable[str]) -> dict[str, Any]:
    """Return the meta entries by which the history forgets objects too.

    What corrections of them replaced goes, so that no undo brings it back; they stay constraints
    ("sealed"). For the batch that removes the objects, or some of their stays or sightings.
    """
    gone = set(object_ids)
    history = History.read(store)
    hit = [e for e in (*history.entries, *history.undone) if e.ids() & gone and not e.is_sealed]
    if not hit:
        return {}
    meta: dict[str, Any] = {}
    for each in hit:
        meta |= removed(each)
    sealed = [
        replace(each, arguments=each.arguments | {"parts": 0, "sealed": True}, lost=())
        for each in hit
    ]
    return meta | history_meta(latest(history, sealed))


def latest(history: History, corrections: Sequence[Correction]) -> History:
    """Return the history with some of its corrections replaced, by number."""
    newer = {each.number: each for each in corrections}
    entries, undone = (
        tuple(newer.get(each.number, each) for each in those)
        for those in (history.entries, history.undone)
    )
    return replace(history, entries=entries, undone=undone)
