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
from assistant.phrases import (
    condition_words,
    definite,
    described,
    found_words,
    gone_words,
    heads_of,
    indefinite,
    newest_of,
    noun_of,
    places_of,
    term_of,
    where_words,
)
from assistant.wording import how_sure
from d3a.answer import Answer, RankedKeyframe
from d3a.colours import is_colour
from grammar import vocabulary
from grammar.forms import ANYTHING, Ask, FormalQuery, ObjectTerm, TimeSlice


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


def _is_open(query: FormalQuery) -> bool:
    """Whether the kinds found are news: anything was asked for, or several things at once."""
    several = query.relation is None and len(query.objects) > 1
    return several or term_of(query).category == ANYTHING


def _whether(answer: Answer, query: FormalQuery, now: datetime) -> str:
    if _is_open(query):
        return f"{'No, there was:' if query.negated else 'Yes.'} {_what(answer, query, now)}"
    words, condition = found_words(answer, query), condition_words(answer, query)
    thing = indefinite(term_of(query), words)
    heads, newest = heads_of(answer), newest_of(answer)
    quantity = term_of(query).quantity
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
        number = places_of(heads)
        spread = counted(number, "place")
        more = f"{times(len(heads))}{' or more' if answer.truncated else ''}"
        told = f"{opening} I saw {thing}{condition} {more} in {spread}, last {said}{where}."
    return f"{told} {gone_words(newest, now)}".strip()


def _where(answer: Answer, query: FormalQuery, now: datetime) -> str:
    term, best = term_of(query), answer.keyframes[0]
    if query.select == "usual":
        return _usual(answer, query)
    if query.time is not None and query.time.is_point and query.time.start is not None:
        return _where_then(answer, query, query.time.start, now)
    if query.relation is None and len(query.objects) > 1:
        return _where_each(answer, query, now)
    words = f"{definite(term, found_words(answer, query))}{condition_words(answer, query)}"
    where, last = where_words(best), "last " if query.select == "last" else ""
    first = "first " if query.select == "first" else ""
    gone = gone_words(best, now) if query.select == "last" else ""
    if "same" in best.why:  # the detector had another word for it there
        words += f" (or {article(vocabulary.canonical(best.category))} like it)"
    if not where:
        told = f"I {last}{first}saw {words} {when(best.end, now)}, but I do not know the place."
    else:
        told = f"{sentence_case(where)}. I {last}{first}saw {words} there {when(best.end, now)}."
    others = places_of(heads_of(answer)) - 1
    if others and query.select == "all":
        told += f" I also saw {'one' if others == 1 else 'such things'} in "
        told += f"{counted(others, 'other place')}."
    return f"{gone} {told}".strip()


def _where_then(answer: Answer, query: FormalQuery, at: datetime, now: datetime) -> str:
    """Return what was true at a moment: the sighting before it, and the one after it."""
    thing = definite(term_of(query), found_words(answer, query))
    heads = heads_of(answer)
    told = []
    before = next((k for k in heads if k.start <= at), None)
    after = next((k for k in heads if k.start > at), None)
    if before is not None:
        where = sentence_case(where_words(before) or "at a place I cannot name")
        if before.end >= at:
            return f"{where}. I was seeing {thing} there {slice_words(TimeSlice(at, at), now)}."
        told.append(f"{where}. I had last seen {thing} there {when(before.end, now)}.")
    if after is not None:
        where = where_words(after)
        there = f", {where}" if where else ""
        thing = "it" if before is not None else thing
        told.append(f"I saw {thing} next {when(after.start, now)}{there}.")
    return " ".join(told)


def _where_each(answer: Answer, query: FormalQuery, now: datetime) -> str:
    """Return a sentence for each of several objects, the unseen ones too."""
    told = []
    for term in query.objects:
        best = next((k for k in answer.keyframes if _is_of(k, term)), None)
        words = described(term, answer.unjudged)
        if best is None:
            told.append(f"I found no {words}.")
            continue
        where = where_words(best)
        there = f", {where}" if where else ""
        last = "last " if query.select == "last" else ""
        told.append(f"I {last}saw {definite(term, words)} {when(best.end, now)}{there}.")
    return " ".join(told)


def _is_of(keyframe: RankedKeyframe, term: ObjectTerm) -> bool:
    judged = keyframe.why.get("attributes", {})
    same = vocabulary.canonical(keyframe.category) == term.category
    return same and all(word in judged for word in term.attributes if is_colour(word))


def _usual(answer: Answer, query: FormalQuery) -> str:
    term = term_of(query)
    spots = []
    best = answer.keyframes[0].object_id
    for keyframe in [k for k in heads_of(answer) if k.object_id == best][:3]:
        share = round(100 * keyframe.why.get("share", 1.0))
        spots.append(f"{where_words(keyframe) or 'a place I cannot name'} ({share} %)")
    thing = definite(term, found_words(answer, query))
    return f"Most of the time I saw {thing} {listed(spots)}."


