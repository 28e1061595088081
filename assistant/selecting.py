"""What a person means by words, a place or a time on a command line: ids, a room, milliseconds."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import fields
from datetime import datetime
from typing import NamedTuple

from assistant.asking import ask_query, read_question
from assistant.config import SettingsError, moment_of
from assistant.lexicon import VocabularyLexicon
from assistant.phrases import kind_of
from assistant.wording import NOT_SURE
from d3a.answer import RankedKeyframe
from d3a.answering.match import squash
from d3a.model import BadInput
from d3a.plan import Precision
from d3a.store.base import Region, Store
from grammar import parse, vocabulary
from grammar.errors import QuestionError
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm
from grammar.vocabulary.words import singular

MOST = 10_000
_RUNGS: tuple[Precision | None, ...] = ("perfect", "attribute", None)
"""A taught name, else the very category and look, else the kinds of it: of fruit, the apple.

What is only like it, or was called so now and then, is not meant.
"""

_SILENT = frozenset(("the", "a", "an", "all", "every", "each", "any", "of", "my", "your", "s"))
"""Words that say nothing of which things are meant, or only whose, which is a field of the term."""
_WORD = re.compile(r"[^\W_]+")


LOOKS_SO = 0.5
"""A thing is meant by a look that is at least so likely its own, however seldom it was seen."""


class NothingMeant(BadInput):
    """Words, or a place, that name nothing in the store; the message says what there is."""


class Meant(NamedTuple):
    """The ids of what is meant; and, told as "clock o26", what only may look as described."""

    ids: frozenset[str]
    doubtful: tuple[str, ...] = ()


def things_meant(store: Store, words: str, *, now: datetime, elsewhere: str = "") -> Meant:
    """Return the objects that are meant: by an id itself, a taught name, or a description.

    "o12", "keys", "my keys", "the red cup". What is done to them may have no undo, so all of a
    description has to be used: where or when a thing was, how many, or what it is not is refused.
    What an answer would list but not name, as it hardly looks so, is not meant.
    elsewhere: what says that instead. Raises NothingMeant where nothing is meant, BadInput for
    a description that says more than can be used, StoreError where the store fails.
    """
    if store.objects(ids=[words], embeddings=False):
        return Meant(frozenset([words]))
    try:
        query = read_question(store, f"Did you ever see {words}?", now=now)
    except QuestionError as error:
        raise NothingMeant(
            f"{words!r} is no id and no description of a thing; o12 or “the red cup” would do"
        ) from error
    if found := unused(query, words):
        raise BadInput(_refusal(words, f"found {found}", elsewhere))
    for rung in _RUNGS:
        answer = ask_query(store, query, now=now, limit=MOST, precision=rung)
        if answer.status == "error":
            raise BadInput(answer.message or answer.answer)
        keyframes = answer.keyframes if rung else _kinds_of(query.objects[0], answer.keyframes)
        if answer.status == "found" and keyframes:
            meant = clearly_meant(words, keyframes)
            _check_owned(store, words, query.objects[0].owner, meant.ids, named=rung == "perfect")
            if answer.unjudged:
                found = " and ".join(f"“{said}”" for said in answer.unjudged)
                raise BadInput(_refusal(words, f"this store cannot tell what is {found}"))
            return meant
    known = [category for category, _ in store.categories()]
    near = answer.suggestions or VocabularyLexicon().nearest(words, known)
    hint = f"; the nearest that are: {', '.join(near)}" if near else ""
    raise NothingMeant(f"nothing in the store is {words!r}{hint}")


def clearly_meant(words: str, keyframes: Sequence[RankedKeyframe]) -> Meant:
    """Return the things of a list apart by whether they are likely to look as described.

    Raises NothingMeant where none is.
    """
    clear = frozenset(
        each.object_id
        for each in keyframes
        if each.score >= NOT_SURE
        or all(chance >= LOOKS_SO for chance in each.why.get("attributes", {}).values())
    )
    rest = {k.object_id: k.category for k in keyframes if k.object_id not in clear}
    doubtful = tuple(f"{category} {id_}" for id_, category in rest.items())
    if not clear:
        raise NothingMeant(
            f"nothing in the store is surely {words!r}; give the id where one of these is meant: "
            f"{', '.join(doubtful)}"
        )
    return Meant(clear, doubtful)


def _kinds_of(term: ObjectTerm, keyframes: Sequence[RankedKeyframe]) -> list[RankedKeyframe]:
    """Return what is of a kind that the noun covers, by the detector's own word for it."""
    return [k for k in keyframes if term.category in vocabulary.broader(kind_of(k))]


