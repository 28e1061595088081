"""Clauses after a noun: that is red, which i left in the hall, about cooking, for the shed."""

from __future__ import annotations

from dataclasses import replace

from grammar import numbers
from grammar import timewords as tw
from grammar.adjectives import describes
from grammar.closed import is_open, words_of
from grammar.cursor import DETERMINERS, OWNED, OWNERS, TIME_GAP, Cursor
from grammar.forms import ANYTHING
from grammar.nouns import PREDICATES, Attribute, Described, Noun, Pattern
from grammar.phrases import SUBJECT_OF, phrases, place_follows, stands_at

_SUBJECTS = ("i", "we", "you", "he", "she", "they")
_AUXILIARY = words_of("have had has am is are was were been did do will would could can")
_SAID_OF_SEEN = words_of("is are was were belongs belong belonged does do did")
_SAID_OF_ONES = ("with", "without", "that", "which", "in", "on")
_OBJECTS = ("her", "him", "them")
_BEFORE_VERB = words_of(
    "last just already always usually normally often typically generally sometimes recently also "
    "never not ever most previously"
)


class ClauseTagger(Cursor):
    """Reads what is said of a noun after it."""

    def _clause(self) -> bool:
        """Read that is red, which was on the table, that has a handle, that i left in the hall."""
        if self._last() == "NOUN" and self._told_again():
            self.i += 2  # my shoes the ones with the stars
            return True
        kinds = [t.type for t in self.out.tags[-3:]]
        if self._text(self.i) == "that" and kinds == ["NOUN", "BE", "THERE"]:
            del self.out.tags[-2:]  # how many chairs are there that are not wooden
        if self._last() not in ("NOUN", "ONE", "ATTR", "PART", "AT_PLACE"):
            asked = self._first() in ("_WHAT", "_WHICH", "_HOWMANY")  # what did you see that is
            seen = self._last() == "SEE" and asked
            if not seen or self._text(self.i + 1) not in _SAID_OF_SEEN:
                return False
        if self._text(self.i) in _SUBJECTS and self._asked():
            return self._relative(self.i)
        k = self.i + 1
        heard = self._text(self.i) == "what" and self._text(k) in _SUBJECTS  # the ball what i had
        if self._text(self.i) not in ("that", "which", "who") and not heard:
            return False
        if self._of_theirs(k):
            return True
        if k < len(self.words) and stands_at(self.words, k):
            self.i = k + 1  # the picture that hangs over the sofa
            return True
        if self._text(k) in ("is", "are", "was", "were"):
            plural = self._text(k) in ("are", "were")
            k += 1
            negated = self._text(k) in ("not", "neither")
            k += negated
            far = self._extraposed(plural)
            if negated and self._text(k) in DETERMINERS:
                self._emit("_EXCEPT", 0, k - self.i)  # that is not a cup
            elif self._is_theirs(k):
                far = self._extraposed(plural, owned=True)
                self._emit("_THAT_IS_NOT" if negated else "_THAT_IS", far, k - self.i)
                self._belongs(self.i)
            elif self._attribute_at(k) or self._looks(k):
                self._emit("_THAT_IS_NOT" if negated else "_THAT_IS", far, k - self.i)
            elif negated and self._names_kind(k):
                self._emit("_EXCEPT", 0, k - self.i)  # that are not cups
            elif self._text(k) in ("made", "built"):
                self._emit(
                    "_NOT_MADE_OF" if negated else "_MADE_OF", far and negated, k + 2 - self.i
                )
            elif negated:
                self._emit("THAT_NOT", 0, k - self.i)
            else:
                told = self._text(k) in phrases().verbs and self._seen_at(k + 1)
                self.i = k + told
            return True
        if self._text(k) in ("has", "have", "had"):
            none = self._text(k + 1) == "no"
            if self._part_of(k + 1 + none, without=none):
                return True
            return self._holds(k + 1 + none, none=none)
        if [self._text(k + n) for n in (1, 2)] == ["not", "have"]:
            return self._part_of(k + 3, without=True)
        return self._relative(k)

    def _told_again(self) -> bool:
        """Whether `the one` is the thing just named, and something is said of it after it."""
        ones = self._text(self.i) in DETERMINERS and self._text(self.i + 1) in ("one", "ones")
        return ones and self._text(self.i + 2) in _SAID_OF_ONES

    def _names_kind(self, k: int) -> bool:
        """Whether a kind of thing stands alone at `k`, no look and no place."""
        found = self.reader.read(self.words, k) if self._open_at(k) else []
        return len(found) == 1 and isinstance(found[0][0], Noun) and found[0][0].known

    def _seen_at(self, k: int) -> bool:
        """Whether a clause that only tells that a thing was seen ends at `k`, or tells where."""
        return self._text(k) in ("", TIME_GAP, ",") or place_follows(self.words, k)

    def _asked(self) -> bool:
        """Whether the question's own verb has been said: another one is a relative clause."""
        return any(t.type in ("BE", "AUX", "_SHOW", "_FIND", "_SEEK") for t in self.out.tags)

    def _relative(self, k: int) -> bool:
        """Read the cup (that) i left on the table: the subject and its verb say nothing more."""
        named = self._text(self.i) == "that" and self._text(k) in self.lexicon.names
        if not named and self._text(k) not in _SUBJECTS:
            return self._happened(k)
        k += 1
        while self._text(k) in _AUXILIARY or self._text(k) in _BEFORE_VERB:
            k += 1
        had = self._text(k - 1) in ("have", "had", "has") and self._seen_at(k)
        if not had and self._text(k) not in phrases().verbs and not is_open(self._text(k)):
            return False
        self.i = k + (not had)
        if not had and self._first() == "_WHERE" and self._text(k) not in phrases().verbs:
            self._told_of()
        if self._text(self.i) in ("around", "about", "in", "on", "with") and self.i + 1 == len(
            self.words
        ):
            self.i += 1  # the banjo that i usually keep around
        return True

    def _told_of(self) -> None:
        """Pass over where something was done with a thing: the flask i took on the hike."""
        found = phrases().by_first.get(self._text(self.i), ())
        sizes = (len(parts) for parts, kind in found if self._place_said(parts, kind))
        k = self.i + next(sizes, 0)
        while k > self.i and (self._text(k) in DETERMINERS or self._text(k) in OWNERS):
            k += 1
        if k > self.i and self._open_at(k):
            self.i = self.reader.read(self.words, k)[-1][2]

    def _place_said(self, parts: tuple[str, ...], kind: str) -> bool:
        said = [self._text(self.i + j) for j in range(len(parts))]
        return kind.startswith("REL ") and said == [*parts]

    def _holds(self, k: int, *, none: bool) -> bool:
        """Read the box that has my tools as the box with them, one that has none as without."""
        if not self._noun_phrase_at(k):
            return False
        self._emit("THAT_NOT_REL" if none else "REL", "together", k - self.i)
        return True

    def _happened(self, k: int) -> bool:
        """Read the box that came: a verb of the thing's own, with no object, says nothing more."""
        following = self._text(k + 1)
        alone = following in ("", TIME_GAP) or place_follows(self.words, k + 1)
        if self._text(self.i) not in ("that", "which") or not is_open(self._text(k)) or not alone:
            return False
        if self._text(k) in tw.UNITS:
            return False  # that day: a time that nothing here tells
        self.i = k + 1
        return True

    def _of_theirs(self, k: int) -> bool:
        """Read that belongs to me, that does not belong to anna."""
        negated = self._text(k) in ("do", "does", "did") and self._text(k + 1) == "not"
        verb = k + 2 * negated
        belongs = self._text(verb) in ("belongs", "belong", "belonged")
        if not belongs or self._text(verb + 1) != "to" or not self._owner_at(verb + 2):
            return False
        far = self._extraposed(self._text(k) in ("belong", "do"), owned=True)
        self._emit("_THAT_IS_NOT" if negated else "_THAT_IS", far, verb + 2 - self.i)
        return self._belongs(self.i)

    def _belongs(self, k: int) -> bool:
        if not self._owner_at(k):
            return False
        k = self._to_owner(k)
        self._emit("OWNED", self._whose(k), k + 1 - self.i)
        return True

    def _to_owner(self, k: int) -> int:
        """Return where the owner's own word stands: my mother, the nurse's."""
        while self._open_at(k + 1) and (self._text(k) in DETERMINERS or self._text(k) in OWNERS):
            k += 1
        return k

    def _owner_at(self, k: int) -> bool:
        owner = self._text(self._to_owner(k))
        return owner in OWNED or is_open(owner)

    def _whose(self, k: int) -> str:
        """Return the owner at `k` as it is kept; hers is of the one whose thing was spoken of."""
        text = self._text(k)
        owner = OWNED.get(text, text.removesuffix("'s"))
        spoken = self.it.owner if self.it is not None else None
        return spoken if spoken and owner in ("her", "him", "them") else owner

    def _is_theirs(self, k: int) -> bool:
        """Whether an owner stands at `k` with nothing of theirs after it: that is anna's."""
        k = self._to_owner(k)
        alone = self._text(k) in OWNED and self._text(k) not in ("me", "us", "you", *_OBJECTS)
        return (alone or self._text(k).endswith("'s")) and not self._open_at(k + 1)

    def _looks(self, k: int) -> bool:
        """Whether a look that is a noun elsewhere stands alone at `k`: that is orange."""
        return self.lexicon.attributes.get(self._text(k)) in PREDICATES and not self._open_at(k + 1)

    def _attribute_at(self, k: int) -> bool:
        found = self.reader.read(self.words, k) if is_open(self._text(k)) else []
        return self._state_at(k) or (bool(found) and isinstance(found[0][0], Attribute))

    def _state_at(self, k: int) -> bool:
        """Whether a word alone says how the thing is: that is not chipped."""
        alone = is_open(self._text(k)) and not self._open_at(k + 1)
        placed = self._text(k) in phrases().verbs or place_follows(self.words, k + 1)
        return alone and not placed and describes(self._text(k), self.lexicon.heads)

    def _extraposed(self, plural: bool, *, owned: bool = False) -> bool:
        """Whether a clause at the end is said of what is asked for, not of the noun before it.

        So `what is on the table that is not red`, and by its number `the cups on it that are red`.
        owned: it says whose a thing is, which what stands on another tells more often.
        """
        tags = self.out.tags
        if self._last() in ("AT_PLACE", "SEE"):
            return True
        nouns = [t for t in tags if t.type == "NOUN"]
        if not any(t.type == "REL" for t in tags) or tags[-1].type != "NOUN":
            return False
        ground = tags[-1].word.start in self.several
        bare = tags[0].type == "_WHAT" and tags[2:3] != [] and tags[2].type != "NOUN"
        first = nouns[0].value
        anything = isinstance(first, Noun) and first.category == ANYTHING and len(nouns) > 1
        if bare or anything:
            return not (plural and ground)
        agrees = (nouns[0].word.start in self.several) == plural
        return len(nouns) > 1 and agrees and (owned or ground != plural or self._in_one_phrase())

    def _in_one_phrase(self) -> bool:
        """Whether a thing and its place are one phrase: the cup on the table that is red.

        Then its head is meant. What is asked to be on the table that is red is no part of it.
        """
        kinds = [t.type for t in self.out.tags]
        first = kinds.index("NOUN")
        asked = kinds[0] in ("BE", "_WHEN", "_WHETHER") and "THERE" not in kinds
        return not (asked or {"BE", "AUX"} & {*kinds[first:]})

    def _topic(self) -> bool:
        """Pass over what a thing is about or for: the book about cooking, the key to the shed."""
        text = self._text(self.i)
        if self._last() not in ("NOUN", "PART"):
            return False
        if text == "by" and self._text(self.i + 1) in self.lexicon.names:
            self.i = self.reader.read(self.words, self.i + 1)[-1][2]  # the book by jane austen
            return True
        if text == "to" and self.superlatives:
            self._emit("REL", "near", 1)  # the closest chair to the door
            return True
        said = [w.text for w in self.words[self.i : self.i + 4]]
        timed = any(tuple(said[: len(p)]) == p for p, _ in phrases().by_first.get(text, ()))
        moving = any(t.type in ("MOVED", "GO", "MISSING") for t in self.out.tags)
        for_use = text in ("for", "to") and not timed and not moving
        if not for_use and text not in SUBJECT_OF:
            return False
        k = self.i + 1
        led = self._text(k) in DETERMINERS or self._text(k) in OWNERS
        if text == "to" and not led:
            return False
        while self._text(k) in DETERMINERS or self._text(k) in OWNERS or self._counts(k):
            k += 1
        if not self._open_at(k) or (for_use and not self._names(k)):
            return False
        if self._text(k) in tw.UNITS and self._text(k + 1) in ("ago", "back", "earlier"):
            return False  # for hours ago: a time that was misheard
        self.i = self.reader.read(self.words, k)[-1][2]
        return True

    def _names(self, k: int) -> bool:
        """Whether what is for the thing at `k` is a thing, and not asked if it is fit for it."""
        noun = self.out.tags[-1].value
        if self._text(self.i - 1).endswith("ing") or (isinstance(noun, Noun) and not noun.known):
            return False
        kinds = [t.type for t in self.out.tags]
        fitness = kinds[0] == "BE" and "THERE" not in kinds
        return not fitness or place_follows(self.words, self.reader.read(self.words, k)[-1][2])

    def _counts(self, k: int) -> bool:
        """Whether a number, or an owner such as anna's, stands at `k`."""
        text = self._text(k)
        return text.endswith("'s") or bool(text and numbers.cardinal([text], 0))

    def _part(self) -> bool:
        """With a handle, without stripes, with no lid; other `with` is the relation together."""
        text = self._text(self.i)
        if text == "and" and self._last() == "PART":
            return self._part_of(self.i + 1, without=self._lacks())
        if text == "or" and self._last() == "PART":
            self._emit("UNKNOWN", text, 1)  # with stripes or dots
            return True
        if text not in ("with", "without"):
            return False
        none = self._text(self.i + 1) == "no"
        if self._part_of(self.i + 1 + none, without=none or text == "without"):
            return True
        if text == "without" and self._noun_phrase_at(self.i + 1):
            self._emit("THAT_NOT_REL", "together", 1)  # the bottle without the cup
            return True
        return False

    def _lacks(self) -> bool:
        """Whether the part said last is one that the thing lacks."""
        parts = [t.type for t in self.out.tags if t.type in ("_WITH_PART", "_WITHOUT_PART")]
        return parts[-1] == "_WITHOUT_PART"

    def _part_of(self, start: int, *, without: bool) -> bool:
        """Take the part or pattern at `start` as what the noun has, or lacks."""
        k = start
        while self._text(k) in DETERMINERS or numbers.cardinal([self._text(k)], 0):
            k += 1
        found = self._described_part(k)
        noun = next((w.said for w, _, _ in found if isinstance(w, Noun)), "")
        pattern = self._pattern(noun)
        part = noun.rpartition(" ")[2] in self.lexicon.parts
        lacking = without and self.lexicon.known_noun(noun) is None
        if not noun or not (pattern or part or lacking):
            return False
        self._emit("_WITHOUT_PART" if without else "_WITH_PART", 0, start - self.i)
        for what, first, end in found:
            self.i = first
            if isinstance(what, Attribute):
                self._emit("ATTR", what, end - first)
            else:
                self._emit("PART", Pattern(pattern) if pattern else what.said, end - first)
        return True

    def _described_part(self, k: int) -> list[tuple[Attribute | Noun, int, int]]:
        """Return the words of a part: blue and white stripes."""
        found = self.reader.read(self.words, k) if is_open(self._text(k)) else []
        end = found[-1][2] if found else k
        described = all(isinstance(what, Attribute) for what, _, _ in found)
        if found and described and self._text(end) == "and" and is_open(self._text(end + 1)):
            return [*found, *self.reader.read(self.words, end + 1)]
        return found

    def _pattern(self, noun: str) -> str | None:
        """Return the word for a pattern that a thing has: stripes make it striped."""
        patterns = self.lexicon.patterns
        return patterns.get(noun) or patterns.get(noun.rpartition(" ")[2])

    def _one_at(self, k: int) -> list[Described]:
        """Return what describes the `one` at `k`: the small silk one; empty where none stands."""
        end = k
        while self._open_at(end):
            end += 1
        if self._text(end) not in ("one", "ones") or end == k:
            return []
        thing = replace(self.words[end], text="thing")
        found = self.reader.read([*self.words[:end], thing], k)[:-1]
        return found if all(isinstance(what, Attribute) for what, _, _ in found) else []

    def _say_one(self, kind: str, k: int) -> None:
        """Emit `kind` for the determiner here, and what describes the `one` at `k`."""
        found = self._one_at(k)
        self._emit(kind, 0, k - self.i)
        for what, _, last in found:
            self._emit("ATTR", what, last - self.i)
        self.i += 1
