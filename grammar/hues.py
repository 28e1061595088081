"""Names of colours that are several words, or things elsewhere, told by their place in a sentence.

"The burnt sienna cup", "is my mug apple green", "a rose pillow": what stands before a noun or is
said of one is a look. "The burnt orange" alone, a red wine and a tea cup are things.
"""

from __future__ import annotations

from dataclasses import replace

from grammar.closed import is_open, words_of
from grammar.phrases import phrases
from grammar.vocabulary import Lexicon
from grammar.vocabulary.hues import carried, hues
from grammar.vocabulary.lexicon import THINGS
from grammar.words import Word

_ONE = ("one", "ones")
_COLOURED = ("coloured", "colored")
_BE = ("is", "are", "was", "were")
_SAID_OF = (*_BE, "it", "they", "not")
_JOINING = ("or", "and")
_WHICH = ("that", "which")
_PLACING = ("where", "when", "how")
_DAYS = ("today", "yesterday", "tonight")
_COVERED = words_of(
    "furniture clothes footwear headwear bedding seat chair couch pillow cushion blanket towel "
    "vehicle bag bed stool hat glove shoe"
)
"""Kinds of things that hold nothing they would be called for: a wine sofa is no sofa of wine."""
_GROWN = words_of("food fruit vegetable plant flower tree bush")
"""Kinds of things that names of one word tell the sort of: a jade plant, a lime tree."""


def with_hues(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Return the words, each name of a colour as one word that the lexicon has as a colour."""
    out: list[Word] = []
    i = 0
    while i < len(words):
        size = _size([*out, *words[i:]], len(out), lexicon)
        if size:
            name = " ".join(w.text for w in words[i : i + size])
            size += _text(words, i + size) in _COLOURED
            out.append(replace(words[i], text=carried(name), end=words[i + size - 1].end))
        else:
            out.append(words[i])
        i += size or 1
    return out


def _size(words: list[Word], i: int, lexicon: Lexicon) -> int:
    """Return how many words from `i` on are the name of a colour here, 0 for none."""
    listed, parts = hues(), _parts(words[i].text)
    for name in listed.beginning.get(parts[0], ()):
        size = max(1, len(name) - len(parts) + 1)
        said = tuple(part for w in words[i : i + size] for part in _parts(w.text))
        if said != name or _shared(words, i, name, lexicon):
            continue
        if _is_look(words, i, size, " ".join(name), lexicon):
            return size
    glued = len(parts) == 1 and parts[0] in listed.glued
    return int(glued and _is_look(words, i, 1, parts[0], lexicon))


def _parts(text: str) -> list[str]:
    """Return the words of one written with hyphens, in the lists' spelling."""
    return text.replace("gray", "grey").split("-")


def _shared(words: list[Word], i: int, name: tuple[str, ...], lexicon: Lexicon) -> bool:
    """Whether it is a shade of what is shared, or written as one: dark or light blue, light-blue.

    Those the reader of nouns knows.
    """
    if lexicon.attributes.get(name[-1]) != "colour":
        return False
    either = {_text(words, i - 1), _text(words, i - 2)} & set(_JOINING)
    return "-" in words[i].text or (bool(either) and name[0] in lexicon.shades)


def _is_look(words: list[Word], i: int, size: int, name: str, lexicon: Lexicon) -> bool:
    """Whether a name at `i` is said of a thing, and is none itself: no red wine, no rose."""
    if " " in name and lexicon.known_noun(name):
        return False
    last, after, is_thing = (
        _text(words, i + size - 1),
        _text(words, i + size),
        name in hues().things,
    )
    if after in _COLOURED:
        return True
    if not _goes_on(after):
        if _is_either(words, i + size, lexicon):
            return not is_thing
        return _said_of(words, i, lexicon, is_thing=is_thing)
    for said in (f"{last} {after}", f"{name} {after}"):
        if lexicon.known_noun(said) or lexicon.is_one_word(said.replace(" ", "")):
            return False
    kinds = _kinds(words, i + size, lexicon)
    if size == 1 and not _GROWN.isdisjoint(kinds):
        return False
    return not is_thing or not _COVERED.isdisjoint(kinds)


def _goes_on(after: str) -> bool:
    """Whether what follows may be the noun, or another look before it: burnt sienna cup."""
    open_word = is_open(after) and after not in _DAYS and after not in phrases().verbs
    return open_word or after in _ONE


def _is_either(words: list[Word], k: int, lexicon: Lexicon) -> bool:
    """Whether another colour follows before the noun: a burnt orange or red cup."""
    other = _text(words, k + 1)
    is_colour = lexicon.attributes.get(other) == "colour" or other in hues().beginning
    return _text(words, k) in _JOINING and is_colour and _goes_on(_text(words, k + 2))


def _said_of(words: list[Word], i: int, lexicon: Lexicon, *, is_thing: bool) -> bool:
    """Whether what stands at `i` is said of the noun before it: is the cup burnt sienna.

    is_thing: it is as likely asked for itself: what is tea.
    """
    texts, before = [w.text for w in words[:i]], _text(words, i - 1)
    if before in THINGS:
        return True
    verb = i - 2 if before == "not" else i - 1
    if _text(words, verb) in _BE and _text(words, verb - 1) in _WHICH:
        return True
    if not set(_BE) & set(texts) or texts[0] in _PLACING or "there" in texts:
        return False
    if before in _JOINING:
        return lexicon.attributes.get(_text(words, i - 2)) == "colour"
    noun = lexicon.known_noun(before) is not None and before not in lexicon.attributes
    return noun or (before in _SAID_OF and (not is_thing or texts[0] == "which"))


def _kinds(words: list[Word], k: int, lexicon: Lexicon) -> set[str]:
    """Return what the noun that begins at `k` is, and is a kind of."""
    head = k
    while _goes_on(_text(words, head + 1)):
        head += 1
    kind = lexicon.canonical(_text(words, head))
    return {kind, *lexicon.wider(kind)}


def _text(words: list[Word], k: int) -> str:
    return words[k].text if 0 <= k < len(words) else ""
