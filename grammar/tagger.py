"""Words into the terminals of question.lark.

Phrases come from phrases.txt, relations and places from their own files; what is left are the open
words of noun phrases. Adverbs that float (last, usually, not) are lifted out and kept beside.
"""

from __future__ import annotations

from grammar import numbers
from grammar.closed import is_open
from grammar.coordination import spread
from grammar.cursor import DETERMINERS, OWNERS, PRONOUNS, TIME_GAP, Tagged
from grammar.forms import ANYTHING, ObjectTerm, Select
from grammar.nouns import Noun
from grammar.opentags import OpenTagger
from grammar.phrases import phrases, stands_at
from grammar.relationtags import SUPERLATIVES
from grammar.sayings import AUXILIARIES
from grammar.speech import SEEK
from grammar.tidying import tidied
from grammar.vocabulary import Lexicon
from grammar.words import Word

_LIMITING = frozenset(("always", "only"))
_INTENSIFIERS = frozenset(("right", "directly", "immediately", "straight"))
_SEEN = frozenset(("seen", "spotted", "detected", "observed", "recorded", "noticed", "found"))
_MINE = ("_WHERE", "BE", "SEE", "LEAVE")
"""After these `me` before a noun is said for my."""
_AREAS = ("room", "area", "house", "place", "location", "spot")
_EACH_OF = ("all", "every", "each")
_BEFORE_EXCEPT = (
    "NOUN", "ONE", "COMMA", "SIDE_BY_SIDE", "AT_PLACE", "HERE", "_WHAT", "MOVED", "MISSING",
    "SEE", "LEAVE", "",
)  # fmt: skip
"""What may stand before what is left out, which may be all that is said: besides the laptop?"""
_ABOUT = ("around", "somewhere", "anywhere", "someplace")
_ALL = ("everything", "all", "every", "each")
_FLOATS: dict[str, Select] = {"last": "last", "first": "first", "usual": "usual"}


def tag(words: list[Word], lexicon: Lexicon, it: ObjectTerm | None = None) -> Tagged:
    """Return the terminals of a sentence whose times are taken out; `it` is what pronouns mean."""
    return Tagger(spread(words, lexicon), lexicon, it).run()


