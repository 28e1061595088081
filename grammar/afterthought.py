"""What is said of a question's thing in a sentence of its own: where is my bag? The red one.

Such a sentence asks nothing anew; it goes to the question before it, which must not lose it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from grammar import timespan
from grammar.closed import LEADING, words_of
from grammar.corrections import corrected
from grammar.errors import QuestionError
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm
from grammar.meaning import THING
from grammar.vocabulary import Lexicon
from grammar.words import Word

if TYPE_CHECKING:
    from grammar.reading import Reading

_OPENINGS = (("i", "mean"), ("i", "meant"), ("it", "must", "be"), ("it", "should", "be"))
_BEING = words_of("is was are were")
_PRONOUNS = words_of("it they he she that those this these")
_ONES = words_of("one ones")
_CLAUSES = tuple([subject] for subject in ("i", "we", "you", "he", "she", "they", "my", "our"))
_LOOKS = frozenset(
    ("DET", "OWNER", "ATTR", "NOT_ATTR", "NOUN", "ONE", "PART", "OWNED", "_THAT_IS",
     "_THAT_IS_NOT", "_WITH_PART", "_WITHOUT_PART", "_MADE_OF", "_NOT_MADE_OF", "_EXCEPT")
)  # fmt: skip
_PLACING = frozenset(("REL", "THAT_NOT_REL", "AT_PLACE", "NOT_AT_PLACE", "HERE", *_LOOKS))


def told_of(
    reading: Reading, asked: FormalQuery, question: list[Word], words: list[Word]
) -> tuple[FormalQuery, list[Word]] | None:
    """Return what was asked with what the words add to it, None where they add nothing.

    question: the words that `asked` was read from; a time or a place that follows goes on them,
    and they are returned with it.
    """
    if not asked.objects:
        return None
    said = _meant(words)
    texts = [w.text for w in said]
    denied = next((i for i in range(2, len(texts)) if texts[i : i + 2] == [",", "not"]), 0)
    if denied and _described(reading, said) is None:
        said = said[:denied]  # the small one, not the double
    longer = _gone_on(reading, asked, question, said)
    if longer is None:
        term = _described(reading, said)
        more = _merged(asked, term, reading.lexicon) if term is not None else None
        if more is not None:
            return more, question
        longer = _instead(reading, question, words, said)
    try:
        found = reading.sentence(longer, None) if longer else asked
    except QuestionError:
        return None
    return (found, longer) if longer and found.ask == asked.ask else None


def _instead(
    reading: Reading, question: list[Word], words: list[Word], said: list[Word]
) -> list[Word]:
    """Return the question with what is meant instead, or said of one as of its thing; else []."""
    if tuple(w.text for w in words[:2]) in _OPENINGS:
        return corrected([*question, *words], reading.lexicon)  # i meant the bowl
    ones = narrows(said)
    return [*question, replace(said[0], text=","), *said] if ones else []


def is_bare(reading: Reading, words: list[Word]) -> bool:
    """Whether the words only name or describe a thing, and ask nothing by themselves."""
    return _described(reading, _meant(words)) is not None


def narrows(words: list[Word]) -> bool:
    """Whether the words tell which one is meant, whatever they say of it: not the double one.

    What somebody did with it says nothing that is seen: the one i bought.
    """
    texts = [w.text for w in words]
    one = next((i for i, text in enumerate(texts) if text in _ONES), 0)
    told = one > 0 and (texts[0] in LEADING or texts[0] == "not") and _BEING.isdisjoint(texts)
    return told and texts[one + 1 : one + 2] not in _CLAUSES


def it_described(reading: Reading, it: ObjectTerm, words: list[Word]) -> ObjectTerm | None:
    """Return what `it` means with what the words say of it: i had a jacket. The red one."""
    term = _described(reading, _meant(words))
    return _more(it, term, reading.lexicon) if term is not None else None


def _meant(words: list[Word]) -> list[Word]:
    """Return the words that describe: i mean the red one; it is red; not the blue one, the red."""
    texts = [w.text for w in words]
    opening = next((o for o in _OPENINGS if tuple(texts[: len(o)]) == o), ())
    words, texts = words[len(opening) :], texts[len(opening) :]
    instead = next((i for i in range(2, len(texts) - 1) if texts[i] in (",", "but")), 0)
    if texts[:1] == ["not"] and instead:
        return _meant(words[instead + 1 + (texts[instead + 1] == "but") :])
    if len(texts) > 2 and texts[0] in _PRONOUNS and texts[1] in _BEING:
        if texts[2] in LEADING and not _ONES.isdisjoint(texts):
            return words[2:]
        lead = [replace(words[0], text=text) for text in ("the", "one", "that")]
        return [*lead, *words[1:]]
    return words


def _gone_on(
    reading: Reading, asked: FormalQuery, question: list[Word], words: list[Word]
) -> list[Word] | None:
    """Return the question with a time or a place that is told after it, None for anything else."""
    texts = [w.text for w in words]
    times = timespan.find(texts)
    if times and times[0].first == 0 and times[-1].last == len(texts):
        return [*question, *words] if asked.time is None else None
    kinds = _kinds(reading, words)
    if not kinds or not kinds <= _PLACING or kinds <= _LOOKS:
        return None
    ones = not _ONES.isdisjoint(texts)
    if ones:
        return [*question, replace(words[0], text=","), *words]
    named = any(t in _ONES or t in LEADING for t in texts[:1])
    return [*question, *words] if asked.ask != "where" and not named else None


def _kinds(reading: Reading, words: list[Word]) -> frozenset[str]:
    """Return the kinds of terminals that the words are, none where they give away what they are."""
    try:
        found = reading.terminals(words, None)
    except QuestionError:
        return frozenset()
    return frozenset(t.type for t in found.tagged.tags) if found.time is None else frozenset()


def _described(reading: Reading, words: list[Word]) -> ObjectTerm | None:
    """Return the one thing that the words describe, None where they say anything else."""
    try:
        found = reading.terminals(words, None)
        kinds = {t.type for t in found.tagged.tags}
        if not kinds or not kinds <= _LOOKS or found.time is not None:
            return None
        group = reading.parsed(found, "fragment").things.group
    except QuestionError:
        return None
    return group.terms[0] if group is not None and len(group.terms) == 1 else None


def _merged(asked: FormalQuery, term: ObjectTerm, lexicon: Lexicon) -> FormalQuery | None:
    """Return what was asked with its thing described further; None where another one is named."""
    thing, *others = asked.objects
    more = _more(thing, term, lexicon)
    known = term.owner is not None or lexicon.known_noun(term.word) is not None
    if more is None and asked.ask == "whether" and term.category != ANYTHING and known:
        more = term  # is the cup on the desk? and the bowl?
    return replace(asked, objects=(more, *others)) if more is not None else None


def _more(thing: ObjectTerm, term: ObjectTerm, lexicon: Lexicon) -> ObjectTerm | None:
    """Return a thing with what a term says of it; None where that names another one."""
    bare = replace(term, var=THING.var) == THING
    wider = (term.category, *lexicon.wider(term.category))
    if bare or (term.category != ANYTHING and thing.category not in wider):
        return None
    named = thing if term.category == ANYTHING else term
    return replace(
        thing,
        category=named.category,
        word=named.word,
        attributes=tuple(dict.fromkeys((*thing.attributes, *term.attributes))),
        without=tuple(dict.fromkeys((*thing.without, *term.without))),
        owner=term.owner or thing.owner,
        quantity=term.quantity or thing.quantity,
        or_else=term.or_else or thing.or_else,
        other_than=(*thing.other_than, *term.other_than),
    )
