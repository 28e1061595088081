"""Terminals of verbs: to be, auxiliaries, verbs of seeing, leaving and of position."""

from __future__ import annotations

from grammar.cursor import OWNERS, Tag
from grammar.nouns import Noun
from grammar.ownertags import OwnerTagger
from grammar.phrases import phrases, stands_at

_APPEARING = frozenset(
    ("appear", "appeared", "show up", "showed up", "turn up", "turned up", "pop up", "popped up")
)
_DUE = ("belongs", "belong", "goes", "go")
_BEING = {"do": "present", "did": "past", "have": "past"}
"""The tense of a question in which a verb of position follows its auxiliary."""


class VerbTagger(OwnerTagger):
    """Reads the verbs of a question by their neighbours."""

    def _acts(self, k: int) -> bool:
        """Whether a verb of seeing or leaving with its object stands at `k`: they left my keys."""
        while self._text(k) in ("have", "had", "last", "ever", "just"):
            k += 1
        return self._text(k) in phrases().verbs and self._noun_phrase_at(k + 1)

    def _subject(self) -> None:
        """Say what a place is asked of where a second sentence leaves it out: `is on my desk`."""
        if self.it is not None and [t.type for t in self.out.tags] == ["BE"]:
            self._emit("NOUN", Noun(self.it.category, self.it.word, True, self.it), 0)

    def _stands(self, terminal: str, said: str, size: int) -> bool:
        """Read a verb of position before its place as `is`: what hangs over the door."""
        if not self.out.tags or self._has("WHO") or not stands_at(self.words, self.i):
            return False
        if said in _DUE and self._last() == "_WHAT":
            self._emit("UNKNOWN", said, size)  # what belongs on the shelf is no sighting
            return True
        value = "present" if terminal == "stands" else "past"
        for k, tag_ in enumerate(self.out.tags):
            if tag_.type == "AUX" and tag_.value in _BEING:  # did a lamp stand on the desk
                self.out.tags[k] = Tag("BE", _BEING.get(str(tag_.value), value), tag_.word)
                self.i += size
                return True
        if self._last() not in ("_WHAT", "NOUN", "ONE", "THERE"):
            return False
        self._emit("BE", value, size)
        return True

    def _be(self, terminal: str, said: str, size: int) -> bool:
        if said == "be" and (self._has("BE") or self._has("AUX")):
            first = self.out.tags[0]
            if first.type == "AUX" and first.value == "can":  # could my keys be in the car
                self.out.tags[0] = Tag("BE", "present", first.word)
            self.i += size
            return True
        self._emit("BE", "present" if terminal == "BE_PRESENT" else "past", size)
        return True

    def _has(self, kind: str) -> bool:
        return any(t.type == kind for t in self.out.tags)

    def _auxiliary(self, terminal: str, said: str, size: int) -> bool:
        following = self._text(self.i + size)
        if terminal == "HAVE":
            counted = self._has("_HOWMANY") and self._last() == "NOUN" and not following
            if counted and self._has("AUX"):
                self._emit("HAVE", said, size)
                return True
            if self._last() != "WHO" or not (
                self._noun_phrase_at(self.i + size)
                or not following
                or following in ("in", "on", "at", "only", "just", "more", "fewer", "less", "up")
            ):
                return False
            self._emit("HAVE", said, size)
            return True
        if said.startswith("should") and following not in ("i", "we", "you"):
            return False  # where should the plates go asks for advice
        being = self.words[-1].text in ("is", "are", "was", "were")
        if terminal in ("AUX_DO", "AUX_DID") and self._first() == "_WHERE" and being:
            self.i += size  # where does my cup is
            return True
        if self._has("AUX") and said in ("have", "had"):
            self.i += size
            return True
        doer = following in ("i", "we", "one", "you", "be") or following in OWNERS
        if terminal == "AUX_CAN" and said == "may" and self.out.tags and not doer:
            return False
        value = {"AUX_DO": "do", "AUX_DID": "did", "AUX_HAVE": "have", "AUX_CAN": "can"}[terminal]
        self._emit("AUX", value, size)
        return True

    def _verb(self, terminal: str, said: str, size: int) -> bool:
        if self._last() in ("DET", "OWNER", "ATTR", "NUMBER", "REL") and terminal != "SEE":
            return False
        if self._last() in ("DET", "OWNER", "ATTR") and self._open_at(self.i):
            return False
        if not self.out.tags:
            return False
        robots = any(t.type == "WHO" and t.value in ("you", "u") for t in self.out.tags)
        if said in ("use", "used", "using") and robots:
            self._emit("UNKNOWN", said, size)  # which planner are you using
            return True
        if terminal == "LEAVE" and self._participle(self.i + size):
            self.i += size
            return True
        appears = said in _APPEARING and (self._has("_WHEN") or self._has("AUX"))
        placed = self._has("_WHERE") or self._has("_HOWLONG") or self._has("_HOWOFTEN")
        if terminal == "GO" and not (placed or appears):
            return False
        habit = said == "go" and self._habitual()
        if (said == "going" and self._has("BE")) or habit:
            self._emit("UNKNOWN", said, size)  # where is the bus going, where do the dishes go
            return True
        if terminal == "GO" and self._has("WHO"):
            return False
        if terminal == "LEAVE" and said in ("lost", "lose") and not self._has("WHO"):
            return False
        if terminal == "LEAVE" and said in ("lay", "hide") and not self._has("WHO"):
            return False
        if said == "leave" and not self._has("WHO"):
            self._emit("UNKNOWN", said, size)  # when does the bus leave
            return True
        if terminal == "MISSING" and said in ("gone", "lost", "removed") and self._has("_WHERE"):
            return False
        if terminal == "MOVED" and said in ("different", "new"):
            asked = [t.type for t in self.out.tags[-2:]] == ["_WHAT", "BE"]
            if not (asked or (said == "different" and self._last() in ("BE", "_WHAT"))):
                return False
        self._emit(terminal, said, size)
        return True

    def _habitual(self) -> bool:
        """Whether it is asked where a thing is to go, not where it went or usually goes."""
        due = any(t.type == "AUX" and t.value == "do" for t in self.out.tags)
        return due and self._first() == "_WHERE" and self.out.select is None

    def _participle(self, following: int) -> bool:
        """Whether a verb of leaving only says how a thing is: `seen hidden behind the box`."""
        said = self._last() == "THERE" or any(t.type == "SEE" for t in self.out.tags)
        return said and (self._relation_at(following) or self._text(following) == "in")
