"""Whether several things were seen, or are somewhere: each is judged, and told, by itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from assistant.amounts import holds
from assistant.english import listed
from assistant.phrases import definite, indefinite, numbered, term_of
from assistant.said import is_one, said_many
from assistant.wording import is_sure
from d3a.answer import Answer
from grammar.forms import FormalQuery, ObjectTerm

_VERDICTS = (
    "Yes. ", "No. ", "Maybe. ", "No, not any more. ", "I cannot be sure. ", "Not all of them. ",
)  # fmt: skip
"""What the answer of one thing begins with: it is told of all of them first."""


def one_by_one(query: FormalQuery) -> list[FormalQuery]:
    """Return the question of each thing by itself, where it is asked whether all were; else none.

    What was denied of them as a whole is told of them as a whole, and of a moment what was seen
    then: of one thing what was seen before and after it would be told.
    """
    plain = query.ask == "whether" and query.relation is None and not query.negated
    plain = plain and not (query.time is not None and query.time.is_point)
    if not plain or len(query.objects) < 2 or query.select == "usual":
        return []
    return [replace(query, objects=(term,)) for term in query.objects]


def told_of_each(query: FormalQuery, answers: Sequence[Answer]) -> Answer:
    """Return one answer of those of each thing, with their sentences: no where one is not so.

    The keyframes of a yes are those of all, the best of each thing first. A no bears what the
    first thing that is not so bears.
    """
    said = _sentence(query, answers)
    failed = next((answer for answer in answers if answer.status != "found"), None)
    if failed is not None:
        return replace(
            failed, text=query.text, query=query, answer=said, elapsed_ms=times_of(answers)
        )
    places = [(n, k) for answer in answers for n, k in enumerate(answer.keyframes)]
    places.sort(key=lambda each: (each[0] > 0, -each[1].score))
    ranked = tuple(replace(k, rank=rank) for rank, (_, k) in enumerate(places, 1))
    return replace(
        answers[0],
        text=query.text,
        query=query,
        answer=said,
        count=len({k.object_id for k in ranked}),
        least=sum(answer.least for answer in answers),
        keyframes=ranked,
        otherwise=next((a.otherwise for a in answers if a.otherwise is not None), None),
        unjudged=tuple(dict.fromkeys(word for a in answers for word in a.unjudged)),
        truncated=any(answer.truncated for answer in answers),
        elapsed_ms=times_of(answers),
    )


def times_of(answers: Sequence[Answer]) -> dict[str, float]:
    """Return what answers took together in ms, by the parts of the work."""
    parts = dict.fromkeys(part for answer in answers for part in answer.elapsed_ms)
    return {part: sum(answer.elapsed_ms.get(part, 0.0) for answer in answers) for part in parts}


def _sentence(query: FormalQuery, answers: Sequence[Answer]) -> str:
    told = [answer.answer for answer in answers]
    if verdict := _verdict(query, answers):
        told = [verdict, *(without_verdict(each) for each in told)]
    return " ".join(told)


def without_verdict(told: str) -> str:
    """Return the sentence of one thing without the word that it begins with."""
    return next((told.removeprefix(word) for word in _VERDICTS if told.startswith(word)), told)


def _verdict(query: FormalQuery, answers: Sequence[Answer]) -> str:
    """Return yes, no, or which of them alone; "" where what is judged is a part of the question."""
    if any(answer.unjudged for answer in answers):
        return ""
    so, two = [is_so(answer) for answer in answers], len(answers) == 2
    if False not in so:
        if None in so:
            return f"I cannot be sure of {'both' if two else 'all of them'}."
        return "Yes, both." if two else "Yes, all of them."
    if None in so:
        return "No, not both." if two else "No, not all of them."
    if True not in so:
        return "No, neither." if two else "No, none of them."
    things = [_thing(query, term) for term, is_so in zip(query.objects, so, strict=True) if is_so]
    return f"No, only {listed(things)}."


def is_so(answer: Answer) -> bool | None:
    """Return whether it is so of one thing; None where that is not sure."""
    if answer.status != "found":
        unsure = answer.perhaps or answer.looked_then is False or answer.status != "not_found"
        return None if unsure else False
    if answer.otherwise is not None or not is_sure(answer.keyframes[0]):
        return None
    asked = answer.query
    is_number = asked is not None and term_of(asked).quantity is not None
    return holds(answer, asked) if asked is not None and is_number else True


def _thing(query: FormalQuery, term: ObjectTerm) -> str:
    alone = replace(query, objects=(term,))
    words = numbered(alone, term)
    many = said_many(alone, term)
    return definite(term, words) if is_one(alone) else indefinite(term, words, many=many)
