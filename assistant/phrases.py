"""Parts of a reply: what was asked for, what was found, where, as noun phrases."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime, timedelta

from assistant.english import (
    ago,
    article,
    clock,
    day_of,
    is_many,
    listed,
    neither,
    number_word,
    plural,
    sentence_case,
    slice_words,
    when,
)
from assistant.said import said_many
from d3a.answer import Answer, RankedKeyframe
from d3a.colours import is_colour
from d3a.rank import LEAST_OF_BEST
from grammar import vocabulary
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm, TimeSlice
from grammar.nountags import KIN, ON_PLACES, PEOPLE
from grammar.phrases import BARE_PLACES

_ALL = frozenset({"everybody", "everyone"})
_SPOKEN_OF = {"her": ("her", "hers"), "him": ("his", "his"), "them": ("their", "theirs")}
"""Owners who were told of by a pronoun alone: before what is theirs, and after it."""
_ROOMY = ("room", " area", " corner", " wing", " zone", " floor")
SCORE_OF_WORD = 0.86
"""Below this the word was a wider or narrower one: the answer says what was found instead."""


def term_of(query: FormalQuery) -> ObjectTerm:
    """Return the first object of a query; anything at all where it names none."""
    return query.objects[0] if query.objects else ObjectTerm(ANYTHING)


def noun_of(term: ObjectTerm) -> str:
    """Return the noun as said; "thing" for anything at all."""
    return "thing" if term.category == ANYTHING else term.word


def described(term: ObjectTerm, unjudged: tuple[str, ...] = (), *, noun: str | None = None) -> str:
    """Return noun and attributes, without those that nobody judged: "orange bowl"."""
    if term.or_else:
        return _any_of(term, unjudged, noun)
    left_out = {word for phrase in unjudged for word in (phrase, *phrase.split())}
    words = [word for word in dict.fromkeys(term.attributes) if word not in left_out]
    for i in range(len(words) - 1, 0, -1):
        if is_colour(words[i - 1]) and is_colour(words[i]):
            words.insert(i, "and")
    said = " ".join([*words, noun or noun_of(term)])
    without = [word for word in term.without if f"not {word}" not in unjudged]
    if term.not_owner is not None and not any(word.startswith("not ") for word in unjudged):
        without.append(theirs(term.not_owner))
    kinds = (described(other) for other in term.other_than)
    without += [article(kind) for kind in kinds if f"not {kind}" not in unjudged]
    many = noun is not None and noun == plural(noun_of(term))  # as what has no singular is
    verb = "are" if many or is_many(said) else "is"
    return f"{said} that {verb} {neither(without)}" if without else said


def _any_of(term: ObjectTerm, unjudged: tuple[str, ...], noun: str | None) -> str:
    """Return what will do as well: "pink or red cup", "cup or bowl"."""
    own = replace(term, or_else=())
    bare = [replace(each, attributes=(), var=term.var) for each in (own, *term.or_else)]
    if all(each == bare[0] for each in bare):  # they differ in their looks alone
        looks = " or ".join(" ".join(each.attributes) for each in (own, *term.or_else))
        return described(replace(own, attributes=(looks,)), unjudged, noun=noun)
    said = [described(own, unjudged, noun=noun)]
    many = noun is not None and noun == plural(noun_of(own))
    said += [
        described(t, unjudged, noun=plural(noun_of(t)) if many else None) for t in term.or_else
    ]
    return " or ".join(said)


def definite(term: ObjectTerm, words: str) -> str:
    """Return the words with the owner or "the": "your keys", "Anna's keys", "the cup", "Tim"."""
    if term.owner:
        return f"{whose(term.owner)} {words}"
    return words if _is_name(words) else f"the {words}"


def _is_name(words: str) -> bool:
    """Whether words are a name, which has no article: Excalibur, but the Bosch drill."""
    return words[:1].isupper() and not is_kind(words)


def is_kind(words: str) -> bool:
    """Whether words end in what things are called in general: cup, Bosch drill."""
    return words.rpartition(" ")[2].lower() in vocabulary.lexicon().nouns


def whose(owner: str) -> str:
    """Return an owner before what is theirs: "your", "Anna's", "your grandmother's"."""
    if owner in ("me", "you"):
        return "your" if owner == "me" else "my"
    if owner in _SPOKEN_OF:
        return _SPOKEN_OF[owner][0]
    if owner in KIN - _ALL:
        return f"your {owner}'s"
    if owner in PEOPLE - KIN:
        return f"the {owner}'s"
    return f"{sentence_case(owner)}'s"


def theirs(owner: str) -> str:
    """Return whose a thing is, after it: "yours", "Anna's"."""
    if owner in _SPOKEN_OF:
        return _SPOKEN_OF[owner][1]
    return {"me": "yours", "you": "mine"}.get(owner) or whose(owner)


def indefinite(term: ObjectTerm, words: str, *, many: bool = False) -> str:
    """Return the words with the owner or an article: "your keys", "an orange bowl".

    many: they are in the plural, as they were said: "keys"; what has no singular has its pair.
    """
    if term.owner or _is_name(words):
        return definite(term, words)
    return words if many and not is_many(words) else article(words)


def kind_of(keyframe: RankedKeyframe) -> str:
    """Return what a keyframe's object is called: the vocabulary's word for its category."""
    return vocabulary.canonical(keyframe.category)


def found_words(answer: Answer, query: FormalQuery) -> str:
    """Return what was found, as found, in the number that it was said in.

    A wider or narrower word is said as the store has it.
    """
    term, best = term_of(query), answer.keyframes[0] if answer.keyframes else None
    noun = noun_of(term)
    kinds = kinds_of_broad(answer, query)
    if kinds and query.ask in ("when", "how_long", "how_often"):
        many = said_many(query, term)
        noun = listed([plural(kind) if many else kind for kind in kinds])
        return described(term, answer.unjudged, noun=noun)
    match = best.why.get("match", 1.0) if best else 1.0
    if best is not None and (term.category == ANYTHING or match < SCORE_OF_WORD):
        # a minority of its views may have been called what was asked for: then that is its word
        noun = noun if is_called(best, term) else kind_of(best)
    return numbered(query, term, answer.unjudged, noun=noun)


def wider_kind(answer: Answer, term: ObjectTerm) -> str:
    """Return the wider word that what a noun means was found by alone; "" where it was not.

    `unjudged` has the noun then: among bottles, nobody knows which is a water bottle.
    """
    if term.category == ANYTHING or term.word not in answer.unjudged:
        return ""
    other = [] if answer.otherwise is None else [answer.otherwise]
    wider = vocabulary.broader(term.category)
    kinds = (kind_of(keyframe) for keyframe in (*answer.keyframes, *other, *answer.instead))
    return next((kind for kind in kinds if kind in wider), "")


def kinds_of_broad(answer: Answer, query: FormalQuery) -> list[str]:
    """Return the kinds that a broader word covers in an answer, best first: banana, apple.

    Empty where it is one kind, or where one keyframe is the answer, which is told as it is.
    """
    term = term_of(query)
    if term.category == ANYTHING or term.owner or query.select != "all":
        return []
    likely = likely_of(answer)
    kinds = list(dict.fromkeys(kind_of(k) for k in likely if _is_other_word(k, term)))
    if kinds and any(is_called(keyframe, term) for keyframe in likely):
        kinds.insert(0, term.category)
    return kinds if len(kinds) > 1 else []


def _is_other_word(keyframe: RankedKeyframe, term: ObjectTerm) -> bool:
    """Whether it was found by a wider or narrower word, not by some views or a taught name."""
    found = keyframe.why.get("match", 1.0) < SCORE_OF_WORD and "votes" not in keyframe.why
    return found and not is_called(keyframe, term)


def is_called(keyframe: RankedKeyframe, term: ObjectTerm) -> bool:
    """Whether the detector's word for a keyframe's object is the one asked for."""
    return term.category != ANYTHING and kind_of(keyframe) == term.category


def numbered(
    query: FormalQuery,
    term: ObjectTerm,
    unjudged: tuple[str, ...] = (),
    *,
    noun: str | None = None,
) -> str:
    """Return noun and attributes in the number that the noun was said in."""
    noun = noun or noun_of(term)
    many = term.category != ANYTHING and said_many(query, term)
    return described(term, unjudged, noun=plural(noun) if many else noun)


def plain_place(name: str) -> str:
    """Return the name of a place in small letters, without "my" before it."""
    return name.casefold().removeprefix("my ").removeprefix("our ").removeprefix("the ")


def is_room(name: str) -> bool:
    """Whether a place is one to be in, by its name: the kitchen, Anna's room, the play area."""
    said = plain_place(name)
    rooms = vocabulary.lexicon().places
    return said in rooms or said.rpartition(" ")[2] in rooms or said.endswith(_ROOMY)


