"""Terminals of relations: on the table, the corner of the kitchen, which shelf is it on."""

from __future__ import annotations

from grammar.cursor import DETERMINERS, OWNERS
from grammar.nouns import Attribute, Noun
from grammar.phrases import phrases, place_follows
from grammar.verbtags import VerbTagger

SUPERLATIVES = ("nearest", "closest")
_WITHIN = ("corner of", "middle of", "center of", "centre of", "end of")
_PARTS_OF = frozenset(("back", "side", "edge", "top", "front", "arm", "end", "surface", "rim"))


class RelationTagger(VerbTagger):
    """Reads relations by what stands before and after them."""

    def _relation(self, kind: str, said: str, size: int) -> bool:
        following = self.i + size
        if said in ("above", "below") and self._last() == "DET":
            return False
        if said.partition(" ")[0] in SUPERLATIVES and self._last() == "DET":
            self.out.tags.pop()  # which cup is the closest to the sink
        if not self.out.tags and self._text(following) in ("which", "what"):
            self._emit("PIED", kind, size)
            return True
        if self._carries(following):
            self._emit("CARRIES", kind, size + 1)
            return True
        kind, said, size = self._through_part(kind, said, size)
        following = self.i + size
        if not self._noun_phrase_at(following) and self._text(following) not in (
            "one",
            "ones",
            "no",
        ):
            return False
        if said.endswith(_WITHIN) and self._within(following, size):
            return True
        self._subject()
        negated = self._last() == "THAT_NOT"
        if negated:
            self.out.tags.pop()
        # a cup with no bowl lacks the bowl; what is asked is not denied
        none = self._text(following) == "no" and self._noun_phrase_at(following + 1)
        self._emit("THAT_NOT_REL" if negated != none else "REL", kind, size + none)
        return True

    def _carries(self, k: int) -> bool:
        """Whether `it` at `k` is the thing before its `with`: a bed with a teddy bear on it."""
        kinds = [t.type for t in self.out.tags]
        named = self._last() == "NOUN" and not self.out.negated  # a table with nothing on it
        if self._text(k) not in ("it", "them") or not named or kinds.count("REL") != 1:
            return False
        link = kinds.index("REL")
        things = kinds[link:].count("NOUN") - kinds[link:].count("OR")
        one = kinds[:link].count("NOUN") == things == 1
        counted = {"NUMBER", "_HOWMANY", "_HOWLONG", "_WHAT", "_WHICH", "AND"} & {*kinds}
        led = link > 0 and kinds[link - 1] == "NOUN" and self.out.tags[link].value == "together"
        return led and one and not counted

    def _through_part(self, kind: str, said: str, size: int) -> tuple[str, str, int]:
        """Read `hanging on the back of` as `on the back of`: the part of a thing is no thing."""
        last = said.rpartition(" ")[2]
        for parts, terminal in phrases().by_first.get(last, ()):
            start = self.i + size - 1
            longer = len(parts) > 2 and parts[-1] == "of" and terminal.startswith("REL ")
            if longer and [self._text(start + j) for j in range(len(parts))] == [*parts]:
                return terminal[4:], " ".join(parts), size - 1 + len(parts)
        part = [self._text(self.i + size + j) for j in range(3)]
        if part[0] == "the" and part[1] in _PARTS_OF and part[2] == "of":
            return kind, said, size + 3  # draped over the back of the chair
        return kind, said, size

    def _within(self, k: int, size: int) -> bool:
        """Read the corner of the kitchen as in it, and the corner of the room as a thing."""
        while self._text(k) in DETERMINERS or self._text(k) in OWNERS:
            k += 1
        place, end = self._place_at(k)
        if place:
            self._emit("AT_PLACE", place, end - self.i)
        elif self._text(k) in ("room", "house", "apartment") and not self._open_at(k + 1):
            part = self._text(self.i + size - 2)  # the corner of the room is a thing of its own
            self._emit("REL", "in", 0)
            self._emit("NOUN", Noun(part, part, known=True), k + 1 - self.i)
        else:
            return False
        return True

    def _stranded(self, text: str) -> bool:
        """Take a preposition at the end that belongs to its `which`: which shelf is it on."""
        if self.room and text in ("in", "at", "on"):
            self.i += 1
            return True
        kind = self.lexicon.relations.get(text)
        if kind is None or not self.out.tags or not self._grounded():
            return False
        self._emit("STRANDED", kind, len(self.words) - self.i)
        return True

    def _grounded(self) -> bool:
        """Whether a thing that others are at is asked for: which shelf is it on, what is it on."""
        kinds = [t.type for t in self.out.tags]
        bare = kinds[0] == "_WHAT" and kinds[-1] == "NOUN" and "REL" not in kinds
        shown = kinds[0] == "_SHOW" and self.out.tags[0].value == "what are"
        return shown or kinds[0] == "_WHICH" or (bare and kinds[2:3] != ["NOUN"])

    def _side(self, text: str) -> bool:
        """Read a preposition or side that is none here: the left shelf, gone from, left at."""
        if text in ("left", "right") and self._last() in ("DET", "OWNER", "ATTR"):
            self._emit("ATTR", Attribute(text, "other"), 1)
            return True
        if text == "from" and self._last() in ("MISSING", "MOVED"):
            self._emit("REL", "on", 1)
            return True
        if text == "at" and (
            self.i + 1 == len(self.words) or place_follows(self.words, self.i + 1)
        ):
            self.i += 1  # where was it left at, where is it at in the hall
            return True
        if text == "for" and self.i + 1 == len(self.words) and self._has("_HOWLONG"):
            self.i += 1  # how long was it there for
            return True
        if text in ("above", "below") and self._last() == "DET" and self._open_at(self.i + 1):
            self._emit("ATTR", Attribute(text, "other"), 1)
            return True
        return False
