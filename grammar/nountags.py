"""Terminals of noun phrases: owners, parts, relative clauses, negation, named places."""

from __future__ import annotations

from grammar.clauses import ClauseTagger
from grammar.closed import words_of
from grammar.cursor import DETERMINERS, OWNED, OWNERS, TIME_GAP
from grammar.nouns import Attribute, Noun
from grammar.phrases import BARE_PLACES, breaks, phrases, place_follows

KIN = words_of(
    "wife husband mom mum mother dad father son daughter brother sister grandma grandpa "
    "grandmother grandfather friend roommate flatmate boyfriend girlfriend partner nurse "
    "carer uncle aunt auntie neighbor neighbour granny grandad granddad gran nan nana mummy mommy "
    "daddy papa mama granddaughter grandson cousin niece nephew everybody "
    "everyone"
)
"""People by their kinship: what they do is no business of a memory of things."""
_MEASURES = words_of("piece pair set bunch pack stack pile roll kind type sort group collection")
PICTURES = words_of(
    "picture photo photograph image snapshot shot footage pic keyframe sighting observation "
    "detection appearance occurrence"
)
"""What a memory keeps of things: the things themselves are asked for."""
_OPENINGS = words_of("door doorway window gate entrance")
_PLACE_WORDS = words_of("in at inside from within into to around of throughout across on")
ON_PLACES = frozenset(
    (
        "balcony", "terrace", "porch", "upstairs", "downstairs", "ground floor", "first floor",
        "second floor", "third floor", "top floor",
    )
)  # fmt: skip
"""What one is on, not in."""
_BEFORE_OWNER = words_of(
    "BE AUX SEE LEAVE FINDS DET REL AND OR _SHOW _FIND _SEEK _HOWMANY _WHERE _WHICH"
) | {""}
_THEIRS = frozenset(("his", "her", "their"))
PEOPLE = KIN | words_of(
    "kid child guest visitor boy girl man woman baby person dog cat lady guy gentleman plumber "
    "caregiver caretaker housekeeper babysitter landlord landlady colleague coworker toddler "
    "teenager grandchild grandkid staff crew porter janitor postman technician "
    "bloke chap fella lad lass fellow pupil student teacher"
)
_AGES = words_of("little big small older younger elder old young eldest oldest youngest new other")
_LEADING = _PLACE_WORDS | DETERMINERS | frozenset(OWNERS)


_ANYBODYS = words_of("somebody's someone's anybody's anyone's")
_NOBODYS = words_of("nobody's no-one's")


