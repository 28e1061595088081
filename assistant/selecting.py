"""What a person means by words, a place or a time on a command line: ids, a room, milliseconds."""

from __future__ import annotations

from datetime import datetime

from assistant.asking import ask_query, read_question
from assistant.config import SettingsError, moment_of
from assistant.lexicon import VocabularyLexicon
from d3a.answering.match import squash
from d3a.model import BadInput
from d3a.plan import Precision
from d3a.store.base import Region, Store
from grammar import parse
from grammar.errors import QuestionError

MOST = 10_000
_RUNGS: tuple[Precision, ...] = ("perfect", "attribute")
"""A taught name, else the very category and look: what is only like it is not meant."""


class NothingMeant(BadInput):
    """Words, or a place, that name nothing in the store; the message says what there is."""


def things_meant(store: Store, words: str, *, now: datetime) -> frozenset[str]:
    """Return the ids of the objects that are meant: an id itself, a taught name, or a description.

    "o12", "keys", "my keys", "the red cup in the kitchen". Raises NothingMeant where nothing is,
    StoreError where the store fails.
    """
    if store.objects(ids=[words], embeddings=False):
        return frozenset([words])
    try:
        query = read_question(store, f"Did you ever see {words}?", now=now)
    except QuestionError as error:
        raise NothingMeant(
            f"{words!r} is no id and no description of a thing; o12 or “the red cup” would do"
        ) from error
    for rung in _RUNGS:
        answer = ask_query(store, query, now=now, limit=MOST, precision=rung)
        if answer.status == "error":
            raise BadInput(answer.message or answer.answer)
        if answer.status == "found":
            return frozenset(keyframe.object_id for keyframe in answer.keyframes)
    known = [category for category, _ in store.categories()]
    near = answer.suggestions or VocabularyLexicon().nearest(words, known)
    hint = f"; the nearest that are: {', '.join(near)}" if near else ""
    raise NothingMeant(f"nothing in the store is {words!r}{hint}")


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
