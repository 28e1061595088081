"""Self-corrections: `where is the cup no the bowl` asks for the bowl."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from grammar import numbers, timespan
from grammar import timewords as tw
from grammar.closed import LEADING, is_open, words_of
from grammar.sayings import AUXILIARIES, QUESTION_STARTS, QUESTION_WORDS, sections
from grammar.vocabulary import Lexicon
from grammar.words import Word


def corrected(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Apply each self-correction: the later words take the place of their like before them."""
    marks = sections()["correction"]
    i = 1
    while i < len(words):
        count = marks.at(words, i)
        if count and (said_after := _before_mark(words, i, count)) is not None:
            words, i = said_after, 1
            continue
        if count and _corrects(words, i, count):
            before, after = _without_commas(words[:i], words[i + count :])
            if words[i].text in HESITATING and not _likened(before, after, lexicon):
                words = [*before, replace(words[i], text=","), *after]
            elif after and before:
                words = _replaced(before, after, lexicon)
                i = 1
                continue
        i += 1
    return words


def _without_commas(before: list[Word], after: list[Word]) -> tuple[list[Word], list[Word]]:
    """Take the commas off where two parts of a sentence meet."""
    while before and before[-1].text == ",":
        before = before[:-1]
    while after and after[0].text == ",":
        after = after[1:]
    return before, after


_AFTER_NO = words_of(
    "longer one more other later earlier sooner less rush hurry worries problem matter idea clue"
)
_DENYING = words_of("there is are was were")
HESITATING = words_of("er erm uh uhh um umm uhm hm hmm well")
"""Between commas these correct a like thing said before them, and else say nothing."""
_MARKING_AFTER = ("i mean", "i meant", "rather", "sorry", "i should say")
_LONGEST_INSERT = 4


def _before_mark(words: list[Word], i: int, count: int) -> list[Word] | None:
    """Correct by what stands before its mark: a fork, a knife i mean, in the kitchen."""
    ends = i + count == len(words) or words[i + count].text == ","
    if not ends or " ".join(w.text for w in words[i : i + count]) not in _MARKING_AFTER:
        return None
    comma = next((k for k in range(i - 1, 1, -1) if words[k].text == ","), i)
    insert = words[comma + 1 : i]
    bare = {w.text for w in insert} & {"one", "ones"} or not any(is_open(w.text) for w in insert)
    if bare or len(insert) > _LONGEST_INSERT or insert[0].text in QUESTION_STARTS:
        return None
    k = comma - 1
    while k > 1 and is_open(words[k - 1].text):
        k -= 1
    if k > 1 and words[k - 1].text in _DETERMINERS and insert[0].text in _DETERMINERS:
        k -= 1
    rest = words[i + count :]
    return [*words[:k], *insert, *rest[1:]]


def _likened(before: list[Word], after: list[Word], lexicon: Lexicon) -> bool:
    """Whether what follows a hesitation is like what stands before it: a thing, a time."""
    if len(after) < 2 or not before or after[1].text in ("one", "ones"):
        return False
    timed = timespan.find([w.text for w in after])
    if timed and timed[0].first == 0:
        told = timespan.find([w.text for w in before])
        return bool(told) and told[-1].last == len(before)
    named = is_open(before[-1].text)
    return (
        named
        and _kind(after[0].text, lexicon) == "determiner"
        and any(_kind(w.text, lexicon) == "determiner" for w in before[1:])
    )


def _corrects(words: list[Word], i: int, count: int) -> bool:
    """Whether the mark at `i` is a self-correction and no part of the question."""
    said = words[i].text
    before = words[i - 1].text
    following = words[i + count].text if i + count < len(words) else ""
    if not following:
        return False
    if said in HESITATING and count == 1:
        return before == "," and following == ","
    if said in ("no", "nope") and count == 1:
        if following in _AFTER_NO:
            return False
        return (
            before == ","
            or is_open(before)
            or before[:1].isdecimal()
            or _kind(before, None) is not None
            or before in ("on", "in", "the", "my", "under")
        )
    if said == "not":  # the mirror that is not that is not round
        return before == "," or is_open(before)
    if said == "no" and before in _DENYING and words[i + 1].text == "no":
        return False  # is there no no lamp
    if said == "actually" and count == 1:
        return _said_anew(words[:i], words[i + 1 :])
    if said in ("rather", "make", "wait", "actually", "sorry"):
        return following not in ("than",)
    return True


