"""Words to objects: which objects of OIc a noun may mean, and how well it fits each.

Paper: "Retrieving object instances" knows three rungs (the very object, its category, any
object). Between them lie the words people use: a taught name, the detector's own spelling, a
synonym, a narrower or a broader word. Each rung is worth less than the one before it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Protocol

from d3a.parameters import DEFAULT
from d3a.plan import FindObjects
from d3a.store.base import ObjectRecord
from grammar.forms import ANYTHING

EXACT = 1.0
SYNONYM = 0.9
"""The same category by another word: a mug was asked for, the detector knows cups."""
NARROWER = 0.85
"""A kind of what was asked for: a sports ball is a ball, but maybe not the one meant."""
BROADER = 0.5
"""What was asked for is a kind of it: a vehicle may be the truck."""


class Lexicon(Protocol):
    """What d3a needs to know of words; the grammar's vocabulary is one, a test's table another."""

    def canonical(self, word: str) -> str:
        """Return the category of a word after synonyms and spelling (`sportsball`), or itself."""
        ...

    def broader(self, category: str) -> Sequence[str]:
        """Return the categories that take it in, nearest first."""
        ...

    def narrower(self, category: str) -> Sequence[str]:
        """Return the categories that it takes in."""
        ...

    def is_part(self, word: str) -> bool:
        """Return whether a word names a part of a thing: handle, lid."""
        ...

    def unlisted_lead(self, word: str) -> str:
        """Return what stands before the head of a compound that is in no list: contract folder."""
        ...

    def nearest(self, word: str, among: Sequence[str]) -> Sequence[str]:
        """Return up to three words of `among` that are like it, best first."""
        ...


@dataclass(frozen=True, slots=True)
class Candidate:
    """An object that a noun may mean.

    match: 0..1, how well the word fits. attributes: word -> probability, "not red" for `without`.
    same: how likely it is the thing meant, for a thing that the detector called otherwise.
    votes: the share of its detections that were called so, where most were called otherwise.
    """

    record: ObjectRecord
    match: float
    attributes: Mapping[str, float] = field(default_factory=dict)
    same: float = 1.0
    votes: float = 1.0


def rungs(step: FindObjects, categories: Sequence[str], lexicon: Lexicon) -> dict[str, float]:
    """Return the categories that the noun may mean, each with its worth in (0, 1].

    categories: as the store or a detector spells them, in their order. The precision "perfect"
    admits none, "category" what is the same category, "any" all.
    """
    if step.category == ANYTHING or step.precision == "any":
        return dict.fromkeys(categories, EXACT)
    if step.precision == "perfect":
        return {}
    asked = lexicon.canonical(step.category)
    narrower = set(lexicon.narrower(asked))
    broader = set(lexicon.broader(asked))
    worth: dict[str, float] = {}
    for category in categories:
        own = lexicon.canonical(category)
        if squash(category) == squash(step.word) or (own == asked and step.word == step.category):
            worth[category] = EXACT
        elif own == asked:
            worth[category] = SYNONYM
        elif step.precision in ("category", "attribute"):
            continue
        elif own in narrower or _is_kind_of(own, asked):
            worth[category] = NARROWER
        elif own in broader:
            worth[category] = BROADER
    return worth


def unheard(
    step: FindObjects, found: Sequence[Candidate], worth: Mapping[str, float], lexicon: Lexicon
) -> str:
    """Return the words of a noun that nothing was found by, "" where all of them were heard.

    Blurple, where there are cups: it may describe them or name a kind of them, nobody knows. A
    listed kind that was found by a wider word alone is one as a whole: sunglasses, among glasses.
    """
    lead = lexicon.unlisted_lead(step.word)
    if lead:
        head = lexicon.canonical(step.word.rpartition(" ")[2])
        by_head = any(lexicon.canonical(category) == head for category in worth)
        words = lead if by_head and not any(own >= SYNONYM for own in worth.values()) else ""
    else:
        words = step.word if found and all(own == BROADER for own in worth.values()) else ""
    return "" if words and any(is_named(c.record, step) for c in found) else words


def candidates(
    step: FindObjects,
    records: Sequence[ObjectRecord],
    worth: Mapping[str, float],
    *,
    confusion: float = DEFAULT.confusion,
) -> list[Candidate]:
    """Return the records that fit, in their order, with their match.

    A taught name that is the word (and whose owner is the one asked for) fits fully. Else the
    detector's votes count: an object called "cup" in seven of ten frames and "bowl" in three is a
    bowl with three tenths of the worth, where the step asks for votes.
    confusion: the share of wrong words that a detector gives anything; fewer votes say nothing.
    """
    found: list[Candidate] = []
    for record in records:
        if is_named(record, step):
            found.append(Candidate(record, EXACT))
            continue
        own, votes = worth.get(record.category), record.categories
        if own is not None and (not votes or (len(votes) == 1 and votes[0][0] == record.category)):
            found.append(Candidate(record, own))  # as of thousands of things most
            continue
        votes = votes or ((record.category, 1.0),)
        total = sum(weight for _, weight in votes)
        match = sum(worth.get(category, 0.0) * weight for category, weight in votes)
        match = match / total if total > 0 else worth.get(record.category, 0.0)
        if record.category in worth:
            found.append(Candidate(record, min(1.0, match)))
        elif step.votes and match > 0:
            share = sum(weight for category, weight in votes if category in worth) / total
            if share > confusion + 2 * math.sqrt(confusion * (1 - confusion) / max(total, 1.0)):
                found.append(Candidate(record, min(1.0, match), votes=share))
    if step.owner is not None:
        return owned(step, found)
    return found


def is_named(record: ObjectRecord, step: FindObjects) -> bool:
    """Whether a person taught this object the asked word, and as the asked owner's where named."""
    if not record.names:
        return False
    words = {squash(step.word), squash(step.category)}
    return any(
        squash(name.word) in words
        and (step.owner in (None, "me", "you") or name.owner in (None, step.owner))
        for name in record.names
    )


