"""Speech made plain: wake words, fillers, politeness, stutters and self-corrections taken out.

What is left are the words of the question proper, still with their offsets in the text.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

from grammar import numbers
from grammar import timewords as tw
from grammar.closed import is_open
from grammar.vocabulary import Lexicon, files
from grammar.words import Word

SEEK = "<seek>"
"""Stands for "I am looking for" and its like at the start of a question."""
_ENDS = frozenset("?!.;")
_ABBREVIATIONS = frozenset((*tw.MONTH_SHORT, *tw.WEEKDAY_SHORT))
_QUESTION_STARTS = frozenset(
    "where when what which who why how is are was were did do does have has had can could show "
    "list in on at".split()
)
_QUESTION_WORDS = frozenset("where when what which how whether whereabouts".split())
_AUXILIARIES = frozenset("is are was were did do does have has had can could should will".split())


@dataclass(frozen=True)
class Phrases:
    """The phrases of one section of speech.txt, found by their first word."""

    by_first: dict[str, tuple[tuple[str, ...], ...]]

    def at(self, words: list[Word], i: int) -> int:
        """Return how many words the longest phrase at `i` takes, 0 for none."""
        if i >= len(words):
            return 0
        for phrase in self.by_first.get(words[i].text, ()):
            end = i + len(phrase)
            if end <= len(words) and all(
                words[i + k].text == part for k, part in enumerate(phrase)
            ):
                return len(phrase)
        return 0

    def ending(self, words: list[Word]) -> int:
        """Return how many words the longest phrase at the end takes, 0 for none."""
        for k in range(max(0, len(words) - 6), len(words)):
            if self.at(words, k) == len(words) - k:
                return len(words) - k
        return 0


@lru_cache(maxsize=1)
def _sections() -> dict[str, Phrases]:
    found: dict[str, Phrases] = {}
    for name, said in files.sections("speech.txt").items():
        by_first: dict[str, list[tuple[str, ...]]] = {}
        for phrase in said:
            parts = tuple(phrase.split())
            by_first.setdefault(parts[0], []).append(parts)
        found[name] = Phrases(
            {k: tuple(sorted(v, key=len, reverse=True)) for k, v in by_first.items()}
        )
    return found


def sentences(words: list[Word]) -> list[list[Word]]:
    """Cut the words at full stops and question marks; the dot of `oct.` is no full stop."""
    found: list[list[Word]] = [[]]
    for i, word in enumerate(words):
        if word.text == "." and i and words[i - 1].text in _ABBREVIATIONS:
            continue
        if word.text in _ENDS:
            found.append([])
        elif word.text != ":":
            found[-1].append(word)
    return [part for sentence in found if sentence for part in _parted(sentence)]


def _parted(words: list[Word]) -> list[list[Word]]:
    """Part a reason said first from its question: `i lost my wallet can you help me find it`."""
    texts = [w.text for w in words]
    dislocated = texts[-1] in ("it", "they", "them") and texts[0] not in _QUESTION_STARTS
    if texts[0] not in ("i", "we", "my", "there", "it") and not dislocated:
        return [words]
    for i in range(1 if dislocated else 2, len(texts) - 2):
        starts = tuple(texts[i : i + 2])
        asked = starts[0] == "where" and starts[1] in (*_AUXILIARIES, "might")
        if (asked or starts in _ASKED) and texts[i - 1] not in _TELLING:
            return [words[:i], words[i:]]
    return [words]


_ASKED = (
    ("is", "there"),
    ("are", "there"),
    ("have", "you"),
    ("did", "you"),
    ("can", "you"),
    ("could", "you"),
    ("do", "you"),
    ("when", "did"),
)
_TELLING = frozenset(
    "know remember forgot forget recall tell wonder sure wondering idea of about and or".split()
)


def plain(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Return the words of one sentence without what changes nothing."""
    words = _heard(_without_fillers(words))
    words = _corrected(words, lexicon)
    words = _without_stutter(words)
    words = _opened(words)
    return _closed(words)


