"""Open words of a noun phrase: attributes, compound nouns and unknown nouns told apart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from grammar import adjectives
from grammar.closed import is_open
from grammar.forms import ANYTHING, ObjectTerm
from grammar.numbers import ORDINALS
from grammar.vocabulary import Lexicon
from grammar.vocabulary.hues import as_said
from grammar.vocabulary.lexicon import THINGS
from grammar.words import Word

_SUFFIXES = (
    "-colored",
    "-coloured",
    "-shaped",
    "-sized",
    "-patterned",
    "-striped",
    "-like",
    "-dotted",
)
_PARTED = frozenset(("shaped", "sized", "colored", "coloured", "patterned", "dotted"))
_MAX_COMPOUND = 4
_EDGES = frozenset(("top", "bottom"))
"""After a noun these are a part of the thing, no attribute: the vanity top."""
PREDICATES = frozenset(("colour", "material", "pattern", "shape", "size"))
"""Kinds of attributes that a camera can vouch for; the others are states and opinions."""


@dataclass(frozen=True, slots=True)
class Noun:
    """A noun as said, singular. known: the lexicon has it. term: what a pronoun stands for."""

    category: str
    said: str
    known: bool
    term: ObjectTerm | None = None


@dataclass(frozen=True, slots=True)
class Attribute:
    """A describing word as said, and its kind (colour, material, pattern, shape, size, other)."""

    said: str
    kind: str

    def __post_init__(self) -> None:
        """Say the name of a colour that a word carries."""
        object.__setattr__(self, "said", as_said(self.said))


@dataclass(frozen=True, slots=True)
class Whose:
    """Whose a thing is said to be, as `ObjectTerm.owner` has it. isnt: it is not theirs."""

    owner: str
    isnt: bool = False


Described: TypeAlias = tuple[Attribute | Noun, int, int]
"""What words[first:last] of a noun phrase are."""


def _other(said: str) -> Attribute:
    return Attribute(said, "other")


class Pattern(str):
    """A pattern that a thing has all over: with stripes is `striped`."""

    __slots__ = ()


def _predicated(words: list[Word], i: int) -> bool:
    """Whether a look at `i` may be said of the noun before it: is the cup glass, no wine glass."""
    ends = i + 1 == len(words) or not words[i + 1].text[:1].isalnum()
    return ends and words[0].text in ("is", "are", "was", "were", "whether", "if")


@dataclass(frozen=True)
class NounReader:
    """Reads the open words at a place as attributes and nouns."""

    lexicon: Lexicon
    breaks: Callable[[list[Word], int], bool]

    def read(self, words: list[Word], i: int) -> list[tuple[Attribute | Noun, int, int]]:
        """Return (what, first, last) for the run of open words at `i`."""
        end = self._run_end(words, i)
        found: list[tuple[Attribute | Noun, int, int]] = []
        pending: int | None = None
        k = i
        while k < end:
            if self._only_counts(words, k, end):
                k += 1
                continue
            if pending is not None and self._is_kind(words, pending, k):
                pending = None  # the object cup is a cup
            if pending is not None and self._is_thing(words, pending, k):
                found += [self._noun(words, pending, k), (_other(words[k].text), k, k + 1)]
                pending, k = None, k + 1
                continue
            size = self._compound(words, k, end)
            attribute = None if size else self._attribute(words, k, end)
            last = pending is not None and not size and k + 1 == end
            if attribute is None and last and self._happens(words[k].text):
                attribute = (words[k].text, "other", 1)
            if size or attribute is None:
                pending = k if pending is None else pending
                k += size or 1
                continue
            if pending == k - 1 and self._made(words, k, end):
                found.append((_other(f"{words[k - 1].text} {words[k].text}"), k - 1, k + 1))
                pending, k = None, k + 1
                continue
            if pending is not None:
                found += self._before_attribute(words, pending, k, k + attribute[2] < end)
                pending = None
            said, kind, count = attribute
            found.append((Attribute(said, kind), k, k + count))
            k += count
        if pending is not None:
            found.append(self._noun(words, pending, end))
        return found

    def _made(self, words: list[Word], k: int, end: int) -> bool:
        """Whether a participle at `k`, before a noun, is said with the word before it.

        So a hand painted vase and a gold rimmed mirror.
        """
        return (
            k + 1 < end and adjectives.describes(words[k].text, ()) and words[k].text[-2:] == "ed"
        )

    def _is_thing(self, words: list[Word], first: int, last: int) -> bool:
        """Whether the noun so far is `something`: what follows describes it."""
        return last == first + 1 and self.lexicon.singular(words[first].text) in THINGS

    def _is_kind(self, words: list[Word], first: int, k: int) -> bool:
        """Whether the noun so far is `object` or `item` and the word at `k` says what it is."""
        text = words[k].text
        named = self._known(text) and text not in self.lexicon.attributes
        return k == first + 1 and words[first].text in ("object", "item") and named

    def _before_attribute(
        self, words: list[Word], first: int, last: int, more: bool
    ) -> list[tuple[Attribute | Noun, int, int]]:
        """Read the words before an attribute: unknown ones describe too: `plush blue pillow`."""
        texts = [w.text for w in words[first:last]]
        if more and not any(t in self.lexicon.words or self._known(t) for t in texts):
            return [(_other(t), first + n, first + n + 1) for n, t in enumerate(texts)]
        return [self._noun(words, first, last)]

    def _known(self, text: str) -> bool:
        return self.lexicon.known_noun(text) is not None

    def _happens(self, text: str) -> bool:
        """Whether a word at the end is what happened to the noun: `the door opened`."""
        return adjectives.happened(text) and not self._known(text)

    def _only_counts(self, words: list[Word], k: int, end: int) -> bool:
        """Whether a word at `k` says which or how dear: `the second cup`, `my favourite cup`."""
        text = words[k].text
        counts = (text in ORDINALS or text in self.lexicon.noise) and k + 1 < end
        return counts and not self._compound(words, k, end)

    def _run_end(self, words: list[Word], i: int) -> int:
        end = i
        while end < len(words) and is_open(words[end].text):
            if words[end].text.endswith("'s"):
                break
            if end > i and self.breaks(words, end):
                break
            size = self._compound(words, end, len(words))
            end += size or 1
        return max(end, i + 1)

    def compound_at(self, words: list[Word], i: int) -> int:
        """Return the length of the listed compound noun at `i`, 0 for none."""
        return self._compound(words, i, len(words))

    def _compound(self, words: list[Word], i: int, end: int) -> int:
        """Return the length of the longest listed compound at `i`, 0 for none."""
        for size in range(min(_MAX_COMPOUND, end - i), 1, -1):
            said = " ".join(w.text for w in words[i : i + size])
            whole = said.replace(" ", "")
            parted = all(is_open(w.text) for w in words[i : i + size])  # a cart on is no carton
            if self.lexicon.known_noun(said) or (parted and self.lexicon.is_one_word(whole)):
                return size
        return 0

    def _attribute(self, words: list[Word], i: int, end: int) -> tuple[str, str, int] | None:
        """Return (word, kind, count) when an attribute stands at `i`, None for a noun."""
        text = words[i].text
        following = words[i + 1].text if i + 1 < end else ""
        kinds = self.lexicon.attributes
        if text in self.lexicon.shades and kinds.get(following) == "colour":
            return f"{text} {following}", "colour", 2
        parted = self._parted(text, following)
        if parted and i + 2 < end:
            return f"{text} {following}", parted, 2
        kind = kinds.get(text) or self._hyphenated(text)
        if kind is None and following and adjectives.describes(text, self.lexicon.heads):
            kind = "other"
        if kind is None or (not following and text in _EDGES):
            return None
        if following and (kind != "other" or i + 1 < end):
            return text, kind, 1
        noun = self.lexicon.known_noun(text)
        before = words[i - 1].text if i else ""
        alone = not is_open(before) or before in kinds or not self._known(before)
        alone = alone or not _predicated(words, i)
        return None if noun and alone else (text, kind, 1)

    def _parted(self, text: str, following: str) -> str | None:
        """Return the kind of an attribute written without its hyphen: polka dot, heart shaped."""
        listed = self.lexicon.attributes.get(f"{text}-{following}")
        shaped = following in _PARTED and text not in self.lexicon.attributes
        return listed or (self._hyphenated(f"{text}-{following}") if shaped else None)

    def _hyphenated(self, text: str) -> str | None:
        if "-" not in text:
            return None
        if text.endswith(_SUFFIXES):
            return "shape" if text.endswith("-shaped") else "colour"
        last = text.rpartition("-")[2]
        described = adjectives.describes(last, ())  # hand-painted
        return self.lexicon.attributes.get(last) or ("other" if described else None)

    def _noun(self, words: list[Word], first: int, last: int) -> tuple[Noun, int, int]:
        said = self.lexicon.singular(" ".join(w.text for w in words[first:last]))
        head = said.rpartition(" ")[2]
        if said in THINGS:
            return Noun(ANYTHING, said, known=True), first, last
        category = self.lexicon.canonical(said)
        known = said in self.lexicon.nouns or (head != said and head in self.lexicon.heads)
        known = known or category != said
        return Noun(category, said, known), first, last
