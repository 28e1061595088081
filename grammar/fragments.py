"""Follow-ups: what a person says after an answer, `and the bowl?`, `what about yesterday?`.

A fragment names only what changes; `assistant.dialogue` merges it with the query before it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from typing import Literal

from grammar import numbers, scope
from grammar.errors import NotUnderstood, QuestionError
from grammar.forms import ANYTHING, Ask, Correction, FormalQuery, ObjectTerm, Select, TimeSlice
from grammar.meaning import AtPlace, Group, Item, Meaning, Outside, Related, form_of
from grammar.parser import NO_STORE, read
from grammar.reading import Reading, Terminals
from grammar.vocabulary import StoreWords
from grammar.words import Word

Relative = Literal["before", "after", "since"]
_LEADS = (
    "and what about", "and how about", "what about", "how about", "or what about", "and also",
    "and then", "and", "or", "but", "also", "then", "ok and", "no", "i mean", "i meant",
    "no i mean", "no i meant", "same question for", "the same question for", "same for",
    "the same for",
)  # fmt: skip
_RELATIVES: dict[str, Relative] = {
    "before that": "before", "before then": "before", "earlier than that": "before",
    "prior to that": "before", "previously": "before", "earlier": "before", "before": "before",
    "the time before": "before", "the time before that": "before", "before this": "before",
    "after that": "after", "after then": "after", "afterwards": "after", "later": "after",
    "later on": "after", "later than that": "after", "after": "after", "after this": "after",
    "since then": "since", "since that": "since", "ever since": "since",
}  # fmt: skip
_SHIFTS: dict[str, timedelta] = {
    "the day before that": timedelta(days=-1), "the day before": timedelta(days=-1),
    "the previous day": timedelta(days=-1), "a day earlier": timedelta(days=-1),
    "one day earlier": timedelta(days=-1), "the night before": timedelta(days=-1),
    "the week before that": timedelta(weeks=-1), "the week before": timedelta(weeks=-1),
    "a week earlier": timedelta(weeks=-1), "an hour earlier": timedelta(hours=-1),
    "an hour before that": timedelta(hours=-1), "an hour before": timedelta(hours=-1),
    "one hour earlier": timedelta(hours=-1), "the day after that": timedelta(days=1),
    "the day after": timedelta(days=1), "the following day": timedelta(days=1),
    "a day later": timedelta(days=1), "an hour later": timedelta(hours=1),
    "an hour after that": timedelta(hours=1), "the week after": timedelta(weeks=1),
    "a week later": timedelta(weeks=1), "half an hour earlier": timedelta(minutes=-30),
    "half an hour later": timedelta(minutes=30),
}  # fmt: skip
_ASKED_ANEW: dict[str, Ask] = {
    "which": "what", "which one": "what", "which ones": "what", "show me": "what",
    "show them": "what", "show me them": "what", "list them": "what", "when was that": "when",
    "when is that": "when", "where was that": "where",
    "how many are there": "count", "how many were there": "count",
    "how many of them are there": "count", "how many of them were there": "count",
}  # fmt: skip
_UNITS = {"minute": 60, "hour": 3600, "day": 86400, "week": 604800}
_AMOUNT_BEFORE = ("before that", "before", "earlier", "prior to that")
_AMOUNT_AFTER = ("after that", "after", "later")
_ALL = ("they", "them")
_WHICH = "I cannot tell which of them you mean."
_SAME_TIME = ("at that time", "that day", "back then", "at the time", "on that day", "then")


@dataclass(frozen=True, slots=True)
class Fragment:
    """What a follow-up changes; what is None or empty stays as it was.

    terms: new objects, `ANYTHING` with attributes for "the red one". items: new places, relations.
    relative: before, after or since the time of the last answer. shift: the last slice, moved.
    query: a whole question whose own words already say all but the relative time.
    corrections: the words that were read as others.
    """

    text: str
    terms: tuple[ObjectTerm, ...] = ()
    items: tuple[Item, ...] = ()
    time: TimeSlice | None = None
    relative: Relative | None = None
    shift: timedelta | None = None
    ask: Ask | None = None
    select: Select | None = None
    negated: bool | None = None
    query: FormalQuery | None = None
    corrections: tuple[Correction, ...] = ()


def parse_fragment(
    text: str,
    *,
    now: datetime,
    words: StoreWords = NO_STORE,
    previous: FormalQuery,
    told: ObjectTerm | None = None,
) -> Fragment | FormalQuery:
    """Return the follow-up of `previous`: a fragment, or a query where it is a whole question.

    Pronouns of a whole question mean the first object of `previous`. told: what the answer told
    of, which `it` means after a list. Raises QuestionError as `parse` does.
    """
    found, corrections = read(text, now, words, lambda r, said: _followed(r, said, previous, told))
    return replace(found, corrections=corrections)


def _followed(
    reading: Reading,
    sentences: list[list[Word]],
    previous: FormalQuery,
    told: ObjectTerm | None,
) -> Fragment | FormalQuery:
    """Return what the sentences mean after `previous`."""
    text, it = reading.text, _spoken_of(previous) or told
    sentences = [_of_them(words) for words in sentences]
    if len(sentences) == 1:
        spoken = " ".join(w.text for w in _led(sentences[0]))
        if spoken in _ASKED_ANEW:
            return Fragment(text, ask=_ASKED_ANEW[spoken])
        if spoken in ("not those", "not these", "not them", "not it", "not that", "not this"):
            raise NotUnderstood(text, 0, _WHICH)
    if len(sentences) != 1:
        return reading.of(sentences, it)
    said, relative, shift, same_time = _relative(sentences[0])
    timed = relative is not None or shift is not None
    if timed and not said:
        return Fragment(text, relative=relative, shift=shift)
    fragment = _fragment(reading, said, it, placed=previous.place is not None)
    if fragment is not None:
        fragment = _of_ground(fragment, it, previous)
        return replace(fragment, relative=relative, shift=shift)
    whole = _whole(reading, said, previous, told)
    if timed:
        return Fragment(text, relative=relative, shift=shift, query=whole)
    pronoun = whole.select == "all" and any(w.text in ("it", "they", "them") for w in said)
    past = not any(w.text in ("is", "are", "now") for w in said)
    if whole.time is None and (same_time or (pronoun and past)):
        return replace(
            whole,
            time=previous.time,
            form="Q3" if whole.form == "Q1" and previous.time else whole.form,
        )
    return whole


def _of_them(words: list[Word]) -> list[Word]:
    """Say of what a number is asked where that is left out: how many are in the kitchen."""
    texts = [w.text for w in words[:3]]
    if texts[:2] != ["how", "many"] or texts[2:] not in (["are"], ["were"], ["did"]):
        return words
    of_them = (replace(words[1], text=text) for text in ("of", "them"))
    return [*words[:2], *of_them, *words[2:]]


def _whole(
    reading: Reading, said: list[Word], previous: FormalQuery, told: ObjectTerm | None
) -> FormalQuery:
    """Read a whole question. After a list, its `it` is the thing told, and its `they` all of it.

    What things were listed by keeps its pronoun: after what is on the table, the cup beside it is
    beside the table.
    """
    spoken_of = _spoken_of(previous)
    whole = reading.of([said], spoken_of or told)
    if told is None or spoken_of is None or not is_list(previous):
        return whole
    of_told = reading.of([said], told)
    if of_told.objects[:1] == whole.objects[:1]:  # the pronoun, if there is one, is no figure
        return whole
    if all(w.text not in _ALL for w in said):
        return replace(whole, objects=(*of_told.objects[:1], *whole.objects[1:]))
    if whole.relation is not None or whole.place is not None:
        raise NotUnderstood(reading.text, 0, _WHICH)
    relation, place = previous.relation, previous.place
    form = form_of(whole.ask, relation, whole.time, place, whole.select)
    return replace(whole, form=form, objects=previous.objects, relation=relation, place=place)


def _of_ground(fragment: Fragment, it: ObjectTerm | None, previous: FormalQuery) -> Fragment:
    """Let `under it` mean under what the thing was beside: nothing is under itself."""
    if fragment.terms or previous.relation is None or len(previous.objects) < 2:
        return fragment
    ground = Group((previous.objects[-1],))
    items = tuple(
        replace(item, group=ground)
        if isinstance(item, Related) and _same(item.group.terms, it)
        else item
        for item in fragment.items
    )
    return replace(fragment, items=items)


def _same(terms: tuple[ObjectTerm, ...], it: ObjectTerm | None) -> bool:
    return it is not None and [replace(term, var=it.var) for term in terms] == [it]


def _amount(spoken: str) -> timedelta | None:
    """Return how far `two hours before that` moves the time, None for what is no such amount."""
    words = spoken.split()
    number = numbers.cardinal(words, 0)
    unit = words[number[1]].removesuffix("s") if number and len(words) > number[1] else ""
    if number is None or unit not in _UNITS:
        return None
    way = " ".join(words[number[1] + 1 :])
    sign = (way in _AMOUNT_AFTER) - (way in _AMOUNT_BEFORE)
    return timedelta(seconds=sign * number[0] * _UNITS[unit]) if sign else None


def _spoken_of(previous: FormalQuery) -> ObjectTerm | None:
    """Return what `it` means after a query: its first object that is not just any thing."""
    named = [t for t in previous.objects if t.category != ANYTHING or t.attributes]
    return next(iter(named or previous.objects), None)


def is_list(query: FormalQuery) -> bool:
    """Whether a query asks what there is, so that its answer names things that it did not."""
    return bool(query.objects) and query.objects[0].category == ANYTHING


def _led(words: list[Word]) -> list[Word]:
    """Take `and`, `what about` off the start, and what is denied there: not the cup, the bowl."""
    texts = [w.text for w in words]
    if texts[0] == "not" and "," in texts[2:-1]:
        return words[texts.index(",") + 1 :]
    for lead in _LEADS:
        parts = lead.split()
        if texts[: len(parts)] == parts and len(texts) > len(parts):
            return words[len(parts) :]
    return words


def _relative(
    words: list[Word],
) -> tuple[list[Word], Relative | None, timedelta | None, bool]:
    """Take `before that` and its like off the end or the start."""
    texts = [w.text for w in _led(words)]
    spoken = " ".join(texts)
    amount = _amount(spoken)
    if amount is not None:
        return [], None, amount, False
    if spoken in _SHIFTS:
        return [], None, _SHIFTS[spoken], False
    if spoken in _RELATIVES:
        return [], _RELATIVES[spoken], None, False
    texts = [w.text for w in words]
    for phrase in sorted((*_SHIFTS, *_RELATIVES, *_SAME_TIME), key=len, reverse=True):
        parts = phrase.split()
        if len(texts) > len(parts) and texts[-len(parts) :] == parts:
            rest = words[: -len(parts)]
            return rest, _RELATIVES.get(phrase), _SHIFTS.get(phrase), phrase in _SAME_TIME
    return words, None, None, False


def _fragment(
    reading: Reading, whole: list[Word], it: ObjectTerm | None, *, placed: bool
) -> Fragment | None:
    """Return the fragment that the words are, None when no rule of fragments reads them.

    Raises NotUnderstood for one unknown word that nothing leads: `thanks` is no thing.
    """
    words = _led(whole)
    try:
        found = reading.terminals(words, it)
        tags = found.tagged.tags
        if not tags:
            return _without_words(reading, found)
        parsed = reading.parsed(found, "fragment")
    except QuestionError:
        return None
    if [w.text for w in words] == [w.text for w in whole]:
        scope.refuse_noise(reading.text, found.tagged, found.words, reading.lexicon, timed=False)
    fragment = _built(reading, found, parsed)
    return _in_place(fragment, reading) if placed else fragment


def _in_place(fragment: Fragment, reading: Reading) -> Fragment:
    """Read a bare place as one where a place was spoken of: `what about the hall?`."""
    places = reading.lexicon.places
    if len(fragment.terms) == 1 and fragment.terms[0].word in places:
        place = AtPlace(places[fragment.terms[0].word])
        return replace(fragment, terms=(), items=(*fragment.items, place))
    return fragment


def _without_words(reading: Reading, found: Terminals) -> Fragment | None:
    """Return a fragment of a time, or of `the first time`, alone."""
    select = found.tagged.select
    if found.time is None and select is None:
        return None
    return Fragment(reading.text, time=found.time, select=select)


def _built(reading: Reading, found: Terminals, meaning: Meaning) -> Fragment:
    from grammar.alternatives import united  # few follow-ups say `or`

    whole = united(meaning if meaning.ask is not None else replace(meaning, ask="whether"))
    if whole is None:
        raise NotUnderstood(reading.text, 0, _WHICH)
    group, items = whole.things.group, whole.things.items
    negated = found.tagged.negated
    if negated and items:  # not in the kitchen: elsewhere; the question is no other
        items, negated = (_denied(items[0]), *items[1:]), False
    return Fragment(
        reading.text,
        terms=group.terms if group is not None else (),
        items=items,
        time=found.time,
        ask=meaning.ask,
        select=found.tagged.select,
        negated=True if negated else None,
    )


def _denied(item: Item) -> Item:
    """Return where a thing must not be: not in the kitchen, not on the table."""
    match item:
        case AtPlace():
            return Outside(item.name, item.others)
        case Related():
            return replace(item, negated=not item.negated)
        case _:
            return item