class NounTagger(ClauseTagger):
    """Reads what belongs to things."""

    def _or(self) -> bool:
        """In the kitchen or the hall: a place after `or` needs no preposition of its own."""
        following = self._next_place()
        said = "or" if self._text(self.i) in ("or", "nor") else "and"
        self._emit("OR", said, 1)
        if following:
            self._emit("AT_PLACE", following[0], following[1] - self.i)
        return True

    def _next_place(self) -> tuple[str, int] | None:
        """Return the place and its end that the word after this one begins, after a place."""
        if self._last() != "AT_PLACE":
            return None
        k = self.i + 1
        while self._text(k) in _LEADING:
            k += 1
        place, end = self._place_at(k)
        return (place, end) if place else None

    def _place(self) -> bool:
        k = self.i
        preposition = self._text(k)
        if self._last() == "AUX" and self._place_has():
            return True
        if preposition == "outside" and self._outside():
            return True
        if preposition in BARE_PLACES and not self._open_at(k + 1):
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
        if not place or (preposition == "on" and place not in ON_PLACES):
            return False
        if preposition in ("to", "from") and self._last() == "NOUN" and not self._moving():
            self.i = end  # the key to the shed, the box from the attic: which one it is
            return True
        denied = self._last() == "THAT_NOT"  # that is not in the kitchen
        if denied:
            self.out.tags.pop()
        self._emit("NOT_AT_PLACE" if denied else "AT_PLACE", place, end - self.i)
        return True

    def _moving(self) -> bool:
        """Whether it is asked what moved, or what is gone: the place is where to or where from."""
        return any(t.type in ("MOVED", "GO", "MISSING") for t in self.out.tags)

    def _outside(self) -> bool:
        """Read outside the kitchen, the box, as not in it, and outside the door as near it."""
        k = self.i + 1 + (self._text(self.i + 1) == "of")
        while self._text(k) in DETERMINERS or self._text(k) in OWNERS:
            k += 1
        place, end = self._place_at(k)
        if place:
            self._emit("NOT_AT_PLACE", place, end - self.i)
            return True
        if not self._open_at(k) or k == self.i + 1:
            return False  # outside lights
        head = self.lexicon.singular(self._text(self.reader.read(self.words, k)[-1][2] - 1))
        if head in _OPENINGS:
            self._emit("REL", "near", k - self.i)
        else:
            self._emit("THAT_NOT_REL", "in", k - self.i)
        return True

    def _place_has(self) -> bool:
        """Read does the kitchen have an island, how many windows does the hall have."""
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
            ends = not self._open_at(end) or breaks(self.words, end)
            ends = ends or self._ends_with_attributes(end)
            if [self._text(j) for j in range(k, end)] == list(parts) and ends:
                return self.lexicon.places[" ".join(parts)], end
        return "", k

    def _ends_with_attributes(self, k: int) -> bool:
        """Whether the sentence ends in words said of its subject: `... in the hall blue`."""
        found = self.reader.read(self.words, k)
        attributes = all(isinstance(what, Attribute) for what, _, _ in found)
        return attributes and found[-1][2] == len(self.words) and self.out.tags[:1] != []

    def _owner(self) -> bool:
        text = self._text(self.i)
        if text in OWNERS or text in ("mine", "ours", "yours"):
            self._emit("OWNER", OWNERS.get(text) or OWNED[text], 1)
            return True
        doer = self._doer() if text in _THEIRS and self._open_at(self.i + 1) else ""
        if doer:
            self._emit("OWNER", doer, 1)  # where did anna leave her keys
            return True
        if text in _ANYBODYS or text in _NOBODYS:  # what is nobody's is no question of things
            self._emit("DET" if text in _ANYBODYS else "UNKNOWN", text, 1)
            return True
        if text.endswith("'s") and len(text) > 2:
            stem = text.removesuffix("'s")
            singular = self.lexicon.singular(stem)
            kin = self.out.tags[-1].value if self._last() == "NOUN" else None
            owned = [t.type for t in self.out.tags[-2:]] == ["OWNER", "NOUN"]
            if owned and isinstance(kin, Noun) and kin.said in KIN:
                self.out.tags.pop()  # my sister anna's pills
            if self._last() == "OWNER":
                self.out.tags.pop()
            led = self._last() in ("DET", "OWNER") or singular in PEOPLE or singular in KIN
            several = stem not in self.lexicon.names and (led or self.lexicon.known_noun(stem))
            self._emit("OWNER", singular if several else stem, 1)
            return True
        if self._full_name():
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
        named = self._text(self.i + 1) in self.lexicon.names and not self._open_at(self.i + 2)
        if text == "from" and self._last() == "NOUN" and named:
            self._emit("OWNED", self._text(self.i + 1), 2)  # the phone from anna
            return True
        if text == "from" and self._last() == "NOUN" and self._sent():
            return True
        if text == "belonging" and self._text(self.i + 1) == "to":
            return self._belongs(self.i + 2)
        names_plural = text.endswith("s") and text[:-1] in self.lexicon.names
        if names_plural and text not in self.lexicon.names and self._open_at(self.i + 1):
            self._emit("OWNER", text[:-1], 1)
            return True
        return False

    def _sent(self) -> bool:
        """Pass over whom a thing is from, who is no thing himself: from my aunt, from the bank."""
        k = self.i + 1
        while self._text(k) in DETERMINERS or self._text(k) in OWNERS:
            k += 1
        if not self._open_at(k) or self._place_at(k)[0]:
            return False
        last = self.reader.read(self.words, k)[-1][2]
        head = self._text(last - 1)
        person = self.lexicon.singular(head) in PEOPLE
        if not person and self.lexicon.known_noun(head) is not None:
            return False
        self.i = last
        return True

    def _full_name(self) -> bool:
        """Take an owner of several words: mrs hall's cane, aunt mary's hat, the desk lamp's shade.

        Of kin and a name the name counts, as it does alone.
        """
        k = self.i
        if not self.owned or not self._open_at(k):
            return False
        while self._open_at(k) and not self._text(k).endswith("'s"):
            k += 1
        several = self.i < k <= self.i + 2 and self._text(k).endswith("'s")
        if not several or not self._open_at(k + 1) or self._last() not in _BEFORE_OWNER:
            return False
        said = [self._text(j) for j in range(self.i, k)]
        named = said[1:] if self.lexicon.singular(said[0]) in KIN else said
        self._emit("OWNER", " ".join((*named, self._text(k).removesuffix("'s"))), k + 1 - self.i)
        return True

    def _doer(self) -> str:
        """Return the person said to have done it, "" where none is named: anna, my wife."""
        said = next((str(t.value) for t in self.out.tags if t.type == "WHO"), "")
        one = self.lexicon.singular(said)
        return one if said in self.lexicon.names or one in PEOPLE else ""

    def _content(self) -> bool:
        """Cup of coffee, box of cereal: what is in it does not name the thing."""
        k = self.i + 1
        while self._text(k) in DETERMINERS or self._text(k) in OWNERS:
            k += 1
        if not self._open_at(k):
            return False
        if self._text(k) in self.lexicon.names and not self._open_at(k + 1) and k == self.i + 1:
            self._emit("OWNED", self._text(k), 2)  # the bag of anna
            return True
        measured = self.out.tags[-1].value
        if isinstance(measured, Noun) and measured.said in PICTURES and self._shown():
            self.out.tags.pop()  # any photos of my keys
            while self._last() == "DET":
                self.out.tags.pop()
            self.i += 1
            return True
        if isinstance(measured, Noun) and measured.said in _MEASURES:
            self.out.tags.pop()
            self.i = k
            return True
        found = self.reader.read(self.words, k)
        self.i = found[-1][2]
        return True

    def _shown(self) -> bool:
        """Whether the memory's own pictures are asked for: show me, do you have."""
        asked = [t.type for t in self.out.tags[:3]] == ["AUX", "WHO", "HAVE"]
        return self._first() == "_SHOW" or (asked and self.out.tags[1].value in ("you", "u"))

    def _noun_as_subject(self) -> bool:
        """anna, my wife, the kids: people who leave things are the subject of the question."""
        k = self.i
        while self._text(k) in DETERMINERS or self._text(k) in OWNERS:
            k += 1
        while k > self.i and self._text(k) in _AGES:
            k += 1  # my little brother
        named = k > self.i and self._open_at(k) and self._text(k) not in self.lexicon.names
        if named and self.lexicon.singular(self._text(k + 1)) in PEOPLE:
            k += self.lexicon.singular(self._text(k)) not in PEOPLE  # the cleaning lady
        text = self._text(k)
        kind = self.lexicon.singular(text)
        person = text in self.lexicon.names or kind in (PEOPLE if k > self.i else KIN)
        if not person and (kind != "camera" or k == self.i):
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
        verb = self._text(after) in phrases().verbs and not self._moves(after)
        if self._sees(after) if kind == "camera" else verb:
            self._emit("WHO", text, k + 1 - self.i)
            return True
        return False

    def _sees(self, k: int) -> bool:
        """Whether a verb of seeing stands at `k`: what the camera saw; else it is a thing."""
        seeing = any(t in ("SEE", "FINDS") for _, t in phrases().by_first.get(self._text(k), ()))
        return seeing and self._last() != "BE"

    def _moves(self, k: int) -> bool:
        """Whether the verb at `k` has no object: the dog that went is the thing asked for."""
        if place_follows(self.words, k + 1) and self._first() != "_WHAT":
            return True
        return not any(self._noun_phrase_at(j) for j in range(k + 1, min(k + 4, len(self.words))))
