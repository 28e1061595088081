"""A clock time told with what happened then: since i left at noon, at six when we came home.

What happened is no thing that was seen, and the clock says all that counts; so it is taken out.
"""

from __future__ import annotations

from dataclasses import replace

from grammar import timespan
from grammar.closed import LEADING, is_open, words_of
from grammar.sayings import QUESTION_STARTS, QUESTION_WORDS
from grammar.words import Word

_BOUNDS = words_of("since after before until till")
_THEN = words_of("when while as")
_IT_WAS = (("it", "was"), ("it", "is"), ("it", "were"))
_SUBJECTS = words_of("i we he she they everyone everybody")
_LONGEST = 9
"""A clause has its time after so few words, counted from what joins it."""
_CLOSED_VERBS = words_of("was were had did left found put")


def without_happenings(words: list[Word]) -> list[Word]:
    """Return the words without a clause that the time in it, or right before it, places."""
    texts = [w.text for w in words]
    if _BOUNDS.isdisjoint(texts) and _THEN.isdisjoint(texts):
        return words
    for i, text in enumerate(texts):
        if i and text in _THEN and tuple(texts[i + 1 : i + 3]) in _IT_WAS:
            times = [time for time in timespan.find(texts) if _by_clock(time)]
            if any(time.first == i + 3 for time in times):  # when it was four o'clock
                return [*words[:i], replace(words[i], text="at"), *words[i + 3 :]]
        verb = _verb_of(texts, i + 1)
        if (text not in _BOUNDS and text not in _THEN) or not verb:
            continue
        end = next((k for k in range(verb, len(texts)) if texts[k] in _ENDS), len(texts))
        times = [time for time in timespan.find(texts) if _by_clock(time)]
        if text == "when" and any(time.last == i for time in times):
            return [*words[:i], *words[end:]]  # at noon when i left
        told = next((time for time in times if verb < time.first < min(end, i + _LONGEST)), None)
        if told is not None and (i or _asks(texts[told.last :])):
            half = _half_of_day(texts[verb : told.first], told)
            said = [*words[told.first : told.last], *(replace(words[i], text=t) for t in half)]
            return [*words[: i + (text in _BOUNDS)], *said, *words[told.last :]]
    return words


_ENDS = frozenset((",", *QUESTION_WORDS))


def _asks(texts: list[str]) -> bool:
    """Whether a question follows what happened: when i left at noon, where was it."""
    following = next((text for text in texts if text != ","), "")
    return following in QUESTION_STARTS


def _verb_of(texts: list[str], i: int) -> int:
    """Return where the verb of a clause that starts at `i` stands: i left, my wife came; else 0."""
    subject = texts[i : i + 1]
    if subject and subject[0] in LEADING and texts[i + 1 :] and is_open(texts[i + 1]):
        i += 1
    elif not subject or subject[0] not in _SUBJECTS:
        return 0
    verb = texts[i + 1 : i + 2]
    return i + 1 if verb and (is_open(verb[0]) or verb[0] in _CLOSED_VERBS) else 0


def _half_of_day(happened: list[str], told: timespan.Found) -> list[str]:
    """Return the am or pm that what happened says of a bare clock time: went to bed at nine."""
    from grammar.timeforms import Clock

    clock = told.said.pieces[0] if len(told.said.pieces) == 1 and not told.said.bounds else None
    if not isinstance(clock, Clock) or clock.meridiem or clock.exact:
        return []
    halves = ((_RISING, "am", 4), (_RESTING, "pm", 6))
    return [half for said, half, first in halves if said & {*happened} and first <= clock.hour < 12]


_RISING = words_of("up woke awoke breakfast")
_RESTING = words_of("bed asleep dinner supper")


def _by_clock(time: timespan.Found) -> bool:
    """Whether a time is placed by the clock, to the hour: a day would be too long for it."""
    from grammar.timeforms import Ago, Clock

    sides = (time.said.pieces, *(side for bound in time.said.bounds for side in bound.sides))
    return any(isinstance(piece, Clock | Ago) for side in sides for piece in side)
