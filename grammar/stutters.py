"""What a speaker says twice, breaks off or says for want of a word: taken out."""

from __future__ import annotations

from operator import eq

from grammar import numbers
from grammar.closed import LEADING, is_open, words_of
from grammar.phrases import phrases, place_follows
from grammar.sayings import AUXILIARIES, QUESTION_STARTS, QUESTION_WORDS
from grammar.vocabulary import Lexicon
from grammar.words import Word

_SOME = ("a", "an", "any", "some")
_NAMELESS = words_of("thing thingy thingie thingamajig whatsit whatnot doodah gizmo")


def without_stutters(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Return the words with each thing said once, and once to its end."""
    if any(word.text == "," for word in words):  # most questions are said without a pause
        words = _placed_once(_named(_restarted(words)))
    words = _without_false_starts(_without_dummy(words))
    return _without_stutter(_looked_anew(words, lexicon), lexicon)


def _looked_anew(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Take out looks that are said again before any thing is: the blue the dark blue jacket."""
    for i in range(1, len(words) - 3):
        k = i + 1
        while k < len(words) - 2 and words[k].text in lexicon.attributes:
            k += 1
        anew = k > i + 1 and words[k].text == words[i].text and words[i].text in LEADING
        if anew and is_open(words[k + 1].text):
            return [*words[:i], *words[k:]]
    return words


def _without_dummy(words: list[Word]) -> list[Word]:
    """Take out an `it` beside its thing: where it is my charger, where was it, the scarf."""
    words = _verb_last(_told_after(words))
    if len(words) < 3 or "it" not in (words[1].text, words[2].text):
        return words
    texts = [w.text for w in words[:4]]
    being = ("is", "are", "was", "were")
    if texts[:2] == ["what", "it"] and texts[2] in being and place_follows(words, 3):
        return [words[0], *words[2:]]  # what it is on the table
    there = texts[1:3] == ["it", "there"] and texts[0] in being and texts[-1] in _SOME
    where = texts[:2] == ["where", "it"] and texts[2:3] != [] and texts[2] in being
    told = texts[:3] in (["where", "is", "it"], ["where", "was", "it"]) and texts[-1] == ","
    if told and len(words) > 5 and words[4].text in LEADING:
        return [*words[:2], *words[4:]]
    if there or (where and (texts[-1] in LEADING or is_open(texts[-1])) and len(texts) == 4):
        return [words[0], *words[2:]]
    return words


def _verb_last(words: list[Word]) -> list[Word]:
    """Put a verb that is said last before its thing: have you my wallet seen."""
    texts = [w.text for w in words]
    asked = texts[:2] in (["have", "you"], ["has", "anyone"], ["has", "anybody"])
    if asked and len(texts) > 4 and texts[2] in LEADING and texts[-1] in ("seen", "found"):
        return [*words[:2], words[-1], *words[2:-1]]
    return words


def _told_after(words: list[Word]) -> list[Word]:
    """Take out an `it` said after or before its thing: my bag where it is, i put it my phone."""
    texts = [w.text for w in words]
    if _IT.isdisjoint(texts):
        return words
    if len(texts) > 4 and texts[0] in LEADING and texts[-3] == "where" and texts[-2] in _IT:
        return [*words[:-2], words[-1]]
    for i in range(2, len(texts) - 2):
        if texts[i] == texts[0] and texts[0] in _BEING and texts[i + 1] in _IT:
            return [*words[:i], *words[i + 2 :]]  # is my wallet is it on the desk
        owned = texts[i + 1] in ("my", "our") and is_open(texts[i + 2])
        if texts[i] in _IT and owned and texts[i - 1] in phrases().verbs:
            return [*words[:i], *words[i + 1 :]]
    return words


_IT = words_of("it they them")
_BEING = ("is", "are", "was", "were")


def _named(words: list[Word]) -> list[Word]:
    """Take out a word for a thing before its name: the thing, the charger."""
    texts = [w.text for w in words]
    for i in range(1, len(texts) - 3):
        nameless = texts[i] in LEADING and texts[i + 1] in _NAMELESS and texts[i + 2] == ","
        if nameless and texts[i + 3] in LEADING:
            return [*words[:i], *words[i + 3 :]]
    return words


def _restarted(words: list[Word]) -> list[Word]:
    """Take out a question that breaks off before it names a thing: `when did i, when did you`."""
    texts = [w.text for w in words]
    for i in range(1, min(len(texts) - 2, _BROKEN_OFF)):
        if texts[i] != "," or texts[0] not in QUESTION_STARTS:
            continue
        named = any(is_open(t) or t in ("it", "they", "them") for t in texts[:i])
        asks = texts[i + 1] in QUESTION_WORDS or texts[i + 1] in AUXILIARIES
        return words[i + 1 :] if asks and not named else words
    return words


def begun_anew(words: list[Word]) -> list[Word]:
    """Return the words without a question that breaks off: where did i no where did my wife."""
    if not words or words[0].text not in _ASKING:
        return words
    for i in range(2, min(len(words) - 2, _BROKEN_OFF + 2)):
        if words[i].text in QUESTION_WORDS and words[i + 1].text in AUXILIARIES:
            named = any(is_open(w.text) or w.text in _GOES_ON for w in words[1:i])
            return words if named else words[i:]
    return words


_ASKING = QUESTION_WORDS | AUXILIARIES
_GOES_ON = words_of("it they them and or")
_BROKEN_OFF = 5
"""A question that has named nothing after so many words may be given up and begun again."""


def _without_false_starts(words: list[Word]) -> list[Word]:
    """Take out a word that breaks off and is said again: `where is my ph my phone`."""
    i = 0
    while i + 3 < len(words):
        first, cut, again, whole = (w.text for w in words[i : i + 4])
        counted = cut in numbers.CARDINALS  # twenty four twenty fourteen
        if first == again and cut != whole and whole.startswith(cut) and not counted:
            words = [*words[:i], *words[i + 2 :]]
        else:
            i += 1
    return words


def _without_stutter(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Take out a word or up to four words said twice in a row: `where is where is the the cup`."""
    kept = words
    for size in (4, 3, 2, 1):
        texts = [w.text for w in kept]
        if not any(map(eq, texts, texts[size:])):
            continue  # most say no word twice at this distance
        i = 0
        out: list[Word] = []
        while i < len(kept):
            here = [w.text for w in kept[i : i + size]]
            again = [w.text for w in kept[i + size : i + 2 * size]]
            twice = here == again and len(here) == size and not _meant_twice(here)
            if twice and not _looks_like_itself(here, kept[i + 2 * size :], lexicon):
                i += size
                continue
            out.append(kept[i])
            i += 1
        kept = out
    return kept


def _placed_once(words: list[Word]) -> list[Word]:
    """Take out a determiner that is said again after a pause: the, the cup; my, my stapler."""
    texts = [w.text for w in words]
    again = (
        i
        for i in range(1, len(texts) - 2)
        if texts[i + 1] == "," and texts[i] == texts[i + 2] and texts[i] in LEADING
    )
    first = next(again, None)
    return words if first is None else _placed_once([*words[:first], *words[first + 2 :]])


def _meant_twice(said: list[str]) -> bool:
    """Whether a repetition may be meant: `twenty twenty`, `that that`."""
    return all(word in numbers.CARDINALS or word.isdecimal() for word in said) or said == [","]


def _looks_like_itself(said: list[str], rest: list[Word], lexicon: Lexicon) -> bool:
    """Whether a look and its thing are one word: the orange orange, the glass glass."""
    one = said[0] if len(said) == 1 else ""
    ends = not rest or not is_open(rest[0].text)
    return ends and one in lexicon.attributes and one in lexicon.nouns
