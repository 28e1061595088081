"""The sentence of an answer: by template from the record, and nothing that is not in it.

Place first, then clock and how long ago, then how sure. The robot says "I last saw", never "it
is". The same question gets the same words each time.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from datetime import datetime

from assistant.amounts import amount_words
from assistant.caveats import is_open, left_out, sure_words, sureness
from assistant.changed import missing_words, moved_words
from assistant.conditions import condition_words, gathered_words
from assistant.counting import count_words
from assistant.each import asks_for_each, where_each_is
from assistant.english import (
    article,
    clock,
    counted,
    day_of,
    listed,
    number_word,
    occasions,
    sentence_case,
    when,
)
from assistant.forced import as_judged, not_judged
from assistant.kinds_told import of_kind, sort_of
from assistant.lasting import how_long_words, since_words
from assistant.phrases import (
    definite,
    described,
    found_words,
    gone_words,
    heads_of,
    indefinite,
    kind_of,
    kinds_of_broad,
    last_words,
    likely_of,
    newest_of,
    numbered,
    places_of,
    seen_when,
    tells_nothing,
    term_of,
    there_words,
    where_words,
    wider_kind,
)
from assistant.polarity import asks_of_an_end
from assistant.refusals import refusal_words
from assistant.said import is_one, said_many
from assistant.tense import stood_then
from assistant.then import where_then, whether_then
from assistant.usually import often_words, usual_verdict, usual_words
from assistant.wording import NOT_SURE, is_sure
from d3a.answer import Answer, RankedKeyframe
from d3a.answering.points import edge_of
from d3a.colours import is_colour
from d3a.model import Position
from grammar import vocabulary
from grammar.forms import Ask, FormalQuery, ObjectTerm
from grammar.tense import chooses_a_sighting

_SPOTS = 3
"""So many other places are told one by one."""


def sentence(answer: Answer, *, now: datetime) -> str:
    """Return one to three plain sentences for an answer that has its query.

    now: aware, its zone is that of the times said.
    """
    if answer.query is None:
        return answer.answer or answer.message or ""
    parts, query = [left_out(answer), not_judged(answer)], as_judged(answer, answer.query)
    if answer.status != "found":
        parts.insert(0, refusal_words(answer, query, now))
    elif not tells_nothing(answer):
        told = _ASKED[query.ask](answer, query, now)
        said = [told, sureness(answer, query)]
        # what is left out turns a yes and a number into another; a place it leaves a place
        parts = [*parts, *said] if query.ask in ("whether", "count") else [*said, *parts]
    parts[:0] = [f"I read “{c.said}” as {c.taken}." for c in answer.query.corrections]
    return " ".join(part for part in parts if part)


def _whether(answer: Answer, query: FormalQuery, now: datetime) -> str:
    if query.select == "usual" and not query.negated and answer.keyframes[0].group is None:
        return usual_verdict(answer, query)
    if is_open(query) or (term_of(query).quantity is None and kinds_of_broad(answer, query)):
        return f"{_yes(answer, query)}{_what(answer, query, now)}"
    at = edge_of(query)
    if at is not None:
        return whether_then(answer, query, at, now, _yes(answer, query))
    term, condition = term_of(query), condition_words(answer, query)
    many = said_many(query, term)
    heads, newest = likely_of(answer), newest_of(answer)
    said, last = seen_when(newest, now), last_words(answer, query, now)
    opening = _yes(answer, query)
    if together := gathered_words(answer, query):
        thing = together
    elif term.quantity is not None:
        if told := amount_words(answer, query, condition, last):
            return told
        thing = counted(answer.count, described(term, answer.unjudged))
    else:
        words = found_words(answer, query)
        is_known = query.negated and is_one(query)
        thing = definite(term, words) if is_known else indefinite(term, words, many=many)
    where = there_words(newest, query)
    elsewhere = _elsewhere(answer, query, now)
    denied = query.negated and query.select == "all"
    if answer.otherwise is not None and not denied:  # it may have moved, under another id
        since = when(answer.otherwise.end, now) + there_words(answer.otherwise, query)
        told = f"I cannot be sure. I last saw {thing}{condition} {said}{where}."
        other = "some" if many else "one"
        if kind_of(answer.otherwise) != kind_of(newest):  # what it stood beside was seen elsewhere
            other = article(kind_of(answer.otherwise))
        return f"{told} I saw {other} that may be the same {since}."
    if len(heads) == 1 or query.select == "last":
        verb = "last saw" if query.select == "last" else "saw"
        told = f"{opening}I {verb} {thing}{condition} {said}{where}."
    else:
        number = places_of(heads)
        spread = counted(number, "place")
        further = places_of(heads_of(answer)) - number  # the table lists them too
        spread += f", maybe in {number_word(further)} more" * bool(further)
        more = f"{occasions(len(heads))}{' or more' if answer.truncated else ''}"
        told = f"{opening}I saw {thing}{condition} {more} in {spread}, {last}{where}."
    one_of = answer.alike > 1 and not term.owner
    return f"{told} {elsewhere or gone_words(newest, now, many=many, one_of=one_of)}".strip()


def _elsewhere(answer: Answer, query: FormalQuery, now: datetime) -> str:
    """Return where a thing was too, of which it is asked whether it was not there; else ""."""
    denied = query.negated and query.select == "all"
    if not denied or answer.otherwise is None or not is_one(query):
        return ""
    pronoun = "them" if said_many(query, term_of(query)) else "it"
    where = "there" if query.contrary else "elsewhere"
    there = there_words(answer.otherwise, query)
    return f"I saw {pronoun} {where} too, {when(answer.otherwise.end, now)}{there}."


def _yes(answer: Answer, query: FormalQuery) -> str:
    """Return the word before what was seen; none where that is only a part of what was asked."""
    if answer.unjudged or not_judged(answer):
        return ""
    if not query.negated or query.contrary:
        return "Yes. " if is_sure(newest_of(answer)) else "Maybe. "
    if asks_of_an_end(query):
        return "No. "
    if any(word in query.text.casefold().split() for word in ("see", "seen")):
        return "I did: "
    if not is_one(query):
        return "No, there was: "
    verb = "They were" if said_many(query, term_of(query)) else "It was"
    return f"{verb}, as far as I saw: " if query.select == "last" else f"{verb}: "


def _where(answer: Answer, query: FormalQuery, now: datetime) -> str:
    term, best = term_of(query), answer.keyframes[0]
    if query.select == "usual":
        return usual_words(answer, query)
    at = edge_of(query)
    if at is not None:
        return where_then(answer, query, at, now)
    if query.relation is None and len(query.objects) > 1:
        return _where_each(answer, query, now)
    words = _the_thing(answer, query)
    since = stood_then(query)
    if query.select == "last" and not since and asks_for_each(answer, query):
        return where_each_is(answer, query, _the_thing(answer, query, each=True), now)
    where, last = where_words(best, query), "last " if query.select == "last" or since else ""
    first = "first " if query.select == "first" else ""
    many = said_many(query, term)
    # of a time that is over it says nothing: the thing was seen since
    is_newest = query.select == "last" and (query.time is None or query.time.end is None)
    gone = gone_words(best, now, many=many) if is_newest else ""
    if "same" in best.why:  # the detector had another word for it there
        words += f" (or {article(kind_of(best))} like {'them' if many else 'it'})"
    sure = " for certain" * (answer.otherwise is not None)  # what may be it was seen since
    seen = f"{sure} {seen_when(best, now)}"
    if where and gone:  # told first, it would read as where the thing is
        told = f"I {last}saw {words}{seen}, {where}."
    elif where:
        told = f"{sentence_case(where)}. I {last}{first}saw {words} there{seen}."
    else:
        known = best.place or best.near  # named by the question, and so not told again
        blank = "" if known else f", but {_nowhere_words(best)}"
        told = f"I {last}{first}saw {words} {seen_when(best, now)}{blank}."
    told += _elsewhere_too(answer, query) if query.select == "all" and not since else ""
    return f"{told} {gone}".strip()


def _nowhere_words(keyframe: RankedKeyframe) -> str:
    """Return that a place has no name, with its coordinates where it has any."""
    if keyframe.position is None:
        return "I do not know the place"
    x, y, _ = keyframe.position
    return f"I have no name for the place (x {x:.1f}, y {y:.1f} on the map)"


def _elsewhere_too(answer: Answer, query: FormalQuery) -> str:
    """Return where else it was seen, or what may be it: each place, where they are few."""
    best = answer.keyframes[0]
    others = [k for k in likely_of(answer) if (k.object_id, k.position) != _place_of(best)]
    number = places_of(others)
    if not number:
        return ""
    spots = list(dict.fromkeys(where_words(keyframe, query) for keyframe in others))
    one = "one" if number == 1 else "such things"
    if all(keyframe.object_id == best.object_id for keyframe in others):
        one = "them" if said_many(query, term_of(query)) else "it"
    if "" in spots or where_words(best, query) in spots or len(spots) > _SPOTS:
        return f" I also saw {one} in {counted(number, 'other place')}."
    return f" I also saw {one} {'; '.join(spots)}."


def _place_of(keyframe: RankedKeyframe) -> tuple[str, Position | None]:
    return keyframe.object_id, keyframe.position


def _where_each(answer: Answer, query: FormalQuery, now: datetime) -> str:
    """Return a sentence for each of several objects, the unseen ones too."""
    told = []
    for term in query.objects:
        best = next((k for k in answer.keyframes if _is_of(k, term)), None)
        words = numbered(query, term, answer.unjudged)
        if best is None:
            told.append(f"I found no {words}.")
            continue
        there = there_words(best, query)
        last = "last " if query.select == "last" else ""
        told.append(f"I {last}saw {definite(term, words)} {seen_when(best, now)}{there}.")
    return " ".join(told)


def _is_of(keyframe: RankedKeyframe, term: ObjectTerm) -> bool:
    judged = keyframe.why.get("attributes", {})
    same = kind_of(keyframe) == term.category
    return same and all(word in judged for word in term.attributes if is_colour(word))


def _when(answer: Answer, query: FormalQuery, now: datetime) -> str:
    if answer.stayed:
        return since_words(answer, query, now)
    thing = _the_thing(answer, query)
    heads, best = likely_of(answer), answer.keyframes[0]
    there = there_words(best, query)
    if query.select in ("last", "first"):
        told = seen_when(best, now) if query.select == "last" else when(best.first, now)
        told = f"{sentence_case(told)}{there}. "
        sure = " for certain" * (answer.otherwise is not None)
        told += f"That is when I {query.select} saw {thing}{sure}."
        many = said_many(query, term_of(query))
        gone = gone_words(best, now, many=many) if query.select == "last" else ""
        return f"{told} {gone}".strip()
    if len(heads) == 1:
        told = f"{sentence_case(seen_when(best, now))}{there}. I saw {thing} once."
        return f"{told}{_maybe_later(answer, query, now)}"
    newest = seen_when(newest_of(answer), now)
    opening = f"I saw {thing} {occasions(len(heads))}"
    if answer.truncated:  # the newest are told: when the first of all was, these do not tell
        return f"{opening} or more, last {newest}."
    first = min(heads, key=lambda k: (k.first, k.rank)).first.astimezone(now.tzinfo)
    told = f"{opening}, first {day_of(first, now)} at {clock(first)} and last {newest}."
    return f"{told}{_maybe_later(answer, query, now)}"


def _maybe_later(answer: Answer, query: FormalQuery, now: datetime) -> str:
    """Return when it was maybe seen, where that is later than the newest that is told as seen."""
    doubtful = max(heads_of(answer), key=lambda k: (k.last, -k.rank))
    if doubtful.last <= newest_of(answer).last:
        return ""
    pronoun = "them" if said_many(query, term_of(query)) else "it"
    return f" I may have seen {pronoun} {seen_when(doubtful, now)}, too."


def _the_thing(answer: Answer, query: FormalQuery, *, each: bool = False) -> str:
    """Return what is told of, with where it was: "the cup on the table", "two cups together".

    each: all of them are told of, be it by a wider word, by which else one of them was found.
    """
    term, words = term_of(query), gathered_words(answer, query)
    if not words:
        words = found_words(answer, query)
        wider = answer.query is not None and wider_kind(answer, term_of(answer.query)) and not each
        many = said_many(query, term)
        words = indefinite(term, words, many=many) if wider else definite(term, words)
    was = (" that were" if said_many(query, term_of(query)) else " that was") * stood_then(query)
    condition = condition_words(answer, query)
    if query.ask == "where" and query.or_places and query.relation is None:
        condition = ""  # which of them it is, is told
    return words + (was if condition else "") + condition


def _what_told(answer: Answer, query: FormalQuery, now: datetime) -> str:
    """Return what was seen, after how sure that is where none of it is rather right than wrong."""
    told, best = _what(answer, query, now), max(heads_of(answer), key=lambda k: k.score)
    if query.select == "usual" or any(is_sure(keyframe) for keyframe in heads_of(answer)):
        return told
    return f"{sure_words(best)}: {told}"


def _what(answer: Answer, query: FormalQuery, now: datetime) -> str:
    if query.select == "usual" and query.ask == "what":
        return often_words(answer, query)
    heads = heads_of(answer)
    somewhere = query.relation is not None or query.place is not None
    chosen = query.select == "first" or chooses_a_sighting(query)
    if chosen or (query.select == "last" and not somewhere):
        return _at_the_edge(answer, query, now)  # what is last somewhere is what is there
    sure = [k for k in heads if k.score >= NOT_SURE] or heads  # the rest stands in the table
    seen = {k.object_id: sort_of(answer, k) for k in sorted(sure, key=lambda k: -k.score)}
    seen = dict([*seen.items()][: answer.count])  # what is doubtful is listed, and not counted
    kinds = Counter(seen.values()).most_common()
    certain = {sort_of(answer, keyframe) for keyframe in heads if is_sure(keyframe)}
    kinds.sort(key=lambda pair: pair[0] not in certain and bool(certain))
    things = [of_kind(answer, query, sort, number) for sort, number in kinds[:8]]
    if certain:  # where nothing is, that is said of all
        doubted = [sort not in certain for sort, _ in kinds]
        things = ["perhaps " * doubt + thing for doubt, thing in zip(doubted, things, strict=False)]
    if len(kinds) > len(things) or answer.count > len({k.object_id for k in heads}):
        things.append("other things")
    condition = condition_words(answer, query)
    if query.select == "last":
        newest = f"{', the newest' * (len(seen) > 1)} {seen_when(newest_of(answer), now)}"
        told = f"I last saw {listed(things)}{condition}{newest}."
        if (other := answer.otherwise) is not None:
            maybe = f"I saw {article(kind_of(other))}, maybe the same, {when(other.end, now)}"
            return f"I cannot be sure. {told} {maybe}{there_words(other, query)}."
        return told + _doubted(answer)
    alone = there_words(newest_of(answer), query) if len(seen) == 1 and not somewhere else ""
    return f"I saw {listed(things)}{condition}, {last_words(answer, query, now)}{alone}."


def _doubted(answer: Answer) -> str:
    """Return what was there too, and was seen elsewhere since, or something like it was."""
    kinds = Counter(vocabulary.canonical(category) for category in answer.doubted)
    if not kinds:
        return ""
    things = listed([article(kind) if n == 1 else counted(n, kind) for kind, n in kinds.items()])
    return f" {sentence_case(things)} that I saw there may be elsewhere by now."


def _at_the_edge(answer: Answer, query: FormalQuery, now: datetime) -> str:
    """Return what was seen first or last of all: one thing, or several in the same moment."""
    is_first, best = query.select == "first", answer.keyframes[0]
    moment = best.first if is_first else best.last
    at_once = [k for k in likely_of(answer) if (k.first if is_first else k.last) == moment]
    kinds = Counter({k.object_id: kind_of(k) for k in at_once or [best]}.values())
    things = [article(kind) if n == 1 else counted(n, kind) for kind, n in kinds.items()]
    there = there_words(best, query) if len(at_once) <= 1 else ""
    condition = condition_words(answer, query)
    told = when(moment, now) if is_first else seen_when(best, now)
    return f"I {query.select} saw {listed(things)}{condition} {told}{there}."


def _how_often(answer: Answer, query: FormalQuery, now: datetime) -> str:
    thing = _the_thing(answer, query)
    often = sentence_case(occasions(round(answer.value or 0)))
    last = last_words(answer, query, now, f"saw {thing} ")
    return f"{often}. I {last}."


_ASKED: dict[Ask, Callable[[Answer, FormalQuery, datetime], str]] = {
    "whether": _whether,
    "where": _where,
    "when": _when,
    "what": _what_told,
    "count": count_words,
    "how_long": how_long_words,
    "how_often": _how_often,
    "moved": moved_words,
    "missing": missing_words,
}
