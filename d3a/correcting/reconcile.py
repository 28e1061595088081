"""Corrections that people make while an ingest runs, and between two runs of it.

A person's word is in the store at once; the ingest holds what it has seen since its checkpoint,
made in ignorance of it. At the next checkpoint the corrections are taken back, what was seen is
put in, and they are made again on top: as if the person had spoken just after.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from d3a.constraints import (
    Correction,
    History,
    history_meta,
    latest,
    packed,
    removed,
    with_records,
)
from d3a.correcting.corrections import do_merge, do_split, origin_of, parameters_of, undone
from d3a.correcting.portion import Portion, difference
from d3a.model import BadInput
from d3a.readers.base import Skipped
from d3a.store.base import Batch, StayKey, Store

LOST = "a correction that no longer applies"
_OWN = {"objects": ("object_id",), "stays": ("object_id",), "sightings": ("object_id",)} | {
    "encounters": ("object_a", "object_b")
}
"""Fields of a batch, and where their records name objects."""
_REMOVED = {"removed_stays": 1, "removed_sightings": 1, "removed_encounters": 2}
"""Fields of a batch that remove, and how many of the first parts of a key are ids."""


@dataclass(frozen=True, slots=True)
class Corrected:
    """What people changed behind an ingest: ids of before and after, and what became of what."""

    before: frozenset[str] = frozenset()
    after: frozenset[str] = frozenset()
    objects: Mapping[str, str] = field(default_factory=dict)
    stays: Mapping[StayKey, StayKey] = field(default_factory=dict)

    def plus(self, other: Corrected) -> Corrected:
        """Return both, the other later."""
        return Corrected(
            self.before | (other.before - self.after),
            (self.after - (other.before - other.after)) | other.after,
            _chained(self.objects, other.objects),
            _chained(self.stays, other.stays),
        )


def _chained(first: Mapping[Any, Any], then: Mapping[Any, Any]) -> dict[Any, Any]:
    return {**then, **{was: then.get(becomes, becomes) for was, becomes in first.items()}}


def changes_of(correction: Correction, *, is_undone: bool) -> Corrected:
    """Return what a merge or a split changes, or what undoing it does."""
    said = correction.arguments
    if correction.kind == "merge":
        kept, gone = said["kept"], said["gone"]
        one, both = frozenset({kept}), frozenset({kept, gone})
        if not is_undone:
            return Corrected(both, one, {gone: kept}, origin_of(said))
        back: dict[StayKey, list[StayKey]] = {}
        for was, becomes in sorted(origin_of(said).items()):
            back.setdefault(becomes, []).append(was)
        return Corrected(one, both, {}, {k: v[0] for k, v in back.items() if len(v) == 1})
    if correction.kind == "split":
        whole, parted = said["object"], said["new"]
        one, both = frozenset({whole}), frozenset({whole, parted})
        if not is_undone:
            return Corrected(one, both, {}, {(whole, said["place"]): (parted, 0)})
        return Corrected(both, one, {parted: whole}, {(parted, 0): (whole, said["place"])})
    return Corrected()


def news_of(history: History, known: frozenset[int]) -> Corrected:
    """Return what people changed since somebody knew these corrections."""
    found = Corrected()
    undone_ones = {each.number for each in history.undone}
    for each in history.news(known):
        found = found.plus(changes_of(each, is_undone=each.number in undone_ones))
    return found


def corrected_stays(store: Store) -> dict[StayKey, StayKey]:
    """Return what stays that merges and splits took out of the store are by now."""
    became = news_of(History.read(store), frozenset()).stays
    held = {stay.key for stay in store.stays()} if became else set()
    return {was: becomes for was, becomes in became.items() if was not in held}


@dataclass(frozen=True, slots=True)
class Reconciled:
    """An ingest's writes with people's corrections on top.

    fields: of the batch. meta: what corrections replaced, as it is now. history: to be written.
    """

    fields: dict[str, Any]
    meta: dict[str, Any]
    history: History
    changed: Corrected


def reconcile(
    store: Store,
    history: History,
    known: frozenset[int],
    fields: dict[str, Any],
    skipped: Skipped,
) -> Reconciled:
    """Put the corrections that an ingest does not know on top of what it is to write, in a turn.

    fields: the batch's writes, made without them. A correction of what is no more is counted as
    left out.
    """
    if not history.news(known):
        return Reconciled(fields, {}, history, Corrected())
    news = [with_records(store, each) for each in history.news(known)]
    ids = {object_id for each in news for object_id in each.ids()}
    now = Portion.read(store, ids)
    undone_ones = {each.number for each in history.undone}
    then = _rolled_back(now, news, undone_ones)
    sealed = {name for each in news if each.is_sealed for name in each.ids()}
    portion = _overlaid(then, fields, ids - sealed)
    done: list[Correction] = []
    changed, numbers = Corrected(), parameters_of(store)
    for each in news:
        is_undone = each.number in undone_ones
        try:
            portion, made = _again(portion, each, is_undone=is_undone, numbers=numbers)
        except BadInput as error:
            skipped.add(LOST, f"{each.said}: {error}")
            done.append(replace(each, number=-each.number))
            continue
        if not is_undone:
            done.append(made)
        changed = changed.plus(changes_of(made, is_undone=is_undone))
    portion = _as_called(portion, now)
    rest = {name: _without(name, values, ids) for name, values in fields.items()}
    own = difference(now, portion)
    joined = {name: [*rest.get(name, ()), *own.get(name, ())] for name in {**rest, **own}}
    newer, meta = _kept(history, done)
    return Reconciled(joined, meta, newer, changed)


def acknowledged(history: History, *, done: bool) -> dict[str, Any]:
    """Return the meta entries that say that a checkpoint has taken the history in."""
    meta: dict[str, Any] = {}
    for each in history.undone:
        meta |= removed(each)
    known = replace(history, seen=0 if done else history.serial, undone=())
    return meta | history_meta(known)


def _rolled_back(now: Portion, news: Sequence[Correction], undone_ones: set[int]) -> Portion:
    portion = now
    for each in reversed(news):
        was = each.undoing if each.number in undone_ones else each.before
        if was is not None:
            portion = portion.without(each.ids()).plus(was)
    return portion


def _again(
    portion: Portion, correction: Correction, *, is_undone: bool, numbers: Any
) -> tuple[Portion, Correction]:
    """Make a correction, or its undoing, on the portion; both come back."""
    if correction.before is None or correction.after is None:
        return portion, correction
    part = portion.only(correction.ids())
    if is_undone:
        after = undone(correction, part, numbers)
        return portion.without(correction.ids()).plus(after), correction
    if correction.kind == "merge":
        made = do_merge(part, correction, numbers, force=True)
    else:
        looks = {
            name: record.embedding
            for name, record in correction.after.objects.items()
            if record.embedding is not None
        }
        made = do_split(part, correction, looks)
    assert made.after is not None
    return portion.without(correction.ids()).plus(made.after), made


def _overlaid(portion: Portion, fields: Mapping[str, Any], ids: set[str]) -> Portion:
    """Return the portion as the batch's writes make it; what is in an STM yet is left out."""
    gone_objects, gone_stays = set(fields["removed_objects"]), set(fields["removed_stays"])
    gone_sightings = set(fields["removed_sightings"])
    mine = gone_objects & ids
    touched = {k for k in portion.stays if k in gone_stays and k[0] in ids}

    def is_gone(stay: StayKey) -> bool:
        return stay in gone_stays or stay[0] in gone_objects

    left = Portion(
        {k: r for k, r in portion.objects.items() if k not in mine},
        {k: r for k, r in portion.stays.items() if k[0] not in mine and k not in touched},
        {
            k: r
            for k, r in portion.sightings.items()
            if k[0] not in mine and k[:2] not in touched and k not in gone_sightings
        },
        {
            k: r
            for k, r in portion.encounters.items()
            if not is_gone((k[0], k[2])) and not is_gone((k[1], k[3]))
        },
    )
    put = Portion.of(*([r for r in fields[name] if _touches(name, r, ids)] for name in _OWN))
    whole = left.plus(put)
    settled = {k for k, r in whole.objects.items() if not r.volatile}
    volatile = {k for k, r in whole.stays.items() if r.volatile and k[0] in settled}
    return Portion(
        whole.objects,
        {k: r for k, r in whole.stays.items() if k not in volatile},
        {k: r for k, r in whole.sightings.items() if k[:2] not in volatile},
        whole.encounters,
    )


