"""Terminals of numbers that are bounded: at least two, fewer than three, exactly four cups."""

from __future__ import annotations

from grammar import numbers
from grammar.cursor import Tag
from grammar.denialtags import DenialTagger
from grammar.forms import Bound
from grammar.phrases import phrases

_BEFORE: dict[tuple[str, ...], tuple[Bound, int]] = {
    ("at", "least"): ("least", 0), ("more", "than"): ("least", 1),
    ("no", "fewer", "than"): ("least", 0), ("no", "less", "than"): ("least", 0),
    ("not", "fewer", "than"): ("least", 0), ("not", "less", "than"): ("least", 0),
    ("minimum", "of"): ("least", 0),
    ("at", "most"): ("most", 0), ("up", "to"): ("most", 0), ("maximum", "of"): ("most", 0),
    ("no", "more", "than"): ("most", 0), ("not", "more", "than"): ("most", 0),
    ("fewer", "than"): ("most", -1), ("less", "than"): ("most", -1),
    ("exactly",): ("exactly", 0), ("precisely",): ("exactly", 0), ("only",): ("exactly", 0),
    ("just",): ("exactly", 0),
}  # fmt: skip
"""What bounds a number before it, and what it adds to it: more than three are at least four."""
_AFTER: dict[tuple[str, ...], Bound] = {
    ("or", "more"): "least", ("at", "least"): "least", ("or", "fewer"): "most",
    ("or", "less"): "most", ("at", "most"): "most", ("at", "the", "most"): "most",
    ("exactly",): "exactly", ("precisely",): "exactly", ("only",): "exactly",
}  # fmt: skip
_MARKS: dict[Bound, str] = {"most": "_MOST", "exactly": "_EXACTLY"}
_FIRST = frozenset(said[0] for said in (*_BEFORE, *_AFTER))


class CountTagger(DenialTagger):
    """Reads how a number of things is meant."""

    def _bounded(self) -> bool:
        """Take what bounds a number before it or after it, or after its noun."""
        text = self._text(self.i)
        if text not in _FIRST:
            return False
        if text == "only" and self._text(self.i + 1) in phrases().verbs:
            self.only = True  # did you only see two cups
        return self._bound_before() or self._bound_after()

    def _bound_before(self) -> bool:
        """Take `at least two`, `fewer than three`, `exactly four` before a noun."""
        sizes = (n for n in (3, 2, 1) if self._said(self.i, n) in _BEFORE)
        size = next(sizes, 0)
        if not size:
            return False
        bound, more = _BEFORE[self._said(self.i, size)]
        k = self.i + size
        number = numbers.cardinal([w.text for w in self.words[k : k + 2]], 0)
        end = self._counted_from(k + number[1]) if number is not None else k
        if number is None or not (self._open_at(end) or self._text(end - 1) == "of"):
            return False
        quantity = number[0] + more
        if quantity < (2 if bound == "least" else 1):
            return False
        if bound in _MARKS:
            self._emit(_MARKS[bound], bound, size)
        else:
            self.i += size
        self._emit("NUMBER", quantity, end - self.i)
        return True

    def _counted_from(self, k: int) -> int:
        """Return where what is counted begins: after `of` in two of my cups, else right there."""
        return k + (self._text(k) == "of" and self._noun_phrase_at(k + 1))

    def _bound_after(self) -> bool:
        """Take `or more` after a number, and `at most` after the noun that is counted."""
        size = next((n for n in (3, 2, 1) if self._said(self.i, n) in _AFTER), 0)
        at = len(self.out.tags) - 1
        while at >= 0 and self.out.tags[at].type in ("ATTR", "NOUN"):
            at -= 1
        if not size or at < 0 or self.out.tags[at].type != "NUMBER":
            return False
        led, following = at < len(self.out.tags) - 1, self.i + size
        if self._text(following) in ("once", "twice") or not (led or self._open_at(following)):
            return False
        mark = _MARKS.get(_AFTER[self._said(self.i, size)])
        bounded = at > 0 and self.out.tags[at - 1].type in _MARKS.values()
        if mark is not None and not bounded:
            self.out.tags.insert(at, Tag(mark, mark, self.out.tags[at].word))
        self.i += size
        return True

    def _said(self, k: int, size: int) -> tuple[str, ...]:
        """Return the words at `k`, of which there are as many."""
        said = tuple(w.text for w in self.words[k : k + size])
        return said if len(said) == size else ()
