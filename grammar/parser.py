"""The parser: a question in English to its formal query.

Stages: words -> names of colours -> spelling -> plain speech -> spoken times out -> terminals ->
grammar -> query.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import datetime
from typing import TypeVar

from grammar import asides, dictated, hues, respelling, speech, spelling
from grammar.cutting import sentences
from grammar.errors import Ambiguous, QuestionError
from grammar.forms import Correction, FormalQuery
from grammar.reading import Reading, capped
from grammar.vocabulary import Lexicon, StoreWords, lexicon
from grammar.words import Word

NO_STORE = StoreWords()
Read = TypeVar("Read")


@dataclass(frozen=True, slots=True)
class Parsed:
    """A formal query, and the spelling corrections that it rests on."""

    query: FormalQuery
    corrections: tuple[Correction, ...] = ()


def parse(text: str, *, now: datetime, words: StoreWords = NO_STORE) -> FormalQuery:
    """Return the formal query of a question.

    now: aware, in the home's zone; all times of the query are in that zone.
    words: a store's categories, taught names and places, which count as known words.
    Raises QuestionError (OutOfScope, NotUnderstood, Ambiguous) and nothing else.
    """
    return parse_report(text, now=now, words=words).query


def parse_report(text: str, *, now: datetime, words: StoreWords = NO_STORE) -> Parsed:
    """Return what `parse` returns, with the spelling corrections it rests on."""
    query, corrections = read(text, now, words, Reading.of)
    return Parsed(replace(query, corrections=corrections), corrections)


def read(
    text: str,
    now: datetime,
    words: StoreWords,
    meaning: Callable[[Reading, list[list[Word]]], Read],
) -> tuple[Read, tuple[Correction, ...]]:
    """Return what `meaning` makes of the sentences of a text, and the corrections it rests on.

    Where it raises, slips in the grammar's own words are made good and it is tried again.
    Raises the first QuestionError where nothing helps.
    """
    if now.tzinfo is None:
        raise ValueError("now has no zone; hand in an aware datetime")
    lex = lexicon(words)
    reading = Reading(text, now, lex)
    said = dictated.with_marks(capped(text), lex)
    found, corrections = spelling.corrected(hues.with_hues(said, lex), lex, words)
    try:
        return meaning(reading, _plain(found, lex)), corrections
    except Ambiguous:
        raise
    except QuestionError:
        for said, slips in respelling.respelled(found, spelling.known(words), corrections):
            with suppress(QuestionError):
                return meaning(reading, _plain(said, lex)), slips
        for said in asides.without_pauses(found):
            with suppress(QuestionError):
                return meaning(reading, _plain(said, lex)), corrections
        for parts in asides.without_asides(_plain(found, lex), lex):
            with suppress(QuestionError):
                return meaning(reading, _opened(parts, lex)), corrections
        raise


def _plain(words: list[Word], lex: Lexicon) -> list[list[Word]]:
    """Return the sentences in plain words."""
    return _opened(sentences(words), lex)


def _opened(spoken: list[list[Word]], lex: Lexicon) -> list[list[Word]]:
    return [plain for words in spoken if (plain := speech.plain(words, lex))]
