"""Spelling: a word that nobody knows becomes the known word it is a slip of, and that is reported.

A slip keeps the first letter (or swaps the first two), and is one letter left out, doubled, swapped
or struck beside its key; words of eight letters may hold two. Where two known words are as near,
or the word is as good a noun as any, nothing is changed: any noun may be asked for.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

from grammar import heard, numbers, phrases, scope
from grammar import timewords as tw
from grammar.closed import CLOSED, is_open, words_of
from grammar.forms import Correction
from grammar.nountags import PICTURES
from grammar.vocabulary import Lexicon, StoreWords, files, inflection, lexicon
from grammar.vocabulary.hues import carried_names
from grammar.words import Word

_ALIKE = [{"b", "p"}, {"d", "t"}, {"g", "k"}, {"f", "v"}, {"s", "z"}, {"c", "k"}, {"m", "n"}]
"""Letters that sound alike: labtop, pakage."""
_KEYS = ("qwertyuiop", "asdfghjkl", "zxcvbnm")
_MIN_LETTERS = 4


@lru_cache(maxsize=16)
def _meant(words: StoreWords) -> frozenset[str]:
    """Return the words that people ask by: what is not of them may be a slip of one."""
    lex = lexicon(words)
    looks = lex.attributes.keys() - carried_names()  # nobody says those
    targets = _words_in((*lex.nouns, *looks, *lex.places, *lex.plurals))
    targets.update(lex.plurals.values())
    targets.update((*tw.WEEKDAYS, *tw.MONTHS, *tw.PARTS, "yesterday", "today", "tonight"))
    targets.update(("where", "what", "when", "which", "there", "between", "behind", "under"))
    targets.update(("anywhere", "somewhere", "everywhere", "anything", "something", "nothing"))
    targets.update(("beside", "together", "without", "many", "last", "before", "after", "since"))
    targets.update(("moved", "changed", "missing", "disappeared", "vanished", "happened"))
    targets.update(("three", "seven", "eight", "eleven", "twelve", "twenty", "thirty", "noon"))
    return frozenset(targets)


@lru_cache(maxsize=16)
def _targets(words: StoreWords) -> tuple[str, ...]:
    """Return the words that a slip may be corrected to, in order."""
    return tuple(sorted(word for word in _meant(words) if len(word) >= _MIN_LETTERS))


@lru_cache(maxsize=16)
def known(words: StoreWords) -> frozenset[str]:
    """Return every word that needs no correction."""
    lex = lexicon(words)
    found = set(_meant(words))
    found.update(CLOSED, PICTURES, lex.names, lex.parts, lex.patterns, lex.shades)
    found.update(numbers.CARDINALS, numbers.ORDINALS, tw.UNITS, tw.MONTH_NUMBER)
    found.update(tw.WEEKDAY_NUMBER, tw.SEASONS, tw.HOLIDAYS, tw.FIXED_CLOCKS)
    found |= _words_in((*tw.PHRASES, *tw.HOLIDAYS, *phrases.spoken(), *scope.spoken()))
    found |= _words_in(files.lines("ordinary.txt"))
    for section in files.sections("speech.txt").values():
        found |= _words_in(phrase.replace("|", " ") for phrase in section)
    return frozenset(found)


def _words_in(said: Iterable[str]) -> set[str]:
    """Return the words of phrases; one split of all of them is a tenth of a split of each."""
    return set(" ".join(said).split())


def corrected(
    words: list[Word], lex: Lexicon, store: StoreWords
) -> tuple[list[Word], tuple[Correction, ...]]:
    """Return the words with slips made good, and what was changed."""
    knows, sounds = known(store), heard.sounds()
    out: list[Word] = []
    changed: list[Correction] = []
    for i, word in enumerate(words):
        taken = heard.meant(words, i, lex) if word.text in sounds else None
        if taken is None and word.text not in knows:
            taken = _meant_by(words, i, store, lex)
        if taken is not None:
            changed.append(Correction(word.text, taken, word.start))
            word = replace(word, text=taken)
        out.append(word)
    return out, tuple(changed)


def _meant_by(words: list[Word], i: int, store: StoreWords, lex: Lexicon) -> str | None:
    """Return the word that the unknown one at `i` is a slip of, None where it stays."""
    knows = known(store)
    taken = _misread(words[i], knows) or _small_word(words, i, knows, lex)
    taken = taken or _taken(words[i], knows, store, lex, located=_located(words, i))
    return None if taken in lex.attributes and _names_thing(words, i, lex) else taken


def _names_thing(words: list[Word], i: int, lex: Lexicon) -> bool:
    """Whether a noun is due at `i`, and no look: my slime on the desk is nothing slim."""
    before = words[i - 1].text if i else ""
    after = words[i + 1].text if i + 1 < len(words) else ""
    ends = not is_open(after) and after not in _BEFORE_ONES
    return ends and (before in _DETERMINING or before in lex.attributes)


_BEFORE_ONES = ("one", "ones", "and", "or", ",", "but")


def _located(words: list[Word], i: int) -> bool:
    """Whether a place is due at `i`: in the kithen."""
    before = [w.text for w in words[max(0, i - 2) : i]]
    return before[:1] == ["in"] and before[-1] in ("in", "the", "my", "our")


def _taken(
    word: Word, known: frozenset[str], store: StoreWords, lex: Lexicon, *, located: bool = False
) -> str | None:
    """Return the word that an unknown one is a slip of. located: a place is due, and preferred."""
    text = word.text
    if text in known or len(text) < _MIN_LETTERS or not text.isalpha() or not is_open(text):
        return None
    if _inflected(text, known):
        return None
    if lex.singular(text) in known or text in lex.glued or lex.singular(text) in lex.glued:
        return None
    reach = 2 if len(text) >= 8 else 1
    targets = _targets(store)
    nearest = _nearest(text, targets, reach)
    nearest = nearest or _short_or_sounding(text, known, targets)
    if not nearest and text.endswith("s"):
        one = _nearest(lex.singular(text), targets, reach) if len(text) > _MIN_LETTERS else []
        one = one or _sounding(lex.singular(text), lex.nouns)
        nearest = [inflection.plural(target, lex.plurals) for target in one]
    if len(nearest) > 1 and located:
        nearest = [target for target in nearest if target in lex.places] or nearest
    if len(nearest) > 1:
        alike = [target for target in nearest if target[-2:] == text[-2:]]
        nearest = alike or nearest
    singles = {lex.singular(target) for target in nearest}
    return nearest[0] if len(singles) == 1 else None


def _inflected(text: str, known: frozenset[str]) -> bool:
    """Whether a word is a known one with -ed or -ing: cleaned is no slip of cleaner."""
    for ending in ("ed", "ing"):
        stem = text.removesuffix(ending)
        if stem != text and len(stem) >= _MIN_LETTERS:
            doubled = stem[:-1] if stem[-1] == stem[-2] else stem
            return bool({stem, stem + "e", doubled} & known)
    return False


def _nearest(text: str, targets: tuple[str, ...], reach: int) -> list[str]:
    """Return the targets that `text` may be a slip of, the nearest alone, in order."""
    from rapidfuzz import process  # only where a word is unknown: its import is not free
    from rapidfuzz.distance import OSA

    near = process.extract(text, targets, scorer=OSA.distance, score_cutoff=reach, limit=8)
    fitting = [(distance, target) for target, distance, _ in near if _is_slip(text, target)]
    best = min((distance for distance, _ in fitting), default=0)
    return sorted({target for distance, target in fitting if distance == best})


def _short_or_sounding(text: str, known: frozenset[str], targets: tuple[str, ...]) -> list[str]:
    """Return the short word with its last letter struck twice, or a plural, or what sounds so."""
    if text[-1] == text[-2] and len(text) == _MIN_LETTERS and text[:-1] in known:
        return [text[:-1]]
    for ending in ("z", "es"):  # keyz, keyes
        if len(text) > len(ending) + 2 and text.removesuffix(ending) in known:  # no bees of be
            return [text.removesuffix(ending) + "s"]
    return _sounding(text, targets)


def _sounding(text: str, targets: Iterable[str]) -> list[str]:
    """Return the targets that sound as a word does."""
    sound = _sound(text)
    return [
        target
        for target in targets
        if target[0] in text[0] + _SOUNDED[text[0]] and _sound(target) == sound
    ]


_SOUNDED = defaultdict(str, f="p", p="f", c="k", k="c", q="k")
"""First letters that may be written for the sound of another: fone, kouch."""


def _sound(word: str) -> str:
    """Return a word as it sounds by its consonants: ph is f, ck and hard c are k, soft c is s.

    Of the vowels those of its end are one where they sound so: kee, key.
    """
    ending = next((e for e in _LONG_E if word.endswith(e) and len(word) > len(e)), "")
    word = word.removesuffix(ending) + "y" * bool(ending)
    out = word.replace("ph", "f").replace("ck", "k") + " "
    hard = (
        ("k" if b not in "eiyh" else "s") if a == "c" and b != "h" else a for a, b in pairwise(out)
    )
    return "".join(hard)


_LONG_E = ("ee", "ey", "ie")
"""Endings that sound as y does: kee, trolly, cooky."""


def _misread(word: Word, known: frozenset[str]) -> str | None:
    """Return the word whose small l was written as a capital I: `Ieave`."""
    meant = "l" + word.text[1:]
    read = word.capital and word.text[0] == "i" and word.text not in known
    return meant if read and meant in known and len(meant) >= _MIN_LETTERS else None


_LEADING = ("the", "this", "that", "these", "those", "my", "your", "our")
_VERBS = ("is", "are", "was", "were", "did", "does", "have")


def _small_word(words: list[Word], i: int, known: frozenset[str], lex: Lexicon) -> str | None:
    """Return the function word that a short unknown word is a slip of where one is due.

    A determiner is due before a noun phrase that has none: `where is teh kettle`; a verb after a
    question word or first: `where si`.
    """
    text = words[i].text
    if not i and len(text) <= _MIN_LETTERS + 1 and (asked := _first_word(text, known, words)):
        return asked
    if text in known or not 1 < len(text) <= _MIN_LETTERS or not text.isalpha():
        return None
    if lex.singular(text) in known:
        return None
    before = words[i - 1].text if i else ""
    after = words[i + 1].text if i + 1 < len(words) else ""
    if before in ("", "where", "what", "when", "which", "how") and after:
        return _slip_of(text, _VERBS)
    if after in _TIMED and (leading := _slip_of(text, ("last", "this"))):
        return leading
    if after and is_open(after) and not is_open(before) and before not in _DETERMINING:
        return _slip_of(text, _LEADING)
    return None


def _first_word(text: str, known: frozenset[str], words: list[Word]) -> str | None:
    """Return the question word that the first word is a slip of: whay is on the desk."""
    if text in known or not text.isalpha() or len(words) < 3:
        return None
    meant = [word for word in _ASKING if _slip_of(text, (word,)) == word]
    return meant[0] if len(meant) == 1 else None


_ASKING = ("where", "what", "when", "which", "how", "have")
_TIMED = frozenset((*tw.PARTS, *tw.WEEKDAYS, "week", "weekend", "month", "year"))
_DETERMINING = words_of(
    "a an the this that these those my your our his her its their some any no and or"
)


def _slip_of(said: str, meant: tuple[str, ...]) -> str | None:
    """Return the word of `meant` with letters swapped, left out, or a neighbour struck."""
    for word in meant:
        if len(word) == len(said) and word != said and sorted(word) == sorted(said):
            return word
    for word in meant:
        if len(word) > 2 and any(word[:k] + word[k + 1 :] == said for k in range(1, len(word))):
            return word
    for word in meant:
        doubled = (k for k in range(1, len(said)) if said[k] == said[k - 1])
        twice = any(said[:k] + said[k + 1 :] == word for k in doubled)
        if twice and len(word) > 2:
            return word
    for word in meant:
        pairs = [(a, b) for a, b in zip(said, word, strict=False) if a != b]
        same_length = len(word) == len(said) and len(pairs) == 1 and word[0] == said[0]
        if same_length and beside(*pairs[0]):
            return word
    return None


def _is_slip(said: str, meant: str) -> bool:
    """Whether `said` may be a slip of `meant` and is no other word by the look of it."""
    if said[0] != meant[0] and said[:2] != meant[1::-1]:
        return False
    forms = (end for end in _FORMS if said.endswith(end) and len(said) > len(end) + 2)
    if any(not meant.endswith(end) for end in forms):
        return False  # mixed is no mixer
    if len(said) > 5 and _undoubled(said) == _undoubled(meant):
        return True
    if len(said) == len(meant):
        differing = [(a, b) for a, b in zip(said, meant, strict=True) if a != b]
        if len(differing) == 1:
            near = beside(*differing[0]) or {*differing[0]} in _ALIKE
            return len(said) > _MIN_LETTERS and near
        if sorted(said) == sorted(meant):
            return True
        return len(said) >= 8 and _struck_beside(said, meant)
    if len(said) > len(meant):
        return len(meant) >= _MIN_LETTERS and (_doubles(said, meant) or len(said) >= 7)
    plural = meant == said + "s" and not meant.endswith("ss")
    return not (plural or (meant.endswith("ing") and meant not in ("morning", "evening")))


_FORMS = ("ed", "ing", "est", "ly", "ness", "tion", "able")
"""Endings by which a word is one of its own."""


def _struck_beside(said: str, meant: str) -> bool:
    """Whether each letter that stands for another is its neighbour on the keyboard."""
    from rapidfuzz.distance import Levenshtein

    swapped = [op for op in Levenshtein.editops(said, meant) if op.tag == "replace"]
    return all(beside(said[op.src_pos], meant[op.dest_pos]) for op in swapped)


def _undoubled(word: str) -> str:
    """Return a word with each doubled letter written once: `baterry` is as `battery`."""
    return "".join(a for a, b in zip(word, word[1:] + " ", strict=True) if a != b)


def _doubles(said: str, meant: str) -> bool:
    """Whether `said` is `meant` with one letter struck twice or a neighbour struck with it."""
    for i, letter in enumerate(said):
        if said[:i] + said[i + 1 :] == meant:
            around = said[max(0, i - 1) : i] + said[i + 1 : i + 2]
            return any(letter == other or beside(letter, other) for other in around)
    return False


@lru_cache(maxsize=1024)
def beside(a: str, b: str) -> bool:
    """Whether two letters are neighbours on the keyboard, or both vowels."""
    if a in "aeiouy" and b in "aeiouy":
        return True
    for row, keys in enumerate(_KEYS):
        if a not in keys:
            continue
        column = keys.index(a)
        for other in range(max(0, row - 1), min(3, row + 2)):
            near = _KEYS[other][max(0, column - 1) : column + 2]
            if b in near:
                return True
    return False
