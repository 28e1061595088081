"""The parser: a question in English to its formal query.

Stages: words -> spelling -> plain speech -> spoken times out -> terminals -> grammar -> query.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import datetime

from grammar import speech, spelling
from grammar.forms import Correction, FormalQuery
from grammar.reading import Reading, capped
from grammar.vocabulary import StoreWords, lexicon
from grammar.words import Word

NO_STORE = StoreWords()


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
    reading, sentences, corrections = opened(text, now, words)
    return Parsed(replace(reading.of(sentences), corrections=corrections), corrections)


def opened(
    text: str, now: datetime, words: StoreWords
) -> tuple[Reading, list[list[Word]], tuple[Correction, ...]]:
    """Return the reading of a text and its sentences in plain, corrected words."""
    if now.tzinfo is None:
        raise ValueError("now has no zone; hand in an aware datetime")
    lex = lexicon(words)
    found, corrections = spelling.corrected(capped(text), lex, words)
    sentences = [plain for s in speech.sentences(found) if (plain := speech.plain(s, lex))]
    return Reading(text, now, lex), sentences, corrections
