"""Who is called in a question: where is my purse, hen; is the cup on the table, big fella.

Whoever is called is no part of the thing that is named before.
"""

from __future__ import annotations

from itertools import pairwise

from grammar import timespan
from grammar.closed import is_open, words_of
from grammar.nountags import KIN
from grammar.phrases import phrases, place_follows
from grammar.vocabulary import Lexicon
from grammar.words import Word

_LONGEST = 2
_LEAST_ASKED = 3
_THINGS_TOO = words_of(
    "jack mark bill rose lily daisy iris robin ruby pearl penny ray mike frank art grant dot peg "
    "basil ginger olive joy hope grace rob nick pat"
)
"""Names that are things as well: a car jack, a bath pearl."""
_NAMED = ("it", "them", "one", "ones")


def without_calls(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Return the words without whom they call, between pauses or by name at the end."""
    texts = [w.text for w in words]
    pauses = [i for i, text in enumerate(texts) if text == ","]
    for i, end in pairwise((*pauses, len(texts))):
        if i >= _LEAST_ASKED and _calls(words, i + 1, end, lexicon):
            return without_calls([*words[:i], *words[end:]], lexicon)
    if len(words) > _LEAST_ASKED and _called(texts, lexicon):
        return words[:-1]
    return words


def _calls(words: list[Word], first: int, end: int, lexicon: Lexicon) -> bool:
    """Whether the words between two pauses name nobody's thing: hen, big fella; not mug, red."""
    texts = [w.text for w in words[first:end]]
    if not 0 < len(texts) <= _LONGEST or not all(map(is_open, texts)):
        return False
    pause, before = words[first - 1], words[first - 2].text
    if pause.end - pause.start > 1 and is_open(before) and not lexicon.known_noun(before):
        return False  # the pruning... shears
    if [w.text for w in words[end + 1 : end + 2]] in (["and"], ["or"]):
        return False  # the keys, gizmo, and the bag
    if texts[-1] in KIN or texts[-1] in lexicon.names:
        return True
    named = lexicon.known_noun(" ".join(texts)) or lexicon.known_noun(texts[-1])
    said = named or texts[-1] in lexicon.attributes or texts[-1] in lexicon.places
    placed = any(place_follows(words, k) for k in range(first, end))
    return not (said or placed or texts[0] in phrases().verbs or timespan.find(texts))


def _called(texts: list[str], lexicon: Lexicon) -> bool:
    """Whether a person is called by name, with no pause, after a thing: where is my phone anna."""
    *_, thing, person = texts
    named = person in lexicon.names and person not in _THINGS_TOO
    if (not named and person not in KIN) or person in lexicon.attributes:
        return False
    before = lexicon.known_noun(thing) or thing in lexicon.places or thing in _NAMED
    return bool(before) and not lexicon.known_noun(f"{thing} {person}")
