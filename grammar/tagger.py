"""Words into the terminals of question.lark.

Phrases come from phrases.txt, relations and places from their own files; what is left are the open
words of noun phrases. Adverbs that float (last, usually, not) are lifted out and kept beside.
"""

from __future__ import annotations

from dataclasses import replace

from grammar import numbers
from grammar.closed import is_open
from grammar.coordination import spread
from grammar.cursor import DETERMINERS, OWNERS, PRONOUNS, TIME_GAP, Tagged
from grammar.forms import ANYTHING, ObjectTerm, Select
from grammar.nouns import Attribute, Described, Noun
from grammar.phrases import breaks, phrases, stands_at
from grammar.relationtags import RelationTagger
from grammar.sayings import AUXILIARIES
from grammar.speech import SEEK
from grammar.tidying import tidied
from grammar.vocabulary import Lexicon
from grammar.words import Word

_INTENSIFIERS = frozenset(("right", "directly", "immediately", "straight"))
_AREAS = ("room", "area", "house", "place", "location", "spot")
_ALL = ("everything", "all", "every", "each")
_FLOATS: dict[str, Select] = {"last": "last", "first": "first", "usual": "usual"}


def tag(words: list[Word], lexicon: Lexicon, it: ObjectTerm | None = None) -> Tagged:
    """Return the terminals of a sentence whose times are taken out; `it` is what pronouns mean."""
    return Tagger(spread(words, lexicon), lexicon, it).run()


class Tagger(RelationTagger):
    """One pass over the words of a sentence."""

    # -- the pass

    def run(self) -> Tagged:
        """Tag every word; what nothing reads becomes UNKNOWN, which no rule takes."""
        while self.i < len(self.words):
            for step in (
                self._joint_part, self._mark, self._clause, self._place, self._topic,
                self._at_least, self._negation, self._part, self._noun_as_subject, self._owner,
                self._phrase, self._plain,
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
        joins = text in ("and", "&", "plus")
        if text in ("or", "nor") or (joins and self._next_place()):
            return self._or()
        if joins:
            two = self._text(self.i + 1) == "not" and self._asks_two(self.i + 2)
            self._emit("UNKNOWN" if two else "AND", text, 1)
        return joins

    def _joint_part(self) -> bool:
        """With a blue cap and a white label: another part of the same thing."""
        return self._text(self.i) == "and" and self._part()

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
            case "_EXCEPT" if said in ("but not", "and not") and self._asks_two(self.i + size):
                self._emit("UNKNOWN", said, size)
                return True
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

    def _asks_two(self, k: int) -> bool:
        """Whether what is denied at `k` is no kind of what is asked for: the cup, not the bowl."""
        figure = self.out.tags[-1].value if self.out.tags else None
        while self._text(k) in DETERMINERS or self._text(k) in OWNERS:
            k += 1
        if not isinstance(figure, Noun) or figure.category == ANYTHING or not self._open_at(k):
            return False
        if self._first() == "_WHAT":
            return False  # what is on the table but not the cup
        denied = self.reader.read(self.words, k)[-1][0]
        wider = self.lexicon.wider(denied.category) if isinstance(denied, Noun) else ()
        return isinstance(denied, Noun) and figure.category not in (denied.category, *wider)

    def _fits(self, terminal: str, said: str, following: int) -> bool:
        """Whether a phrase may be what it looks like, by what stands before and after it."""
        match terminal:
            case "seen_alone" | "where_last" | "what_last" | "what_first":
                return not self.out.tags
            case "any_alone":
                verbal = any(w.text in AUXILIARIES for w in self.words)
                return not self.out.tags and not verbal and self._noun_phrase_at(following)
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
            case "any_alone":
                self._emit("BE", "present", 0)
                self._emit("THERE", said, size)
            case "where_last" | "where_room":
                self.room = terminal == "where_room" or said.endswith(_AREAS)
                self.out.select = "last" if terminal == "where_last" else self.out.select
                self._emit("_WHERE", said, size)
            case "what_last" | "what_first":
                self.out.select = "last" if terminal == "what_last" else "first"
                self._emit("_WHAT", said, size)
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
        self.room = self.room or (terminal == "_WHERE" and said.endswith(_AREAS))
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
        event = said == "before" and self._text(self.i + size) in (*PRONOUNS, "i", "we", "you")
        if said in ("that", "which") or event:
            return False
        self.i += size
        return True

    def _float(self, terminal: str, said: str, size: int) -> bool:
        before_noun = self._last() in ("DET", "OWNER") and self._open_at(self.i + size)
        if before_noun and terminal != "last":  # the last cup is the one seen last
            return False
        if self.reader.compound_at(self.words, self.i) or (said, self._last()) == ("first", "DET"):
            return False
        if self._last() == "DET" and self.out.tags[-1].value == "the" and not before_noun:
            self.out.tags.pop()
        self.out.select = _FLOATS[terminal]
        self.i += size
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
        if said == "about" and self.i + 1 == len(self.words) and self._first() == "_WHAT":
            return False  # what is the book about
        if said == "home" and self._last() in ("DET", "OWNER"):
            return False
        self._emit("HERE", said, size)
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
        if text in ("one", "ones") and not self._open_at(self.i + 1):
            self._emit("ONE", text, 1)
            return True
        number = numbers.cardinal([w.text for w in self.words[self.i : self.i + 2]], 0)
        if number is not None and self._measured(*number):
            return True
        if number is not None:
            self._emit("NUMBER", number[0], number[1])
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
        """Read what a thing is made of as said of it: glass is a noun elsewhere."""
        if text not in self.lexicon.attributes or self._last() not in ("_MADE_OF", "_NOT_MADE_OF"):
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