def _when(answer: Answer, query: FormalQuery, now: datetime) -> str:
    thing = definite(term_of(query), found_words(answer, query)) + condition_words(answer, query)
    heads, best = heads_of(answer), answer.keyframes[0]
    where = where_words(best)
    there = f", {where}" if where else ""
    if query.select in ("last", "first"):
        moment = best.end if query.select == "last" else best.start
        told = f"{sentence_case(when(moment, now))}{there}. "
        told += f"That is when I {query.select} saw {thing}."
        return f"{told} {gone_words(best, now) if query.select == 'last' else ''}".strip()
    if len(heads) == 1:
        return f"{sentence_case(when(best.end, now))}{there}. I saw {thing} once."
    first = min(heads, key=lambda k: (k.start, k.rank)).start.astimezone(now.tzinfo)
    more = f"{times(len(heads))}{' or more' if answer.truncated else ''}"
    newest = when(newest_of(answer).end, now)
    opening = f"I saw {thing} {more}"
    return f"{opening}, first {day_of(first, now)} at {clock(first)} and last {newest}."


def _what(answer: Answer, query: FormalQuery, now: datetime) -> str:
    seen = {k.object_id: vocabulary.canonical(k.category) for k in heads_of(answer)}
    kinds = Counter(seen.values())
    things = [article(kind) if n == 1 else counted(n, kind) for kind, n in kinds.most_common(8)]
    if len(kinds) > len(things):
        things.append("other things")
    newest = newest_of(answer)
    return f"I saw {listed(things)}{condition_words(answer, query)}, last {when(newest.end, now)}."


def _count(answer: Answer, query: FormalQuery, now: datetime) -> str:
    words = described(term_of(query), answer.unjudged)
    said = sentence_case(counted(answer.count, words))
    newest = newest_of(answer)
    once = sum(1 for k in heads_of(answer) if "tentative" in k.why)
    unsure = f" {sentence_case(counted(once, words))} of them I saw only once." if once else ""
    unsure = unsure if 0 < once < answer.count else ""
    return f"{said}{condition_words(answer, query)}, last seen {when(newest.end, now)}.{unsure}"


def _how_long(answer: Answer, query: FormalQuery, now: datetime) -> str:
    thing = definite(term_of(query), found_words(answer, query)) + condition_words(answer, query)
    seconds = answer.value or 0.0
    if seconds < 1:
        return f"I saw {thing} only in passing, {when(newest_of(answer).end, now)}."
    last = when(newest_of(answer).end, now)
    return f"About {duration(seconds)}: that is how long I saw {thing}, last {last}."


def _how_often(answer: Answer, query: FormalQuery, now: datetime) -> str:
    thing = definite(term_of(query), found_words(answer, query)) + condition_words(answer, query)
    number = round(answer.value or 0)
    return f"{sentence_case(times(number))}. I last saw {thing} {when(newest_of(answer).end, now)}."


def _moved(answer: Answer, query: FormalQuery, now: datetime) -> str:
    told = []
    for keyframe in heads_of(answer)[:3]:
        where = where_words(keyframe) or "to a place I cannot name"
        kind = vocabulary.canonical(keyframe.category)
        told.append(f"the {kind}, seen {where} {when(keyframe.start, now)}")
    number = counted(answer.count, "thing")
    return f"{sentence_case(number)} moved: {listed(told)}."


def _missing(answer: Answer, query: FormalQuery, now: datetime) -> str:
    told = []
    for keyframe in heads_of(answer)[:3]:
        kind = vocabulary.canonical(keyframe.category)
        where = where_words(keyframe)
        told.append(f"the {kind}, last seen {where} {when(keyframe.end, now)}".replace("  ", " "))
    number = counted(answer.count, "thing")
    verb = "is" if answer.count == 1 else "are"
    return f"{sentence_case(number)} {verb} no longer in place: {listed(told)}."


def _sureness(answer: Answer, query: FormalQuery) -> str:
    """Return how sure the best keyframe is, in words with the reason."""
    best, quantity = answer.keyframes[0], term_of(query).quantity
    if query.ask not in ("whether", "where", "when") or query.select == "usual":
        return ""
    point = query.time is not None and query.time.is_point
    if point or _is_open(query) or (quantity is not None and answer.count < quantity):
        return ""
    views = int(best.why.get("views", best.seen))
    band = how_sure(best)
    said = "This is a guess" if band == "a guess" else f"I am {band}"
    rivals = [k for k in heads_of(answer)[1:] if k.object_id != best.object_id]
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
    condition = condition_words(answer, query)
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
    if _refused_term(answer, query) != term_of(query) and answer.reason == "never":
        kind = article(vocabulary.canonical(other.category))
        return f"I did see {kind} {when(other.end, now)}{there}."
    pronoun = "some" if is_many(term_of(query).word) else "one"
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
    return next(quoted, term_of(query))


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
