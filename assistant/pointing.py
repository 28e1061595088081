"""What a person says of the rows of an answer: not this one, the second one, when was that.

Sayings that no grammar of questions can read, as they mean what stands on the screen. Pure
functions over answers: no store, no clock.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from typing import Literal

from assistant.english import clock, sentence_case, when
from assistant.phrases import (
    definite,
    kind_of,
    left_with,
    newest_of,
    noun_of,
    numbered,
    term_of,
    there_words,
)
from assistant.reply import sentence
from assistant.taught import LAST, ORDINAL, ROW, Row, row_of
from d3a.answer import Answer, RankedKeyframe, is_by_look
from grammar.forms import FormalQuery, ObjectTerm

_LONG = timedelta(minutes=1)
"""A sighting of less is told by its end alone."""
ONE_PLACE_M = 1.0
"""Looks at a thing that are not farther apart are of one place: positions are that uncertain."""
NOTHING_SHOWN = "Ask where it is first: then I know which one you mean."
_THAT = r"(?:this|that|these|those)(?: ones?)?"
_WRONG = re.compile(
    rf"(?:no,? )?(?:(?:it is |it's |that is |that's )?not (?P<a>{_THAT}|it|them|{ROW})"
    r"|(?:it is |it's |that is |that's )?(?:the )?wrong (?:one|thing)|another(?: one)?"
    r"|(?:a|some) different one|(?:it is|it's|that is|that's|these are|those are) not (?:it|them)"
    rf"|(?P<b>{_THAT}|{ROW}) is not (?:it|what i mean|the one(?: i mean)?))"
)
_CHOSEN = re.compile(
    r"(?:and |or |what about |how about |and what about |show me |take |i mean |it is |no,? )*"
    rf"(?P<row>{ROW}|\d{{1,2}}|the {ORDINAL} (?:place|thing|picture|row)|the (?P<step>other|next"
    r"|previous)(?: one)?|next|previous)"
)
_OTHERS = re.compile(
    r"(?:and |or |what about |how about |and what about )*"
    r"(?:(?:is|are|was|were) there |did you see |have you seen |do you see )?"
    r"(?:the others|(?:any |some )?others?|(?:any |some )other ones?|another one|any more"
    r"(?: of (?:them|those))?|what else|(?:any|some)thing else|else|more)"
)
_AGAIN = re.compile(
    r"(?:and )?(?:are you (?:really |quite |so )?(?:sure|certain)(?: about (?:that|it))?|really"
    r"|how (?:sure|certain) are you(?: about (?:that|it))?|how do you know(?: that)?"
    r"|show me (?:the|a|its|that) (?:picture|photo|image|frame)(?: of (?:it|them|that))?)"
)
"""What asks for the row that is told once more, with how sure it is."""
_ASKED = re.compile(
    r"(?:and )?(?P<ask>when|where|at what time|what time|how long ago|in which room|what day)"
    rf" (?:was|is|were|are|did you (?:last )?see|have you seen) (?P<row>{_THAT}|it|they|{ROW})"
    r"(?: seen)?"
)


@dataclass(frozen=True, slots=True)
class NotThis:
    """The row is not what was meant: the next best is wanted."""

    row: Row


@dataclass(frozen=True, slots=True)
class Chosen:
    """Another row is meant. step: so many further things in the list, where no number was said."""

    row: Row
    step: int = 0


@dataclass(frozen=True, slots=True)
class AskedOf:
    """When or where a row's sighting was."""

    ask: Literal["when", "where"]
    row: Row


@dataclass(frozen=True, slots=True)
class Others:
    """Another thing of the list is asked for: any others, what else."""


Pointing = NotThis | Chosen | AskedOf | Others


def read_pointing(text: str) -> Pointing | None:
    """Return what a saying means of the rows shown, None for what is a question of its own."""
    said = " ".join(text.lower().replace("\u2019", "'").split()).rstrip(".!?, ")
    if found := _WRONG.fullmatch(said):
        return NotThis(row_of(found["a"] or found["b"]))
    if found := _CHOSEN.fullmatch(said):
        step = found["step"] or (found["row"] if found["row"] in ("next", "previous") else None)
        if step is not None:
            return Chosen(None, -1 if step == "previous" else 1)
        return Chosen(row_of(found["row"]))
    if _OTHERS.fullmatch(said):
        return Others()
    if _AGAIN.fullmatch(said):
        return Chosen(None)
    if found := _ASKED.fullmatch(said):
        at_place = found["ask"] in ("where", "in which room")
        ask: Literal["when", "where"] = "where" if at_place else "when"
        if ask == "where" and found["row"] in ("it", "they"):
            return None  # the grammar knows what it is
        return AskedOf(ask, row_of(found["row"]))
    return None


def shown(answer: Answer | None) -> tuple[RankedKeyframe, ...]:
    """Return the rows of an answer: its own, else what may be it or is true elsewhere."""
    if answer is None:
        return ()
    return answer.keyframes or answer.instead


def told(answer: Answer) -> RankedKeyframe | None:
    """Return the row that the sentence of an answer tells: what `that` means after it."""
    if answer.keyframes and answer.query is not None and answer.query.ask == "whether":
        return newest_of(answer)
    return next(iter(shown(answer)), None)


