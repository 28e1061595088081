"""Words that a recogniser writes for a noun's or a color's that sounds the same: my sell phone.

Such a word is known, so it is no slip of spelling; what stands beside it tells what was said.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from grammar.closed import LEADING, is_open
from grammar.vocabulary import Lexicon, files
from grammar.words import Word

_COLORS = {"read": "red", "blew": "blue"}
_ENDS_NOUN = {"draw": "drawer", "draws": "drawers"}


@lru_cache(maxsize=1)
def sounds() -> Mapping[str, str]:
    """Return the words that may be another: read, where red is meant; read once."""
    pairs = (line.partition("=") for line in files.lines("sounds.txt"))
    nouns = {written.strip(): said.strip() for written, _, said in pairs}
    return {**nouns, **_COLORS, **_ENDS_NOUN}


def meant(words: list[Word], i: int, lexicon: Lexicon) -> str | None:
    """Return what was said where `words[i]` was written for its sound, None where it may stand."""
    written = words[i].text
    said = sounds()[written]
    before = words[i - 1].text if i else ""
    after = words[i + 1].text if i + 1 < len(words) and is_open(words[i + 1].text) else ""
    if written in _COLORS:
        return said if before in LEADING and after else None
    if written in _ENDS_NOUN:
        led = before in LEADING or before in lexicon.attributes or before in ("of", "top", "bottom")
        return said if led and not after else None
    if after and _named(said, after, lexicon) and not _named(written, after, lexicon):
        return said
    named = before and _named(before, said, lexicon) and not _named(before, written, lexicon)
    return said if named else None


def _named(first: str, second: str, lexicon: Lexicon) -> bool:
    """Whether two words name a thing that is known, apart or in one."""
    return any(lexicon.known_noun(noun) for noun in (f"{first} {second}", first + second))
