"""The sentence of an honest no: never, not then, not there, no longer, or no such word."""

from __future__ import annotations

from datetime import datetime

from assistant.amounts import agrees_with_none, other_amount_words
from assistant.conditions import condition_words, gathered_words
from assistant.english import (
    all_of,
    article,
    counted,
    listed,
    plural,
    sentence_case,
    slice_words,
    when,
)
from assistant.forced import not_taught
from assistant.phrases import (
    asked_place,
    definite,
    described,
    gone_words,
    indefinite,
    kind_of,
    noun_of,
    numbered,
    term_of,
    theirs,
    there_words,
)
from assistant.said import is_one, said_many
from assistant.then import around_words, looking_into
from d3a.answer import Answer, RankedKeyframe
from d3a.answering.points import edge_of
from grammar import vocabulary
from grammar.forms import ANYTHING, Ask, FormalQuery, ObjectTerm

_OF_A_KNOWN_THING: frozenset[Ask] = frozenset({"where", "when", "how_long", "how_often"})
"""Who asks so has a thing in mind: it is told with "the" and "it"."""


def refusal_words(answer: Answer, query: FormalQuery, now: datetime) -> str:
    """Return why there is no answer, and what was seen instead or when the robot looked last.

    now: aware, its zone is that of the times said.
    """
    term = _refused_term(answer, query)
    opening = "That is right: " if agrees_with_none(query) else ""
    if answer.reason == "empty":
        return "My memory is empty: nothing was stored yet."
    if untaught := not_taught(answer, query, term):
        return untaught
    if answer.status == "unknown_object":
        never = opening if answer.reason == "never" else ""  # who knows what it never knew
        return never + _unknown(answer, query, term) + _last_look(answer, query, now)
    if answer.reason == "gone" and query.select == "last" and query.ask != "where":
        return sentence_case(f"{opening}{_not_any_more(answer, query, now)}")
    if answer.count and answer.otherwise is not None:
        last = f"last {when(answer.otherwise.end, now)}"
        return other_amount_words(answer, query, condition_words(answer, query), last)
    none, condition = _none_of(answer, query, term), condition_words(answer, query)
    told = f"{opening}I never saw {none}{condition}."
    time = f" {slice_words(query.time, now)}" if query.time else ""
    refused = answer.otherwise.why.get("refused") if answer.otherwise is not None else None
    change = query.ask in ("moved", "missing")
    if answer.looked_then is False and (change or answer.reason in ("not_then", "not_there")):
        looked = "was not looking" if query.time else "never looked"
        told = f"I {looked}{looking_into(answer, query)}{time}, so I cannot tell."
    elif answer.reason == "never" and answer.denied and term == term_of(query) and term.owner:
        return _all_denied(answer.denied, noun_of(term), term.owner)
    elif refused:
        like = _perhaps_like_it if answer.perhaps else _none_like_it
        told = f"{'' if answer.perhaps else opening}{like(answer, query, refused, now)}"
    elif answer.apart:
        many, spread = said_many(query, term), counted(answer.apart, "place")
        things = indefinite(term, numbered(query, term, answer.unjudged), many=many)
        same = "they are the same" if many else "it was the same one"
        told = f"I saw {things} in {spread}{time}. I cannot be sure that {same}."
    elif change and answer.reason != "gone":
        told = _no_change(answer, query, condition, time)
    elif answer.reason in ("not_then", "not_there"):
        place = condition if answer.reason == "not_there" else ""
        told = f"{opening}I did not see {none}{place}{time}."
        elsewhere = query.outside != query.contrary and query.relation is None
        if elsewhere and query.place and place:
            only = definite(term, numbered(query, term, answer.unjudged))
            told = f"I saw {only} nowhere but {asked_place(query, query.place)}{time}."
    elif answer.reason == "gone":
        verb = "were" if said_many(query, term) else "was"
        words = definite(term, numbered(query, term, answer.unjudged))
        told = f"{opening}I looked again and {words} {verb} gone."
    if answer.otherwise is not None and not refused:
        told += f" {_instead(answer.otherwise, answer, query, now)}"
    if answer.otherwise is None or answer.reason == "not_then":
        told += _last_look(answer, query, now)
    return sentence_case(told)


def _no_change(answer: Answer, query: FormalQuery, condition: str, time: str) -> str:
    """Return that nothing moved or is missing; of one thing, which was seen elsewhere, that not."""
    term = term_of(query)
    if answer.otherwise is not None:
        thing = definite(term, numbered(query, term, answer.unjudged))
        if query.ask == "moved":
            return f"I did not see {thing} move{time}."
        verb = "are" if said_many(query, term) else "is"
        verb = "did not go" if time else f"{verb} not"
        return f"As far as I saw, {thing} {verb} missing{time}."
    none = "nothing" if term.category == ANYTHING else f"no {described(term, answer.unjudged)}"
    verb = "moved" if query.ask == "moved" else ("went missing" if time else "is missing")
    seen = " that I saw" if query.ask == "missing" and query.relation is not None else ""
    return f"As far as I saw, {none} {verb}{seen}{condition}{time}."


def _last_look(answer: Answer, query: FormalQuery, now: datetime) -> str:
    if answer.last_looked is None:
        return ""
    return f" I last looked{looking_into(answer, query)} {when(answer.last_looked, now)}."


def _none_like_it(answer: Answer, query: FormalQuery, refused: list[str], now: datetime) -> str:
    """Return what was seen of the word, and that none of it had the attributes asked for."""
    other, missed = answer.otherwise, _looked(refused)
    assert other is not None
    if _refused_term(answer, query).category == ANYTHING:
        return f"Nothing that I saw {missed}."
    there = there_words(other, query)
    told = f"I saw {article(kind_of(other))}, but none that {missed}."
    colours = " or ".join(other.why.get("looked", ()))
    one = f"one, which looked {colours}," if colours else "one"
    return f"{told} I last saw {one} {when(other.end, now)}{there}."


