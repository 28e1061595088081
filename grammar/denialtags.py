"""Terminals of what is denied: not red, that is not a cup, not in the hall, nothing, never."""

from __future__ import annotations

from grammar.closed import is_open
from grammar.cursor import DETERMINERS, OWNERS
from grammar.forms import ANYTHING
from grammar.nouns import Attribute, Noun
from grammar.nountags import NounTagger
from grammar.phrases import place_follows

_DENYING = frozenset(("not", "no", "never", "nothing", "nowhere", "none", "neither"))


class DenialTagger(NounTagger):
    """Reads what is denied by what stands before and after `not`."""

    def _negation(self) -> bool:
        """Lift `not` out, unless it denies a word of a noun phrase."""
        text = self._text(self.i)
        if text not in _DENYING:
            return False
        placed = place_follows(self.words, self.i + 1)
        if text == "not" and placed and self._is_placed():
            self._emit("AND", "but", 0)  # near the door, not on the desk
        joined = self._last() == "AND" or self._describes()
        if text == "not" and joined and placed:
            self._emit("THAT_NOT", 0, 1)  # on the table and not near the lamp
            return True
        if text == "not":
            if not self._denial(self.i + 1):
                self.out.negated = True
                self.out.contrary = self._is_contrary(self.i + 1)
                self.i += 1
            return True
        if text == "neither" and self._text(self.i + 1) == "of":
            self.out.negated = True  # neither of the cups
            self.i += 2
            return True
        lost = text == "nowhere" and self._text(self.i + 1) == "to"  # nowhere to be found
        if lost or text not in ("no", "never", "nothing", "nowhere", "none"):
            return False
        self.out.negated, self.out.never = True, text == "never"
        if text == "none" and self._text(self.i + 1) == "of":
            self.i += 2  # none of the cups
        elif text in ("nothing", "none"):
            self._emit("NOUN", Noun("object", "thing", known=True), 1)
        elif text == "no" and self._text(self.i + 1) != "longer":
            self._emit("DET", text, 1)
        else:
            self.i += 2 if text == "no" else 1
        return True

    def _all_but(self) -> bool:
        """Read what is left out of all there is: anything but cups, all cups but the red one.

        Nothing but cups are cups alone, which no sighting tells.
        """
        if self._text(self.i) != "but" or self._last() != "NOUN" or self.out.negated:
            return False
        if not self._noun_phrase_at(self.i + 1):
            return False
        if not self._of_anything() and "all" not in [w.text for w in self.words[: self.i]]:
            return False
        self._emit("_EXCEPT", 0, 1)
        return True

    def _lacks_one(self) -> bool:
        """Read what things are without: with an apple and no banana, cups but no bowls on it."""
        if self._text(self.i) not in ("and", "but") or self._text(self.i + 1) != "no":
            return False
        if self._last() != "NOUN" or not self._open_at(self.i + 2):
            return False
        links = [t.value for t in self.out.tags if t.type in ("REL", "THAT_NOT_REL", "AT_PLACE")]
        if links[-1:] == ["together"]:
            self._emit("THAT_NOT_REL", "together", 2)
            return True
        one = sum(t.type == "NOUN" for t in self.out.tags) == 1
        end = self.reader.read(self.words, self.i + 2)[-1][2]
        if links or not one or not self._relation_at(end) or self._text(end) == "with":
            return False
        self._emit("LACKS", "no", 2)
        return True

    def _is_contrary(self, k: int) -> bool:
        """Whether `not` before `k` denies of a thing where it is: was it not in the hall.

        Was there no cup in the hall, and was no cup seen there, deny that there was any.
        """
        kinds = {t.type for t in self.out.tags}
        while self._text(k) in ("been", "be", "ever"):
            k += 1
        of_a_thing = self._first() in ("BE", "AUX", "_WHETHER") and "NOUN" in kinds
        there = not kinds.isdisjoint(("THERE", "SEE", "WHO"))
        return (
            of_a_thing
            and not there
            and (place_follows(self.words, k) or self._text(k) == "together")
        )

    def _describes(self) -> bool:
        """Whether `not` here denies where a thing is: did you see a cup not on the table."""
        kinds = [t.type for t in self.out.tags]
        asked = kinds[:1] == ["AUX"] and kinds[-2:-1] != ["BE"] and "SEE" in kinds
        return self._last() in ("NOUN", "ONE") and (asked or kinds[:2] == ["BE", "THERE"])

    def _is_placed(self) -> bool:
        """Whether it was said already where the thing is: what is denied next is one thing more."""
        kinds = [t.type for t in self.out.tags if t.type != "COMMA"]
        return kinds[-1:] == ["AT_PLACE"] or (kinds[-1:] == ["NOUN"] and "REL" in kinds)

    def _denial(self, k: int) -> bool:
        """Take `not` before a word of a noun phrase: not red, not the red one, not made of wood."""
        after_noun = self._last() in ("NOUN", "ONE", "COMMA", "ATTR", "AND", "")
        belonging = self._text(k) == "belonging" and self._text(k + 1) == "to"
        if after_noun and (belonging or self._is_theirs(k)):
            self._emit("_THAT_IS_NOT", 0, 1)  # not belonging to anna, not mine
            return belonging or self._belongs(k)
        if self._text(k) in DETERMINERS or self._text(k) in OWNERS:
            if after_noun and self._one_at(k + 1):
                self._say_one("_EXCEPT", k + 1)
                return True
            alone = not self.out.tags and self._kind_at(k + 1)  # after what is there: not the book
            if after_noun and (self._contrasted(k + 1) or self._of_anything() or alone):
                self._emit("_EXCEPT", 0, 1)
                return True
            return self._no_kind(k)
        if self._kind_at(k) and (self._no_kind(k) or self._last() == "AND"):
            if self._last() == "AND" and self._of_anything():
                self._emit("_EXCEPT", 0, 1)  # that are not cups and not bowls
            return self._last() == "_EXCEPT"
        if self._text(k) in ("made", "built") and self._text(k + 1) in ("of", "from", "out"):
            self._emit("_NOT_MADE_OF", 0, 4 if self._text(k + 1) == "out" else 3)
            return True
        return self._attribute_at(k) and self._denied_attribute(k, after_noun=after_noun)

    def _denied_attribute(self, k: int, *, after_noun: bool) -> bool:
        """Take `not red`, said before its noun or after it."""
        kinds = [t.type for t in self.out.tags]
        if self._last() == "BE" and self._chosen():
            self.out.tags.pop()  # how many chairs are not red: chairs that are not
            self._emit("_THAT_IS_NOT", "REL" in kinds, 1)
            return True
        if self._last() == "AND" and not {"THAT_NOT_REL", "NOT_AT_PLACE"}.isdisjoint(kinds):
            self._emit("_THAT_IS_NOT", True, 1)  # that is not on the counter and not green
            return True
        found = self.reader.read(self.words, k)
        before_noun = len(found) > 1 and isinstance(found[-1][0], Noun)
        if before_noun and self._last() in ("DET", "OWNER", ""):
            self.i += 1
            attribute, _, last = found[0]
            self._emit("NOT_ATTR", attribute, last - self.i)
            return True
        if after_noun:
            self._emit("_THAT_IS_NOT", 0, 1)
        return after_noun

    def _of_anything(self) -> bool:
        """Whether any things are asked for, of which some kind may be left out."""
        nouns = [t.value for t in self.out.tags if t.type == "NOUN"]
        figure = nouns[0] if nouns else None
        left_out = any(t.type == "_EXCEPT" for t in self.out.tags)  # and not a bowl
        bare = self._first() == "_WHAT" and (len(nouns) < 2 or left_out)
        return bare or (isinstance(figure, Noun) and figure.category == ANYTHING)

    def _no_kind(self, k: int) -> bool:
        """Read which red things are not cups, which on the desk is not a book."""
        asked = self._chosen() or self._first() == "_WHAT"
        if self._last() != "BE" or not asked or not self._of_anything() or len(self.out.tags) < 3:
            return False
        self.out.tags.pop()
        self._emit("_EXCEPT", 0, 1)
        return True

    def _kind_at(self, k: int) -> bool:
        """Whether a kind of thing is named at `k`, with its looks: not red cups."""
        found = self.reader.read(self.words, k) if self._open_at(k) else []
        noun = found[-1][0] if found else None
        return isinstance(noun, Noun) and noun.known and noun.category != ANYTHING

    def _chosen(self) -> bool:
        """Whether things are chosen or counted: which chairs, how many chairs."""
        return any(t.type in ("_WHICH", "_HOWMANY") for t in self.out.tags)

    def _contrasted(self, k: int) -> bool:
        """Whether `not the red one` stands here: an attribute, and `one` or nothing after it."""
        found = self.reader.read(self.words, k) if is_open(self._text(k)) else []
        if not found:
            return False
        return all(isinstance(what, Attribute) for what, _, _ in found)
