"""What the product answers and what it does not, and how a refusal is worded.

A memory of sightings knows things, places, relations and times. States, use, advice, people's and
the robot's doings, the weather and the future are out of scope; noise is not understood.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise

from grammar import speech
from grammar.closed import is_open, words_of
from grammar.cursor import DETERMINERS, OWNERS, PRONOUNS, TIME_GAP, Tagged
from grammar.errors import NotUnderstood, OutOfScope, QuestionError
from grammar.forms import ObjectTerm
from grammar.nouns import Noun
from grammar.nountags import KIN
from grammar.phrases import asks_at_start, phrases
from grammar.suggestions import suggestions
from grammar.vocabulary import Lexicon, files
from grammar.words import Word

_ASKING = words_of(
    "where when what which who whose why how is are was were am do does did have has had "
    "can could may might should shall will would must whether if"
)
_DOERS = ("i", "we", "you", "someone", "one")
_WHERE_VERBS = frozenset(["find", "see", "look", "search", "locate"])


@lru_cache(maxsize=1)
def lists() -> dict[str, frozenset[str]]:
    """Return the lists of scope.txt by their headings."""
    return {name: frozenset(lines) for name, lines in files.sections("scope.txt").items()}


@lru_cache(maxsize=1)
def _openings() -> dict[str, list[tuple[tuple[str, ...], tuple[tuple[str, ...], ...]]]]:
    """Return the openings that are refused by their first word, with what excuses each after it."""
    found: dict[str, list[tuple[tuple[str, ...], tuple[tuple[str, ...], ...]]]] = {}
    for line in sorted(lists()["opening"]):
        opening, _, excuses = line.partition("~")
        goes_on = tuple(tuple(said.split()) for said in files.split(excuses))
        said = tuple(opening.split())
        found.setdefault(said[0], []).append((said, goes_on))
    return found


def spoken() -> tuple[str, ...]:
    """Return every phrase of the scope lists, for spelling to leave alone."""
    return tuple(phrase for phrases in lists().values() for phrase in phrases)


def doings() -> frozenset[str]:
    """Return common verbs of people's doings."""
    return lists()["doing"]


def commands() -> frozenset[str]:
    """Return the words that begin an order."""
    return lists()["command"]


def asks(words: list[Word]) -> bool:
    """Whether a sentence is a question by its first word, or looks for something."""
    led = len(words) > 1 and words[0].text in ("on", "in", "at")
    if led and words[1].text in ("which", "what"):
        return True
    return bool(words) and (words[0].text in _ASKING or words[0].text == speech.SEEK)


# -- refusals -------------------------------------------------------------------------------------


def refuse_early(
    text: str, words: list[Word], rest: list[Word], lexicon: Lexicon, it: ObjectTerm | None
) -> None:
    """Raise OutOfScope for what the words alone give away: the future, reasons, advice."""
    texts = [w.text for w in words]
    hit = _future(texts)
    if hit is not None:
        raise out(text, words[hit], "A memory knows the past, not the future", rest, lexicon)
    if texts[0] in _ERASING and {*texts[1:2]} & {*DETERMINERS, *OWNERS, "all", "everything"}:
        reason = "It answers questions; the command d3a forget takes things out of the memory"
        raise out(text, words[0], reason, rest, lexicon)
    if _commanded(texts, lexicon):
        raise out(text, words[0], "It answers questions and carries out no commands", rest, lexicon)
    if texts[-2:-1] == ["or"] and {texts[-1], *texts[-3:-2]} <= lists()["state"]:
        raise out(text, words[-1], "It knows no states of things", rest, lexicon)
    if texts[0] in ("which", "what") and any(pair in _LEADING for pair in pairwise(texts)):
        raise out(text, words[0], "It knows no plan of the building", rest, lexicon)
    if _use_asked(texts) or _usable(texts) or _in_sight(texts):
        raise out(text, words[0], "A memory of sightings gives no advice", rest, lexicon)
    for opening, excuses in _openings().get(texts[0], ()):
        if tuple(texts[: len(opening)]) != opening:
            continue
        after = tuple(texts[len(opening) :])
        if any(after[: len(said)] == said for said in excuses) or _points(opening, after, it):
            continue
        if opening == ("what", "does") and _has(after, lexicon):
            continue
        raise out(text, words[len(opening) - 1], _REASON, rest, lexicon)


