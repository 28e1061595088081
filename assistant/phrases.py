"""Parts of a reply: what was asked for, what was found, where, as noun phrases."""

from __future__ import annotations

from datetime import datetime

from assistant.english import article, clock, day_of, listed, sentence_case
from d3a.answer import Answer, RankedKeyframe
from d3a.colours import is_colour
from grammar import vocabulary
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm

_RELATIONS = {
    "together": "with",
    "near": "next to",
    "in_front_of": "in front of",
    "left_of": "left of",
    "right_of": "right of",
    "same_place": "in the same place as",
}
_SCORE_OF_WORD = 0.86
"""Below this the word was a wider or narrower one: the answer says what was found instead."""


def term_of(query: FormalQuery) -> ObjectTerm:
    """Return the first object of a query; anything at all where it names none."""
    return query.objects[0] if query.objects else ObjectTerm(ANYTHING)


def noun_of(term: ObjectTerm) -> str:
    """Return the noun as said; "thing" for anything at all."""
    return "thing" if term.category == ANYTHING else term.word


def described(term: ObjectTerm, unjudged: tuple[str, ...] = (), *, noun: str | None = None) -> str:
    """Return noun and attributes, without those that nobody judged: "orange bowl"."""
    left_out = {word for phrase in unjudged for word in (phrase, *phrase.split())}
    words = [word for word in term.attributes if word not in left_out]
    for i in range(len(words) - 1, 0, -1):
        if is_colour(words[i - 1]) and is_colour(words[i]):
            words.insert(i, "and")
    said = " ".join([*words, noun or noun_of(term)])
    without = [word for word in term.without if f"not {word}" not in unjudged]
    return f"{said} that is not {listed(without)}" if without else said


def definite(term: ObjectTerm, words: str) -> str:
    """Return the words with the owner or "the": "your keys", "Anna's keys", "the cup"."""
    if term.owner in ("me", "you"):
        return f"{'your' if term.owner == 'me' else 'my'} {words}"
    return f"{sentence_case(term.owner)}'s {words}" if term.owner else f"the {words}"


def indefinite(term: ObjectTerm, words: str) -> str:
    """Return the words with the owner or an article: "your keys", "an orange bowl"."""
    return definite(term, words) if term.owner else article(words)


def found_words(answer: Answer, query: FormalQuery) -> str:
    """Return what was found, as found: a wider or narrower word is said as the store has it."""
    term, best = term_of(query), answer.keyframes[0] if answer.keyframes else None
    match = best.why.get("match", 1.0) if best else 1.0
    if best is None or (term.category != ANYTHING and match >= _SCORE_OF_WORD):
        return described(term, answer.unjudged)
    if term.category != ANYTHING and vocabulary.canonical(best.category) == term.category:
        return described(term, answer.unjudged)
    return described(term, answer.unjudged, noun=vocabulary.canonical(best.category))


def condition_words(answer: Answer, query: FormalQuery) -> str:
    """Return relation and place of the question, as far as they were judged: " on the table"."""
    words = ""
    if query.relation is not None and len(query.objects) > 1:
        kind = _RELATIONS.get(query.relation.kind, query.relation.kind)
        grounds = query.objects[1:]
        said = listed([definite(term, described(term, answer.unjudged)) for term in grounds])
        plain = f"the {described(grounds[-1])}"
        if not any(condition.endswith(plain) for condition in answer.unjudged):
            absent = query.negated and query.ask != "whether"
            words += f" {'not ' if absent else ''}{kind} {said}"
    if query.place is not None and f"in the {query.place}" not in answer.unjudged:
        absent = query.negated and query.relation is None and query.ask != "whether"
        words += f" {'not ' if absent else ''}in the {query.place}"
    return words


def where_words(keyframe: RankedKeyframe) -> str:
    """Return where a keyframe's object was: room and landmark, else the map; "" if unknown."""
    parts = []
    if keyframe.place:
        parts.append(f"in the {keyframe.place}")
    if keyframe.near:
        parts.append(f"next to the {keyframe.near}")
    if not parts and keyframe.position is not None:
        x, y, _ = keyframe.position
        return f"at {x:.1f}, {y:.1f} metres on the map"
    return ", ".join(parts)


def heads_of(answer: Answer) -> list[RankedKeyframe]:
    """Return the first keyframe of each moment."""
    seen: set[int] = set()
    heads: list[RankedKeyframe] = []
    for keyframe in answer.keyframes:
        if keyframe.group is None or keyframe.group not in seen:
            heads.append(keyframe)
        if keyframe.group is not None:
            seen.add(keyframe.group)
    return heads


def places_of(heads: list[RankedKeyframe]) -> int:
    """Return at how many places the keyframes show their objects."""
    return len({(k.object_id, k.position) for k in heads})


def newest_of(answer: Answer) -> RankedKeyframe:
    """Return the keyframe that was seen last, the better ranked of two."""
    return max(heads_of(answer), key=lambda k: (k.end, -k.rank))


def gone_words(keyframe: RankedKeyframe, now: datetime) -> str:
    """Return that the place was empty later, "" where nobody looked or it was still there."""
    absent = keyframe.last_absent
    if absent is None:
        return ""
    local = absent.astimezone(now.tzinfo)
    return f"When I looked there again {day_of(local, now)} at {clock(local)}, it was gone."
