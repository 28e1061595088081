"""Queries that were read, and that no camera answers: what is no thing, states, doings."""

from __future__ import annotations

from collections.abc import Iterator

from grammar import adjectives, scope
from grammar import timewords as tw
from grammar.closed import words_of
from grammar.cursor import DETERMINERS, TIME_GAP
from grammar.errors import NotUnderstood
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm
from grammar.nountags import KIN
from grammar.phrases import phrases
from grammar.suggestions import suggestions
from grammar.vocabulary import Lexicon
from grammar.words import Word


def refuse_late(text: str, found: FormalQuery, rest: list[Word], lexicon: Lexicon) -> None:
    """Raise OutOfScope for a query whose head noun is no thing: `what is the weather`."""
    _refuse_leftover_time(text, found, rest, lexicon)
    said = [w.text for w in rest if w.text != TIME_GAP]
    for reasons in (_no_things, _states, _no_places, _doings):
        for word, reason in reasons(found, said, lexicon):
            at = next((w for w in rest if w.text == word), rest[-1])
            raise scope.out(text, at, reason, rest, lexicon)


def _no_things(found: FormalQuery, said: list[str], lexicon: Lexicon) -> Iterator[tuple[str, str]]:
    """Yield a word that names nothing to see, and why."""
    for i, term in enumerate(found.objects):
        if term.category in lexicon.places or term.category == ANYTHING:
            continue
        head = term.word.rpartition(" ")[2]
        if head == "like" and len(term.word) > len(head):
            yield head, "It knows no properties of things"
        which = i > 0 and found.ask == "where" and _asks_which(said)
        if ((not i or which) and _is_abstract(term.word, head, lexicon)) or (
            which and head in _ORDERS
        ):
            word = next((w for w in said if w.startswith(head[:4])), said[-1])
            yield word, f"“{term.word}” is no thing that a camera sees"
    together = found.relation is not None and found.relation.kind == "together"
    first = found.objects[0].category if found.objects else ""
    if found.ask == "count" and together and first in scope.lists()["content"]:
        yield said[-1], f"How many of “{first}” a thing has cannot be seen from outside"


def _asks_which(said: list[str]) -> bool:
    """Whether it is asked on or in which one a thing is: what style is it in, on which page."""
    return not {"what", "which"}.isdisjoint(said[:2])


def _states(found: FormalQuery, said: list[str], lexicon: Lexicon) -> Iterator[tuple[str, str]]:
    """Yield a word that asks for a state of a thing, and why it is none that is known."""
    lists = scope.lists()
    for term in found.objects[:1]:
        head = term.word.rpartition(" ")[2]
        if head in _ONLY_STATES and head != term.word:  # is the baby asleep in the crib
            yield head, _STATES
        states = lists["state"] & {*term.attributes, *term.without} - {"off", "on", "up", "down"}
        asked = any(_asked_for(state, said, lexicon) for state in states)
        if asked and found.ask in ("count", "whether", "what"):
            yield said[-1], _STATES
    verb = said[:1] if found.ask == "whether" else said[1:2] if found.ask == "when" else []
    ends = verb in (["is"], ["are"], ["was"], ["were"])
    if ends and (said[-1] in lists["state"] - _NO_STATES or _predicated(found, said, lexicon)):
        yield said[-1], _STATES
    if found.ask == "when" and ends and _happens(found, said, lexicon):
        yield said[-1], "It tells when a thing was seen, not when something is on"
    if len(found.objects) == 2 and found.relation and found.relation.kind == "in":
        content, vessel = (term.category for term in found.objects)
        held = vessel in lists["vessel"] or vessel.rpartition(" ")[2] in lists["vessel"]
        if content in lists["liquid"] and held and not _DEFINITE & {*said[1:2]}:
            yield said[-1], "What is in a vessel is a state of it"


_ORDERS = words_of("order sequence page channel setting mode gear position")
"""What a thing is set to, or has its turn in: what channel is it on."""


