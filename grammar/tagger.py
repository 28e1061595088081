"""Words into the terminals of question.lark.

Phrases come from phrases.txt, relations and places from their own files; what is left are the open
words of noun phrases. Adverbs that float (last, usually, not) are lifted out and kept beside.
"""

from __future__ import annotations

from grammar import numbers
from grammar.closed import is_open
from grammar.cursor import DETERMINERS, OWNERS, PRONOUNS, TIME_GAP, Tagged
from grammar.forms import ObjectTerm, Select
from grammar.nouns import Attribute, Noun
from grammar.phrases import breaks, phrases, place_follows, stands_at
from grammar.speech import SEEK
from grammar.tidying import tidied
from grammar.verbtags import VerbTagger
from grammar.vocabulary import Lexicon
from grammar.words import Word

_WITHIN = ("corner of", "middle of", "center of", "centre of", "end of")
_INTENSIFIERS = frozenset(("right", "directly", "immediately", "straight"))
_PARTS_OF = frozenset(("back", "side", "edge", "top", "front", "arm", "end", "surface", "rim"))
_ALL = ("everything", "all", "every", "each")
_FLOATS: dict[str, Select] = {"last": "last", "first": "first", "usual": "usual"}


def tag(words: list[Word], lexicon: Lexicon, it: ObjectTerm | None = None) -> Tagged:
    """Return the terminals of a sentence whose times are taken out; `it` is what pronouns mean."""
    return Tagger(words, lexicon, it).run()