def _touches(name: str, record: Any, ids: set[str]) -> bool:
    return any(getattr(record, part) in ids for part in _OWN[name])


def _without(name: str, values: Iterable[Any], ids: set[str]) -> list[Any]:
    """Return the values of a field of the batch that concern none of the ids."""
    if name in _OWN:
        return [record for record in values if not _touches(name, record, ids)]
    if name == "removed_objects":
        return [object_id for object_id in values if object_id not in ids]
    if name in _REMOVED:
        return [key for key in values if not ids & set(key[: _REMOVED[name]])]
    return list(values)


def _as_called(portion: Portion, now: Portion) -> Portion:
    """Return the portion with the names that people gave its objects by now."""
    objects = {
        name: replace(record, names=now.objects[name].names) if name in now.objects else record
        for name, record in portion.objects.items()
    }
    return replace(portion, objects=objects)


def _kept(history: History, done: Sequence[Correction]) -> tuple[History, dict[str, Any]]:
    """Return the history with the corrections as they were made again, and their records."""
    lost = {-each.number for each in done if each.number < 0}
    meta: dict[str, Any] = {}
    entries = tuple(each for each in history.entries if each.number not in lost)
    for each in history.entries:
        if each.number in lost:
            meta |= removed(each)
    newer = []
    for each in done:
        if each.number > 0 and each.before is not None:
            old = removed(each)
            kept, parts = packed(each)
            newer.append(kept)
            meta |= old | parts
    return latest(replace(history, entries=entries), newer), meta


def take_in(store: Store) -> History:
    """Return the history as an ingest begins; who undoes some of it now leaves word of that."""
    with store.turn():
        history = History.read(store)
        if history.serial > 0:
            history = replace(history, seen=history.serial)
            store.apply(Batch(meta=history_meta(history)))
    return history
