"""What is said around a question that is no part of it, cut off where no rule reads the whole.

`I came home late and now I wonder where my gloves are`, `where is my coat, it is freezing`: no list
holds all that people say first and last. So this is tried only after a sentence has failed. What
is cut off tells: it asks nothing, orders nothing and names no time.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice, zip_longest

from grammar import scope, timespan
from grammar.closed import LEADING, is_open, words_of
from grammar.nountags import KIN
from grammar.phrases import asks_at_start
from grammar.sayings import AUXILIARIES, QUESTION_WORDS, sections
from grammar.vocabulary import Lexicon
from grammar.words import Word

_MOST_TRIES = 4
_JOINTS = words_of(", - ; but and so then because since")
_TELLERS = words_of("i we it let please there maybe perhaps could can would will may might just")
_TELLING = words_of(
    "know ask wonder wondering interested curious remember recall forgot forget forgotten me us "
    "find figure work check see learn hear say idea clue hint sure out is in of about at "
    "asks asked asking wonders myself up"
)
"""What comes right before a question that is told: i would love to know where it is."""
_ASKING_FOR = words_of("asks asked asking wants wonders")
_ASKING_YOU = ("ask", "asking", "trouble", "bother")
_ASKERS = words_of("who whom whose why what where when which how whether whereabouts")
_PAST = words_of("was were did have has had saw seen")
_SUBJECTS = LEADING | words_of("i we you it he she they there any anyone someone")
_TAILS = words_of(
    "i we it he she they my there that this because cause since as so otherwise thanks thank "
    "cheers sorry you please"
)


def without_asides(spoken: list[list[Word]], lexicon: Lexicon) -> Iterator[list[list[Word]]]:
    """Yield the sentences with what stands around a question cut off, the least cut first."""
    cuts = [
        [
            *_called(words, lexicon), *_questions_in(words), *_heads_of(words), *_unfound(words),
            *_undescribed(words),
        ]
        for words in spoken
    ]  # fmt: skip
    if any(cuts):
        tries = zip_longest(*([*kept] or [words] for kept, words in zip(cuts, spoken, strict=True)))
        for tried in islice(tries, _MOST_TRIES):
            yield [part or words for part, words in zip(tried, spoken, strict=True)]


def without_pauses(words: list[Word]) -> Iterator[list[Word]]:
    """Yield the words without those that fill a pause, then without the pauses too.

    They may be meant, at the end (how is it like) or where they stand first.
    """
    kept = words
    for filling in (_FILLING, _PAUSES):
        inner = (w for w in kept[1:-1] if w.text not in filling)
        thinned = [*kept[:1], *inner, *kept[1:][-1:]]
        if len(thinned) < len(kept):
            yield thinned
        kept = thinned


_FILLING = words_of("like well okay ok so right just")
_PAUSES = frozenset((",",))


def _called(words: list[Word], lexicon: Lexicon) -> Iterator[list[Word]]:
    """Yield the question before which somebody is called: mommy where is my doll."""
    texts = [w.text for w in words]
    if len(texts) < 4 or not is_open(texts[0]) or texts[0] in scope.commands():
        return
    person = texts[0] in KIN or texts[0] in lexicon.names
    thing = lexicon.known_noun(texts[0]) or texts[0] in lexicon.places or _dated(texts[:1])
    asked = texts[1] in QUESTION_WORDS and texts[2] in AUXILIARIES
    if (person or not thing) and (asked or _asks(texts, 1)):
        yield words[1:]


def _unfound(words: list[Word]) -> Iterator[list[Word]]:
    """Yield the question before it is told that its thing can not be found, and all the rest."""
    texts = [w.text for w in words]
    for i in range(3, len(texts) - 4):
        lost = texts[i : i + 2] in (["i", "can"], ["we", "can"]) and texts[i + 2] == "not"
        if lost and texts[i + 3] in ("find", "see") and texts[i + 4] in ("it", "them"):
            yield words[:i]
            return


def _undescribed(words: list[Word]) -> Iterator[list[Word]]:
    """Yield the question without what its last thing is told by: the doll the kids play with."""
    texts = [w.text for w in words]
    for i in range(4, len(texts) - 2):
        tail = texts[i:]
        led = is_open(texts[i - 1]) and tail[0] in _TELLERS_OF and is_open(tail[1])
        tells = any(_is_verb(t) for t in tail[2:])
        if led and tells and texts[0] in QUESTION_WORDS and not _dated(tail):
            yield words[:i]
            return


def _is_verb(text: str) -> bool:
    return text.endswith("ed") or not scope.doings().isdisjoint((text, text.removesuffix("s")))


_TELLERS_OF = words_of("the my our your his her their")


def _questions_in(words: list[Word]) -> Iterator[list[Word]]:
    """Yield the questions that follow what is only told before them."""
    texts = [w.text for w in words]
    if texts[0] in scope.commands():
        return
    for i in range(1, len(texts) - 1):
        lead = texts[:i]
        if not _ASKERS.isdisjoint(lead):
            return
        timeless = not _dated(lead) or _PAST.isdisjoint(texts[i:])
        if timeless and (_joined(texts, i) or _told(texts, i)):
            yield words[i:]


def _dated(texts: list[str]) -> bool:
    """Whether a time is told: it may belong to the question."""
    return bool(timespan.find(texts))


def _joined(texts: list[str], i: int) -> bool:
    """Whether a question stands at `i` after a joint; a question before it would be a second."""
    if texts[i - 1] not in _JOINTS:
        return False
    asked = texts[0] in AUXILIARIES and texts[0] not in _TELLERS
    return not asked and (_asks(texts, i) or _requests(texts, i))


def _asks(texts: list[str], i: int) -> bool:
    """Whether a question starts at `i` by its first two words: where is, is the, how many."""
    first, second = texts[i], texts[i + 1]
    if first in QUESTION_WORDS:
        return True
    return first in AUXILIARIES and second in _SUBJECTS


def _requests(texts: list[str], i: int) -> bool:
    """Whether an opening that asks stands at `i`: could you tell me, show me, i am looking for."""
    rest = [Word(text, 0, 0) for text in texts[i : i + 8]]
    opened = any(sections()[name].at(rest, 0) for name in ("prefix", "seek"))
    return opened or asks_at_start(texts[i:])


def _told(texts: list[str], i: int) -> bool:
    """Whether a question that is told stands at `i`: i would love to know where it is."""
    starts = texts[i] in QUESTION_WORDS or texts[i] == "if"
    telling = texts[i - 1] in _TELLING or (texts[i - 1] == "you" and texts[i - 2] in _ASKING_YOU)
    tells = texts[0] in _TELLERS or not _ASKING_FOR.isdisjoint(texts[:i])
    return starts and tells and telling


def _heads_of(words: list[Word]) -> Iterator[list[Word]]:
    """Yield the question before a comma after which something is told: `, it is freezing`."""
    texts = [w.text for w in words]
    for i in range(len(texts) - 3, 2, -1):
        tail = texts[i + 1 :]
        tells = texts[i] in (",", "-") and tail[0] in _TAILS and not _asks(texts, i + 1)
        if tells and _ASKERS.isdisjoint(tail) and not _dated(tail):
            yield words[:i]
