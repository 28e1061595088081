"""Whether so many things were seen as a question says: two cups, at most three, exactly four."""

from __future__ import annotations

from assistant.english import counted, number_word
from assistant.phrases import described, term_of
from d3a.answer import Answer
from grammar.forms import FormalQuery


def holds(answer: Answer, query: FormalQuery) -> bool | None:
    """Return whether the number asked for is that of the things found; None where none can tell.

    `least` of them must be different things, and there are no more than `count`.
    """
    term = term_of(query)
    number, least, most = term.quantity, answer.least, answer.count
    assert number is not None
    if term.bound == "least":
        return True if least >= number else None if most >= number else False
    if term.bound == "most":
        return True if most <= number else None if least <= number else False
    if least == most == number:
        return True
    return None if least <= number <= most else False


def other_amount_words(answer: Answer, query: FormalQuery, condition: str, last: str) -> str:
    """Return a sentence on a number that is not the one asked for: too few, or too many."""
    words = described(term_of(query), answer.unjudged)
    vague = answer.least < answer.count
    if answer.count < (term_of(query).quantity or 0):
        seen = f"{'at most' if vague else 'only'} {counted(answer.count, words)}"
    else:
        seen = f"{'at least ' * vague}{counted(answer.least, words)}"
    return f"{_opening(query, verdict=False)}I saw {seen}{condition}, {last}."


def amount_words(answer: Answer, query: FormalQuery, condition: str, last: str) -> str:
    """Return a sentence on the number seen; "" where that is the number, to be told as a thing.

    It is not another number than the one asked for, as far as can be told.

    condition: the relation and place asked for. last: when it was seen last.
    """
    term, verdict = term_of(query), holds(answer, query)
    words = described(term, answer.unjudged)
    least = counted(answer.least, words)
    vague = answer.least < answer.count
    if verdict is None:
        seen = f"at least {least}" if term.bound == "least" else _between(answer, words)
        told = f"I cannot be sure: I saw {seen}{condition}, {last}"
        return f"{told}. More that I saw may be the same at another place."
    if verdict and not vague and term.bound != "most":
        return ""
    opening = "" if answer.unjudged else _opening(query, verdict=True)
    seen = _between(answer, words) if term.bound == "most" else f"at least {least}"
    return f"{opening}I saw {seen}{condition}, {last}."


def agrees_with_none(query: FormalQuery) -> bool:
    """Whether nothing seen is what the question says: no cup, at most two cups."""
    at_most = term_of(query).bound == "most"
    if query.contrary:  # was it ever not there: nothing to the contrary is a no
        return False
    return query.ask == "whether" and (query.negated != at_most)


def _between(answer: Answer, words: str) -> str:
    if answer.least == answer.count:
        return counted(answer.least, words)
    return f"at least {number_word(answer.least)} and at most {counted(answer.count, words)}"


def _opening(query: FormalQuery, *, verdict: bool) -> str:
    """Return the word before what was seen, as the question's own polarity has it."""
    if query.negated:
        return "No, there was: " if verdict else "That is right: "
    return "Yes. " if verdict else "No. "
