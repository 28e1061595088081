"""Terminals of whose a thing is, where a verb says it: does anna have, belongs to me, are hers."""

from __future__ import annotations

from grammar.closed import words_of
from grammar.counttags import CountTagger
from grammar.cursor import DETERMINERS, OWNED, OWNERS, Tag
from grammar.nouns import Noun, Whose
from grammar.nountags import KIN, PEOPLE

_HAVING = words_of("have own possess has owns possesses had owned got")
_TITLES = words_of("mr mrs ms miss dr")
_BELONGING = frozenset(("belong", "belongs", "belonged"))
_PERSONS = KIN | PEOPLE - {"dog", "cat"}
_ASKING = ("BE", "_WHICH", "_HOWMANY", "_WHAT", "_WHETHER")


class OwnerTagger(CountTagger):
    """Reads verbs and predicates of owning."""

    def _owning(self) -> bool:
        """Read does anna have, which cups belong to anna, are the keys on the desk mine."""
        text = self.words[self.i].text
        if text in _BELONGING and self._text(self.i + 1) == "to":
            return self._belonging()
        if self._last() == "AUX" and self.out.tags[-1].value in ("do", "did", "have"):
            return self._possessor()
        led = text in OWNED or text in OWNERS or text in DETERMINERS or text.endswith("'s")
        return led and self._theirs()

    def _possessor(self) -> bool:
        """Read the person of whom it is asked what they have: a thing that is known, no cold."""
        k = self.i
        while self._text(k) in DETERMINERS or self._text(k) in OWNERS:
            k += 1
        titled = self._text(k) in _TITLES and self._open_at(k + 1)
        k += titled
        text = " ".join(w.text for w in self.words[k - titled : k + 1])
        kind = self.lexicon.singular(text)
        named = titled or text in self.lexicon.names
        person = named or kind in KIN or (k > self.i and kind in PEOPLE)
        if not person or self._text(k + 1) not in _HAVING:
            return False
        if not self._has_things(k + 2):
            self._emit("UNKNOWN", text, k + 1 - self.i)
            return True
        self._emit("POSSESSOR", Whose(kind if kind in KIN | PEOPLE else text), k + 1 - self.i)
        self._emit("HAVE", "have", 1)
        return True

    def _has_things(self, k: int) -> bool:
        """Whether what is had is known as a thing: said before, or after the verb at `k`."""
        nouns = [t.value for t in self.out.tags if isinstance(t.value, Noun)]
        if not nouns and self._first() != "_WHAT":
            while self._text(k) in DETERMINERS or not (self._open_at(k) or self._text(k) == ""):
                k += 1
            found = self.reader.read(self.words, k) if self._open_at(k) else []
            nouns = [what for what, _, _ in found if isinstance(what, Noun)]
        known = all(noun.known and noun.said not in _PERSONS for noun in nouns)
        return known and (bool(nouns) or self._first() == "_WHAT")

    def _belonging(self) -> bool:
        """Read a verb of belonging as an owner said of what is asked for; a teacher is nobody."""
        k = self._to_owner(self.i + 2)
        tags = self.out.tags
        somebody = self._owner_at(k) and self._text(self.i + 2) not in ("a", "an")
        if self._last() not in ("NOUN", "ONE", "_WHAT", "AUX", "AT_PLACE") or not somebody:
            return False
        auxiliary = next((n for n, t in enumerate(tags) if t.type == "AUX"), None)
        if auxiliary is not None:
            at = tags.pop(auxiliary)
            tags.insert(auxiliary, Tag("BE", "present", at.word))
        elif self._first() in ("_WHICH", "_HOWMANY", "_WHAT", "_WHETHER"):
            self._emit("BE", "present", 0)
        else:
            return False
        self._say_whose(k)
        return True

    def _theirs(self) -> bool:
        """Read an owner after `is`: which cups are anna's, is the mug on the desk mine."""
        first, last = self._first(), self._last()
        follows = last in ("NOUN", "ONE", "AT_PLACE") if first == "BE" else last == "BE"
        if not follows or first not in _ASKING or not self._is_theirs(self.i):
            return False
        self._say_whose(self._to_owner(self.i))
        return True

    def _say_whose(self, k: int) -> None:
        """Emit the owner at `k`; of things that are chosen, `not` says whose they are not."""
        isnt = self.out.negated and self._first() in ("_WHICH", "_HOWMANY", "_WHAT")
        self.out.negated = self.out.negated and not isnt
        self._emit("IS_OWNED", Whose(self._whose(k), isnt), k + 1 - self.i)