def _heard(words: list[Word]) -> list[Word]:
    """Return the words with a `where` that a recogniser spelled as it sounds."""
    if len(words) > 2 and words[0].text in ("wear", "ware", "were", "we're"):
        if words[1].text in ("is", "are", "did", "was", "have"):
            return [replace(words[0], text="where"), *words[1:]]
    return words


def _without_fillers(words: list[Word]) -> list[Word]:
    fillers = _sections()["filler"]
    kept: list[Word] = []
    i = 0
    while i < len(words):
        count = fillers.at(words, i)
        if count and not _no_filler(words, i, count, kept):
            i += count
            if i < len(words) and words[i].text == "," and (not kept or kept[-1].text == ","):
                i += 1
            continue
        kept.append(words[i])
        i += 1
    return kept


def _no_filler(words: list[Word], i: int, count: int, kept: list[Word]) -> bool:
    """Whether a filler is said in earnest: the `oh` of `nine oh five`, `do you know`."""
    before = kept[-1].text if kept else ""
    if words[i].text in ("oh", "o"):
        return before in numbers.CARDINALS
    if words[i].text == "you":
        following = words[i + count].text if i + count < len(words) else ""
        return before in _AUXILIARIES or before == "if" or following in (*_QUESTION_WORDS, "if")
    return False


def _without_stutter(words: list[Word]) -> list[Word]:
    """Take out a word or up to four words said twice in a row: `where is where is the the cup`."""
    kept = words
    for size in (4, 3, 2, 1):
        i = 0
        out: list[Word] = []
        while i < len(kept):
            here = [w.text for w in kept[i : i + size]]
            again = [w.text for w in kept[i + size : i + 2 * size]]
            if here == again and len(here) == size and not _meant_twice(here):
                i += size
                continue
            out.append(kept[i])
            i += 1
        kept = out
    return kept


def _meant_twice(said: list[str]) -> bool:
    """Whether a repetition may be meant: `twenty twenty`, `that that`."""
    return all(word in numbers.CARDINALS or word.isdecimal() for word in said) or said == [","]


def _opened(words: list[Word]) -> list[Word]:
    """Take wake words and indirect openings off the start."""
    sections = _sections()
    wake, prefix, seek = sections["wake"], sections["prefix"], sections["seek"]
    i = 0
    while i < len(words):
        count = prefix.at(words, i)
        if count and _clause_follows(words, i + count):
            i += count
            if i < len(words) and words[i].text == "that":
                i += 1
            continue
        if words[i].text == ",":
            i += 1
            continue
        count = seek.at(words, i)
        if count and i + count < len(words):
            return [Word(SEEK, words[i].start, words[i + count - 1].end), *words[i + count :]]
        count = wake.at(words, i)
        if count and not _said_in_earnest(words, i, count):
            i += count
            continue
        break
    return words[i:]


def _said_in_earnest(words: list[Word], i: int, count: int) -> bool:
    """Whether a wake word is the question itself: `no`, `now` and `computer` may be its nouns."""
    following = words[i + count].text if i + count < len(words) else ""
    if not following:
        return True
    if is_open(words[i].text) and words[i].text in ("robot", "computer", "help", "question"):
        return following not in (*_QUESTION_STARTS, ",") and not following.startswith("i")
    return False


def _clause_follows(words: list[Word], i: int) -> bool:
    """Whether an indirect question or a statement follows an opening such as `tell me`."""
    k = i
    while k < len(words) and words[k].text in (
        ",",
        "please",
        "about",
        "at",
        "in",
        "on",
        "the",
        "to",
        "of",
        "me",
    ):
        k += 1
    return k < len(words) and (
        words[k].text in (*_QUESTION_WORDS, "if", "that", "who", "i", "you", "there", *_AUXILIARIES)
        or words[i - 1].text in ("that",)
        or _sections()["prefix"].at(words, k) > 0
    )


def _closed(words: list[Word]) -> list[Word]:
    """Take politeness and tags off the end."""
    suffix = _sections()["suffix"]
    while words:
        if words[-1].text in (",", "-"):
            words = words[:-1]
            continue
        count = suffix.ending(words)
        if not count or count >= len(words):
            return words
        if words[-count].text in ("is", "was", "did", "have", "are", "were", "does") and not _tag(
            words, count
        ):
            return words
        words = words[:-count]
    return words


