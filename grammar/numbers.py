"""Number words: `twenty five` is 25, `twenty-first` is the 21st, `oh six` is 06."""

from __future__ import annotations

_UNITS = ["zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine"]
_TEENS = [
    "ten",
    "eleven",
    "twelve",
    "thirteen",
    "fourteen",
    "fifteen",
    "sixteen",
    "seventeen",
    "eighteen",
    "nineteen",
]
_TENS = ["twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety"]
CARDINALS: dict[str, int] = {
    **{word: n for n, word in enumerate(_UNITS)},
    **{word: n + 10 for n, word in enumerate(_TEENS)},
    **{word: (n + 2) * 10 for n, word in enumerate(_TENS)},
    "fourty": 40,
}
_UNIT_ORDINALS = [
    "zeroth",
    "first",
    "second",
    "third",
    "fourth",
    "fifth",
    "sixth",
    "seventh",
    "eighth",
    "ninth",
]
_TEEN_ORDINALS = [
    "tenth",
    "eleventh",
    "twelfth",
    "thirteenth",
    "fourteenth",
    "fifteenth",
    "sixteenth",
    "seventeenth",
    "eighteenth",
    "nineteenth",
]
ORDINALS: dict[str, int] = {
    **{word: n for n, word in enumerate(_UNIT_ORDINALS) if n},
    **{word: n + 10 for n, word in enumerate(_TEEN_ORDINALS)},
    "twentieth": 20,
    "thirtieth": 30,
}


def cardinal(words: list[str], i: int) -> tuple[int, int] | None:
    """Return (value, words used) of the number at `words[i]` below 100, or None.

    `twenty five` and `twenty-five` are one number; `twenty twelve` is not.
    """
    if i >= len(words):
        return None
    word = words[i]
    if word.isdecimal() and word.isascii():
        return (int(word), 1) if len(word) <= 4 else None
    if "-" in word:
        tens, _, unit = word.partition("-")
        if tens in _TENS and unit in _UNITS[1:]:
            return CARDINALS[tens] + CARDINALS[unit], 1
        return None
    value = CARDINALS.get(word)
    if value is None:
        return None
    if word in _TENS and i + 1 < len(words) and words[i + 1] in _UNITS[1:]:
        return value + CARDINALS[words[i + 1]], 2
    return value, 1


def ordinal(words: list[str], i: int) -> tuple[int, int] | None:
    """Return (value, words used) of the ordinal at `words[i]`, 1 to 99, or None."""
    word = words[i]
    if word[:-2].isdecimal() and word.isascii() and word[-2:] in ("st", "nd", "rd", "th"):
        return int(word[:-2]), 1
    if "-" in word:
        tens, _, unit = word.partition("-")
        if tens in _TENS and unit in ORDINALS:
            return CARDINALS[tens] + ORDINALS[unit], 1
        return None
    if word in ORDINALS:
        return ORDINALS[word], 1
    if word in _TENS and i + 1 < len(words) and ORDINALS.get(words[i + 1], 10) < 10:
        return CARDINALS[word] + ORDINALS[words[i + 1]], 2
    return None