def _perhaps_like_it(answer: Answer, query: FormalQuery, refused: list[str], now: datetime) -> str:
    """Return what was seen of the word, and that some of it may have the attributes asked for."""
    other, looked = answer.perhaps[0], _looked(refused)
    last = f"{when(other.end, now)}{there_words(other, query)}"
    kind, several = kind_of(other), len({k.object_id for k in answer.perhaps}) > 1
    if _refused_term(answer, query).category == ANYTHING:
        told = f"I cannot be sure that anything that I saw {looked}."
        return f"{told} The likeliest is {article(kind)}, which I last saw {last}."
    if several:
        told = f"I saw {plural(kind)}, but I cannot be sure that any of them {looked}."
        return f"{told} The likeliest I last saw {last}."
    return f"I saw {article(kind)}, but I cannot be sure that it {looked}. I last saw it {last}."


def _looked(refused: list[str]) -> str:
    """Return looks as said of what was seen: looked red, did not look red."""
    looks = listed([word for word in refused if not word.startswith("not ")])
    unlike = listed([word.removeprefix("not ") for word in refused if word.startswith("not ")])
    return f"looked {looks}" if looks else f"did not look {unlike}"


def all_refused(answer: Answer) -> str:
    """Return that a person said no to each thing of an answer: not this one, nor that."""
    number = max(len({k.object_id for k in answer.keyframes}), 1) + answer.denied
    named = "it"
    if answer.query is not None:
        term = term_of(answer.query)
        if not term.owner and term.category != ANYTHING:
            named = definite(term, numbered(answer.query, term))
    then = " then" if answer.query is not None and answer.query.time is not None else ""
    return f"You said no to {all_of(number)} that I saw{then}: nothing else could be {named}."


def _all_denied(number: int, noun: str, owner: str) -> str:
    """Return that there were some, whatever they looked like, and whose none is, as was said."""
    which = "it is" if number == 1 else "they are"
    each = "that" if number == 1 else f"of {all_of(number)} that"
    return f"I saw {counted(number, noun)}, and you said {each} {which} not {theirs(owner)}."


def _none_of(answer: Answer, query: FormalQuery, term: ObjectTerm) -> str:
    """Return what was not seen: "anything", "your keys", "an orange bowl", "keys"."""
    if term.category == ANYTHING:
        return "anything"
    if term == term_of(query) and (together := gathered_words(answer, query)):
        return together
    words = numbered(query, term, answer.unjudged)
    if query.ask in _OF_A_KNOWN_THING and answer.otherwise is not None:
        return definite(term, words)
    return indefinite(term, words, many=said_many(query, term))


def _not_any_more(answer: Answer, query: FormalQuery, now: datetime) -> str:
    """Return what was seen there, but is not there now: where it was seen last."""
    term, other = _refused_term(answer, query), answer.otherwise
    many = said_many(query, term)
    openings = {
        "whether": "" if query.negated else "No, not any more. ",
        "count": "None any more. ",
        "when": "Not any more. ",
        "how_long": "Not any more. ",
    }
    opening = openings.get(query.ask, "Nothing any more. ")
    assert other is not None  # what is gone was seen
    thing = _none_of(answer, query, term)
    if term.category == ANYTHING:
        thing = f"{article(kind_of(other))}{condition_words(answer, query)}"
    elif (query.ask == "whether" or term != term_of(query)) and not term.owner:
        thing = definite(term, numbered(query, term, answer.unjudged))
    there = there_words(other, query)
    told = f"{opening}I last saw {thing} {when(other.end, now)}{there}."
    return f"{told} {gone_words(other, now, many=many)}".strip()


def _instead(other: RankedKeyframe, answer: Answer, query: FormalQuery, now: datetime) -> str:
    there = there_words(other, query)
    term = _refused_term(answer, query)
    if term != term_of(query) and answer.reason == "never":
        return f"I did see {article(kind_of(other))} {when(other.end, now)}{there}."
    many = said_many(query, term_of(query))
    pronoun = "some" if many else "one"
    if term_of(query).category == ANYTHING:
        pronoun = article(kind_of(other))
    elif is_one(query) or query.ask in _OF_A_KNOWN_THING or answer.reason == "gone":
        pronoun = "them" if many else "it"
    at = edge_of(query)
    if at is not None and query.ask == "whether":
        return around_words(other, pronoun, query, at, now)
    opening = "I saw" if answer.reason == "not_then" else "I last saw"
    return f"{opening} {pronoun} {when(other.end, now)}{there}."


def _unknown(answer: Answer, query: FormalQuery, term: ObjectTerm) -> str:
    word = noun_of(term)
    if answer.reason == "not_recognisable":
        told = f"I cannot recognise {plural(word)}: the detector of this memory has no such word."
    else:
        words = plural(word) if said_many(query, term) else article(word)
        told = f"I never saw {words}, and my memory has no such word."
    known = [plural(vocabulary.canonical(word)) for word in answer.suggestions]
    return f"{told} I know {listed(known)}." if known else told


def _refused_term(answer: Answer, query: FormalQuery) -> ObjectTerm:
    """Return the object that a no is about: the message quotes it where it is not the first."""
    message = (answer.message or "").casefold()  # a taught name may be written otherwise
    said = {term: " ".join((*term.attributes, term.word)) for term in query.objects}
    quoted = (term for term, words in said.items() if f"“{words.casefold()}”" in message)
    return next(quoted, term_of(query))