def _refusal(words: str, why: str, elsewhere: str = "") -> str:
    more = f"; {elsewhere}" if elsewhere else ""
    return (
        f"{words!r} is not certain: a thing is meant here by its noun, look, owner or taught name "
        f"alone, and {why}{more}; or give ids from `d3a objects`"
    )


def unused(query: FormalQuery, words: str) -> str:
    """Return what a description says beyond a noun, looks and an owner; "" where nothing.

    A field of the query that is added later is refused until it stands here. What the grammar
    passes over ("the first cup" is any cup) has no field, so each word is accounted for too.
    """
    if not query.objects:
        return "no thing"
    term = query.objects[0]
    if term.category == ANYTHING and term.word != "everything" and not term.attributes:
        return f"“{term.word}”, which is everything"
    plain_term = ObjectTerm(
        category=term.category, word=term.word, attributes=term.attributes, owner=term.owner
    )
    plain = FormalQuery(text=query.text, form="Q1", ask="whether", objects=(plain_term,))
    over = [f"“{each.said}”, read as “{each.taken}”" for each in query.corrections]
    if left := _words_left(plain_term, words):
        over.append(f"“{left}”")
    if not over and query != plain:
        over = [name for name in _differing(query, plain) if name != "objects"]
        over += _differing(term, plain_term) or ["more than one thing"] * (len(query.objects) > 1)
    return ", ".join(over)


def _words_left(term: ObjectTerm, words: str) -> str:
    """Return the words of a description that are in no part of its term, as they were said."""
    said = " ".join((term.category, term.word, *term.attributes, term.owner or "")).lower()
    used = set(_WORD.findall(said))
    spans: list[tuple[int, int]] = []
    goes_on = False
    for each in _WORD.finditer(words):
        word = each[0].lower()
        if word in _SILENT:
            continue
        if word in used or singular(word) in used:
            goes_on = False
            continue
        start = spans.pop()[0] if goes_on else each.start()
        spans.append((start, each.end()))
        goes_on = True
    return "” and “".join(words[start:end] for start, end in spans)


def _differing(one: FormalQuery | ObjectTerm, plain: FormalQuery | ObjectTerm) -> list[str]:
    compared = [field.name for field in fields(one) if field.compare]
    return [name for name in compared if getattr(one, name) != getattr(plain, name)]


def _check_owned(
    store: Store, words: str, owner: str | None, ids: frozenset[str], *, named: bool
) -> None:
    """Refuse an owner that nobody taught of all these things.

    named: the noun itself was taught of them; the person who taught it may call them theirs.
    """
    if owner is None or (named and owner in ("me", "you")):
        return
    for record in store.objects(ids=sorted(ids), embeddings=False):
        if all(name.owner != owner for name in record.names):
            raise BadInput(
                _refusal(words, "nobody taught which thing is so owned (d3a teach does)")
            )


def place_meant(store: Store, name: str) -> Region:
    """Return the room of that name; raises NothingMeant, with the rooms that there are."""
    rooms = store.regions()
    found = next((room for room in rooms if squash(room.name) == squash(name)), None)
    if found is None:
        known = f"there are: {', '.join(room.name for room in rooms)}" if rooms else "it has none"
        raise NothingMeant(f"the store has no place {name!r}; {known}")
    return found


def start_meant(text: str, now: datetime) -> int:
    """Return where a time begins, UTC milliseconds: ISO, or words ("last Monday")."""
    return _moment(text, f"What did you see since {text}?", "start", now)


def end_meant(text: str, now: datetime) -> int:
    """Return what "before" a time ends at, UTC milliseconds: ISO, or words ("yesterday")."""
    return _moment(text, f"What did you see before {text}?", "end", now)


def _moment(text: str, question: str, end: str, now: datetime) -> int:
    try:
        moment: datetime | None = moment_of(text, now.tzinfo)
    except SettingsError:
        moment = _spoken(question, end, now)
    if moment is None:
        raise BadInput(
            f"{text!r} is not a time; write it like 2020-02-25T19:00, or as one says it: yesterday"
        )
    return round(moment.timestamp() * 1000)


def _spoken(question: str, end: str, now: datetime) -> datetime | None:
    try:
        time = parse(question, now=now).time
    except QuestionError:
        return None
    moment: datetime | None = None if time is None else getattr(time, end)
    return moment
