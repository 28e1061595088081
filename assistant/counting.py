"""The sentence of a number: how many there were, of one kind of thing or of several."""

from __future__ import annotations

from datetime import datetime

from assistant.conditions import condition_words, gathered_words
from assistant.english import counted, listed, number_word, plural, sentence_case
from assistant.phrases import described, heads_of, last_words, term_of
from d3a.answer import Answer
from grammar.forms import FormalQuery


def count_words(answer: Answer, query: FormalQuery, now: datetime) -> str:
    """Return how many there were, and when one was seen last.

    They are so many at most as there are ids, and so many at least as must be different things.
    """
    words, together = described(term_of(query), answer.unjudged), gathered_words(answer, query)
    last = last_words(answer, query, now, "seen ")
    if answer.amounts:
        return _of_several(answer, query, f"{condition_words(answer, query)}, {last}")
    said = sentence_case(together or amount_of(answer.least, answer.count, words))
    once = len({k.object_id for k in heads_of(answer) if "tentative" in k.why})
    unsure = f" {sentence_case(number_word(once))} of them I saw only once."
    unsure = unsure if 0 < once < answer.count else ""
    return f"{said}{condition_words(answer, query)}, {last}.{unsure}"


def amount_of(least: int, most: int, words: str) -> str:
    """Return "three cups", "at least two cups and at most four", "at most one cup"."""
    if least == most:
        return counted(most, words)
    if least == 0:
        return f"at most {counted(most, words)}"
    return f"at least {counted(least, words)} and at most {number_word(most)}"


def _of_several(answer: Answer, query: FormalQuery, seen: str) -> str:
    """Return the number of all things that were asked for, and of each kind by itself.

    seen: where, and when last.
    """
    words = [described(term, answer.unjudged) for term in query.objects]
    number = amount_of(answer.least, answer.count, listed([plural(each) for each in words]))
    if answer.least == answer.count == 1:
        number = "one thing"
    amounts = zip(answer.amounts, words, strict=True)
    each = [amount_of(least, most, its) for (least, most), its in amounts]
    return f"{sentence_case(number)}{seen}: {'; '.join(each)}."
