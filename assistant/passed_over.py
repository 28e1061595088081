"""What a question says of a thing and no memory of sightings can use: it is told, not ignored."""

from __future__ import annotations

import re
from itertools import pairwise

from assistant.english import ORDINALS
from assistant.phrases import likely_of, term_of
from d3a.answer import Answer
from grammar import vocabulary
from grammar.closed import is_open
from grammar.forms import FormalQuery
from grammar.phrases import phrases

_NUMBERED = re.compile(rf"{'|'.join(ORDINALS[1:])}|(?!1st)\d{{1,2}}(?:st|nd|rd|th)")
_SUBJECTS = ("i", "we", "you", "he", "she", "they")
_BEFORE = frozenset(
    {"have", "had", "has", "was", "were", "am", "are", "been", "just", "only", "always", "usually"}
    | {"often", "once", "recently", "originally", "actually"}
)
"""What may stand between the subject of a clause and its verb."""


def of_its_number(answer: Answer, query: FormalQuery) -> str:
    """Return that "the third cup" was read as the cup: nobody numbers what lies about."""
    if not answer.keyframes:
        return ""
    told = [{*term.word.split(), *term.attributes} for term in query.objects]
    for number, word in pairwise(_words(query)):
        if not _NUMBERED.fullmatch(number):
            continue
        its = next((each for each in told if vocabulary.singular(word) in each), None)
        if its is not None and number not in its:
            return f"Which one is the {number} I cannot tell."
    return ""


def of_its_clause(answer: Answer, query: FormalQuery) -> str:
    """Return that "the cup I bought yesterday" was read as any cup, seen yesterday.

    Only where there are several: of the one that there is it tells nothing.
    """
    likely = {keyframe.object_id for keyframe in likely_of(answer)}
    if answer.status != "found" or len(likely) < 2 or not query.objects:
        return ""
    words, head = _words(query), term_of(query).word.split()[-1]
    for at, word in enumerate(words):
        if vocabulary.singular(word) == vocabulary.singular(head) and (
            said := _clause(words, at + 1)
        ):
            time = "" if query.time is None else " I took the time as when I saw it."
            return f"Which one is meant by “{said}” I cannot tell.{time}"
    return ""


def _clause(words: list[str], start: int) -> str:
    """Return the clause that begins at a word, up to its verb; "" where that is used, or none."""
    at = start + (words[start : start + 1] in (["that"], ["which"]))
    if words[at : at + 1] == [] or words[at] not in _SUBJECTS:
        return ""
    verb = next((k for k in range(at + 1, len(words)) if words[k] not in _BEFORE), len(words))
    if verb == len(words) or words[verb] in phrases().verbs or not is_open(words[verb]):
        return ""
    subject = "I" if words[at] == "i" else words[at]
    return " ".join([subject, *words[at + 1 : verb + 1]])


def _words(query: FormalQuery) -> list[str]:
    return [word.strip(".,?!").lower() for word in query.text.split()]
