"""The sentence of an answer: by template from the record, and nothing that is not in it.

Place first, then clock and how long ago, then how sure. The robot says "I last saw", never "it
is". The same question gets the same words each time.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from datetime import datetime

from assistant.english import (
    article,
    clock,
    counted,
    day_of,
    duration,
    is_many,
    listed,
    plural,
    sentence_case,
    slice_words,
    times,
    when,
)
from assistant.wording import how_sure
from d3a.answer import Answer, RankedKeyframe
from d3a.colours import is_colour
from grammar import vocabulary
from grammar.forms import ANYTHING, Ask, FormalQuery, ObjectTerm

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


def sentence(answer: Answer, *, now: datetime) -> str:
    """Return one to three plain sentences for an answer that has its query.

    now: aware, its zone is that of the times said.
    """
    if answer.query is None:
        return answer.answer or answer.message or ""
    if answer.status != "found":
        parts = [_refusal(answer, answer.query, now)]
    else:
        parts = [_ASKED[answer.query.ask](answer, answer.query, now)]
        parts.append(_sureness(answer, answer.query))
    if answer.unjudged:
        parts.append(_unjudged(answer))
    return " ".join(part for part in parts if part)


def _term(query: FormalQuery) -> ObjectTerm:
    return query.objects[0] if query.objects else ObjectTerm(ANYTHING)


def noun_of(term: ObjectTerm) -> str:
    """Return the noun as said; "thing" for anything at all."""
    return "thing" if term.category == ANYTHING else term.word


def described(term: ObjectTerm, unjudged: tuple[str, ...] = (), *, noun: str | None = None) -> str:
    """Return noun and attributes, without those that nobody judged: "orange bowl"."""
    words = [word for word in term.attributes if word not in unjudged]
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


def _found_words(answer: Answer, query: FormalQuery) -> str:
    """Return what was found, as found: a wider or narrower word is said as the store has it."""
    term, best = _term(query), answer.keyframes[0] if answer.keyframes else None
    match = best.why.get("match", 1.0) if best else 1.0
    if best is None or (term.category != ANYTHING and match >= _SCORE_OF_WORD):
        return described(term, answer.unjudged)
    if term.category != ANYTHING and vocabulary.canonical(best.category) == term.category:
        return described(term, answer.unjudged)
    return described(term, answer.unjudged, noun=vocabulary.canonical(best.category))


def _condition(answer: Answer, query: FormalQuery) -> str:
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


def _heads(answer: Answer) -> list[RankedKeyframe]:
    """Return the first keyframe of each moment."""
    seen: set[int] = set()
    heads: list[RankedKeyframe] = []
    for keyframe in answer.keyframes:
        if keyframe.group is None or keyframe.group not in seen:
            heads.append(keyframe)
        if keyframe.group is not None:
            seen.add(keyframe.group)
    return heads


def _places(heads: list[RankedKeyframe]) -> int:
    return len({(k.object_id, k.position) for k in heads})


def _newest(answer: Answer) -> RankedKeyframe:
    return max(_heads(answer), key=lambda k: (k.end, -k.rank))


def _since(keyframe: RankedKeyframe, now: datetime) -> str:
    """Return that the place was empty later, "" where nobody looked or it was still there."""
    absent = keyframe.last_absent
    if absent is None:
        return ""
    local = absent.astimezone(now.tzinfo)
    return f"When I looked there again {day_of(local, now)} at {clock(local)}, it was gone."


def _is_open(query: FormalQuery) -> bool:
    """Whether the kinds found are news: anything was asked for, or several things at once."""
    several = query.relation is None and len(query.objects) > 1
    return several or _term(query).category == ANYTHING


def _whether(answer: Answer, query: FormalQuery, now: datetime) -> str:
    if _is_open(query):
        return f"{'No, there was:' if query.negated else 'Yes.'} {_what(answer, query, now)}"
    words, condition = _found_words(answer, query), _condition(answer, query)
    thing = indefinite(_term(query), words)
    heads, newest = _heads(answer), _newest(answer)
    quantity = _term(query).quantity
    if quantity is not None and answer.count < quantity:
        only = counted(answer.count, words)
        return f"No. I saw only {only}{condition}, last {when(newest.end, now)}."
    opening = "No, there was:" if query.negated else "Yes."
    if quantity is not None:
        thing = counted(answer.count, words)
    where = where_words(newest)
    where = f", {where}" if where else ""
    said = when(newest.end, now)
    if len(heads) == 1:
        told = f"{opening} I saw {thing}{condition} {said}{where}."
    else:
        number = _places(heads)
        spread = "one place" if number == 1 else f"{number} places"
        more = f"{times(len(heads))}{' or more' if answer.truncated else ''}"
        told = f"{opening} I saw {thing}{condition} {more} in {spread}, last {said}{where}."
    return f"{told} {_since(newest, now)}".strip()


def _where(answer: Answer, query: FormalQuery, now: datetime) -> str:
    term, best = _term(query), answer.keyframes[0]
    if query.select == "usual":
        return _usual(answer, query)
    words = f"{definite(term, _found_words(answer, query))}{_condition(answer, query)}"
    where, last = where_words(best), "last " if query.select == "last" else ""
    first = "first " if query.select == "first" else ""
    gone = _since(best, now) if query.select == "last" else ""
    if "same" in best.why:  # the detector had another word for it there
        words += f" (or {article(vocabulary.canonical(best.category))} like it)"
    if not where:
        told = f"I {last}{first}saw {words} {when(best.end, now)}, but I do not know the place."
    else:
        told = f"{sentence_case(where)}. I {last}{first}saw {words} there {when(best.end, now)}."
    others = _places(_heads(answer)) - 1
    if others and query.select == "all":
        told += f" I also saw {'one' if others == 1 else 'such things'} in "
        told += f"{counted(others, 'other place')}."
    return f"{gone} {told}".strip()


def _usual(answer: Answer, query: FormalQuery) -> str:
    term = _term(query)
    spots = []
    best = answer.keyframes[0].object_id
    for keyframe in [k for k in _heads(answer) if k.object_id == best][:3]:
        share = round(100 * keyframe.why.get("share", 1.0))
        spots.append(f"{where_words(keyframe) or 'a place I cannot name'} ({share} %)")
    thing = definite(term, _found_words(answer, query))
    return f"Most of the time I saw {thing} {listed(spots)}."


def _when(answer: Answer, query: FormalQuery, now: datetime) -> str:
    thing = definite(_term(query), _found_words(answer, query)) + _condition(answer, query)
    heads, best = _heads(answer), answer.keyframes[0]
    where = where_words(best)
    there = f", {where}" if where else ""
    if query.select in ("last", "first"):
        moment = best.end if query.select == "last" else best.start
        told = f"{sentence_case(when(moment, now))}{there}. "
        told += f"That is when I {query.select} saw {thing}."
        return f"{told} {_since(best, now) if query.select == 'last' else ''}".strip()
    if len(heads) == 1:
        return f"{sentence_case(when(best.end, now))}{there}. I saw {thing} once."
    first = min(heads, key=lambda k: (k.start, k.rank)).start.astimezone(now.tzinfo)
    more = f"{times(len(heads))}{' or more' if answer.truncated else ''}"
    newest = when(_newest(answer).end, now)
    opening = f"I saw {thing} {more}"
    return f"{opening}, first {day_of(first, now)} at {clock(first)} and last {newest}."


def _what(answer: Answer, query: FormalQuery, now: datetime) -> str:
    seen = {k.object_id: vocabulary.canonical(k.category) for k in _heads(answer)}
    kinds = Counter(seen.values())
    things = [article(kind) if n == 1 else counted(n, kind) for kind, n in kinds.most_common(8)]
    if len(kinds) > len(things):
        things.append("other things")
    newest = _newest(answer)
    return f"I saw {listed(things)}{_condition(answer, query)}, last {when(newest.end, now)}."


def _count(answer: Answer, query: FormalQuery, now: datetime) -> str:
    words = described(_term(query), answer.unjudged)
    said = sentence_case(counted(answer.count, words))
    newest = _newest(answer)
    once = sum(1 for k in _heads(answer) if "tentative" in k.why)
    unsure = f" {sentence_case(counted(once, words))} of them I saw only once." if once else ""
    unsure = unsure if 0 < once < answer.count else ""
    return f"{said}{_condition(answer, query)}, last seen {when(newest.end, now)}.{unsure}"


def _how_long(answer: Answer, query: FormalQuery, now: datetime) -> str:
    thing = definite(_term(query), _found_words(answer, query)) + _condition(answer, query)
    seconds = answer.value or 0.0
    if seconds < 1:
        return f"I saw {thing} only in passing, {when(_newest(answer).end, now)}."
    last = when(_newest(answer).end, now)
    return f"About {duration(seconds)}: that is how long I saw {thing}, last {last}."


def _how_often(answer: Answer, query: FormalQuery, now: datetime) -> str:
    thing = definite(_term(query), _found_words(answer, query)) + _condition(answer, query)
    number = round(answer.value or 0)
    return f"{sentence_case(times(number))}. I last saw {thing} {when(_newest(answer).end, now)}."


def _moved(answer: Answer, query: FormalQuery, now: datetime) -> str:
    told = []
    for keyframe in _heads(answer)[:3]:
        where = where_words(keyframe) or "to a place I cannot name"
        kind = vocabulary.canonical(keyframe.category)
        told.append(f"the {kind}, seen {where} {when(keyframe.start, now)}")
    number = counted(answer.count, "thing")
    return f"{sentence_case(number)} moved: {listed(told)}."


def _missing(answer: Answer, query: FormalQuery, now: datetime) -> str:
    told = []
    for keyframe in _heads(answer)[:3]:
        kind = vocabulary.canonical(keyframe.category)
        where = where_words(keyframe)
        told.append(f"the {kind}, last seen {where} {when(keyframe.end, now)}".replace("  ", " "))
    number = counted(answer.count, "thing")
    verb = "is" if answer.count == 1 else "are"
    return f"{sentence_case(number)} {verb} no longer in place: {listed(told)}."


def _sureness(answer: Answer, query: FormalQuery) -> str:
    """Return how sure the best keyframe is, in words with the reason."""
    best, quantity = answer.keyframes[0], _term(query).quantity
    if query.ask not in ("whether", "where", "when") or query.select == "usual":
        return ""
    if _is_open(query) or (quantity is not None and answer.count < quantity):
        return ""
    views = int(best.why.get("views", best.seen))
    band = how_sure(best)
    said = "This is a guess" if band == "a guess" else f"I am {band}"
    rivals = [k for k in _heads(answer)[1:] if k.object_id != best.object_id]
    close = [k for k in rivals if k.score >= 0.8 * best.score]
    if query.ask == "where" and close:
        return f"{said}: {counted(len({k.object_id for k in close}), 'thing')} more may be meant."
    return f"{said}: seen {times(views)}."


def _unjudged(answer: Answer) -> str:
    """Return what this memory cannot tell of the question."""
    return f"I cannot tell what is {listed([f'“{words}”' for words in answer.unjudged])} here."


def _refusal(answer: Answer, query: FormalQuery, now: datetime) -> str:
    term = _refused_term(answer, query)
    words = described(term, answer.unjudged)
    opening = "That is right: " if query.negated and query.ask == "whether" else ""
    if answer.reason == "empty":
        return "My memory is empty: nothing was stored yet."
    if answer.status == "unknown_object":
        return opening + _unknown(answer, term)
    none = "anything" if term.category == ANYTHING else indefinite(term, words)
    condition = _condition(answer, query)
    told = f"{opening}I never saw {none}{condition}."
    time = f" {slice_words(query.time, now)}" if query.time else ""
    if query.ask in ("moved", "missing"):
        verb = "moved" if query.ask == "moved" else "is missing"
        told = f"As far as I saw, nothing {verb}{time}."
    elif answer.reason in ("not_then", "not_there"):
        place = condition if answer.reason == "not_there" else ""
        told = f"{opening}I did not see {none}{place}{time}."
    elif answer.reason == "gone":
        told = f"{opening}I looked again and {definite(term, words)} was gone."
    if answer.otherwise is not None:
        told += f" {_instead(answer.otherwise, answer, query, now)}"
    elif answer.last_looked is not None:
        there = f"in the {query.place} " if query.place and not answer.unjudged else ""
        told += f" I last looked {there}{when(answer.last_looked, now)}."
    return sentence_case(told)


def _instead(other: RankedKeyframe, answer: Answer, query: FormalQuery, now: datetime) -> str:
    where = where_words(other)
    there = f", {where}" if where else ""
    if _refused_term(answer, query) != _term(query) and answer.reason == "never":
        kind = article(vocabulary.canonical(other.category))
        return f"I did see {kind} {when(other.end, now)}{there}."
    pronoun = "some" if is_many(_term(query).word) else "one"
    opening = "I saw" if answer.reason == "not_then" else "I last saw"
    return f"{opening} {pronoun} {when(other.end, now)}{there}."


def _unknown(answer: Answer, term: ObjectTerm) -> str:
    word = noun_of(term)
    if answer.reason == "not_recognisable":
        told = f"I cannot recognise {plural(word)}: the detector of this memory has no such word."
    else:
        told = f"I never saw {article(word)}, and my memory has no such word."
    known = [plural(vocabulary.canonical(word)) for word in answer.suggestions]
    return f"{told} I know {listed(known)}." if known else told


def _refused_term(answer: Answer, query: FormalQuery) -> ObjectTerm:
    """Return the object that a no is about: the message quotes it where it is not the first."""
    message = answer.message or ""
    quoted = (t for t in query.objects if f"“{' '.join((*t.attributes, t.word))}”" in message)
    return next(quoted, _term(query))


_ASKED: dict[Ask, Callable[[Answer, FormalQuery, datetime], str]] = {
    "whether": _whether,
    "where": _where,
    "when": _when,
    "what": _what,
    "count": _count,
    "how_long": _how_long,
    "how_often": _how_often,
    "moved": _moved,
    "missing": _missing,
}