def the_place(name: str) -> str:
    """Return a place as it is told: the kitchen, Anna's bedroom, upstairs."""
    said = name.removeprefix("my ").removeprefix("our ").removeprefix("the ")
    if said in BARE_PLACES:
        return said
    owned = said.partition(" ")[0].endswith(("'s", "s'"))
    mine = "your" if said != name and not name.startswith("the ") else "the"
    return sentence_case(said) if owned else f"{mine} {said}"


def at_place(name: str) -> str:
    """Return a place with its preposition: in the kitchen, at the desk, on the balcony."""
    said = plain_place(name)
    if said in BARE_PLACES:
        return said
    if said in ON_PLACES:
        return f"on {the_place(name)}"
    return f"{'in' if is_room(name) else 'at'} {the_place(name)}"


def asked_place(query: FormalQuery, name: str) -> str:
    """Return a place with its preposition; one that is no thing is a room where it is said so.

    What a person calls it need not tell: in the galley, but at the desk.
    """
    said = plain_place(name)
    inside = rf"\b(in|inside)\s+((the|my|our)\s+)?{re.escape(said)}\b"
    is_thing = said.rpartition(" ")[2] in vocabulary.lexicon().nouns
    if not is_thing and re.search(inside, query.text.casefold()):
        return f"in {the_place(name)}"
    return at_place(name)


