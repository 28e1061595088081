"""What may be a thing that people named, by another id: it was carried since they did.

A name holds of one id, and what is carried often gets a new one. What nobody named, of the same
kind and no other look, and never seen in one round with the named thing, may be it.
"""

from __future__ import annotations

from collections.abc import Collection

from d3a.answering import columns
from d3a.answering.facts import Facts
from d3a.answering.lookalikes import same_look
from d3a.constraints import History
from d3a.store.base import ObjectRecord

RULED_OUT = 0.1
"""A look that is less likely one thing than this is another thing's: one in ten is let go.

Light and what lies around change a look; what is told is only that it may be the thing.
"""


def may_be_named(facts: Facts, named: Collection[str], owner: str | None) -> tuple[str, ...]:
    """Return the ids of what may be one of some named things.

    Not what has a name of its own, was said not to be the owner's, or may be a mistake. A look
    that was not kept rules nothing out. Raises StoreError.
    """
    known = facts.store.objects(ids=sorted(named))
    kinds = sorted({record.category for record in known})
    looks = {r.object_id: r for r in facts.objects(kinds, embeddings=True)}
    known = [looks.get(record.object_id, record) for record in known]
    denied = {name for name, _, theirs in History.read(facts).denials() if theirs == owner}
    others = [
        (record.object_id, like)
        for record in looks.values()
        if record.category in kinds and not (record.names or record.tentative)
        if record.object_id not in denied
        if (like := [one.object_id for one in known if _is_like(one, record)])
    ]
    if not others:
        return ()
    spans = facts.spans(sorted({*named, *(name for name, _ in others)}), None, None)
    shown = columns.Shown.of(spans)
    return tuple(
        name for name, like in others if any(shown[one].isdisjoint(shown[name]) for one in like)
    )


def _is_like(named: ObjectRecord, other: ObjectRecord) -> bool:
    if named.category != other.category:
        return False
    look = named.embedding
    return look is None or other.embedding is None or same_look(look, other) >= RULED_OUT
