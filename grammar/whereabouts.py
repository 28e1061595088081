"""A thing's location asked for by its name: my phone's location, wallet location yesterday."""

from __future__ import annotations

from dataclasses import replace

from grammar import timespan
from grammar.closed import is_open
from grammar.sayings import AUXILIARIES
from grammar.words import Word


def located(words: list[Word]) -> list[Word]:
    """Read a thing's location as where it is: `my phone's location`, `wallet location`."""
    texts = [w.text for w in words]
    at = next((i for i, text in enumerate(texts) if text in _LOCATIONS), 0)
    first = next((n for n in (2, 0) if tuple(texts[:n]) in _SHOWN), None)
    if first is None or at - first < 1 or "of" in texts or not is_open(texts[at - 1]):
        return words
    if not AUXILIARIES.isdisjoint(texts[first:at]):
        return words  # did it change position
    times = timespan.find(texts[at + 1 :])
    when = times and (times[0].first, times[-1].last) == (0, len(texts) - at - 1)
    if at + 1 < len(texts) and not when:
        return words
    named = [*words[first : at - 1], replace(words[at - 1], text=texts[at - 1].removesuffix("'s"))]
    asked = (replace(words[at], text=text) for text in ("where", "was" if when else "is"))
    return [*asked, *named, *words[at + 1 :]]


_LOCATIONS = ("location", "whereabouts", "position")


_SHOWN = ((), ("what", "is"), ("give", "me"), ("show", "me"), ("tell", "me"), ("get", "me"))