_WHITHER = words_of("to into onto out outside outdoors upstairs downstairs")
_LEADING = {(verb, to) for verb in ("leads", "lead", "opens") for to in _WHITHER}
_ERASING = words_of("delete forget remove")
_REASON = "A memory of sightings knows where and when things were seen, nothing else"


def _has(after: tuple[str, ...], lexicon: Lexicon) -> bool:
    """Whether it is said that a person has something: anna has, my sister owns on the desk.

    What they have to do, or for lunch, is no thing that was seen.
    """
    led = after[:1] != () and after[0] in OWNERS
    person, verb, *more = (*after[led:], "", "")
    known = lexicon.singular(person) in KIN if led else person in lexicon.names or person in KIN
    return known and verb in ("have", "own", "possess") and more[0] not in ("to", "for")


def _points(opening: tuple[str, ...], after: tuple[str, ...], it: ObjectTerm | None) -> bool:
    """Whether `is it`, `is that` speaks of a thing: one spoken of before, or named after it."""
    if len(opening) != 2 or opening[1] not in (*PRONOUNS, "this", "that"):
        return False
    if it is not None and opening[1] in PRONOUNS:
        return True
    named = opening[1] != "it" and bool(after) and is_open(after[0])
    return named and after[0] not in lists()["state"]


def _commanded(texts: list[str], lexicon: Lexicon) -> bool:
    """Whether the first word is an order: `turn on the lights`, not `watch on the bed`."""
    if len(texts) < 2 or texts[0] not in lists()["command"] or asks_at_start(texts):
        return False
    if lexicon.known_noun(texts[0]) or texts[0] in lexicon.attributes:
        return texts[1] in DETERMINERS or texts[1] in OWNERS
    return True


_NEXT = words_of(
    "week month year monday tuesday wednesday thursday friday saturday sunday weekend day time"
)


def _future(texts: list[str]) -> int | None:
    for i, text in enumerate(texts):
        if text in ("will", "shall", "tomorrow", "gonna"):
            return i
        if text == "next" and texts[i + 1 : i + 2] and texts[i + 1] in _NEXT:
            return i
        if (
            text == "going"
            and texts[i + 1 : i + 2] == ["to"]
            and i
            and texts[i - 1] in ("am", "is", "are", "be")
        ):
            return i
    return None


_SKIPPED = words_of("i also usually normally always last typically generally")
_CLAUSES = words_of("know remember forgot forget recall tell wonder think sure say idea")
_PUTTING = words_of(
    "put store keep place leave hang set throw get lay park sit stand lie hide stash stow toss"
)


def _use_asked(texts: list[str]) -> bool:
    """Whether it is asked what to do, or where to do it: `where can i brush my teeth`."""
    if texts[:1] != ["where"] or len(texts) < 4 or texts[2] not in _DOERS:
        return False
    if texts[1] not in ("can", "could", "should", "may", "do", "would", "might"):
        return False
    verb = next((t for t in texts[3:5] if t not in _SKIPPED), "")
    if verb == "have" and texts[1] not in ("do", "would"):
        after = texts[texts.index("have") + 1 : texts.index("have") + 2]
        return not (after and after[0] in phrases().verbs)  # where can i have a seat
    if verb in _WHERE_VERBS or verb == "have":
        return False
    known = verb in phrases().verbs or verb in _PUTTING
    yours = texts[1:3] == ["would", "you"] and verb in _PUTTING  # where would you put the sofa
    advice = (
        texts[1] in ("should", "may")
        or yours
        or (texts[1] in ("can", "could") and verb in _PUTTING)
    )
    return not known or advice


def _in_sight(texts: list[str]) -> bool:
    """Whether it is asked what can be seen from somewhere: `can i see the tv from the sofa`."""
    able = texts[:1] in (["can"], ["could"]) and texts[2:3] == ["see"]
    return able and "from" in texts


def _usable(texts: list[str]) -> bool:
    """Whether things are asked for by what one can do with them: `anything i can use`."""
    for i in range(2, len(texts) - 2):
        may = texts[i] in _DOERS and texts[i + 1] in ("can", "could", "should", "may", "might")
        thing = is_open(texts[i - 1]) or texts[i - 1] in ("that", "which", "one", "ones", "to")
        if may and thing and texts[i - 1] not in _CLAUSES:
            verb = next((t for t in texts[i + 2 : i + 4] if t not in _SKIPPED and t != "not"), "")
            return verb not in _WHERE_VERBS and verb not in ("have", "")
    return False