def where_words(keyframe: RankedKeyframe, query: FormalQuery) -> str:
    """Return where a keyframe's object was: room and landmark; "" where it is unknown.

    What the question itself named is not told again. Where nothing near has a name, the nearest
    thing that has one, with its distance.
    """
    parts = []
    own = plain_place(keyframe.place or "") == kind_of(keyframe)  # the desk is not at the desk
    named = keyframe.place == query.place and not query.or_places  # of several it is told which
    if keyframe.place and not named and not own:
        parts.append(at_place(keyframe.place))
    if keyframe.near and keyframe.near != keyframe.place and not _is_named(keyframe.near, query):
        parts.append(f"next to the {keyframe.near}")
    if not keyframe.place and not keyframe.near and keyframe.beyond is not None:
        landmark, metres = keyframe.beyond
        parts.append(f"about {_metres(metres)} from the {landmark}")
    if keyframe.vague and not _is_named(keyframe.vague, query):
        parts.append(f"somewhere near the {keyframe.vague}")
    return ", ".join(parts)


def there_words(keyframe: RankedKeyframe, query: FormalQuery) -> str:
    """Return the same after a comma, for the end of a clause."""
    where = where_words(keyframe, query)
    return f", {where}" if where else ""


def _metres(distance: float) -> str:
    number = max(2, round(distance))  # nearer things are landmarks beside it
    return f"{number_word(number)} metres"


