"""Why one asks, and when a thing was seen by telling it: taken off the end of a question."""

from __future__ import annotations

from dataclasses import replace

from grammar import speech
from grammar.closed import is_open, words_of
from grammar.cursor import DETERMINERS, OWNERS
from grammar.words import Word

_NO_VERBS = words_of("left right the a an my your our his her their its this that me you be")
_NO_PURPOSE = words_of(
    "something anything place somewhere anywhere want need thing way spot belonging belongs belong "
    "belonged happen happened going able supposed used like next close adjacent attached "
    "opposite similar nearest closest"
)
_REASONS = words_of("so because cause cos coz cuz only before")
_WENT = words_of("was were had did went left came got took ate slept woke fell lost made")


def _past(verb: str) -> bool:
    """Whether a verb tells what has happened: before i went out is a time, before i go none."""
    return verb in _WENT or verb.endswith("ed")


def without_purpose(words: list[Word]) -> list[Word]:
    """Cut off what only says why one asks: `so i can watch tv`, `to put some snacks`."""
    texts = [w.text for w in words]
    if texts[-2:] in (["saw", "it"], ["saw", "them"]) and "you" in texts[-4:]:
        return _last_saw(words)
    for i in range(3, len(texts) - 3):
        user = texts[i] == "for" and (texts[i + 1] in DETERMINERS or texts[i + 1] in OWNERS)
        if user and is_open(texts[i + 2]) and texts[i + 3] == "to":
            return words[:i]  # for the guest to use
    if not texts or texts[0] not in ("where", "whereabouts", speech.SEEK, "have", "did", "when"):
        return words
    for i in range(2, len(texts)):
        rest = texts[i + 1 : i + 3]
        if (
            texts[i] in _REASONS
            and rest
            and rest[0] in ("i", "we", "that")
            and not (texts[i] == "before" and _past(rest[-1]))
        ):
            return words[:i]
        if (
            texts[i] in ("i", "we")
            and rest
            and rest[0] in ("want", "need", "have", "would", "am")
            and _complete(texts[:i])
        ):
            return words[:i]
        infinitive = texts[i] == "to" and bool(rest) and rest[0] not in _NO_VERBS
        if infinitive and i >= 3 and is_open(texts[i - 1]) and texts[i - 1] not in _NO_PURPOSE:
            return words[:i]
        if texts[i] == "in" and rest[:2] == ["order", "to"]:
            return words[:i]
    return words


def _last_saw(words: list[Word]) -> list[Word]:
    """Read `when you last saw it` at the end as the word last, and the first time as first."""
    texts = [w.text for w in words]
    for which in ("last", "first"):
        for opening in (
            ["the", which, "time", "you"],
            [which, "time", "you"],
            ["when", "you", which],
            ["when", which, "you"],
        ):
            for i in range(3, len(texts) - len(opening)):
                if texts[i : i + len(opening)] == opening:
                    return [*words[:i], replace(words[i], text=which)]
    return words


def _complete(texts: list[str]) -> bool:
    """Whether a clause may be over: it has a noun, and no verb waits for its subject."""
    return is_open(texts[-1]) and len(texts) >= 3