def find_row(rows: Sequence[RankedKeyframe], row: Row) -> RankedKeyframe | None:
    """Return the keyframe of a number, None where the list has none such."""
    if row == LAST and rows:
        return rows[-1]
    return next((each for each in rows if each.rank == row), None)


def other_thing(
    rows: Sequence[RankedKeyframe], now_at: RankedKeyframe | None, step: int
) -> RankedKeyframe | None:
    """Return the first row of the next thing in the list, or of the one before."""
    heads = list({each.object_id: each for each in reversed(rows)}.values())[::-1]
    heads.sort(key=lambda each: each.rank)
    ids = [each.object_id for each in heads]
    at = ids.index(now_at.object_id) if now_at and now_at.object_id in ids else -1
    there = at + step
    return heads[there] if 0 <= there < len(heads) else None


def row_words(row: RankedKeyframe, query: FormalQuery | None, *, ask: str, now: datetime) -> str:
    """Return one row as a sentence, as if it alone were the answer."""
    term = term_of_row(row, query)
    base = query or FormalQuery(row.category, "Q1", "where", (term,))
    alone = replace(
        base, ask="where", objects=(term,), relation=None, place=None, outside=False, time=None,
        select="all", negated=False,
    )  # fmt: skip
    if ask == "when":
        there = there_words(row, alone)
        said = f"{sentence_case(when(row.end, now))}{there}."
        if row.end - row.start >= _LONG:
            start, end = (t.astimezone(now.tzinfo) for t in (row.start, row.end))
            thing = definite(term, numbered(alone, term))
            said += f" I had {thing} in view from {clock(start)} to {clock(end)}."
        return said
    answer = Answer(text=alone.text, query=alone, count=1, least=1, keyframes=(row,))
    return sentence(answer, now=now)


def term_of_row(row: RankedKeyframe, query: FormalQuery | None) -> ObjectTerm:
    """Return the question's own words for a row's thing where they are, else the store's."""
    kind = kind_of(row)
    if query is not None:
        for term in query.objects:
            if term.category == kind or noun_of(term) == kind:
                return term
        if len(query.objects) == 1 and row.why.get("match", 0.0) >= 1.0:
            term = term_of(query)
            if term.category != "object":
                return term
    return ObjectTerm(kind, kind)


def narrowed(
    answer: Answer, keep: Callable[[RankedKeyframe], bool], now: datetime, *, nothing: str
) -> Answer:
    """Return the answer of those keyframes alone, its sentence told anew.

    A moment of several things goes whole where one of them goes. nothing: what is said where no
    keyframe is left.
    """
    if answer.query is None or all(map(keep, shown(answer))):
        return answer
    gone = {k.group for k in answer.keyframes if not keep(k) and k.group is not None}
    kept = [k for k in answer.keyframes if keep(k) and k.group not in gone]
    perhaps = tuple(k for k in answer.perhaps if keep(k))
    otherwise = next((k for k in perhaps or answer.instead if keep(k)), None)
    if not kept and otherwise is None:
        return replace(
            answer, status="not_found", answer=nothing, keyframes=(), otherwise=None, perhaps=(),
            count=0, least=0, truncated=False,
        )  # fmt: skip
    fewer = left_with(replace(answer, otherwise=otherwise, perhaps=perhaps), kept)
    return replace(fewer, answer=sentence(fewer, now=now))


def same_place(a: RankedKeyframe, b: RankedKeyframe) -> bool:
    """Whether two looks are of one place; where a position is unknown, whether of one room."""
    if a.position is None or b.position is None:
        return a.place == b.place and a.near == b.near
    apart = sum((p - q) ** 2 for p, q in zip(a.position, b.position, strict=True))
    return apart <= ONE_PLACE_M**2


def of_the_told(answer: Answer | None) -> Answer | None:
    """Return an answer whose query is of the thing told in place of what was asked for.

    After "I saw a bowl, but none that looked blue", `it` is that bowl: not the blue one.
    """
    query, other = (answer.query, answer.otherwise) if answer is not None else (None, None)
    refused = other.why.get("refused") if other is not None else None
    if answer is None or query is None or not refused:
        return None
    term = query.objects[0]
    plain = replace(
        term,
        attributes=tuple(word for word in term.attributes if word not in refused),
        without=tuple(word for word in term.without if f"not {word}" not in refused),
    )
    return replace(answer, query=replace(query, objects=(plain, *query.objects[1:])))


def is_of(row: RankedKeyframe, refused: RankedKeyframe) -> bool:
    """Whether a row shows what was refused: its thing, or of a mere look the same place."""
    if row.object_id != refused.object_id:
        return False
    return not is_by_look(row.object_id) or same_place(row, refused)


def same_row(rows: tuple[RankedKeyframe, ...], row: RankedKeyframe | None) -> RankedKeyframe | None:
    """Return the row that shows what one of an earlier answer showed."""
    if row is None:
        return None
    return next((each for each in rows if (each.frame, each.box) == (row.frame, row.box)), None)