def _is_named(landmark: str, query: FormalQuery) -> bool:
    """Whether the question was about that landmark: on the table, next to the table."""
    relations = query.relation is not None and query.relation.kind in ("on", "near", "in", "under")
    kinds = {landmark, *vocabulary.broader(landmark)}
    heads = (word for t in query.objects[1:] for word in (t.category, t.word.rpartition(" ")[2]))
    return relations and any(word in kinds for word in heads)  # a kitchen table is a table


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


def left_with(answer: Answer, kept: Sequence[RankedKeyframe]) -> Answer:
    """Return the answer of these of its keyframes alone, ranked and counted anew."""
    lost = len({k.object_id for k in answer.keyframes} - {k.object_id for k in kept})
    count = max(answer.count - lost, 0)
    ranked = tuple(replace(k, rank=rank) for rank, k in enumerate(kept, 1))
    return replace(answer, keyframes=ranked, count=count, least=min(answer.least, count))


def places_of(heads: list[RankedKeyframe]) -> int:
    """Return at how many places the keyframes show their objects."""
    return len({(k.object_id, k.position) for k in heads})


def tells_nothing(answer: Answer) -> bool:
    """Whether what was asked for is only where it is, and that cannot be told: all is nothing."""
    query = answer.query
    if query is None or answer.status != "found":
        return False
    term = term_of(query)
    whose = term.owner is not None or term.not_owner is not None
    conditions = (query.relation is not None) + (query.place is not None) + whose
    conditions += len(term.other_than)
    anything = term.category == ANYTHING and not term.attributes
    named = {each.word for each in query.terms}  # by a wider word: a thing was found all the same
    left_out = sum(word not in named for word in answer.unjudged)
    return anything and 0 < conditions <= left_out


def likely_of(answer: Answer) -> list[RankedKeyframe]:
    """Return the heads that are at least half as likely as the best: what is told as seen."""
    heads = heads_of(answer)
    best = max((k.score for k in heads), default=0.0)
    return [k for k in heads if k.score >= LEAST_OF_BEST * best]


def newest_of(answer: Answer) -> RankedKeyframe:
    """Return the likely keyframe that was seen last, the better ranked of two."""
    return max(likely_of(answer), key=lambda k: (k.last, -k.rank))


def seen_when(keyframe: RankedKeyframe, now: datetime) -> str:
    """Return when an object was seen last; within an asked slice that it outlasts, all of it."""
    if keyframe.last == keyframe.end:
        return when(keyframe.end, now)
    end = keyframe.last + timedelta(milliseconds=1)  # that of the slice
    return f"{slice_words(TimeSlice(keyframe.first, end), now)}, {ago(end, now)}"


def last_words(answer: Answer, query: FormalQuery, now: datetime, seen: str = "") -> str:
    """Return "last today at 9:42, 9 hours ago"; of what was asked of a moment, that moment."""
    if query.time is not None and query.time.is_point:
        return f"{seen}{slice_words(query.time, now)}"
    return f"last {seen}{seen_when(newest_of(answer), now)}"


def gone_words(
    keyframe: RankedKeyframe, now: datetime, *, many: bool = False, one_of: bool = False
) -> str:
    """Return that the place was empty later, "" where nobody looked or it was still there.

    With the first look that did not show it, where that was another: it may have overlooked it.
    one_of: there are others of the kind, one of which may have been there.
    """
    absent = keyframe.last_absent
    if absent is None:
        return ""
    pronoun, verb = ("they", "were") if many else ("it", "was")
    if one_of:
        pronoun = "those" if many else "that one"
    moment = _at_clock(absent, now)
    if keyframe.first_missed is None:
        return f"When I looked there again {moment}, {pronoun} {verb} gone."
    missed = _at_clock(keyframe.first_missed, now)
    told = pronoun if one_of else ("them" if many else "it")
    back = "they" if many else "it"
    return f"When I looked there again {missed}, I did not see {told}; {moment} {back} {verb} gone."


def _at_clock(moment: datetime, now: datetime) -> str:
    local = moment.astimezone(now.tzinfo)
    return f"{day_of(local, now)} at {clock(local)}"
