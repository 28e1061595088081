"""The phrases of a question, by their first word: phrases.txt and relations.txt."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from grammar.closed import is_open, words_of
from grammar.vocabulary import files
from grammar.words import Word

STANCES = ("stands", "stood")
_ASKING = (
    "_SHOW", "_WHERE", "_FIND", "_HOWMANY", "_HOWOFTEN", "where_last", "where_first", "when_last",
    "when_first", "what_last", "what_first", "where_all", "when_all",
)  # fmt: skip
SUBJECT_OF = words_of(
    "about regarding concerning called named titled entitled labeled labelled marked saying "
    "depicting containing holding"
)
"""Words before what a book, a jar or a picture is about: that names no other thing."""
VERBAL = ("SEE", "LEAVE", "FINDS", "GO", "MOVED", "MISSING")
_CUTTING = ("GO", "MOVED", "_MADE_OF", "_EXCEPT", "SIDE_BY_SIDE", "MISSING", "usual", "HERE")
BARE_PLACES = frozenset(("upstairs", "downstairs", "outside", "outdoors"))
_EVERY = (("all",), ("all", "the"), ("every",))
_BEING = frozenset(("is", "are", "was", "were", "been"))
_PREPOSITIONS = frozenset(("in", "at", "inside", "within", "throughout", "on"))
_ADVERBS = frozenset(("right", "directly", "immediately", "straight", "still", "just", "usually"))
_BREAKING = ("HERE", "drop", "last", "first", "usual", "SIDE_BY_SIDE", "negative")


@dataclass(frozen=True)
class Phrases:
    """phrases.txt and relations.txt by first word, longest first, and the one-word verbs.

    stances: verbs of position (stands, hung); breakers: what goes on no noun phrase.
    by_two: the same by their first two words, the second "" for a phrase of one.
    """

    by_first: dict[str, list[tuple[tuple[str, ...], str]]]
    verbs: frozenset[str]
    stances: frozenset[str]
    breakers: frozenset[str]
    by_two: dict[tuple[str, str], list[tuple[tuple[str, ...], str]]]

    def starting(self, first: str, second: str) -> list[tuple[tuple[str, ...], str]]:
        """Return the phrases that may stand where these two words do, longest first."""
        return [*self.by_two.get((first, second), ()), *self.by_two.get((first, ""), ())]


@lru_cache(maxsize=1)
def phrases() -> Phrases:
    """Return the phrases of the question; read once."""
    found: dict[str, list[tuple[tuple[str, ...], str]]] = {}
    verbs: set[str] = set()
    stances: set[str] = set()
    breakers: set[str] = set()
    for line in files.lines("phrases.txt"):
        terminal, _, said = line.partition("=")
        for parts in (each for phrase in files.split(said) for each in files.spelled(phrase)):
            found.setdefault(parts[0], []).append((parts, terminal.strip()))
            if len(parts) == 1 and terminal.strip() in VERBAL:
                verbs.add(parts[0])
            if terminal.strip() in STANCES:
                stances.add(" ".join(parts))
            if len(parts) == 1 and terminal.strip() in _BREAKING:
                breakers.add(parts[0])
    for line in files.lines("relations.txt"):
        kind, _, said = line.partition(":")
        for phrase in files.split(said):
            parts = tuple(phrase.split())
            found.setdefault(parts[0], []).append((parts, f"REL {kind.strip()}"))
    for entries in found.values():
        entries.sort(key=lambda entry: (-len(entry[0]), entry[1] not in STANCES))
    by_two: dict[tuple[str, str], list[tuple[tuple[str, ...], str]]] = {}
    for first, entries in found.items():
        for entry in entries:
            by_two.setdefault((first, "".join(entry[0][1:2])), []).append(entry)
    breakers |= verbs | SUBJECT_OF | {"belonging"}
    return Phrases(found, frozenset(verbs), frozenset(stances), frozenset(breakers), by_two)


def breaks(words: list[Word], k: int) -> bool:
    """Whether the open word at `k` starts a phrase of its own and goes on no noun."""
    known = phrases()
    text = words[k].text
    counted = text.removesuffix("s") in _NOUNS_TOO and text != text.removesuffix("s")
    if counted and [w.text for w in words[k + 1 : k + 2]] and words[k + 1].text in _OF_MANY:
        return False  # how many mic stands have we got
    laid = [w.text for w in words[k : k + 2]] in _LAID
    if text in _NOUNS_TOO and not laid and not _verb_due(words, k):
        return False  # where is the glue stick, did you see my cake stand
    if stands_at(words, k):
        return True
    if text in known.stances and _BEING & {w.text for w in words[:k]}:
        return False  # is the lamp stand here: a noun
    if text in known.breakers:
        return True
    if text in BARE_PLACES and (k + 1 == len(words) or not is_open(words[k + 1].text)):
        return True  # is my phone upstairs
    for parts, terminal in known.by_first.get(text, ()):
        cuts = terminal.startswith("REL") or terminal in _CUTTING
        if cuts and [w.text for w in words[k : k + len(parts)]] == [*parts]:
            return True
    return False


_NOUNS_TOO = words_of("stick set stand drop store park record view rest hide light stop")
_OF_MANY = words_of("are were have did do")
_LAID = (["set", "up"], ["set", "down"], ["set", "out"])
_ACTING = words_of("do does did have has had can could")


def _verb_due(words: list[Word], k: int) -> bool:
    """Whether the question still lacks its verb before `k`: where did mom stick it."""
    before = [w.text for w in words[:k]]
    if not phrases().verbs.isdisjoint(before):
        return False
    if not _ACTING.isdisjoint(before):
        return True
    if words[k].text == "set" and before[0] in ("was", "were"):
        return place_follows(words, k + 1)  # was the cup set on the table
    return _BEING.isdisjoint(before) and before[0] in ("which", "what", "who", "how")


def stands_at(words: list[Word], k: int) -> bool:
    """Whether the word at `k` is a verb of position: it has its place, and no `is` before it.

    So `which coats hang on the rack`, and `is the lamp stand on the rack`, where it is a noun.
    """
    if words[k].text not in phrases().stances or k + 1 >= len(words):
        return False
    before = [w.text for w in words[:k]]
    if not before or (_BEING & {*before} and before[-1] not in ("that", "which")):
        return False
    return place_follows(words, k + 1)


def place_follows(words: list[Word], k: int) -> bool:
    """Whether a relation, a preposition of place or `there` stands at `k`, after adverbs."""
    while k < len(words) and words[k].text in _ADVERBS:
        k += 1
    if k >= len(words):
        return False
    text = words[k].text
    if text in _PREPOSITIONS or text in ("here", "there", "upstairs", "downstairs"):
        return True
    return any(
        terminal.startswith("REL ") and [w.text for w in words[k : k + len(parts)]] == [*parts]
        for parts, terminal in phrases().by_first.get(text, ())
    )


def asks_at_start(texts: list[str]) -> bool:
    """Whether the words start with a phrase that asks: `give me a list of`, `tell me the place`."""
    return any(
        terminal in _ASKING and texts[: len(parts)] == [*parts] and parts not in _EVERY
        for parts, terminal in phrases().starting(texts[0], "".join(texts[1:2]))
    )


def spoken() -> tuple[str, ...]:
    """Return every phrase of the question, for spelling to leave alone."""
    said = (" ".join(parts) for entries in phrases().by_first.values() for parts, _ in entries)
    return (*said, *SUBJECT_OF)


@lru_cache(maxsize=16)
def by_first(said: tuple[str, ...]) -> dict[str, list[tuple[str, ...]]]:
    """Return phrases by their first word, longest first."""
    found: dict[str, list[tuple[str, ...]]] = {}
    for phrase in said:
        parts = tuple(phrase.split())
        found.setdefault(parts[0], []).append(parts)
    for entries in found.values():
        entries.sort(key=len, reverse=True)
    return found
