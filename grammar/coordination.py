"""Relations joined by `or` before one noun phrase: on or under the table, left or right of it."""

from __future__ import annotations

from dataclasses import replace

from grammar.cursor import TIME_GAP
from grammar.phrases import phrases
from grammar.words import Word

_SIDES = ("left", "right")


def spread(words: list[Word]) -> list[Word]:
    """Give each of two relations its noun phrase: on the table or under the table."""
    for k in range(1, len(words) - 2):
        if words[k].text != "or":
            continue
        size = _relation_at(words, k + 1)
        sided = words[k - 1].text in _SIDES and words[k + 1].text in _SIDES
        if not size or not (sided or _relation_ends(words, k)):
            continue
        start = k + 1 + size
        end = next((i for i in range(start, len(words)) if words[i].text == TIME_GAP), len(words))
        if start == end:
            return words
        link = [replace(words[k], text="of")] if sided else []
        return [*words[:k], *link, *words[start:end], *words[k:]]
    return words


def _relation_at(words: list[Word], k: int) -> int:
    """Return how many words the longest relation at `k` takes, 0 for none."""
    for parts, terminal in phrases().by_first.get(words[k].text, ()):
        if terminal.startswith("REL ") and [w.text for w in words[k : k + len(parts)]] == [*parts]:
            return len(parts)
    return 0


def _relation_ends(words: list[Word], k: int) -> bool:
    """Whether the words right before `k` are a relation."""
    return any(_relation_at(words, j) == k - j for j in range(max(1, k - 4), k))