def _tag(words: list[Word], count: int) -> bool:
    """Whether an auxiliary with a pronoun at the end is a tag (`, isn't it`) and no clause of its own."""
    rest = words[:-count]
    return len(rest) >= 3 and any(w.text in _AUXILIARIES for w in rest) or rest[-1].text == ","


# -- self-correction ------------------------------------------------------------------------------


def _corrected(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Apply each self-correction: the later words take the place of their like before them."""
    marks = _sections()["correction"]
    i = 1
    while i < len(words):
        count = marks.at(words, i)
        if count and _corrects(words, i, count):
            before, after = words[:i], words[i + count :]
            while before and before[-1].text == ",":
                before = before[:-1]
            while after and after[0].text == ",":
                after = after[1:]
            if after and before:
                words = _replaced(before, after, lexicon)
                i = 1
                continue
        i += 1
    return words


def _corrects(words: list[Word], i: int, count: int) -> bool:
    """Whether the mark at `i` is a self-correction and no part of the question."""
    said = words[i].text
    before = words[i - 1].text
    following = words[i + count].text if i + count < len(words) else ""
    if not following:
        return False
    if said in ("no", "nope") and count == 1:
        if following in ("longer", "one", "more", "other", "later", "earlier", "sooner", "less"):
            return False
        return (
            before == ","
            or is_open(before)
            or _kind(before, None) is not None
            or before in ("on", "in", "the", "my", "under")
        )
    if said == "actually" and count == 1:
        return following in _DETERMINERS
    if said in ("rather", "make", "wait", "actually", "sorry"):
        return following not in ("than",)
    return True


def _replaced(before: list[Word], after: list[Word], lexicon: Lexicon) -> list[Word]:
    """Return `before` with its end replaced by `after`, from the last word of the same kind."""
    if after[0].text == "not" and len(after) > 1:
        return before
    if after[0].text in _QUESTION_STARTS and after[0].text not in ("in", "on", "at", "is", "was"):
        return after
    if after[0].text in ("is", "was", "are", "were") and before[0].text in (
        *_AUXILIARIES,
        *_QUESTION_WORDS,
    ):
        return after
    same: list[Callable[[str], bool]] = [
        lambda word: word == after[0].text,
        lambda word: (
            (kind := _kind(after[0].text, lexicon)) is not None and _kind(word, lexicon) == kind
        ),
    ]
    for alike in same:
        for k in range(len(before) - 1, 0, -1):
            if alike(before[k].text):
                return [*before[:k], *after]
    return _head_replaced(before, after)


def _head_replaced(before: list[Word], after: list[Word]) -> list[Word]:
    """Put `after` in the place of the last noun phrase, or at the end."""
    k = len(before)
    while k > 1 and is_open(before[k - 1].text):
        k -= 1
    if after[0].text in _DETERMINERS and k > 1 and before[k - 1].text in _DETERMINERS:
        k -= 1
    return [*before[:k], *after] if k < len(before) else [*before, *after]


_DETERMINERS = frozenset(
    "the a an my your our his her their its this that these those any some".split()
)
_PREPOSITIONS = frozenset(
    "on in under behind near by above below beside inside at over beneath underneath".split()
)


def _kind(word: str, lexicon: Lexicon | None) -> str | None:
    """Return the kind of word that a correction replaces like with like by."""
    if word in _DETERMINERS:
        return "determiner"
    if word in _PREPOSITIONS:
        return "preposition"
    if word in tw.WEEKDAY_NUMBER or word in ("yesterday", "today", "tonight"):
        return "day"
    if word in tw.PARTS:
        return "part"
    if word in numbers.CARDINALS or word.isdecimal():
        return "number"
    if lexicon is not None and word in lexicon.attributes:
        return "attribute"
    if lexicon is not None and word.endswith("'s"):
        return "determiner"
    return None
