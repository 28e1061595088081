"""Questions that do parse: what a person may say instead, and how a query is said."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from grammar.closed import is_open
from grammar.cursor import OWNERS, TIME_GAP
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm
from grammar.nouns import Attribute, Noun, NounReader
from grammar.phrases import breaks
from grammar.vocabulary import Lexicon, files
from grammar.words import Word


def suggestions(words: list[Word], lexicon: Lexicon, text: str = "") -> tuple[str, ...]:
    """Return up to three questions that do parse and share words with this one.

    text: the question, where the time that was said in it is to stay; it can be placed then.
    """
    nouns = _nouns(words, lexicon)
    if not nouns:
        return ()
    first = nouns[0]
    times = [text[w.start : w.end] for w in words if w.text == TIME_GAP]
    other = f" near {nouns[1].said}" if len(nouns) > 1 else ""
    if len(times) == 1 and times[0]:
        found = [f"Where {first.was} {first.said}", f"When did you see {first.said}"]
        return tuple(f"{each} {times[0]}?" for each in (*found, f"Did you see {first.said}{other}"))
    found = [f"Where {first.be} {first.said}?", f"When did you last see {first.said}?"]
    return (*found, f"Did you see {first.said}{other or ' today'}?")


@dataclass(frozen=True, slots=True)
class _Mentioned:
    """A noun phrase of a question that failed, ready to be asked for."""

    said: str
    be: str

    @property
    def was(self) -> str:
        """The verb of what is over."""
        return "were" if self.be == "are" else "was"


def _nouns(words: list[Word], lexicon: Lexicon) -> list[_Mentioned]:
    """Return the known nouns of the words with a determiner, as they were said."""
    reader = NounReader(lexicon, breaks)
    lists = files.sections("scope.txt")
    unseen = {*lists["abstract"], *lists["medium"]}
    if words and words[0].text in lists["command"]:
        words = words[1:]
    found: list[_Mentioned] = []
    i = 0
    while i < len(words):
        if not is_open(words[i].text):
            i += 1
            continue
        parts = reader.read(words, i)
        start, i = i, parts[-1][2]
        attributes = [p.said for p, _, _ in parts if isinstance(p, Attribute) and p.kind != "other"]
        nouns = [_without_state(words, n, a, b, lexicon, (*lists["state"], "tomorrow"))
                 for n, a, b in parts if isinstance(n, Noun)]  # fmt: skip
        nouns = [(p, a, b) for p, a, b in nouns if p.known]
        if not nouns or nouns[0][0].category == ANYTHING or nouns[0][0].said in unseen:
            continue
        noun, first, last = nouns[0]
        as_said = " ".join(w.text for w in words[first:last])
        lead = words[start - 1].text if start and words[start - 1].text in OWNERS else "the"
        several = as_said != noun.said or lexicon.plurals.get(as_said) == as_said
        several = several and not as_said.endswith("ss")  # a glass is one
        found.append(_Mentioned(" ".join([lead, *attributes, as_said]), "are" if several else "is"))
    return list(dict.fromkeys(found))


def _without_state(
    words: list[Word], noun: Noun, first: int, last: int, lexicon: Lexicon, states: Sequence[str]
) -> tuple[Noun, int, int]:
    """Cut off the state that a noun was asked for: `is the milk cold` is about the milk."""
    if noun.said in lexicon.nouns or last - first < 2 or words[last - 1].text not in states:
        return noun, first, last
    said = lexicon.singular(" ".join(w.text for w in words[first : last - 1]))
    return Noun(lexicon.canonical(said), said, known=True), first, last - 1


_RELATIONS = {"in_front_of": "in front of", "left_of": "left of", "right_of": "right of",
              "together": "with", "same_place": "in the same place as"}  # fmt: skip


def spelled(query: FormalQuery) -> str:
    """Return a plain question for a query, to tell two readings apart."""
    named = " and ".join(phrase(term) for term in query.objects)
    anything = bool(query.objects) and query.objects[0].category == ANYTHING
    if query.relation is not None and len(query.objects) > 1:
        first, *rest = (phrase(term) for term in query.objects)
        kind = _RELATIONS.get(query.relation.kind, query.relation.kind)
        named = f"{first} {kind} {' and '.join(rest)}"
    if query.place is not None:
        named += f" in the {query.place}"
    match query.ask:
        case "where" if query.select == "last":
            return f"Where is {named}?"
        case "where" | "when":
            return f"{query.ask.capitalize()} did you see {named}?"
        case "what" if anything and not query.objects[0].attributes:
            return f"What is {named.removeprefix('the thing ')}?"
        case "what":
            return f"Show me {named}"
        case _:
            return f"Did you see {named}?"


def phrase(term: ObjectTerm) -> str:
    """Return a noun phrase for an object term."""
    owner = {None: "the", "me": "my", "you": "your"}.get(term.owner) or f"{term.owner}'s"
    return " ".join([owner, *term.attributes, term.word])
