"""What is told room by room: "how many cups are in each room", "where is everything"."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from assistant.counting import amount_of
from assistant.english import article, counted, listed, sentence_case
from assistant.phrases import at_place, described, heads_of, is_room, kind_of, term_of
from assistant.several import times_of
from d3a.answer import Answer, RankedKeyframe
from d3a.answering.points import asks_where_all_is
from d3a.store.base import Region
from grammar.forms import FormalQuery

_EACH = re.compile(r"\b(each|every|all( of)?( the)?)\s+rooms?\b")
EVERYTHING = 1000
"""Of so many things at most it is told where each is."""


def in_each_room(query: FormalQuery, regions: Sequence[Region]) -> list[FormalQuery]:
    """Return the question of each room by itself, where each is asked for; else none."""
    relation = query.relation
    if relation is None or relation.kind != "in" or len(query.objects) != 2:
        return []
    if query.ask not in ("count", "what", "whether"):
        return []
    if query.objects[1].word != "room" or not _EACH.search(query.text.casefold()):
        return []
    plain = replace(query, form="Q3", objects=query.objects[:1], relation=None)
    rooms = sorted((r.name for r in regions if is_room(r.name)), key=str.casefold)
    return [replace(plain, place=name) for name in rooms]


def told_by_room(query: FormalQuery, answers: Sequence[Answer]) -> Answer:
    """Return one answer of those of each room: their keyframes by score, and a sentence of all."""
    keyframes = sorted(
        (k for answer in answers for k in answer.keyframes), key=lambda k: (-k.score, k.start)
    )
    ranked = tuple(replace(k, rank=rank) for rank, k in enumerate(keyframes, 1))
    found = [answer for answer in answers if answer.status == "found"]
    whole = sum(answer.value or 0.0 for answer in answers)
    first = (found or answers)[0]
    return replace(
        first,
        text=query.text,
        query=query,
        answer=_sentence(query, answers),
        count=len({k.object_id for k in ranked}),
        value=whole if query.ask == "count" and found else None,
        keyframes=ranked,
        otherwise=None,
        truncated=any(answer.truncated for answer in answers),
        elapsed_ms=times_of(answers),
    )


def _sentence(query: FormalQuery, answers: Sequence[Answer]) -> str:
    told = [(answer.query.place or "", _of_room(answer)) for answer in answers if answer.query]
    said = [(at_place(place), words) for place, words in told if words]
    none = [at_place(place) for place, words in told if not words]
    parts = [("No." if none else "Yes.")] if query.ask == "whether" else []
    if said:
        (first, words), *others = said
        rest = "".join(f"; {spot} {its}" for spot, its in others)
        parts.append(f"{sentence_case(first)} I saw {words}{rest}.")
    if none:
        parts.append(f"I saw {counted(0, described(term_of(query)))} {listed(none)}.")
    return " ".join(parts)


def _of_room(answer: Answer) -> str:
    """Return what was seen in one room, "" for nothing."""
    if answer.status != "found" or answer.query is None:
        return ""
    if answer.query.ask == "count":
        words = described(term_of(answer.query), answer.unjudged)
        return amount_of(answer.least, answer.count, words)
    return _kinds(heads_of(answer))


def everything_words(answer: Answer, query: FormalQuery) -> str:
    """Return where everything is, place by place; "" where that was not asked."""
    if answer.status != "found" or not asks_where_all_is(query) or answer.unjudged:
        return ""
    heads = heads_of(answer)
    sure = [k for k in heads if "tentative" not in k.why] or heads
    of: dict[tuple[bool, str], list[RankedKeyframe]] = {}  # rooms first
    for keyframe in sure:
        of.setdefault((not keyframe.place, _spot(keyframe)), []).append(keyframe)
    told = [f"{sentence_case(spot)}: {_kinds(its)}." for (_, spot), its in sorted(of.items())]
    if left := len(heads) - len(sure):
        told.append(f"{sentence_case(counted(left, 'more thing'))} I saw only once.")
    return " ".join(told)


def _spot(keyframe: RankedKeyframe) -> str:
    if keyframe.place:
        return at_place(keyframe.place)
    beside = keyframe.near or (keyframe.beyond[0] if keyframe.beyond is not None else None)
    return f"by the {beside}" if beside else "at places that have no name"


def _kinds(keyframes: Sequence[RankedKeyframe]) -> str:
    """Return the things of keyframes by their kinds: "two cups, a bowl and a kettle"."""
    kinds = Counter({k.object_id: kind_of(k) for k in keyframes}.values())
    return listed([article(k) if n == 1 else counted(n, k) for k, n in kinds.most_common()])
