"""Words into the terminals of question.lark.

Phrases come from phrases.txt, relations and places from their own files; what is left are the open
words of noun phrases. Adverbs that float (last, usually, not) are lifted out and kept beside.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

from grammar import numbers
from grammar.closed import is_open
from grammar.forms import ObjectTerm, Select
from grammar.nouns import PREDICATES, Attribute, Noun, NounReader, Pattern
from grammar.speech import SEEK
from grammar.vocabulary import Lexicon, files
from grammar.words import Word

TIME_GAP = "<time>"
"""Stands where a spoken time was taken out: no phrase reaches across it."""
DETERMINERS = frozenset(
    "a an the this that these those some any their his her its another no".split()
)
OWNERS = {"my": "me", "our": "me", "your": "you"}
OWNED = {"mine": "me", "ours": "me", "yours": "you", "me": "me", "us": "me", "you": "you"}
PRONOUNS = frozenset("it they them these those he him she".split())
KIN = frozenset(
    "wife husband mom mum mother dad father son daughter brother sister grandma grandpa "
    "grandmother grandfather friend roommate flatmate boyfriend girlfriend partner nurse carer "
    "uncle aunt neighbor neighbour granny granddaughter grandson cousin everybody everyone".split()
)
"""People by their kinship: what they do is no business of a memory of things."""
PEOPLE = KIN | frozenset("kid child guest visitor boy girl man woman baby person dog cat".split())
_PLACE_WORDS = frozenset("in at inside from within into to around of throughout across on".split())
_ON_PLACES = frozenset(("balcony", "terrace", "porch", "upstairs", "downstairs"))
_BARE_PLACES = frozenset(("upstairs", "downstairs", "outside", "outdoors"))
_INTENSIFIERS = frozenset(("right", "directly", "immediately", "straight"))
_SUBJECTS = ("i", "we", "you", "he", "she", "they")
_AUXILIARY = frozenset("have had has am is are was were been did do will would could can".split())
_FLOATS: dict[str, Select] = {"last": "last", "first": "first", "usual": "usual"}
_VERBAL = ("SEE", "LEAVE", "FINDS", "GO", "MOVED", "MISSING")
_CUTTING = ("_MADE_OF", "_EXCEPT", "SIDE_BY_SIDE", "MISSING", "usual", "HERE")
_BREAKING = ("HERE", "drop", "last", "first", "usual", "SIDE_BY_SIDE", "negative")


@dataclass(frozen=True, slots=True)
class Tag:
    """A terminal of question.lark with its value; `word` is where it stands in the text."""

    type: str
    value: object
    word: Word


@dataclass
class Tagged:
    """The terminals of a sentence and what was lifted out of it."""

    tags: list[Tag] = field(default_factory=list)
    select: Select | None = None
    negated: bool = False
    here: bool = False


@dataclass(frozen=True)
class Phrases:
    """phrases.txt and relations.txt by first word, longest first, and the one-word verbs."""

    by_first: dict[str, list[tuple[tuple[str, ...], str]]]
    verbs: frozenset[str]
    breakers: frozenset[str]


@lru_cache(maxsize=1)
def phrases() -> Phrases:
    """Return the phrases of the question; read once."""
    found: dict[str, list[tuple[tuple[str, ...], str]]] = {}
    verbs: set[str] = set()
    breakers: set[str] = set()
    for line in files.lines("phrases.txt"):
        terminal, _, said = line.partition("=")
        for phrase in files.split(said):
            parts = tuple(phrase.split())
            found.setdefault(parts[0], []).append((parts, terminal.strip()))
            if len(parts) == 1 and terminal.strip() in _VERBAL:
                verbs.add(phrase)
            if len(parts) == 1 and terminal.strip() in _BREAKING:
                breakers.add(phrase)
    for line in files.lines("relations.txt"):
        kind, _, said = line.partition(":")
        for phrase in files.split(said):
            parts = tuple(phrase.split())
            found.setdefault(parts[0], []).append((parts, f"REL {kind.strip()}"))
    for entries in found.values():
        entries.sort(key=lambda entry: len(entry[0]), reverse=True)
    return Phrases(found, frozenset(verbs), frozenset(verbs | breakers | {"belonging"}))


def breaks(words: list[Word], k: int) -> bool:
    """Whether the open word at `k` starts a phrase of its own and goes on no noun."""
    known = phrases()
    text = words[k].text
    if text in known.breakers:
        return True
    for parts, terminal in known.by_first.get(text, ()):
        if terminal.startswith("REL") or terminal in _CUTTING:
            if all(k + j < len(words) and words[k + j].text == p for j, p in enumerate(parts)):
                return True
    return False


def spoken() -> tuple[str, ...]:
    """Return every phrase of the question, for spelling to leave alone."""
    return tuple(" ".join(parts) for entries in phrases().by_first.values() for parts, _ in entries)


@lru_cache(maxsize=16)
def _by_first(said: tuple[str, ...]) -> dict[str, list[tuple[str, ...]]]:
    found: dict[str, list[tuple[str, ...]]] = {}
    for phrase in said:
        parts = tuple(phrase.split())
        found.setdefault(parts[0], []).append(parts)
    for entries in found.values():
        entries.sort(key=len, reverse=True)
    return found


def tag(words: list[Word], lexicon: Lexicon, it: ObjectTerm | None = None) -> Tagged:
    """Return the terminals of a sentence whose times are taken out; `it` is what pronouns mean."""
    return Tagger(words, lexicon, it).run()


class Tagger:
    """One pass over the words of a sentence."""

    def __init__(self, words: list[Word], lexicon: Lexicon, it: ObjectTerm | None) -> None:
        self.words = [w for w in words if w.text not in ("-", ":", ";")]
        self.lexicon, self.it = lexicon, it
        self.reader = NounReader(lexicon, breaks)
        self.places = _by_first(tuple(lexicon.places))
        self.out = Tagged()
        self.room = False
        self.i = 0

    # -- looking around ------------------------------------------------------------------------

    def _text(self, k: int) -> str:
        return self.words[k].text if 0 <= k < len(self.words) else ""

    def _last(self) -> str:
        return self.out.tags[-1].type if self.out.tags else ""

    def _emit(self, kind: str, value: object, count: int, at: int | None = None) -> None:
        word = self.words[self.i if at is None else at]
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

    # -- the pass --------------------------------------------------------------------------------

    def run(self) -> Tagged:
        """Tag every word; what nothing reads becomes UNKNOWN, which no rule takes."""
        while self.i < len(self.words):
            for step in (
                self._mark, self._clause, self._place, self._negation, self._part,
                self._owner, self._noun_as_subject, self._phrase, self._plain,
            ):  # fmt: skip
                if step():
                    break
            else:
                self._emit("UNKNOWN", self._text(self.i), 1)
        self._tidy()
        return self.out

    def _mark(self) -> bool:
        text = self._text(self.i)
        if text == TIME_GAP:
            self.i += 1
            return True
        if text == SEEK:
            self._emit("_SEEK", text, 1)
            return True
        if text == ",":
            self._emit("COMMA", text, 1)
            return True
        if text in ("and", "&", "plus"):
            self._emit("AND", text, 1)
            return True
        if text in ("or", "nor"):
            return self._or()
        return False

    def _or(self) -> bool:
        """in the kitchen or the hall: a place after `or` needs no preposition of its own."""
        after_place = self._last() == "AT_PLACE"
        self._emit("OR", "or", 1)
        if after_place:
            k = self.i
            while (
                self._text(k) in _PLACE_WORDS
                or self._text(k) in DETERMINERS
                or self._text(k) in OWNERS
            ):
                k += 1
            place, end = self._place_at(k)
            if place:
                self._emit("AT_PLACE", place, end - self.i)
        return True

    def _clause(self) -> bool:
        """that is red, which was on the table, that has a handle, that i left in the hall."""
        kinds = [t.type for t in self.out.tags[-3:]]
        if self._text(self.i) == "that" and kinds == ["NOUN", "BE", "THERE"]:
            del self.out.tags[-2:]  # how many chairs are there that are not wooden
        if self._last() not in ("NOUN", "ONE", "ATTR", "PART"):
            return False
        if self._text(self.i) in _SUBJECTS and self._asked():
            return self._relative(self.i)
        if self._text(self.i) not in ("that", "which", "who"):
            return False
        k = self.i + 1
        if self._text(k) in ("is", "are", "was", "were"):
            k += 1
            negated = self._text(k) == "not"
            k += negated
            if self._attribute_at(k):
                self._emit("_THAT_IS_NOT" if negated else "_THAT_IS", 0, k - self.i)
            elif self._text(k) in ("made", "built"):
                self._emit("_NOT_MADE_OF" if negated else "_MADE_OF", 0, k + 2 - self.i)
            elif negated:
                self._emit("THAT_NOT", 0, k - self.i)
            else:
                self.i = k
            return True
        if self._text(k) in ("has", "have", "had"):
            none = self._text(k + 1) == "no"
            return self._part_of(k + 1 + none, without=none)
        if [self._text(k + n) for n in (1, 2)] == ["not", "have"]:
            return self._part_of(k + 3, without=True)
        if self._text(k) in ("belongs", "belong", "belonged") and self._text(k + 1) == "to":
            self.i = k
            return self._belongs(k + 2)
        return self._relative(k)

    def _asked(self) -> bool:
        """Whether the question's own verb has been said, so that another one is a relative clause."""
        return any(t.type in ("BE", "AUX", "_SHOW", "_FIND", "_SEEK") for t in self.out.tags)

    def _relative(self, k: int) -> bool:
        """the cup (that) i left on the table: the subject and its verb say nothing more."""
        if self._text(k) not in _SUBJECTS:
            return False
        k += 1
        while self._text(k) in _AUXILIARY or self._text(k) in ("last", "just", "already", "always"):
            k += 1
        if self._text(k) not in phrases().verbs and not is_open(self._text(k)):
            return False
        self.i = k + 1
        return True

    def _belongs(self, k: int) -> bool:
        owner = self._text(k)
        if owner in OWNED or is_open(owner):
            self._emit("OWNED", OWNED.get(owner, owner.removesuffix("'s")), k + 1 - self.i)
            return True
        return False

    def _attribute_at(self, k: int) -> bool:
        found = self.reader.read(self.words, k) if is_open(self._text(k)) else []
        return bool(found) and isinstance(found[0][0], Attribute)

    def _place(self) -> bool:
        k = self.i
        preposition = self._text(k)
        if self._last() == "AUX" and self._place_has():
            return True
        if preposition in _BARE_PLACES and not self._open_at(k + 1):
            self._emit("AT_PLACE", preposition, 1)
            return True
        if preposition not in _PLACE_WORDS:
            return False
        k += 1
        if preposition in ("inside",) and self._text(k) == "of":
            k += 1
        while (
            self._text(k) in DETERMINERS
            or self._text(k) in OWNERS
            or self._text(k) in ("same", "whole", "entire")
        ):
            k += 1
        if self._text(k).endswith("'s") and k > self.i + 1:
            return False
        place, end = self._place_at(k)
        if not place or (preposition == "on" and place not in _ON_PLACES):
            return False
        self._emit("AT_PLACE", place, end - self.i)
        return True

    def _place_has(self) -> bool:
        """does the kitchen have an island, how many windows does the hall have."""
        k = self.i
        while self._text(k) in DETERMINERS or self._text(k) in OWNERS:
            k += 1
        place, end = self._place_at(k)
        if not place or self._text(end) not in ("have", "contain"):
            return False
        self._emit("AT_PLACE", place, end - self.i)
        self._emit("HAVE", "have", 1)
        return True

    def _place_at(self, k: int) -> tuple[str, int]:
        """Return (place, its end) of the named place at `k`; no noun may follow it."""
        for parts in self.places.get(self._text(k), ()):
            end = k + len(parts)
            if [self._text(j) for j in range(k, end)] == list(parts) and not self._open_at(end):
                return self.lexicon.places[" ".join(parts)], end
        return "", k

    def _negation(self) -> bool:
        text = self._text(self.i)
        if text == "no":
            following = self._text(self.i + 1)
            if following == "longer":
                self.out.negated = True
                self.i += 2
                return True
            self.out.negated = True
            self._emit("DET", text, 1)
            return True
        if text in ("never", "nothing", "nowhere", "none"):
            self.out.negated = True
            if text in ("nothing", "none"):
                self._emit("NOUN", Noun("object", "thing", known=True), 1)
            else:
                self.i += 1
            return True
        if text != "not":
            return False
        k = self.i + 1
        after_noun = self._last() in ("NOUN", "ONE", "COMMA", "ATTR", "AND", "")
        if self._text(k) in DETERMINERS or self._text(k) in OWNERS:
            if after_noun and self._contrasted(k + 1):
                self._emit("_EXCEPT", 0, 1)
                return True
        elif self._attribute_at(k) and self._last() == "BE" and self._chosen():
            self.out.tags.pop()  # how many chairs are not red: chairs that are not
            self._emit("_THAT_IS_NOT", 0, 1)
            return True
        elif self._attribute_at(k):
            found = self.reader.read(self.words, k)
            before_noun = len(found) > 1 and isinstance(found[-1][0], Noun)
            if before_noun and self._last() in ("DET", "OWNER", ""):
                self.i += 1
                attribute, _, last = found[0]
                self._emit("NOT_ATTR", attribute, last - self.i)
                return True
            if after_noun:
                self._emit("_THAT_IS_NOT", 0, 1)
                return True
        elif self._text(k) in ("made", "built") and self._text(k + 1) in ("of", "from", "out"):
            count = 4 if self._text(k + 1) == "out" else 3
            self._emit("_NOT_MADE_OF", 0, count)
            return True
        self.out.negated = True
        self.i += 1
        return True

    def _chosen(self) -> bool:
        """Whether things are chosen or counted: which chairs, how many chairs."""
        return any(t.type in ("_WHICH", "_HOWMANY") for t in self.out.tags)

    def _contrasted(self, k: int) -> bool:
        """Whether `not the red one` stands here: an attribute, and `one` or nothing after it."""
        found = self.reader.read(self.words, k) if is_open(self._text(k)) else []
        if not found:
            return False
        return all(isinstance(what, Attribute) for what, _, _ in found)

    def _part(self) -> bool:
        """with a handle, without stripes, with no lid; other `with` is the relation together."""
        text = self._text(self.i)
        if text not in ("with", "without"):
            return False
        none = self._text(self.i + 1) == "no"
        return self._part_of(self.i + 1 + none, without=none or text == "without")

    def _part_of(self, start: int, *, without: bool) -> bool:
        """Take the part or pattern at `start` as what the noun has, or lacks."""
        k = start
        while self._text(k) in DETERMINERS or numbers.cardinal([self._text(k)], 0):
            k += 1
        found = self.reader.read(self.words, k) if is_open(self._text(k)) else []
        noun = next((w.said for w, _, _ in found if isinstance(w, Noun)), "")
        pattern = self._pattern(noun)
        if not noun or not (pattern or without or noun.rpartition(" ")[2] in self.lexicon.parts):
            return False
        self._emit("_WITHOUT_PART" if without else "_WITH_PART", 0, start - self.i)
        for what, first, end in found:
            self.i = first
            if isinstance(what, Attribute):
                self._emit("ATTR", what, end - first)
            else:
                self._emit("PART", Pattern(pattern) if pattern else what.said, end - first)
        return True

    def _pattern(self, noun: str) -> str | None:
        """Return the word for a pattern that a thing has: stripes make it striped."""
        patterns = self.lexicon.patterns
        return patterns.get(noun) or patterns.get(noun.rpartition(" ")[2])

    def _owner(self) -> bool:
        text = self._text(self.i)
        if text in OWNERS or text in ("mine", "ours", "yours"):
            self._emit("OWNER", OWNERS.get(text) or OWNED[text], 1)
            return True
        if text.endswith("'s") and len(text) > 2:
            stem = text.removesuffix("'s")
            singular = self.lexicon.singular(stem)
            if self._last() == "OWNER":
                self.out.tags.pop()
            self._emit("OWNER", stem if stem in self.lexicon.names else singular, 1)
            return True
        if text == "of" and self._last() in ("NOUN", "ONE"):
            following = self._text(self.i + 1)
            if following in ("mine", "ours", "yours"):
                self._emit("OWNED", OWNED[following], 2)
                return True
            if following.endswith("'s") and not self._open_at(self.i + 2):
                self._emit("OWNED", following.removesuffix("'s"), 2)
                return True
            return self._content()
        if text == "belonging" and self._text(self.i + 1) == "to":
            return self._belongs(self.i + 2)
        names_plural = text.endswith("s") and text[:-1] in self.lexicon.names
        if names_plural and text not in self.lexicon.names and self._open_at(self.i + 1):
            self._emit("OWNER", text[:-1], 1)
            return True
        return False

    def _content(self) -> bool:
        """cup of coffee, box of cereal: what is in it does not name the thing."""
        k = self.i + 1
        while self._text(k) in DETERMINERS or self._text(k) in OWNERS:
            k += 1
        if not self._open_at(k):
            return False
        found = self.reader.read(self.words, k)
        self.i = found[-1][2]
        return True

    def _noun_as_subject(self) -> bool:
        """anna, my wife, the kids: people who leave things are the subject of the question."""
        k = self.i
        while self._text(k) in DETERMINERS or self._text(k) in OWNERS:
            k += 1
        text = self._text(k)
        person = text in self.lexicon.names or (
            k > self.i and self.lexicon.singular(text) in PEOPLE
        )
        if not person:
            return False
        after = k + 1
        while self._text(after) in (
            "last",
            "ever",
            "first",
            "usually",
            "have",
            "had",
            "just",
            "also",
            "always",
            "normally",
            "did",
            TIME_GAP,
        ):
            after += 1
        if self._text(after) in phrases().verbs and not self._moves(after):
            self._emit("WHO", text, k + 1 - self.i)
            return True
        return False

    def _moves(self, k: int) -> bool:
        """Whether the verb at `k` has no object: the dog that went is itself the thing asked for."""
        return not any(self._noun_phrase_at(j) for j in range(k + 1, min(k + 4, len(self.words))))

    # -- phrases -----------------------------------------------------------------------------------

    def _phrase(self) -> bool:
        for parts, terminal in phrases().by_first.get(self._text(self.i), ()):
            size = len(parts)
            if any(self._text(self.i + k) != part for k, part in enumerate(parts)):
                continue
            if self._take(terminal, " ".join(parts), size):
                return True
        return False

    def _take(self, terminal: str, said: str, size: int) -> bool:
        """Take a phrase as `terminal` when its neighbours allow it."""
        following = self.i + size
        if terminal.startswith("REL "):
            return self._relation(terminal[4:], said, size)
        match terminal:
            case "drop":
                return self._drop(said, size)
            case "last" | "first" | "usual":
                return self._float(terminal, said, size)
            case "seen_alone":
                if self.out.tags:
                    return False
                for kind, value in (("AUX", "have"), ("WHO", "you"), ("SEE", said)):
                    self._emit(kind, value, 0)
                self.i += size
            case "where_last":
                if self.out.tags:
                    return False
                self.out.select = "last"
                self._emit("_WHERE", said, size)
            case "where_room":
                self.room = True
                self._emit("_WHERE", said, size)
            case "when_last" | "when_first":
                self.out.select = "last" if terminal == "when_last" else "first"
                self._emit("_WHEN", said, size)
            case "same_place":
                if self._text(following) == "as":
                    return False
                self._emit("SIDE_BY_SIDE", "same_place", size)
            case "SIDE_BY_SIDE":
                if said == "together" and self._text(following) == "with":
                    return False
                self._emit("SIDE_BY_SIDE", "together", size)
            case "BE_PRESENT" | "BE_PAST":
                return self._be(terminal, said, size)
            case "AUX_DO" | "AUX_DID" | "AUX_HAVE" | "AUX_CAN" | "HAVE":
                return self._auxiliary(terminal, said, size)
            case "HERE":
                return self._here(said, size)
            case "WHO":
                if said in ("you", "u") and self._last() in ("SEE",):
                    return False
                self._emit("WHO", said, size)
            case "_SHOW" | "_FIND" | "_WHETHER":
                if self.out.tags:
                    return False
                if self._noun_phrase_at(following) or terminal == "_WHETHER":
                    self._emit(terminal, said, size)
                    return True
                return False
            case "SEE" | "LEAVE" | "FINDS" | "GO" | "MOVED" | "MISSING":
                return self._verb(terminal, said, size)
            case "_WHAT" | "_WHICH" | "_WHERE" | "_WHEN" | "_HOWMANY" | "_HOWLONG" | "_HOWOFTEN":
                return self._question_word(terminal, said, size)
            case "_EXCEPT":
                if self._last() not in ("NOUN", "ONE", "COMMA", "SIDE_BY_SIDE", "AT_PLACE", "HERE"):
                    return False
                self._emit("_EXCEPT", said, size)
            case _:
                self._emit(terminal, said, size)
        return True

    def _question_word(self, terminal: str, said: str, size: int) -> bool:
        following = self.i + size
        if (
            terminal == "_WHAT"
            and said == "what"
            and (self._open_at(following) or self._text(following) in numbers.CARDINALS)
        ):
            terminal = "_WHICH"
        if terminal == "_WHICH" and not self._noun_phrase_at(following):
            if self._text(following) not in ("one", "ones"):
                return False
        if terminal == "_HOWMANY" and said == "count" and self.out.tags:
            return False
        self._emit(terminal, said, size)
        return True

    def _drop(self, said: str, size: int) -> bool:
        if said == "back" and self._open_at(self.i + size):
            return False
        if said in _INTENSIFIERS and not self._relation_at(self.i + size):
            return False
        led = self._last() in ("DET", "OWNER", "ATTR", "NUMBER")
        if led and self._open_at(self.i) and not self._open_at(self.i + size):
            return False
        if led and said in (
            "standing",
            "hanging",
            "sitting",
            "lying",
            "hidden",
            "stored",
            "mounted",
            "up",
            "present",
        ):
            return False
        if self._last() == "" and said in ("up", "out"):
            return False
        if said in ("that", "which"):
            return False
        self.i += size
        return True

    def _relation_at(self, k: int) -> bool:
        """Whether a phrase of relation stands at `k`: `right above`, `directly next to`."""
        return any(
            terminal.startswith("REL ")
            and [self._text(k + j) for j in range(len(parts))] == [*parts]
            for parts, terminal in phrases().by_first.get(self._text(k), ())
        )

    def _float(self, terminal: str, said: str, size: int) -> bool:
        if self._last() in ("DET", "OWNER") and self._open_at(self.i + size):
            return False
        if self.reader.compound_at(self.words, self.i):
            return False
        if said == "first" and self._last() == "DET":
            return False
        if self._last() == "DET" and self.out.tags[-1].value == "the":
            self.out.tags.pop()
        self.out.select = _FLOATS[terminal]
        self.i += size
        return True

    def _relation(self, kind: str, said: str, size: int) -> bool:
        following = self.i + size
        if not self._noun_phrase_at(following) and self._text(following) not in (
            "one",
            "ones",
            "no",
        ):
            return False
        negated = self._last() == "THAT_NOT"
        if negated:
            self.out.tags.pop()
        self._emit("THAT_NOT_REL" if negated else "REL", kind, size)
        return True

    def _be(self, terminal: str, said: str, size: int) -> bool:
        if said == "be" and (self._has("BE") or self._has("AUX")):
            self.i += size
            return True
        if said == "lies" and not self.out.tags:
            return False
        self._emit("BE", "present" if terminal == "BE_PRESENT" else "past", size)
        return True

    def _has(self, kind: str) -> bool:
        return any(t.type == kind for t in self.out.tags)

    def _auxiliary(self, terminal: str, said: str, size: int) -> bool:
        following = self._text(self.i + size)
        if terminal == "HAVE":
            if self._last() != "WHO" or not (
                self._noun_phrase_at(self.i + size)
                or not following
                or following in ("in", "on", "at")
            ):
                return False
            self._emit("HAVE", said, size)
            return True
        if self._has("AUX") and said in ("have", "had"):
            self.i += size
            return True
        if terminal == "AUX_CAN" and said == "may" and self.out.tags:
            return False
        value = {"AUX_DO": "do", "AUX_DID": "did", "AUX_HAVE": "have", "AUX_CAN": "can"}[terminal]
        self._emit("AUX", value, size)
        return True

    def _here(self, said: str, size: int) -> bool:
        following = self.i + size
        if said == "there":
            bare = self._last() in ("BE", "AUX", "_WHETHER", "") or self._text(following) in (
                "is",
                "are",
                "was",
                "were",
            )
            if bare and self._last() != "NOUN":
                self._emit("THERE", said, size)
                return True
        if said in ("around", "about", "nearby", "over there") and self._noun_phrase_at(following):
            return False
        if said in ("somewhere", "anywhere", "someplace") and self._text(following) in (
            "in",
            "on",
            "near",
            "at",
            "inside",
        ):
            self.i += size
            return True
        if said == "around" and self._last() in ("LEAVE", "SEE"):
            self.i += size
            return True
        if said == "home" and self._last() in ("DET", "OWNER"):
            return False
        self._emit("HERE", said, size)
        return True

    def _verb(self, terminal: str, said: str, size: int) -> bool:
        if self._last() in ("DET", "OWNER", "ATTR", "NUMBER", "REL") and terminal != "SEE":
            return False
        if self._last() in ("DET", "OWNER", "ATTR") and self._open_at(self.i):
            return False
        if not self.out.tags:
            return False
        if terminal == "GO" and not (
            self._has("_WHERE") or self._has("_HOWLONG") or self._has("_HOWOFTEN")
        ):
            return False
        if terminal == "GO" and self._has("WHO"):
            return False
        if terminal == "LEAVE" and said in ("lost", "lose") and not self._has("WHO"):
            return False
        if terminal == "LEAVE" and said in ("lay", "hide") and not self._has("WHO"):
            return False
        if terminal == "MISSING" and said in ("gone", "lost", "removed") and self._has("_WHERE"):
            return False
        if terminal == "MOVED" and said == "different" and self._last() not in ("BE", "_WHAT"):
            return False
        self._emit(terminal, said, size)
        return True

    # -- the rest ------------------------------------------------------------------------------------

    def _plain(self) -> bool:
        """Determiners, numbers, pronouns and the open words of noun phrases."""
        text = self._text(self.i)
        if text in PRONOUNS and not self._open_at(self.i + 1) and self.it is not None:
            self._emit("NOUN", Noun(self.it.category, self.it.word, True, self.it), 1)
            return True
        if text in DETERMINERS:
            self._emit("DET", text, 1)
            return True
        if text in ("one", "ones") and not self._open_at(self.i + 1):
            self._emit("ONE", text, 1)
            return True
        number = numbers.cardinal([w.text for w in self.words[self.i : self.i + 2]], 0)
        if number is not None:
            self._emit("NUMBER", number[0], number[1])
            return True
        if text == "at" and self.i + 1 == len(self.words):
            self.i += 1
            return True
        if text in ("in", "at", "on") and self.room and self.i + 1 == len(self.words):
            self.i += 1
            return True
        if not is_open(text):
            return False
        if self._last() == "BE" and len(self.out.tags) > 1 and self.out.tags[-2].type == "_WHAT":
            return False  # what is written, what is wrong: no thing is named
        for what, first, last in self.reader.read(self.words, self.i):
            self.i = first
            self._emit("NOUN" if isinstance(what, Noun) else "ATTR", what, last - first)
        return True

    # -- tidying -------------------------------------------------------------------------------------

    def _tidy(self) -> None:
        """Settle what needs a look at both neighbours: commas, `and`, predicates."""
        tags = self.out.tags
        tags = _commas(tags)
        tags = _joined_attributes(tags)
        tags = _things_described(tags)
        self.out.tags = _predicates(tags)


