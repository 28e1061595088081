"""A text cut into its sentences, and a reason said first parted from its question."""

from __future__ import annotations

from dataclasses import replace

from grammar import timespan
from grammar import timewords as tw
from grammar.closed import LEADING, is_open, words_of
from grammar.phrases import phrases, place_follows
from grammar.sayings import AUXILIARIES, QUESTION_STARTS, QUESTION_WORDS, sections
from grammar.words import Word

_ENDS = frozenset("?!.;")
_UMS = words_of("er erm uh uhh um umm uhm hm hmm")
"""What is heard where no word was found; after a pause it may mend what was said."""
_TITLES = ("mr", "mrs", "ms", "dr", "prof", "st")
_ABBREVIATIONS = frozenset((*tw.MONTH_SHORT, *tw.WEEKDAY_SHORT))


def sentences(words: list[Word]) -> list[list[Word]]:
    """Cut the words at full stops and question marks; the dot of `oct.` is no full stop."""
    words = [
        w for i, w in enumerate(words) if w.text not in _UMS or (i and words[i - 1].text == ",")
    ]
    found: list[list[Word]] = [[]]
    for i, word in enumerate(words):
        if word.text == "." and i and _dotted(words, i):
            continue
        if word.text in _ENDS:
            found.append([])
        else:
            pause = word.text == ":" or (word.text == "-" and _breaks_off(words, i))
            found[-1].append(replace(word, text=",") if pause else word)
    return [
        part for sentence in _gone_on(found) for asked in _told(sentence) for part in _parted(asked)
    ]


def _told(words: list[Word]) -> list[list[Word]]:
    """Part from a question what is told of its thing after a comma: where is it, it is blue."""
    texts = [w.text for w in words]
    if words and texts[0] in QUESTION_STARTS and "," in texts:
        for i in range(3, len(texts) - 3):
            told = texts[i] == "," and texts[i + 1] in _THINGS and texts[i + 2] in _BEING
            denied = texts[i : i + 2] == [",", "not"] and texts[-1] in ("one", "ones")
            if denied or (told and not _asks_at(texts, i + 1)):
                return [words[:i], words[i + 1 :]]
    return [words]


_THINGS = words_of("it they he she")
_BEING = words_of("is are was were")


def _gone_on(found: list[list[Word]]) -> list[list[Word]]:
    """Join to a question the things it is asked of too: where is the wallet, and the phone."""
    kept = [sentence for sentence in found if sentence]
    for i in range(len(kept) - 1, 0, -1):
        things = _things_too(kept[i])
        if things and kept[i - 1][0].text in _OF_THINGS:
            placed = any(place_follows(kept[i - 1], k) for k in range(len(kept[i - 1])))
            kept[i - 1 : i + 1] = [kept[i - 1] + things] if not placed else kept[i - 1 : i + 1]
    return kept


def _things_too(words: list[Word]) -> list[Word]:
    """Return `and` and the things of a sentence that names nothing else; nothing for others."""
    if words[0].text != "and" or len(words) < 3:
        return []
    first = 3 if words[1].text in ("what", "how") and words[2].text == "about" else 1
    led = first + 1 < len(words) and words[first].text in LEADING
    named = all(is_open(w.text) or w.text in LEADING or w.text == "and" for w in words[first:])
    return [words[0], *words[first:]] if led and named else []


_OF_THINGS = ("where", "when", "have", "did")
"""What begins a question that ends in its things, where no place is told after them."""


def _breaks_off(words: list[Word], i: int) -> bool:
    """Whether the dash at `i` stands beside a mark of correction: the cup - no - the bowl."""
    marks = sections()["correction"]
    return marks.at(words, i + 1) > 0 or marks.ending(words[max(0, i - 3) : i]) > 0


def _dotted(words: list[Word], i: int) -> bool:
    """Whether the dot at `i` belongs to a date or a title: `oct.`, `16. nov`, `mrs. hall`."""
    before = words[i - 1].text
    after = words[i + 1].text if i + 1 < len(words) else ""
    if before in _ABBREVIATIONS or (before in _TITLES and after):
        return True
    month_and_day = before in tw.MONTH_NUMBER and after[:1].isdecimal()
    return month_and_day or (before.isdecimal() and after in tw.MONTH_NUMBER)


