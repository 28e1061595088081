"""Plurals of English nouns: rules, and the exceptions of plurals.txt."""

from __future__ import annotations

from collections.abc import Mapping

_KEEP_ENDINGS = ("ss", "us", "sis")
_ES_STEMS = ("ss", "sh", "ch", "x", "zz")


def singular(noun: str, exceptions: Mapping[str, str]) -> str:
    """Return the singular of a noun or compound; only the last word of a compound changes."""
    if noun in exceptions:
        return exceptions[noun]
    head, _, last = noun.rpartition(" ")
    one = exceptions.get(last) or _singular_word(last)
    return f"{head} {one}" if head else one


def _singular_word(word: str) -> str:
    if len(word) < 3 or not word.endswith("s") or word.endswith(_KEEP_ENDINGS):
        return word
    if word.endswith("ies"):
        return word[:-3] + "y"
    if word.endswith("es") and word[:-2].endswith(_ES_STEMS):
        return word[:-2]
    if word.endswith("oes"):
        return word[:-2]
    if word.endswith("'s"):
        return word
    return word[:-1]


def plural(noun: str, exceptions: Mapping[str, str]) -> str:
    """Return a plural of a singular noun or compound: the one `singular` takes back."""
    head, _, last = noun.rpartition(" ")
    many = _plural_word(last, exceptions)
    return f"{head} {many}" if head else many


def _plural_word(word: str, exceptions: Mapping[str, str]) -> str:
    if exceptions.get(word) == word:
        return word
    for several, one in exceptions.items():
        if one == word:
            return several
    if word.endswith("y") and word[-2:-1] not in "aeiou":
        return word[:-1] + "ies"
    if word.endswith(("s", "sh", "ch", "x", "z")):
        return word + "es"
    return word + "s"