def _happens(found: FormalQuery, said: list[str], lexicon: Lexicon) -> bool:
    """Whether it is asked when something is on: when is the service, when was the rehearsal."""
    named = len(found.objects) == 1 and lexicon.singular(said[-1]) in found.objects[0].word
    bare = named and found.relation is None and found.place is None and found.select == "all"
    present = said[1] in ("is", "are")
    return bare and (present or lexicon.known_noun(found.objects[0].word) is None)


_ONLY_STATES = words_of("asleep awake alive alone ajar afraid awry askew ablaze alight")
"""Words that say how a thing is, and stand before none."""


def _asked_for(state: str, said: list[str], lexicon: Lexicon) -> bool:
    """Whether a state is asked for, not said of a thing that one knows: a wet towel, my wet one."""
    i = said.index(state) if state in said else 0
    while i and said[i - 1] in lexicon.attributes:
        i -= 1
    return not i or said[i - 1] not in _DEFINITE or i + 1 == len(said)


_DEFINITE = words_of("the my your our his her their this that these those")


def _no_places(found: FormalQuery, said: list[str], lexicon: Lexicon) -> Iterator[tuple[str, str]]:
    """Yield a word that names no place for things, and why."""
    on_it = found.relation is not None and found.relation.kind in ("on", "in")
    for term in found.objects[1:]:
        plain = not (term.attributes or term.owner or term.where)
        bare = plain and said[-1:] == [term.word] and found.ask == "whether"
        if term.word in scope.lists()["medium"] and on_it:
            yield said[-1], f"“{term.word}” is no place for things"
        if bare and on_it and term.word in scope.lists()["predicate"] and said[-2] in _ON_OR_IN:
            yield said[-1], _STATES  # is the lid on tight
        if bare and on_it and term.word in _IN_ORDER:
            yield said[-1], _STATES
        if term.quantity is not None and term.word in _MEASURES:
            yield said[-1], _STATES
    placed = found.relation is not None and found.objects
    if placed and found.objects[0].category in lexicon.places:
        yield said[-1], "It knows no plan of the building"


def _doings(found: FormalQuery, said: list[str], lexicon: Lexicon) -> Iterator[tuple[str, str]]:
    """Yield a word that asks what people do, or what became of a thing, and why not."""
    for first in found.objects[:1]:
        if found.ask == "whether" and not _USING.isdisjoint(said):
            yield said[-1], "It remembers things, not what became of them"
        if _acted(first, said, lexicon):
            yield said[-1], "It remembers things, not what became of them"
        if _attending(found, said) or _came(found, said, lexicon):
            yield said[0], _PEOPLE
        if first.category == "person" and not _DWELLING.isdisjoint(said):
            yield said[-1], _PEOPLE
        named = first.category in lexicon.names and not _led(first.word, said)
        if (named or first.category in KIN) and first.category not in lexicon.taught:
            yield said[-1], _PEOPLE


_USING = words_of("use used using")
_ON_OR_IN = ("on", "in")
_IN_ORDER = words_of("place way order use danger shape condition trouble motion")
"""What a thing may be in, and no place."""
_MEASURES = words_of("degree percent celsius fahrenheit volt watt amp litre liter mph kmh psi bar")
_DWELLING = words_of("live lives lived stay stays stayed work works worked sleep sleeps")
_STATES = "It knows no states of things"
_PEOPLE = "It remembers things, not the doings of people"


def _is_abstract(word: str, head: str, lexicon: Lexicon) -> bool:
    """Whether a noun is no thing: the level, but not the spirit level; music, no sheet music."""
    lists = scope.lists()
    if word in lists["abstract"]:
        return True
    concrete = word in lexicon.nouns or head in lists["compound"] or head in lexicon.nouns
    return head in lists["abstract"] and not concrete