def refuse_noise(
    text: str, tagged: Tagged, rest: list[Word], lexicon: Lexicon, *, timed: bool
) -> None:
    """Raise NotUnderstood for a short form whose noun nobody knows: noise is no question."""
    kinds = [t.type for t in tagged.tags]
    if any(k.startswith("_") or k in ("BE", "AUX", "WHO", "THERE") for k in kinds):
        return
    nouns = [t for t in tagged.tags if t.type == "NOUN"]
    for noun in nouns[:1]:
        value = noun.value
        assert isinstance(value, Noun)
        led = any(t.type in ("DET", "OWNER") for t in tagged.tags)
        if not value.known and not (led or timed):
            typed = text[noun.word.start : noun.word.end]
            raise NotUnderstood(
                text,
                noun.word.start,
                f"I do not know “{value.said if ' ' in value.said else typed}”.",
                suggestions(rest, lexicon, text),
            )


_LOOKS = words_of("color colour shape size material pattern")
"""What is known of a thing's look: it is looked for, never told."""


def unread(
    text: str, rest: list[Word], word: Word | None, tagged: Tagged, lexicon: Lexicon
) -> QuestionError:
    """Return the error of a sentence that no rule reads; `word` is the first one not read."""
    words = [w for w in rest if w.text != TIME_GAP]
    stopped = word or (words[-1] if words else None)
    position = stopped.start if stopped is not None else 0
    said = text[stopped.start : stopped.end] if stopped is not None else text.strip()
    hints = suggestions(rest, lexicon, text)
    if len(words) > 1 and words[0].text in ("what", "which") and words[1].text in _LOOKS:
        look = words[1]
        reason = f"I do not tell the {look.text} of a thing, but I look for one that you name"
        return OutOfScope(text, look.start, f"{reason}: the red cup, the small box.", hints)
    if stopped is not None and (beyond := _beyond(words, stopped)):
        return OutOfScope(text, position, f"{beyond}.", hints)
    if words and (asks(words) or words[0].text in lists()["command"]):
        if _garbled(words) and not any(t.type == "WHO" for t in tagged.tags):
            return NotUnderstood(text, position, f"I could not follow at “{said}”.", hints)
        return OutOfScope(text, position, f"{_REASON}; I could not follow at “{said}”.", hints)
    return NotUnderstood(text, position, f"I could not follow at “{said}”.", hints)


def _beyond(words: list[Word], stopped: Word) -> str:
    """Return why no sighting tells what a word asks: always, only, in the same room; "" else."""
    if stopped.text in _BEYOND:
        return _BEYOND[stopped.text]
    here = next(i for i, w in enumerate(words) if w.start == stopped.start)
    if [w.text for w in words[here : here + 4]] == ["in", "the", "same", "room"]:
        return "I do not compare the rooms of two things; ask for each where it was"
    if not {"before", "after"}.isdisjoint([w.text for w in words[max(0, here - 1) : here + 1]]):
        return (
            "I tell times by the clock; ask when it was there, and then where before or after that"
        )
    denied = [w.text for w in words[here + 1 : here + 2]] in (["no"], ["not"])
    if stopped.text in ("and", "but") and denied:
        return "I tell what was seen without another thing where it is said on or with what"
    return ""


_EACH = "I tell of each thing where it was seen, not that it is so of all; ask which are"
_BEYOND = {
    "all": _EACH, "each": _EACH, "every": _EACH,
    "twice": "I tell how often a thing was seen; ask that",
    "always": "I know when things were seen, not that something was so all the time",
    "only": "I know what was seen, not that there was nothing else or nowhere else",
}  # fmt: skip
"""Words that ask what no sighting tells, and why none does."""


def _garbled(words: list[Word]) -> bool:
    """Whether a question breaks off without a noun: `where is the`."""
    return not any(is_open(w.text) for w in words[1:]) and len(words) < 5


def out(text: str, word: Word, reason: str, rest: list[Word], lexicon: Lexicon) -> OutOfScope:
    """Return the refusal of a question at a word of it, for a reason."""
    return OutOfScope(text, word.start, f"{reason}.", suggestions(rest, lexicon))