def _parted(words: list[Word]) -> list[list[Word]]:
    """Part a reason said first from its question: `i lost my wallet can you help me find it`."""
    seen = len(words) > 2 and words[-2].text in phrases().verbs
    if seen and words[-1].text in ("her", "him"):  # a cat, or what else has been named
        words = [*words[:-1], replace(words[-1], text="it")]
    words = _hailed(words)
    texts = [w.text for w in words]
    if texts[-1] in _NOW and (told := _told_when(words, texts)):
        return told
    pause = _pause(texts)
    if pause:
        return [words[:pause], *_parted(words[pause + 1 :])]
    dislocated = texts[-1] in ("it", "they", "them") and texts[0] not in QUESTION_STARTS
    owned = texts[0].endswith("'s")
    pointing = (texts[0] in _POINTING or owned) and not dislocated
    if texts[0] not in _STATING and not dislocated and not pointing:
        return [words]
    for i in range(1 if dislocated else 2, len(texts) - 2):
        starts = tuple(texts[i : i + 2])
        asked = starts[0] in QUESTION_WORDS and starts[1] in _ASKING_VERBS
        pronoun = starts[0] in AUXILIARIES and starts[1] in _ASKED_SUBJECTS
        if pointing and not (pronoun or (asked and texts[i + 2] in _ASKED_SUBJECTS)):
            continue  # this cup where was it
        if sections()["suffix"].at(words, i) == len(words) - i:
            break  # i lost my keys can you help me
        if (asked or pronoun or starts in _ASKED) and texts[i - 1] not in _TELLING:
            return [words[:i], words[i:]]
    return [words]


def _told_when(words: list[Word], texts: list[str]) -> list[list[Word]]:
    """Part what is told with its time first: in the morning i kept it here where is it now."""
    i = next((i for i in range(3, len(texts) - 2) if _asks_at(texts, i)), 0)
    times = timespan.find(texts[:i])
    led = bool(times) and not times[0].first and texts[times[0].last : i]
    return [words[:i], words[i:]] if led and led[0] in _STATING else []


_NOW = ("now", "it", "they", "them")


def _hailed(words: list[Word]) -> list[Word]:
    """Take wake words off a statement: `hi can you help me i lost my keys where are they`."""
    wake, i = sections()["wake"], 0
    while count := wake.at(words, i):
        i += count
    return words[i:] if 0 < i < len(words) and words[i].text in _STATING else words


def _pause(texts: list[str]) -> int:
    """Return where a comma parts a statement from a question, 0 for nowhere.

    A time or a place before the comma belongs to the question: `yesterday, where was my cup`.
    """
    for i in range(2, len(texts) - 3):
        if texts[i] != "," or not _asks_at(texts, i + 1):
            continue
        if texts[0] in QUESTION_STARTS:
            about_it = texts[i + 1] in AUXILIARIES and texts[i + 2] in ("it", "they")
            if not about_it or texts[i + 3] == "not":
                continue
        times = timespan.find(texts[:i])
        if not (times and times[0].first <= 1 and times[-1].last == i):
            return i
    return 0


def _asks_at(texts: list[str], i: int) -> bool:
    """Whether a question starts at `i`: where is, how can, is it, have you."""
    first, second = texts[i], texts[i + 1]
    if first in QUESTION_WORDS:
        return second in _ASKING_VERBS
    if (first, second) in _IDEAS:
        return texts[i + 2] in QUESTION_WORDS
    return first in AUXILIARIES and second in (*_ASKED_SUBJECTS, "you", "there", "i", "we")


_STATING = words_of("i we my our there it he she they")
_POINTING = words_of("this these those that your a the")
_ASKING_VERBS = AUXILIARIES | words_of("might may must would")
_ASKED_SUBJECTS = ("it", "they")
_ASKED = (
    ("is", "there"),
    ("are", "there"),
    ("have", "you"),
    ("did", "you"),
    ("can", "you"),
    ("could", "you"),
    ("do", "you"),
)
_IDEAS = (("any", "idea"), ("any", "ideas"), ("any", "clue"), ("no", "idea"), ("no", "clue"))
_TELLING = words_of(
    "know remember forgot forget recall tell wonder sure wondering idea of about and or"
)