def _said_anew(before: list[Word], after: list[Word]) -> bool:
    """Whether what follows is said instead of its like: on monday actually on tuesday."""
    following = after[0].text
    if following in _DETERMINERS or following.endswith("'s"):
        return True
    told, anew = (timespan.find([w.text for w in part]) for part in (before, after))
    if told and anew and told[-1].last == len(before) and anew[0].first == 0:
        return True
    places = [w.text for w in before[1:-1] if w.text in _PREPOSITIONS]
    return bool(places) and following in _PREPOSITIONS


def _replaced(before: list[Word], after: list[Word], lexicon: Lexicon) -> list[Word]:
    """Return `before` with its end replaced by `after`, from the last word of the same kind."""
    if after[0].text == "not" and len(after) > 1:
        return before
    if after[0].text in QUESTION_STARTS and after[0].text not in ("in", "on", "at", "is", "was"):
        return after
    if after[0].text in ("is", "was", "are", "were") and before[0].text in (
        *AUXILIARIES,
        *QUESTION_WORDS,
    ):
        return after
    if (timed := _time_replaced(before, after)) is not None:
        return timed
    same: list[Callable[[str], bool]] = [
        lambda word: word == after[0].text,
        lambda word: (
            (kind := _kind(after[0].text, lexicon)) is not None and _kind(word, lexicon) == kind
        ),
    ]
    for alike in same:
        for k in range(len(before) - 1, 0, -1):
            if alike(before[k].text):
                return [*before[:k], *after]
    return _head_replaced(before, after)


def _time_replaced(before: list[Word], after: list[Word]) -> list[Word] | None:
    """Put a time in the place of the one said last: yesterday no the day before yesterday."""
    corrected = timespan.find([w.text for w in after])
    if not corrected or corrected[0].first != 0:
        return None
    said = timespan.find([w.text for w in before])
    if not said or said[-1].last != len(before):
        return None
    if corrected[0].last - corrected[0].first == 1:
        return None  # monday no tuesday: the word alone is replaced
    first = said[-1].first
    bound = before[first : first + 1]
    unbound = _bounds(bound) and not _bounds(after[:1])
    return [*before[:first], *(bound if unbound else ()), *after]


def _bounds(words: list[Word]) -> bool:
    """Whether a word bounds the time that follows it: until ten, sorry, eleven."""
    return bool(words) and tw.PHRASES.get(words[0].text, ("",))[0] in _BOUNDING


_BOUNDING = ("_SINCE", "_UNTIL", "_BEFORE", "_AFTER", "_FROM")


def _head_replaced(before: list[Word], after: list[Word]) -> list[Word]:
    """Put `after` in the place of the last noun phrase, or at the end."""
    k = len(before)
    while k > 1 and is_open(before[k - 1].text):
        k -= 1
    if after[0].text in _DETERMINERS and k > 1 and before[k - 1].text in _DETERMINERS:
        k -= 1
    return [*before[:k], *after] if k < len(before) else [*before, *after]


_DETERMINERS = LEADING | {"any", "some"}
_PREPOSITIONS = words_of(
    "on in under behind near by above below beside inside at over beneath underneath"
)


def _kind(word: str, lexicon: Lexicon | None) -> str | None:
    """Return the kind of word that a correction replaces like with like by."""
    if word in _DETERMINERS:
        return "determiner"
    if word in _PREPOSITIONS:
        return "preposition"
    if word in tw.WEEKDAY_NUMBER or word in ("yesterday", "today", "tonight"):
        return "day"
    if word in tw.PARTS:
        return "part"
    if word in numbers.CARDINALS or word.isdecimal():
        return "number"
    if lexicon is not None and word in lexicon.attributes:
        return "attribute"
    if lexicon is not None and word.endswith("'s"):
        return "determiner"
    return None