def _predicated(found: FormalQuery, said: list[str], lexicon: Lexicon) -> bool:
    """Whether the last word is said of the subject: `is the plant on the windowsill healthy`."""
    ground, _, last = found.objects[-1].word.rpartition(" ") if found.objects else ("", "", "")
    known = ground in lexicon.nouns or ground in lexicon.places
    said_of = last in scope.lists()["predicate"] or (
        known and adjectives.describes(last, lexicon.heads)
    )
    final = bool(ground) and last == said[-1] and "there" not in said
    return final and said_of and last not in lexicon.heads


def _acted(term: ObjectTerm, said: list[str], lexicon: Lexicon) -> bool:
    """Whether a noun ends in a verb of doing, or starts with a name: `team won`, `anna come`."""
    first, last = term.word.partition(" ")[0], term.word.rpartition(" ")[2]
    superlative = last.endswith("est") and lexicon.known_noun(last) is None
    if first in _WANTING or (superlative and said[0] in ("which", "what")):
        return True
    if term.word in lexicon.nouns or last in lexicon.heads:
        return False
    noun = first not in lexicon.names and first not in KIN and first != last
    placed = _ACTING.isdisjoint(said) or not phrases().verbs.isdisjoint(said)
    if noun and placed and last in _DEEDS:
        return False  # where is the door stop, did you see the face wash
    return last in scope.doings() or (
        first != last and first in lexicon.names and not _led(first, said)
    )


def _led(word: str, said: list[str]) -> bool:
    """Whether a determiner makes a name that of a thing: the jack, a jack knife."""
    i = said.index(word) if word in said else 0
    return i > 0 and said[i - 1] in DETERMINERS


_DEEDS = words_of("stop wash press ring walk rest watch iron drink break play work feed dry wear")
"""Verbs of doing that are nouns too, where the question has a verb of its own."""
_ACTING = words_of("do does did have has had will can could")
_WANTING = ("need", "needs", "want", "wants", "seem", "seems")
"""Verbs that begin no noun: which rooms still need painting."""
_NO_STATES = words_of("on off up down home set made free visible available safe good fine high low")
"""Words of state that may end a question of a place or of a thing's look."""
_TIMES = frozenset((*tw.UNITS, *tw.PARTS, *tw.WEEKDAYS, *tw.MONTHS)) - tw.SHY
_CLOCK_WORDS = words_of("am pm oclock o'clock ago later yesterday today tonight")


def _refuse_leftover_time(
    text: str, found: FormalQuery, rest: list[Word], lexicon: Lexicon
) -> None:
    """Raise NotUnderstood for a word of time that no time took in: it must not go unheard."""
    for i, term in enumerate(found.terms):
        head = term.word.rpartition(" ")[2]
        timed = head in _CLOCK_WORDS or (i > 0 and head in _TIMES)
        if timed and term.word not in lexicon.nouns:
            word = next((w for w in rest if w.text.startswith(head)), rest[-1])
            reason = f"I could not place “{text[word.start : word.end]}” in a time."
            raise NotUnderstood(text, word.start, reason, suggestions(rest, lexicon))


def _came(found: FormalQuery, said: list[str], lexicon: Lexicon) -> bool:
    """Whether it is asked if somebody came, a person by the ending: did the drummer show up."""
    who = found.objects[0].word
    ends = said[0] in ("did", "has", "have") and said[-2:] in (["show", "up"], ["turn", "up"])
    return ends and who.endswith(("er", "or", "ist")) and lexicon.known_noun(who) is None


def _attending(found: FormalQuery, said: list[str]) -> bool:
    """Whether it is asked if people were here: `were any students here lately`."""
    being = len(said) > 1 and said[0] in ("is", "are", "was", "were")
    having = said[:1] in (["do"], ["did"]) and said[2:3] == ["have"]  # do we have guests
    if not (being or having) or said[1] == "there" or found.relation is not None:
        return False
    return found.objects[0].word in scope.lists()["people"] or found.objects[0].category == "person"
