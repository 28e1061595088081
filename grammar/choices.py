"""Questions that ask for one thing or another: each of them spelled, in the person's own words."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from grammar.cursor import TIME_GAP, Tag
from grammar.errors import QuestionError
from grammar.forms import FormalQuery
from grammar.suggestions import spelled
from grammar.words import Word

_JOINTS = ("OR", "OR_ITEM")
_NOUN_PHRASE = frozenset(("DET", "OWNER", "ATTR", "NOT_ATTR", "NUMBER", "NOUN", "ONE", "OWNED"))
_LEADS = frozenset(("REL", "AT_PLACE"))
_BEFORE = frozenset(("DET", "OWNER"))
_UNLED = frozenset(("ATTR", "NOT_ATTR", "NOUN"))


def as_one(queries: Sequence[FormalQuery]) -> FormalQuery | None:
    """Return the one query that all are, whatever the word: a cup or a mug; None for several."""
    first, *others = (_by_category(query) for query in queries)
    return first if all(other == first for other in others) else None


def _by_category(query: FormalQuery) -> FormalQuery:
    return replace(query, objects=tuple(replace(t, word=t.category) for t in query.objects))


def choices(
    text: str,
    words: Sequence[Word],
    tags: Sequence[Tag],
    queries: Sequence[FormalQuery],
    again: Callable[[str], FormalQuery],
) -> tuple[str, ...]:
    """Return a question for each query: the text with one thing said, where each reads so.

    A thing that shares the word before the first is offered with it: my cup or bowl, my bowl.
    again: reads another spelling of the text. Else plain questions that mean the queries.
    """
    parts = _parts(text, words, tags)
    start, end = (text[: parts[0][0]], text[parts[-1][1] :]) if parts else ("", "")
    shared = [_shared(text, tags, parts[0], part) for part in parts]
    said = [f"{start}{w}{text[a:b]}{end}" for w, (a, b) in zip(shared, parts, strict=True)]
    shorter = len(said) == len(queries) and all(len(one) < len(text) for one in said)
    if shorter and all(map(partial(_reads_as, again=again), said, queries)):
        return tuple(said)
    return tuple(spelled(query) for query in queries)


def _shared(text: str, tags: Sequence[Tag], first: tuple[int, int], part: tuple[int, int]) -> str:
    """Return the determiner or owner that a part shares with the first; "" where it does not."""
    lead, own = (next(t for t in tags if t.word.start >= start) for start, _ in (first, part))
    # an owner that is not said again stands with its thing
    shared = own.type == "OWNER" and sum(t.word.start == own.word.start for t in tags) > 1
    if lead.type not in _BEFORE or not (shared or own.type in _UNLED):
        return ""
    word = text[lead.word.start : lead.word.end]
    if word.lower() in ("a", "an"):
        word = "an" if text[part[0]].lower() in "aeiou" else "a"
    return f"{word} "


def _reads_as(said: str, query: FormalQuery, again: Callable[[str], FormalQuery]) -> bool:
    try:
        return replace(again(said), text=query.text) == query
    except QuestionError:
        return False


def _parts(text: str, words: Sequence[Word], tags: Sequence[Tag]) -> list[tuple[int, int]]:
    """Return where in the text each of the things stands that `or` joins, or else `and`."""
    at = [i for i, tag in enumerate(tags) if tag.type in _JOINTS] or _first_ands(tags)
    if not at:
        return []
    first, last = _start(tags, at[0]), _end(tags, at[-1])
    cuts = [i for i in range(first, last) if tags[i].type in (*_JOINTS, "AND")]
    starts = [tags[first].word.start, *(tags[i + 1].word.start for i in cuts)]
    ends = [*(tags[i].word.start for i in cuts), _stop(text, words, tags, last)]
    return [
        (a, a + len(text[a:b].rstrip(" ,"))) for a, b in zip(starts, ends, strict=True) if a < b
    ]


def _first_ands(tags: Sequence[Tag]) -> list[int]:
    """Return where the first things that `and` joins are joined: the cup and the bowl on it."""
    at: list[int] = []
    for i, tag in enumerate(tags):
        if tag.type == "AND":
            at.append(i)
        elif at and tag.type not in _NOUN_PHRASE:
            break
    return at


def _start(tags: Sequence[Tag], joint: int) -> int:
    """Return where the first of the joined things begins, its preposition with it where it has."""
    i = joint
    while i > 0 and (tags[i - 1].type in _NOUN_PHRASE or tags[i - 1].type in ("AND", *_JOINTS)):
        i -= 1
    if i > 0 and tags[joint].type == "OR_ITEM" and tags[i - 1].type in _LEADS:
        i -= 1
    return i


def _end(tags: Sequence[Tag], joint: int) -> int:
    """Return the tag after the last of the joined things."""
    i = joint + 1
    if i < len(tags) and tags[i].type in _LEADS:
        i += 1
    while i < len(tags) and tags[i].type in _NOUN_PHRASE:
        i += 1
    return i


def _stop(text: str, words: Sequence[Word], tags: Sequence[Tag], last: int) -> int:
    """Return where the last thing ends: at the next terminal, at a time, or with the text."""
    begun = tags[last - 1].word.start
    following = [tags[last].word.start] if last < len(tags) else []
    gaps = [w.start for w in words if w.text == TIME_GAP]
    later = [start for start in (*following, *gaps) if start > begun]
    return min(later, default=len(text.rstrip(" ?.!")))