def is_by_name(step: FindObjects, found: Sequence[Candidate]) -> bool:
    """Whether a name alone chose what was found: my keys are those that were taught to be mine."""
    return bool(found) and all(
        any(name.owner == step.owner for name in c.record.names)
        if step.owner is not None
        else is_named(c.record, step)
        for c in found
    )


def owned(step: FindObjects, found: Sequence[Candidate]) -> list[Candidate]:
    """Keep what is taught to be the owner's, where anything is; else all that is nobody else's.

    Whose a thing is cannot be seen: without a taught owner it is not judged, never a no.
    """
    theirs = [
        candidate
        for candidate in found
        if any(name.owner == step.owner for name in candidate.record.names)
    ]
    return theirs or [c for c in found if all(n.owner is None for n in c.record.names)]


def said_alone(owner: str) -> str:
    """Return an owner as it is said alone: mine, hers, anna's."""
    alone = {"me": "mine", "you": "yours", "her": "hers", "him": "his", "them": "theirs"}
    return alone.get(owner, f"{owner}'s")


@lru_cache(maxsize=4096)
def squash(word: str) -> str:
    """Return a word without blanks, hyphens and case: detectors write `sportsball`."""
    return "".join(ch for ch in word.lower() if ch.isalnum())


def in_room(word: str, rooms: Sequence[str]) -> tuple[str, str] | None:
    """Return the room and the rest of a noun that begins with its name: kitchen, table.

    rooms: the names of the store's rooms. The longest name counts: living room before living.
    """
    words = word.split()
    named = {squash(room): room for room in rooms}
    for size in range(len(words) - 1, 0, -1):
        room = named.get(squash("".join(words[:size])))
        if room is not None:
            return room, " ".join(words[size:])
    return None


def _is_kind_of(category: str, asked: str) -> bool:
    """Whether the noun's head says so: a coffee cup is a cup."""
    words = category.replace("_", " ").replace("-", " ").split()
    return len(words) > 1 and words[-1] == asked
