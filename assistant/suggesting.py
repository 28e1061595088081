"""What a person may be about to type: an earlier question, or a word that the store knows."""

from __future__ import annotations

from collections.abc import Sequence

_LEAST = 2
"""Letters before a word is completed: one letter fits too much."""


def completion(value: str, earlier: Sequence[str], words: Sequence[str]) -> str | None:
    """Return `value` completed, or None: by an earlier question, else by a known word.

    earlier: likeliest last. words: likeliest first; of several words too ("dining table").
    """
    if not value.strip():
        return None
    folded = value.casefold()
    for question in reversed(earlier):
        if len(question) > len(value) and question.casefold().startswith(folded):
            return value + question[len(value) :]
    tokens = folded.split(" ")
    for count in (3, 2, 1):  # the longest tail that begins a known word wins
        tail = " ".join(tokens[-count:])
        if count > len(tokens) or len(tail) < _LEAST:
            continue
        for word in words:
            if len(word) > len(tail) and word.casefold().startswith(tail):
                return value + word[len(tail) :]
    return None
