"""The phrases around a question, by section of speech.txt, and the words that start one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

from grammar.closed import words_of
from grammar.nountags import KIN
from grammar.vocabulary import files
from grammar.words import Word

QUESTION_STARTS = words_of(
    "where when what which who why how is are was were did do does have has had can could "
    "show list in on at"
)
QUESTION_WORDS = frozenset(["where", "when", "what", "which", "how", "whether", "whereabouts"])
AUXILIARIES = words_of("is are was were did do does have has had can could should will")


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
def sections() -> dict[str, Phrases]:
    """Return the phrases of speech.txt by section; read once."""
    found: dict[str, Phrases] = {}
    for name, said in files.sections("speech.txt").items():
        by_first: dict[str, list[tuple[str, ...]]] = {}
        for parts in (each for phrase in said for each in files.spelled(phrase)):
            by_first.setdefault(parts[0], []).append(parts)
        found[name] = Phrases(
            {k: tuple(sorted(v, key=len, reverse=True)) for k, v in by_first.items()}
        )
    return found


def seeking(words: list[Word], i: int) -> int:
    """Return how many words at `i` say that somebody looks for what follows, 0 for none.

    Of another it is said as of oneself: mum can not find, she is looking for.
    """
    seek = sections()["seek"]
    if count := seek.at(words, i):
        return count
    owned = i < len(words) and words[i].text in ("my", "our")
    subject = i + owned
    if subject + 1 >= len(words) or words[subject].text not in (*KIN, *_OTHERS[: 3 * (not owned)]):
        return 0
    verb = words[subject + 1]
    told = replace(verb, text=_AS_OF_ME.get(verb.text, verb.text))
    of_me = [replace(verb, text="i"), told, *words[subject + 2 :]]
    count = seek.at(of_me, 0)
    return count + owned if count > 1 else 0


_OTHERS = ("he", "she", "they")
_AS_OF_ME = {"is": "am", "are": "am", "has": "have"}


def to_be_told(words: list[Word], i: int) -> bool:
    """Whether one wants to be told of what comes: (tell me) when you see my keys."""
    texts = [w.text for w in words[i:]]
    seen = texts[2:3] != [] and texts[2] in _SEEING and "last" not in texts and "first" not in texts
    return seen and texts[0] in ("when", "whenever", "once") and texts[1] == "you"


_SEEING = words_of("see find spot notice detect")
