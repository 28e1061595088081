"""A question as words with their offsets: the first stage, before any meaning."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from grammar import numbers
from grammar import timewords as tw
from grammar.closed import words_of

MAX_CHARACTERS = 600
"""A longer text is refused unread: no spoken question is so long."""
MAX_WORDS = 60
"""A question of more words is refused: what the parser does is bounded by this."""

_WORD = re.compile(
    r"\d{4}[-/.]\d{1,2}[-/.]\d{1,2}(?:[tT]\d{1,2}:\d{2}(?::\d{2})?)?"  # ISO, with or without a time
    r"|\d{1,2}[-/.]\d{1,2}[-/.](?:\d{4}|\d{2})(?![\d:])"  # 10/16/2016
    r"|\d{1,2}-[a-zA-Z]{3,9}-\d{2,4}|\d{4}-[a-zA-Z]{3,9}-\d{1,2}(?!\d)"  # 05-aug-2016, 2016-aug-05
    r"|[a-zA-Z]{3,9}-\d{1,2}-\d{4}(?!\d)"  # feb-14-2025
    r"|\d{4}[-/]\d{1,2}(?![\d:])|\d{1,2}/\d{4}(?!\d)"  # 2015-3, 11/2015
    r"|\d{1,2}-(?:jan|feb|mar|apr|may|jun|jul|aug|sep|oct|nov|dec)[a-z]*\b(?!-)"  # 28-nov
    r"|\d{1,2}/\d{1,2}(?![\d/])"  # 5/15
    r"|\d{1,2}[:.]\d{2}(?::\d{2})?(?!\d)"  # 12:30
    r"|[a-zA-Z]{3,9}-\d{1,2}(?!\d)"  # oct-28
    r"|\d{1,2}[hH]\d{2}\b"  # 18h30
    r"|\d+(?:st|nd|rd|th)\b"
    r"|\b[a-zA-Z]\d{1,2}\b"  # a4
    r"|\d{3}0s\b"
    r"|-?ish\b"  # 8ish
    r"|\d+(?:\.\d+)?"
    r"|[ap]\.\s?m\b\.?"  # a.m.
    r"|[^\W\d_]+(?:['\u2019\-][^\W\d_]+)*['\u2019]?"
    r"|\.\.+|[\u2014\u2026]"  # a pause
    r"|[?!.,;:&]|-"
)
_CONTRACTIONS = {
    "n't": "not",
    "'re": "are",
    "'ve": "have",
    "'ll": "will",
    "'d": "did",
    "'m": "am",
}
_IS_AFTER = words_of(
    "where what who when how that there it here he she this everything something anything "
    "which why whereabouts"
)
_WITHOUT_APOSTROPHE = {
    "wheres": ("where", "is"),
    "whats": ("what", "is"),
    "whos": ("who", "is"),
    "whens": ("when", "is"),
    "thats": ("that", "is"),
    "theres": ("there", "is"),
    "hows": ("how", "is"),
    "isnt": ("is", "not"),
    "arent": ("are", "not"),
    "wasnt": ("was", "not"),
    "werent": ("were", "not"),
    "didnt": ("did", "not"),
    "doesnt": ("does", "not"),
    "dont": ("do", "not"),
    "havent": ("have", "not"),
    "hasnt": ("has", "not"),
    "cant": ("can", "not"),
    "cannot": ("can", "not"),
    "couldnt": ("could", "not"),
    "im": ("i", "am"),
    "ive": ("i", "have"),
    "youve": ("you", "have"),
    "wheres's": ("where", "is"),
    "whered": ("where", "did"),
    "whatre": ("what", "are"),
    "wherere": ("where", "are"),
    "gonna": ("going", "to"),
    "wanna": ("want", "to"),
    "lemme": ("let", "me"),
    "gimme": ("give", "me"),
    "r": ("are",),
    "u": ("you",),
    "ur": ("your",),
    "ye": ("you",),
    "yer": ("your",),
    "em": ("them",),
    "wat": ("what",),
    "whereis": ("where", "is"),
    "whereare": ("where", "are"),
    "whatis": ("what", "is"),
    "howmany": ("how", "many"),
    "wats": ("what", "is"),
    "whr": ("where",),
    "hav": ("have",),
    "rn": ("right", "now"),
    "yday": ("yesterday",),
    "tdy": ("today",),
    "tmrw": ("tomorrow",),
    "mornin": ("morning",),
    "evenin": ("evening",),
    "nite": ("night",),
    "idk": ("i", "do", "not", "know"),
    "didyou": ("did", "you"),
    "d'you": ("do", "you"),
    "didja": ("did", "you"),
}


_APPROXIMATE = frozenset(numbers.CARDINALS) | {"noon", "midnight", "midday"}
"""What may end in -ish: eightish, noonish."""
_MIDDLES = frozenset((*tw.PARTS, *tw.MONTHS, *tw.SEASONS, "week", "month", "year"))
"""What may follow mid-: mid-morning, mid-january."""


_PAUSES = ("\u2014", "\u2026")
"""A long dash and three dots part what is said as a comma does."""


@dataclass(frozen=True, slots=True)
class Word:
    """A word in lower case with its place in the text: text[start:end] is what was said.

    capital: said with a capital letter. A removed time leaves one word `TIME_GAP` behind.
    """

    text: str
    start: int
    end: int
    capital: bool = False


def split(text: str) -> list[Word]:
    """Return the words and the marks of `text`, lower case, contractions taken apart."""
    found: list[Word] = []
    for match in _WORD.finditer(text):
        said = match.group().replace("\u2019", "'")
        word = Word(said.lower(), match.start(), match.end(), said[:1].isupper())
        found += _apart(word)
    return found


_DATED = re.compile(
    r"(?:mon|tue|wed|thu|fri|sat|sun|jan|feb|mar|apr|may|jun|jul|aug|sep|oct|nov|dec)"
)


_CLOCK_ENDS = frozenset(("am", "pm", *tw.FIXED_CLOCKS)) - {"mid-day"}


def _dashed(word: Word) -> list[Word]:
    """Take `oct-28`, `28-oct` and `monday-friday` apart; other words keep their hyphens."""
    left, _, right = word.text.partition("-")
    if left in _CLOCK_ENDS and (right in _CLOCK_ENDS or right.isdecimal()):
        middle = word.start + len(left)
        return [
            replace(word, text=left, end=middle),
            Word("-", middle, middle + 1),
            replace(word, text=right, start=middle + 1),
        ]
    if left.isdecimal() and right.isalpha() and _DATED.match(right):
        middle = word.start + len(left)
        return [
            replace(word, text=left, end=middle),
            replace(word, text=right, start=middle + 1),
        ]
    if not _DATED.match(left) or not (right.isdecimal() or _DATED.match(right)):
        return []
    middle = word.start + len(left)
    first, second = (
        replace(word, text=left, end=middle),
        replace(word, text=right, start=middle + 1),
    )
    if right.isdecimal():
        return [first, second]
    return [first, Word("-", middle, middle + 1), second]


def _apart(word: Word) -> list[Word]:
    """Take a contraction apart: `where's` is `where is`, `isn't` is `is not`."""
    text = word.text
    if text in _PAUSES or text.startswith(".."):
        return [replace(word, text=",")]
    if text in _WITHOUT_APOSTROPHE:
        return [replace(word, text=part) for part in _WITHOUT_APOSTROPHE[text]]
    if text == "non":
        return [replace(word, text="not")]
    if text == "-ish":
        return [replace(word, text="ish")]
    if text.endswith("ish") and text.removesuffix("ish").rstrip("-") in _APPROXIMATE:
        middle = word.end - 3
        stem = text.removesuffix("ish").rstrip("-")
        return [replace(word, text=stem, end=middle), replace(word, text="ish", start=middle)]
    if text.startswith("mid-") and text.removeprefix("mid-") in _MIDDLES:
        middle = word.start + 4
        rest = text.removeprefix("mid-")
        return [replace(word, text="mid", end=middle - 1), replace(word, text=rest, start=middle)]
    if text.startswith("non-"):
        return [replace(word, text="not"), replace(word, text=text.removeprefix("non-"))]
    if "-and-" in text:
        left, _, right = text.partition("-and-")
        return [replace(word, text=part) for part in (left, "and", right)]
    if "-" in text and (parted := _dashed(word)):
        return parted
    if "'" not in text:
        return [word]
    if text == "can't":
        return [replace(word, text="can"), replace(word, text="not")]
    if text == "won't":
        return [replace(word, text="will"), replace(word, text="not")]
    stem, _, ending = text.rpartition("'")
    if ending == "s" and stem in _IS_AFTER:
        return [replace(word, text=stem), replace(word, text="is")]
    if ending == "s" and stem == "let":
        return [replace(word, text="let"), replace(word, text="us")]
    for tail, full in _CONTRACTIONS.items():
        if text.endswith(tail) and len(text) > len(tail):
            return [replace(word, text=text[: -len(tail)]), replace(word, text=full)]
    if text == "o'clock":
        return [word]
    if ending == "" and stem:
        return (
            [replace(word, text=stem + "'s")] if stem.endswith("s") else [replace(word, text=stem)]
        )
    return [word]
