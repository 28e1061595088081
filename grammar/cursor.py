"""A place among the words of a sentence, and the terminals that are read so far."""

from __future__ import annotations

from dataclasses import dataclass, field

from grammar import numbers
from grammar.closed import LEADING, is_open, words_of
from grammar.forms import ObjectTerm, Select
from grammar.lalr import Token
from grammar.nouns import NounReader
from grammar.phrases import breaks, by_first, phrases
from grammar.vocabulary import Lexicon
from grammar.words import Word

TIME_GAP = "<time>"
"""Stands where a spoken time was taken out: no phrase reaches across it."""
OWNERS = {"my": "me", "our": "me", "your": "you"}
DETERMINERS = (LEADING - OWNERS.keys()) | words_of("some any another no")
OWNED = {
    "mine": "me", "ours": "me", "yours": "you", "me": "me", "us": "me", "you": "you",
    "hers": "her", "his": "him", "theirs": "them", "her": "her", "him": "him", "them": "them",
}  # fmt: skip
"""What stands alone for an owner, as it is kept; of her, who is not told of, "her" is kept."""
PRONOUNS = words_of("it they them these those he him she")


@dataclass(frozen=True, slots=True)
class Tag(Token):
    """A terminal of question.lark with its value; `word` is where it stands in the text."""

    word: Word


@dataclass
class Tagged:
    """The terminals of a sentence and what was lifted out of it."""

    tags: list[Tag] = field(default_factory=list)
    select: Select | None = None
    negated: bool = False
    never: bool = False
    contrary: bool = False
    here: bool = False


class Cursor:
    """Looks around in the words; the taggers derive from it."""

    def __init__(self, words: list[Word], lexicon: Lexicon, it: ObjectTerm | None) -> None:
        self.words = [w for w in words if w.text not in ("-", ":", ";")]
        self.lexicon, self.it = lexicon, it
        self.reader = NounReader(lexicon, breaks)
        self.places = by_first(tuple(lexicon.places))
        self.out = Tagged()
        self.room = False
        self.superlatives = {w.text for w in self.words} & {"closest", "nearest", "closer"}
        self.owned = any(w.text.endswith("'s") for w in self.words)
        self.several: set[int] = set()
        self.only = False
        self.i = 0

    # -- looking around ------------------------------------------------------------------------

    def _text(self, k: int) -> str:
        return self.words[k].text if 0 <= k < len(self.words) else ""

    def _last(self) -> str:
        return self.out.tags[-1].type if self.out.tags else ""

    def _first(self) -> str:
        return self.out.tags[0].type if self.out.tags else ""

    def _emit(self, kind: str, value: object, count: int, at: int | None = None) -> None:
        word = self.words[self.i if at is None else at]
        last = self._text(self.i + count - 1)
        if kind == "NOUN" and count and self.lexicon.singular(last) != last:
            self.several.add(word.start)  # the words where a noun in the plural begins
        self.out.tags.append(Tag(kind, value, word))
        self.i += count

    def _open_at(self, k: int) -> bool:
        """Whether an open word that starts or goes on a noun phrase stands at `k`."""
        text = self._text(k)
        return is_open(text) and text not in phrases().verbs

    def _noun_phrase_at(self, k: int) -> bool:
        text = self._text(k)
        return (
            self._open_at(k)
            or text in DETERMINERS
            or text in OWNERS
            or (bool(text) and numbers.cardinal([text], 0) is not None)
            or text in ("all", "both", "each", "every", "it", "them")
        )

    def _relation_at(self, k: int) -> bool:
        """Whether a phrase of relation stands at `k`: `right above`, `directly next to`."""
        return any(
            terminal.startswith("REL ")
            and [self._text(k + j) for j in range(len(parts))] == [*parts]
            for parts, terminal in phrases().by_first.get(self._text(k), ())
        )
