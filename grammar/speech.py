"""Speech made plain: wake words, fillers, politeness, stutters and self-corrections taken out.

What is left are the words of the question proper, still with their offsets in the text.
"""

from __future__ import annotations

from dataclasses import replace

from grammar import calling, numbers, stutters, timespan, whereabouts
from grammar.closed import LEADING, is_open, words_of
from grammar.corrections import HESITATING, corrected
from grammar.nountags import KIN, PEOPLE
from grammar.phrases import asks_at_start, phrases, place_follows
from grammar.sayings import (
    AUXILIARIES,
    QUESTION_STARTS,
    QUESTION_WORDS,
    sections,
    seeking,
    to_be_told,
)
from grammar.vocabulary import Lexicon
from grammar.words import Word

SEEK = "<seek>"
"""Stands for "I am looking for" and its like at the start of a question."""


def plain(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Return the words of one sentence without what changes nothing."""
    said = _without_fillers(_unpaused(words))
    if 0 < len(said) < len(words):
        said = _without_fillers(said)  # by any um chance
    words = _joined(_counting(_heard(said), lexicon), lexicon)
    words = _owning(_unowned(_short_of_is(words), lexicon), lexicon)
    words = corrected(words, lexicon)
    words = stutters.without_stutters(words, lexicon)
    words = stutters.begun_anew(_opened(_searching(words)))
    words = calling.without_calls(_closed(_searching(_without_thought(words))), lexicon)
    return whereabouts.located(words)


def _searching(words: list[Word]) -> list[Word]:
    """Read where one is told to look as where it may be: search the kitchen for my phone."""
    if not words or words[0].text not in ("where", *_SEARCHED):
        return words
    texts = [w.text for w in words]
    if texts[0] == "where" and texts[2:3] == ["one"] and texts[3:4] in (["find"], ["see"]):
        return [*words[:2], replace(words[2], text="i"), *words[3:]]  # where might one find it
    if texts[0] not in _SEARCHED or "for" not in texts[2:-1]:
        return words
    at = texts.index("for", 2)
    place = words[1:at]
    led = place[0].text in ("in", "on", "under", "behind")
    place = place if led else [replace(words[0], text="in"), *place]
    return [Word(SEEK, words[0].start, words[0].end), *words[at + 1 :], *place]


_SEARCHED = ("search", "check", "look", "scan")


def _without_thought(words: list[Word]) -> list[Word]:
    """Take out who thinks or says it: `where do you think my keys are`."""
    opening = [w.text for w in words[:4]]
    seen = opening[:2] in (["did", "you"], ["have", "you"]) and len(words) > 5
    if seen and opening[2] in _NOTICING and opening[3] in (*QUESTION_WORDS, "if"):
        return words[3:]  # have you seen where my phone is
    said = tuple(opening[1:])
    thought = len(said) == 3 and said[:2] in _THINKING and said[2] in _THOUGHTS
    if words and words[0].text in QUESTION_WORDS and thought and len(words) > 5:
        return [words[0], *words[4:]]
    return words


_NOTICING = words_of("see seen notice noticed")
_THINKING = (("do", "you"), ("did", "you"), ("did", "i"), ("would", "you"))
_THOUGHTS = words_of("think believe reckon guess suppose say tell")


def _heard(words: list[Word]) -> list[Word]:
    """Return the words with a `where` that a recogniser spelled as it sounds."""
    sounds = len(words) > 2 and words[0].text in ("wear", "ware", "were", "we're")
    if sounds and words[1].text in ("is", "are", "did", "was", "have"):
        return [replace(words[0], text="where"), *words[1:]]
    return words


def _owning(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Return the words with the apostrophes that speech has not: my daughters bag, chris bike."""
    found = words
    for i, word in enumerate(words[:-1]):
        if word.text[-1] != "s":
            continue
        named, person = word.text in lexicon.names, word.text[:-1] in _OWNING
        if not (named or person) or lexicon.known_noun(f"{word.text} {words[i + 1].text}"):
            continue
        k = i + 1
        while k + 1 < len(words) and words[k].text in lexicon.attributes:
            k += 1
        thing, pair = words[k].text, " ".join(w.text for w in words[k : k + 2])
        known = lexicon.known_noun(thing) or lexicon.known_noun(pair)
        if is_open(thing) and thing not in phrases().verbs and known:
            owner = word.text if named else word.text[:-1]
            found = [*found[:i], replace(word, text=f"{owner}'s"), *found[i + 1 :]]
    return found


_OWNING = PEOPLE - {"kid", "guest", "baby", "visitor"}
"""People whose plural does not say what kind a thing is, as in a kids table."""


def _short_of_is(words: list[Word]) -> list[Word]:
    """Return the words with the 's of has or is told: where the cat's got to, where my bag's at.

    Who owns something is no place: the pen's in the drawer.
    """
    verbal = not AUXILIARIES.isdisjoint(w.text for w in words)
    for i, word in enumerate(words[:-1]):
        if word.text[-2:] != "'s" or not is_open(word.text):
            continue
        after = [w.text for w in words[i + 1 :]]
        asked = not _ASKS_WHERE.isdisjoint(w.text for w in words[:i])
        gone = asked and after[0] in _GONE and (len(after) == 1 or after[1] in _GONE_TO)
        placed = i and not verbal and len(after) > 1 and place_follows(words, i + 1)
        if gone or placed:
            verb = "is" if placed or after[0] == "at" else "has"
            thing = replace(word, text=word.text[:-2])
            return [*words[:i], thing, replace(word, text=verb), *words[i + 1 :]]
    return words


_ASKS_WHERE = words_of("where whereabouts")
_GONE = words_of("got gotten gone been at disappeared vanished wandered run")
_GONE_TO = words_of("to off now , please")


def _counting(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Return the words with `how much` before several things as how many."""
    said = [w.text for w in words[:3]]
    several = said[:2] == ["how", "much"] and lexicon.singular(said[-1]) != said[-1]
    if several and lexicon.known_noun(said[-1]):
        return [words[0], replace(words[1], text="many"), *words[2:]]
    return words


def _joined(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Join what a recogniser parts: `anna s` is anna's, `t v` is tv where that is a noun."""
    out: list[Word] = []
    for word in words:
        before = out[-1] if out else None
        if before is not None and before.end < word.start and before.text.isalpha():
            owner = word.text == "s" and is_open(before.text) and len(before.text) > 1
            joined = f"{before.text}'s" if owner else before.text + word.text
            spelled = len(before.text) == 1 and lexicon.known_noun(joined) and before.text != "a"
            led = len(word.text) == 1 or (len(out) > 1 and out[-2].text in LEADING)
            if owner or (spelled and led):
                out[-1] = replace(before, text=joined, end=word.end)
                continue
        out.append(word)
    return out


def _unowned(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Return the words with things that a recogniser made owners of nothing: `my key's`."""
    for i in range(2, len(words)):
        if not words[i].text.endswith("'s"):
            continue
        thing = words[i].text.removesuffix("'s")
        if thing in KIN or lexicon.known_noun(thing) is None:
            continue
        verb = words[i - 2].text in AUXILIARIES or words[i - 2].text in phrases().verbs
        after = [w.text for w in words[i + 1 :]]
        owns = after and (is_open(after[0]) or after[0] == "own")
        timed = owns and any(time.first == 0 for time in timespan.find(after))
        if verb and words[i - 1].text in LEADING and (timed or not owns):
            return [*words[:i], replace(words[i], text=thing), *words[i + 1 :]]
    return words


def _unpaused(words: list[Word]) -> list[Word]:
    """Take out a pause where none parts anything: where... is my inhaler, on the... shelf."""
    return [
        word
        for i, word in enumerate(words)
        if word.text != "," or not i or words[i - 1].text not in _GOING_ON
    ]


_GOING_ON = (LEADING - words_of("her that this these those")) | words_of(
    "is are was were do does did have has you on in under near behind with to of at from where "
    "when how beside inside between and"
)
"""After these words a sentence goes on, whatever pause is made."""


def _without_fillers(words: list[Word]) -> list[Word]:
    fillers = sections()["filler"]
    kept: list[Word] = []
    i = 0
    while i < len(words):
        count = fillers.at(words, i)
        if count and not _no_filler(words, i, count, kept):
            i += count
            if i < len(words) and words[i].text == "," and (not kept or kept[-1].text == ","):
                i += 1
            continue
        kept.append(words[i])
        i += 1
    return kept


def _no_filler(words: list[Word], i: int, count: int, kept: list[Word]) -> bool:
    """Whether a filler is said in earnest: the `oh` of `nine oh five`, `do you know`."""
    before = kept[-1].text if kept else ""
    if count == 1 and words[i].text in HESITATING and before == ",":
        return words[i + 1 : i + 2] != [] and words[i + 1].text == "," and len(kept) > 1
    if words[i].text == "mm":
        return before.isdecimal() or before in numbers.CARDINALS  # the 10 mm socket
    if words[i].text == "like":
        following = words[i + 1].text if i + 1 < len(words) else ""
        if following in phrases().verbs and before in ("you", "i", "we", *AUXILIARIES):
            return False  # did you like see it
        named = following in LEADING
        return before not in _BEFORE_LIKE and not (named and before in _LEAVING)
    if words[i].text in ("oh", "o"):
        return before in numbers.CARDINALS
    if words[i].text == "you":
        following = words[i + count].text if i + count < len(words) else ""
        return before in _KNOWING or following in (*QUESTION_WORDS, "if")
    return False


_KNOWING = words_of("do does did can could should will would might must may if")
"""After these `you know` is asked or told in earnest."""
_BEFORE_LIKE = (
    "",
    *words_of("so ok okay well where when is are was were there at around by in on for and to"),
    *words_of("my your our the under near behind with beside inside list"),
    *words_of("between since until after before during from"),
)
"""After these `like` says nothing: `where is like my cup`, `at like three`."""
_LEAVING = words_of("put leave left find found see seen saw lose lost spot keep store kept")
"""After these it says nothing before a determiner: `where did i put like the tape`."""


def _opened(words: list[Word]) -> list[Word]:
    """Take wake words and indirect openings off the start."""
    said = sections()
    wake, prefix = said["wake"], said["prefix"]
    i = 0
    while i < len(words):
        count = prefix.at(words, i)
        if count and _clause_follows(words, i + count) and not to_be_told(words, i + count):
            i += count
            if i < len(words) and words[i].text == "that":
                i += 1
            if [w.text for w in words[i : i + 2]] in _FOR_WHOM:
                i += 2  # could you find out for me
            continue
        if words[i].text == ",":
            i += 1
            continue
        count = seeking(words, i)
        if count and i + count < len(words) and words[i + count].text != "to":
            return [Word(SEEK, words[i].start, words[i + count - 1].end), *words[i + count :]]
        count = wake.at(words, i)
        if count and not _said_in_earnest(words, i, count):
            i += count
            continue
        break
    return words[i:]


_FOR_WHOM = (["for", "me"], ["for", "us"])


_CALLED = ("robot", "computer", "help", "question", "quick", "man")


def _said_in_earnest(words: list[Word], i: int, count: int) -> bool:
    """Whether a wake word is the question itself: `no`, `now` and `computer` may be its nouns."""
    following = words[i + count].text if i + count < len(words) else ""
    if not following:
        return True
    if words[i].text == "no" and is_open(following) and following not in _CALLED:
        return not any(_verbal(w.text) or w.text in QUESTION_WORDS for w in words[i:])
    if is_open(words[i].text) and words[i].text in _CALLED:
        return following not in (*QUESTION_STARTS, *_CALLED, ",") and not following.startswith("i")
    return False


def _clause_follows(words: list[Word], i: int) -> bool:
    """Whether an indirect question or a statement follows an opening such as `tell me`."""
    k = i
    while k < len(words) and words[k].text in (
        ",",
        "please",
        "about",
        "at",
        "in",
        "on",
        "the",
        "to",
        "of",
        "me",
        "for",
        "us",
        "robot",
    ):
        k += 1
    return k < len(words) and (
        words[k].text in (*QUESTION_WORDS, "if", "that", "who", "i", "you", "there", *AUXILIARIES)
        or words[i - 1].text in ("that",)
        or asks_at_start([w.text for w in words[i:]])
        or sections()["prefix"].at(words, k) > 0
    )


def _closed(words: list[Word]) -> list[Word]:
    """Take politeness and tags off the end."""
    suffix = sections()["suffix"]
    told = False
    if len(words) > _LEAST_ASKED and words[-1].text in _ANYONE and _complete(words[-2].text):
        words = words[:-1]
    while words:
        if words[-1].text in (",", "-"):
            words = words[:-1]
            continue
        count = suffix.ending(words)
        if not count or count >= len(words) or _robotic(words) or _judged(words):
            break
        if words[-count].text in ("is", "was", "did", "have", "are", "were", "does") and not _tag(
            words, count
        ):
            return words
        told = told or words[-count].text in (*_ASKING_TAGS, *AUXILIARIES)
        words = words[:-count]
    stated = words and words[0].text not in (*QUESTION_STARTS, *QUESTION_WORDS, SEEK)
    if told and stated and any(_verbal(w.text) for w in words):
        return [replace(words[0], text="whether"), *words]  # the cup is on the table, isn't it
    return words


_LEAST_ASKED = 3
_ANYONE = ("anyone", "anybody")


def _complete(text: str) -> bool:
    """Whether a question may end in a word, and who is asked come after it: the keys, anyone."""
    return (is_open(text) or text == ",") and not _verbal(text)


def _judged(words: list[Word]) -> bool:
    """Whether it is asked if a thing is right: is the clock on the wall correct."""
    asked = words[0].text in ("is", "are", "was", "were") and words[-1].text in ("right", "correct")
    return asked and words[-2].text != ","


def _robotic(words: list[Word]) -> bool:
    """Whether the `robot` at the end is a thing that is asked for: the toy robot."""
    return words[-1].text == "robot" and words[-2].text in _ROBOTIC


_ROBOTIC = words_of(
    "the a my toy lego vacuum cleaning mop lawn tin model small big little red blue"
)
_ASKING_TAGS = ("right", "correct", "yes", "no")


def _verbal(text: str) -> bool:
    """Whether a word may be the verb of a statement: was, saw, left."""
    return text in AUXILIARIES or text in phrases().verbs


def _tag(words: list[Word], count: int) -> bool:
    """Whether an auxiliary and a pronoun at the end are a tag (`, isn't it`), no clause."""
    rest = words[:-count]
    return (len(rest) >= 3 and any(_verbal(w.text) for w in rest)) or rest[-1].text == ","