class Tagger(OpenTagger):
    """One pass over the words of a sentence."""

    # -- the pass

    def run(self) -> Tagged:
        """Tag every word; what nothing reads becomes UNKNOWN, which no rule takes."""
        steps = (
            self._joint_part, self._lacks_one, self._all_but, self._bounded, self._mark,
            self._clause, self._place, self._topic,
            self._negation, self._part, self._owning, self._noun_as_subject, self._owner,
            self._closed_noun, self._phrase, self._plain,
        )  # fmt: skip
        while self.i < len(self.words):
            for step in steps:
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
        if joins and self._goes_on_telling():
            self.i += 1  # that is red and that is on the table
            return True
        if text in ("or", "nor") or (joins and self._next_place()):
            return self._or()
        if joins:
            following = self._text(self.i + 1)
            two = following == "not" and self._asks_two(self.i + 2)
            two = two or (following == "no" and self._noun_phrase_at(self.i + 2))
            self._emit("UNKNOWN" if two else "AND", text, 1)
        return joins

    def _goes_on_telling(self) -> bool:
        """Whether another clause is said of the noun before: and that is on the table."""
        following = [self._text(self.i + n) for n in (1, 2)]
        told = self._last() in ("NOUN", "ATTR") and following[0] in ("that", "which")
        return told and following[1] in ("is", "are", "was", "were")

    def _joint_part(self) -> bool:
        """With a blue cap and a white label: another part of the same thing; or no rule's."""
        return self._text(self.i) in ("and", "or") and self._part()

    # -- phrases

    def _phrase(self) -> bool:
        for parts, terminal in phrases().starting(self._text(self.i), self._text(self.i + 1)):
            size = len(parts)
            if any(self._text(self.i + k) != parts[k] for k in range(2, size)):
                continue
            if self._take(terminal, " ".join(parts), size):
                return True
        return False

    def _take(self, terminal: str, said: str, size: int) -> bool:
        """Take a phrase as `terminal` when its neighbours allow it."""
        if terminal.startswith("REL "):
            return self._relation(terminal[4:], said, size)
        match terminal:
            case "same_room":
                self._emit("UNKNOWN", said, size)
                return True
            case "_EXCEPT" if self._other_place(self.i + size):
                return True
            case "_EXCEPT" if said == "but not" and self._relation_at(self.i + size):
                self._emit("AND", said, 1)  # on the table but not near the lamp
                return True
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

    def _other_place(self, k: int) -> bool:
        """Read where it was besides the kitchen, other than in the hall, as not in it."""
        k += self._text(k) in ("in", "at")
        while self._text(k) in DETERMINERS or self._text(k) in OWNERS:
            k += 1
        place, end = self._place_at(k)
        if not place or self._last() not in _BEFORE_EXCEPT[:-1]:
            return False
        self._emit("NOT_AT_PLACE", place, end - self.i)
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
            case (
                "seen_alone"
                | "where_last"
                | "what_last"
                | "what_first"
                | "when_last"
                | "when_first"
                | "where_first"
            ):
                return not self.out.tags
            case "where_all" | "when_all":
                return not self.out.tags
            case "any_alone":
                verbal = any(w.text in AUXILIARIES for w in self.words)
                return not self.out.tags and not verbal and self._noun_phrase_at(following)
            case "_SHOW" if said.partition(" ")[0] in _ALL:  # all cups seen: no verb of its own
                verbs = AUXILIARIES | phrases().verbs - _SEEN
                verbal = any(w.text in verbs for w in self.words)
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
                if self._named_after(following):
                    return False
                if is_open(said.rpartition(" ")[2]) and self._goes_on(following):
                    return False  # the robot vacuum is a thing
                return said not in ("you", "u") or self._last() != "SEE"
            case "_EXCEPT":
                return self._last() in _BEFORE_EXCEPT
            case _:
                return True

    def _emit_phrase(self, terminal: str, said: str, size: int) -> None:
        """Emit the terminals of a phrase, and keep beside what it says of the selection."""
        match terminal:
            case "seen_alone" if self.out.select in ("last", "first"):  # last seen toolbox
                self._emit("_WHERE", said, size)
            case "seen_alone":
                for kind, value in (("AUX", "have"), ("WHO", "you"), ("SEE", said)):
                    self._emit(kind, value, 0)
                self.i += size
            case "any_alone":
                self._emit("BE", "present", 0)
                self._emit("THERE", said, size)
            case "where_last" | "where_first" | "where_room":
                self.room = terminal == "where_room" or said.endswith(_AREAS)
                if terminal != "where_room":
                    self.out.select = "last" if terminal == "where_last" else "first"
                self._emit("_WHERE", said, size)
                self._linked()
            case "what_last" | "what_first":
                self.out.select = "last" if terminal == "what_last" else "first"
                self._emit("_WHAT", said, size)
            case "when_last" | "when_first":
                self.out.select = "last" if terminal == "when_last" else "first"
                self._emit("_WHEN", said, size)
                self._linked()
            case "where_all" | "when_all":
                self.out.select = "all"
                self._emit(f"_{terminal.removesuffix('_all').upper()}", said, size)
                self._linked()
            case "WHO" if said in ("nobody", "no one"):
                self.out.negated = True
                self._emit(terminal, said, size)
            case "same_place":
                self._emit("SIDE_BY_SIDE", "same_place", size)
            case "SIDE_BY_SIDE":
                self._emit("SIDE_BY_SIDE", "together", size)
            case _:
                self._emit(terminal, said, size)

    def _linked(self) -> None:
        """Pass over what joins a place or a time to its clause: the last time that you saw it."""
        if self._text(self.i) in ("that", "when", "where") and self.i + 2 < len(self.words):
            self.i += 1

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
        if said in SUPERLATIVES and self._text(self.i + size) in DETERMINERS | OWNERS.keys():
            if self._last() == "DET":
                self.out.tags.pop()
            return self._relation("near", said, size)  # which chair is nearest the window
        if said == "me" and self._last() in _MINE and self._open_at(self.i + size):
            self._emit("OWNER", "me", size)  # have you seen me hat
            return True
        event = said == "before" and self._text(self.i + size) in (*PRONOUNS, "i", "we", "you")
        if said in ("that", "which") or event:
            return False
        if said in ("both", "both of") and self._two_at(self.i + size):
            self._emit("NUMBER", 2, size)
            return True
        if self._limits(said) or self._of_all(said):
            self._emit("UNKNOWN", said, size)
        else:
            self.i += size
        return True

    def _two_at(self, k: int) -> bool:
        """Whether two of one kind are told at `k`, no two things: both cups, both of my cups."""
        k += self._text(k) in DETERMINERS or self._text(k) in OWNERS
        if not self._open_at(k) or any(w.text in ("and", "or") for w in self.words[k:]):
            return False
        last = self._text(self.reader.read(self.words, k)[-1][2] - 1)
        return self.lexicon.singular(last) != last

    def _of_all(self, said: str) -> bool:
        """Whether it is asked if something is so of all of a kind: were all cups in the kitchen."""
        k = self.i + len(said.split())
        asked = self._first() in ("BE", "_WHETHER") and self._last() in ("BE", "_WHETHER")
        return said.split()[0] in _EACH_OF and asked and self._noun_phrase_at(k)

    def _limits(self, said: str) -> bool:
        """Whether it is asked of all the time, or of one thing alone: no sighting tells that.

        Where it always is may be told by where it is, and `only two cups` are exactly two.
        """
        if said not in _LIMITING or not self.out.tags or self._first() == "_WHERE":
            return False
        after = (w.text for w in self.words[self.i + 1 :])
        counted = said == "only" and not numbers.CARDINALS.keys().isdisjoint(after)
        return not counted and self._last() not in ("DET", "OWNER")

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
        if said == "in it" and self._carries(self.i + 1):
            self._emit("CARRIES", "in", size)
            return True
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
        if said in _ABOUT and self._last() in ("LEAVE", "SEE", "FINDS"):
            self.i += size
            return True
        if said == "about" and self.i + 1 == len(self.words) and self._first() == "_WHAT":
            return False  # what is the book about
        if said == "home" and self._last() in ("DET", "OWNER"):
            return False
        self._emit("HERE", said, size)
        return True