class Tagger(VerbTagger):
    """One pass over the words of a sentence."""

    # -- the pass

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
        self.out.tags = tidied(self.out.tags)
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
            if self._text(self.i + 1) in DETERMINERS and self._text(self.i + 2) in ("one", "ones"):
                self.i += 3  # my keys, the ones i put in the box
                return True
            self._emit("COMMA", text, 1)
            return True
        if text in ("and", "&", "plus"):
            self._emit("AND", text, 1)
            return True
        if text in ("or", "nor"):
            return self._or()
        return False

    # -- phrases

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
        if terminal.startswith("REL "):
            return self._relation(terminal[4:], said, size)
        match terminal:
            case "drop":
                return self._drop(said, size)
            case "last" | "first" | "usual":
                return self._float(terminal, said, size)
            case "BE_PRESENT" | "BE_PAST":
                return self._be(terminal, said, size)
            case "stands" | "stood":
                return self._stands(terminal, said, size)
            case "AUX_DO" | "AUX_DID" | "AUX_HAVE" | "AUX_CAN" | "HAVE":
                return self._auxiliary(terminal, said, size)
            case "HERE":
                return self._here(said, size)
            case "SEE" | "LEAVE" | "FINDS" | "GO" | "MOVED" | "MISSING":
                return self._verb(terminal, said, size)
            case "_WHAT" | "_WHICH" | "_WHERE" | "_WHEN" | "_HOWMANY" | "_HOWLONG" | "_HOWOFTEN":
                return self._question_word(terminal, said, size)
        if not self._fits(terminal, said, self.i + size):
            return False
        self._emit_phrase(terminal, said, size)
        return True

    def _fits(self, terminal: str, said: str, following: int) -> bool:
        """Whether a phrase may be what it looks like, by what stands before and after it."""
        match terminal:
            case "seen_alone" | "where_last":
                return not self.out.tags
            case "_SHOW" if said == "tell me":
                return not self.out.tags and self._text(following) in _ALL
            case "_SHOW" | "_FIND":
                return not self.out.tags and self._noun_phrase_at(following)
            case "_WHETHER":
                return not self.out.tags
            case "same_place":
                return self._text(following) != "as"
            case "SIDE_BY_SIDE":
                return said != "together" or self._text(following) != "with"
            case "WHO":
                if said in PRONOUNS and self.it is not None:
                    return self._acts(following)
                if is_open(said.rpartition(" ")[2]) and self._goes_on(following):
                    return False  # the robot vacuum is a thing
                return said not in ("you", "u") or self._last() != "SEE"
            case "_EXCEPT":
                before = ("NOUN", "ONE", "COMMA", "SIDE_BY_SIDE", "AT_PLACE", "HERE")
                return self._last() in before
            case _:
                return True

    def _emit_phrase(self, terminal: str, said: str, size: int) -> None:
        """Emit the terminals of a phrase, and keep beside what it says of the selection."""
        match terminal:
            case "seen_alone":
                for kind, value in (("AUX", "have"), ("WHO", "you"), ("SEE", said)):
                    self._emit(kind, value, 0)
                self.i += size
            case "where_last" | "where_room":
                self.room = terminal == "where_room"
                self.out.select = "last" if terminal == "where_last" else self.out.select
                self._emit("_WHERE", said, size)
            case "when_last" | "when_first":
                self.out.select = "last" if terminal == "when_last" else "first"
                self._emit("_WHEN", said, size)
            case "same_place":
                self._emit("SIDE_BY_SIDE", "same_place", size)
            case "SIDE_BY_SIDE":
                self._emit("SIDE_BY_SIDE", "together", size)
            case _:
                self._emit(terminal, said, size)

    def _question_word(self, terminal: str, said: str, size: int) -> bool:
        following = self.i + size
        if (
            terminal == "_WHAT"
            and said == "what"
            and (self._open_at(following) or self._text(following) in numbers.CARDINALS)
            and not (following < len(self.words) and stands_at(self.words, following))
        ):
            terminal = "_WHICH"
        named = self._noun_phrase_at(following) or self._text(following) in ("one", "ones")
        if terminal == "_WHICH" and not named:
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
        if said in ("above", "below") and self._last() == "DET":
            return False
        if not self.out.tags and self._text(following) in ("which", "what"):
            self._emit("PIED", kind, size)
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
        self._emit("THAT_NOT_REL" if negated else "REL", kind, size)
        return True

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

    def _stranded(self, text: str) -> bool:
        """Take a preposition at the end that belongs to its `which`: which shelf is it on."""
        if self.room and text in ("in", "at", "on"):
            self.i += 1
            return True
        kind = self.lexicon.relations.get(text)
        if kind is None or not self.out.tags or self.out.tags[0].type != "_WHICH":
            return False
        self._emit("STRANDED", kind, 1)
        return True

    def _happening(self, text: str) -> bool:
        """Whether a bare word after `what is` names no thing: what is written, what is shown."""
        kinds = [t.type for t in self.out.tags[-2:]]
        if kinds == ["_WHAT", "BE"]:
            return True
        return kinds == ["_WHEN", "BE"] and self.lexicon.known_noun(text) is None

    def _goes_on(self, k: int) -> bool:
        """Whether an open word at `k` goes on a noun phrase: `these cups`, not `it somewhere`."""
        return self._open_at(k) and not breaks(self.words, k)

    # -- the rest

    def _plain(self) -> bool:
        """Tag determiners, numbers, pronouns and the open words of noun phrases."""
        text = self._text(self.i)
        if text in PRONOUNS and self.it is not None and not self._goes_on(self.i + 1):
            self._emit("NOUN", Noun(self.it.category, self.it.word, True, self.it), 1)
            return True
        if text in DETERMINERS:
            self._emit("DET", text, 1)
            return True
        numbered = text[:1].isdecimal() and text[-2:] in ("st", "nd", "rd", "th")
        if numbered and self._open_at(self.i + 1):
            self.i += 1  # the 1st drawer: which one is no business of a camera
            return True
        if text in ("one", "ones") and not self._open_at(self.i + 1):
            self._emit("ONE", text, 1)
            return True
        number = numbers.cardinal([w.text for w in self.words[self.i : self.i + 2]], 0)
        if number is not None:
            self._emit("NUMBER", number[0], number[1])
            return True
        if self._side(text):
            return True
        if self.i + 1 == len(self.words) and self._stranded(text):
            return True
        if not is_open(text):
            return False
        if self._happening(text):
            return False
        for what, first, last in self.reader.read(self.words, self.i):
            self.i = first
            self._emit("NOUN" if isinstance(what, Noun) else "ATTR", what, last - first)
        return True

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
        if text in ("above", "below") and self._last() == "DET" and self._open_at(self.i + 1):
            self._emit("ATTR", Attribute(text, "other"), 1)
            return True
        return False
