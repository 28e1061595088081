"""Terminals of open words: nouns, numbers that measure, materials, places that are said last."""

from __future__ import annotations

from dataclasses import replace

from grammar import numbers
from grammar import timewords as tw
from grammar.closed import is_open, words_of
from grammar.cursor import DETERMINERS, OWNERS, PRONOUNS, TIME_GAP
from grammar.forms import ANYTHING
from grammar.nouns import Attribute, Described, Noun
from grammar.phrases import breaks, phrases, place_follows
from grammar.relationtags import RelationTagger

_NUMBERED = words_of(
    "number size type model version channel room box drawer shelf locker gate bay aisle level desk "
    "table station bin cabinet rack row slot tray dock door unit crate container pallet machine "
    "printer lane zone bed ward seat cupboard case compartment hook bench cell cone marker sample"
)
"""What has its number said after it: shelf 2, box three."""

_NOUNS_TOO = ("can", "saw", "record", "list")
_PATTERNS_TOO = ("spotted",)
_AFTER_VERBS = DETERMINERS | {*OWNERS, "i", "we", "you", "it", "he", "she", "they", "one", "be"}


class OpenTagger(RelationTagger):
    """Reads the words that no phrase takes."""

    def _happening(self, text: str) -> bool:
        """Whether a bare word after `what is` names no thing: what is written, what is shown."""
        kinds = [t.type for t in self.out.tags[-2:]]
        if kinds == ["_WHAT", "BE"]:
            return True
        return kinds == ["_WHEN", "BE"] and self.lexicon.known_noun(text) is None

    def _goes_on(self, k: int) -> bool:
        """Whether an open word at `k` goes on a noun phrase: `these cups`, not `it somewhere`."""
        return self._open_at(k) and not breaks(self.words, k)

    def _named_after(self, k: int) -> bool:
        """Whether the thing of a pronoun stands right after it: where are they the scissors."""
        if self._text(self.i) not in ("it", "they", "he", "she") or self.it is not None:
            return False
        named = self._text(k) in DETERMINERS or self._text(k) in OWNERS
        return named and self._last() == "BE"

    def _plain(self) -> bool:
        """Tag determiners, numbers, pronouns and the open words of noun phrases."""
        text = self._text(self.i)
        if text in PRONOUNS and self.it is not None and not self._goes_on(self.i + 1):
            self._emit("NOUN", Noun(self.it.category, self.it.word, True, self.it), 1)
            return True
        if self._named_after(self.i + 1):
            self.i += 1
            return True
        if text in DETERMINERS and self._apposed():
            return True
        if text in DETERMINERS:
            asked = [t.type for t in self.out.tags] == ["_WHAT", "BE"]
            if asked and (self._relation_at(self.i + 1) or self._text(self.i + 1) == "in"):
                self._emit("NOUN", Noun(ANYTHING, "thing", known=True), 1)  # what is that on it
                return True
            self._emit("DET", text, 1)
            return True
        numbered = text[:1].isdecimal() and text[-2:] in ("st", "nd", "rd", "th")
        if numbered and self._open_at(self.i + 1):
            self.i += 1  # the 1st drawer: which one is no business of a camera
            return True
        if text in ("one", "ones") and not self._goes_on(self.i + 1):
            self._emit("ONE", text, 1)
            return True
        number = numbers.cardinal([w.text for w in self.words[self.i : self.i + 2]], 0)
        if number is not None and (self._measured(*number) or self._numbered(number[1])):
            return True
        if number is not None:
            if self.only:
                self._emit("_EXACTLY", text, 0)
            end = self._counted_from(self.i + number[1])
            self._emit("NUMBER", number[0], end - self.i)
            return True
        if self._side(text):
            return True
        ending = " ".join(w.text for w in self.words[self.i :])
        if ending in self.lexicon.relations and self._stranded(ending):
            return True
        if not is_open(text):
            return False
        if self._material(text) or self._place_last(text):
            return True
        if self._happening(text):
            return False
        for what, first, last in self._without_place(self.reader.read(self.words, self.i)):
            self.i = first
            if isinstance(what, Noun) and what.said == "glasses" and self._counted():
                what = Noun("glass", "glass", known=True)  # what is counted is to drink from
            self._emit("NOUN" if isinstance(what, Noun) else "ATTR", what, last - first)
        return True

    def _closed_noun(self) -> bool:
        """Read a verb of the grammar where it is none: a can opener, a soup can, a spotted dog."""
        text, k = self._text(self.i), self.i + 1
        before = self.out.tags[-1].value if self._last() == "NOUN" else None
        led = self._last() in ("DET", "OWNER", "ATTR", "NUMBER")
        if text in _PATTERNS_TOO and led and self._open_at(k):
            self._emit("ATTR", Attribute(text, "pattern"), 1)
            return True
        if text == "lost" and led and self._open_at(k):
            self.i = k  # my lost keys are my keys
            return True
        if text not in _NOUNS_TOO or not (led or isinstance(before, Noun)):
            return False
        if self._text(k) in _AFTER_VERBS or (before and not is_open(self._text(self.i - 1))):
            return False
        goes_on = is_open(self._text(k)) or self._text(k) in phrases().verbs
        if before and goes_on and not place_follows(self.words, k):
            return False  # how many people can sit here
        while self._open_at(k) and not breaks(self.words, k):
            k += 1
        rest = " ".join(w.text for w in self.words[self.i : k])
        said = self.lexicon.singular(f"{before.said} {rest}" if isinstance(before, Noun) else rest)
        noun = Noun(self.lexicon.canonical(said), said, known=True)
        if isinstance(before, Noun):
            self.out.tags[-1] = replace(self.out.tags[-1], value=noun)
            self.i = k
        else:
            self._emit("NOUN", noun, k - self.i)
        return True

    def _apposed(self) -> bool:
        """Read the one that is said after its kind: the box, the cardboard one."""
        if self._last() not in ("NOUN", "COMMA"):
            return False
        kinds = [t.type for t in self.out.tags[-2:]]
        if "NOUN" not in (kinds[-1:] if kinds[-1:] != ["COMMA"] else kinds[:1]):
            return False
        if not self._one_at(self.i + 1):
            return False
        if kinds[-1] == "COMMA":
            self.out.tags.pop()
        self._say_one("_THAT_IS", self.i + 1)
        return True

    def _numbered(self, size: int) -> bool:
        """Read a number that names one of its kind as part of its noun: shelf 2, size 12 shoe."""
        noun = self.out.tags[-1].value if self._last() == "NOUN" else None
        k = self.i + size
        unit = self._text(k) in tw.UNITS or self._text(k) in ("time", "times")
        if not isinstance(noun, Noun) or unit or self._text(self.i - 1) in (TIME_GAP, ","):
            return False
        head = noun.said.rpartition(" ")[2]
        if self._text(self.i - 1) != head or not (head in _NUMBERED or self._goes_on(k)):
            return False
        end = self.reader.read(self.words, k)[-1][2] if self._goes_on(k) else k
        rest = " ".join(w.text for w in self.words[self.i : end])
        said = self.lexicon.singular(f"{noun.said} {rest}")
        first = self.out.tags.pop()
        self.out.tags.append(replace(first, value=Noun(self.lexicon.canonical(said), said, True)))
        self.i = end
        return True

    def _measured(self, number: int, size: int) -> bool:
        """Read a number that measures one thing as part of its noun: the five minute timer."""
        k = self.i + size
        if number < 2 or self._last() not in ("DET", "OWNER") or not self._open_at(k):
            return False
        what, first, last = self.reader.read(self.words, k)[-1]
        head = self._text(last - 1)
        one = self.lexicon.singular(head) == head and self.lexicon.plurals.get(head) != head
        if not isinstance(what, Noun) or first != k or last - first < 2 or not one:
            return False
        said = " ".join(w.text for w in self.words[self.i : last])
        self._emit("NOUN", Noun(self.lexicon.canonical(said), said, what.known), last - self.i)
        return True

    def _material(self, text: str) -> bool:
        """Read what a thing is made of or looks like as said of it: glass is a noun elsewhere."""
        told = self._last() in ("_THAT_IS", "_THAT_IS_NOT")
        if told and text not in self.lexicon.attributes and self._state_at(self.i):
            self._emit("ATTR", Attribute(text, "other"), 1)
            return True
        made = self._last() in ("_MADE_OF", "_NOT_MADE_OF")
        looks = self._last() in ("_THAT_IS", "_THAT_IS_NOT") and self._looks(self.i)
        asked = (
            self._last() == "BE" and self._first() in ("_WHICH", "_WHAT") and self._looks(self.i)
        )
        if text not in self.lexicon.attributes or not (made or looks or asked):
            return False
        self._emit("ATTR", Attribute(text, self.lexicon.attributes[text]), 1)
        return True

    def _place_last(self, text: str) -> bool:
        """Read a room at the end, after a time, as where: `remote control last night kitchen`."""
        place, end = self._place_at(self.i)
        alone = {t.type for t in self.out.tags} <= {"DET", "OWNER", "ATTR", "NOUN"}
        if not place or end != len(self.words) or self._text(self.i - 1) != TIME_GAP:
            return False
        if not alone or self._last() != "NOUN":
            return False
        self._emit("AT_PLACE", place, end - self.i)
        return True

    def _counted(self) -> bool:
        """Whether a number of what stands here is said or asked for, or what is in it."""
        counts = [t.type for t in self.out.tags if t.type != "ATTR"][-1:]
        pairs = any(w.text in ("pair", "pairs") for w in self.words[: self.i])
        return (counts in (["NUMBER"], ["_HOWMANY"]) and not pairs) or self._text(
            self.i + 1
        ) == "of"

    def _without_place(self, found: list[Described]) -> list[Described]:
        """Cut a place off a noun where nothing but the two is said: `red cup kitchen`."""
        what, first, last = found[-1]
        led = all(t.type in ("DET", "OWNER", "ATTR", "NUMBER") for t in self.out.tags)
        ends = all(w.text == TIME_GAP for w in self.words[last:])
        if not isinstance(what, Noun) or not ends:
            return found
        for k in range(first + 1, last):
            thing = self.lexicon.known_noun(" ".join(w.text for w in self.words[first:k]))
            place, end = self._place_at(k)
            several = self.lexicon.singular(self._text(k - 1)) != self._text(k - 1)
            if not several and (not led or what.known):
                continue  # the kitchen table; but keys are never part of a noun: keys kitchen
            if thing and place and end == last:
                noun = Noun(self.lexicon.canonical(thing), thing, known=True)
                self.words[k:k] = [replace(self.words[k], text="in")]
                return [*found[:-1], (noun, first, k)]
        return found