def _commas(tags: list[Tag]) -> list[Tag]:
    """A comma between nouns of a list is an `and`; any other is nothing."""
    out: list[Tag] = []
    for i, tag_ in enumerate(tags):
        if tag_.type != "COMMA":
            out.append(tag_)
            continue
        before = out[-1].type if out else ""
        after = tags[i + 1].type if i + 1 < len(tags) else ""
        listed = any(t.type in ("AND", "OR") for t in tags[i + 1 :])
        if (
            before in ("NOUN", "ONE")
            and after in ("NOUN", "DET", "OWNER", "ATTR", "NUMBER")
            and listed
        ):
            out.append(Tag("AND", ",", tag_.word))
    return out


def _joined_attributes(tags: list[Tag]) -> list[Tag]:
    """Drop `and` between attributes, before a relation, and after another `and`."""
    out: list[Tag] = []
    for i, tag_ in enumerate(tags):
        before = out[-1].type if out else ""
        after = tags[i + 1].type if i + 1 < len(tags) else ""
        if tag_.type == "AND":
            attributes = before == "ATTR" and after == "ATTR"
            ground = after in (
                "REL",
                "AT_PLACE",
                "SIDE_BY_SIDE",
                "THAT_NOT_REL",
                "_WITH_PART",
                "_THAT_IS",
                "_EXCEPT",
                "",
            )
            if attributes or ground or before in ("AND", ""):
                continue
        if tag_.type == "OR" and after in ("REL", "AT_PLACE"):
            tag_ = Tag("OR_ITEM", "or", tag_.word)
        out.append(tag_)
    return out


def _things_described(tags: list[Tag]) -> list[Tag]:
    """Put attributes before their noun in `something red`."""
    out: list[Tag] = []
    for tag_ in tags:
        noun = out[-1] if out else None
        if (
            tag_.type == "ATTR"
            and noun is not None
            and noun.type == "NOUN"
            and isinstance(noun.value, Noun)
            and noun.value.category == "object"
        ):
            out.insert(len(out) - 1, tag_)
            continue
        out.append(tag_)
    return out


def _predicates(tags: list[Tag]) -> list[Tag]:
    """An attribute after its noun, with no `that is`, is said of it: `is the cup red`."""
    out: list[Tag] = []
    for i, tag_ in enumerate(tags):
        if tag_.type == "ATTR" and isinstance(tag_.value, Attribute):
            rest = tags[i:]
            ends = all(t.type == "ATTR" for t in rest)
            follows = i > 0 and out[-1].type in ("NOUN", "ONE", "PREDICATE", "BE", "AUX")
            if ends and follows:
                kind = "PREDICATE" if tag_.value.kind in PREDICATES else "STATE"
                out.append(Tag(kind, tag_.value, tag_.word))
                continue
        out.append(tag_)
    return out
