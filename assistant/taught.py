"""What a person says to teach: these are my keys, call this place the desk, that is the same cup.

A small grammar of statements, apart from that of questions: it reads a whole sentence or nothing,
and never one that asks. It knows no store: what `this` points at, the conversation knows.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from assistant.english import ORDINALS
from grammar.vocabulary import lexicon

Row = int | None
"""The number of a keyframe in the list, from 1; -1 for the last; None for the one pointed at."""
LAST = -1


@dataclass(frozen=True, slots=True)
class Naming:
    """A thing is called so: said is "my keys", "anna's", "excalibur". isnt: it is not.

    sure: also where it looks like something else. heard: what was said, as it was written.
    """

    row: Row
    said: str
    isnt: bool = False
    sure: bool = False
    heard: str = ""


@dataclass(frozen=True, slots=True)
class PlaceNaming:
    """A place is called so. here: where the robot stands; else around what is pointed at.

    anew: also where there is a place of that name.
    """

    name: str
    here: bool = False
    anew: bool = False


@dataclass(frozen=True, slots=True)
class PlaceRenaming:
    """A named place is called otherwise; `new` is None where it is no place any more."""

    name: str
    new: str | None


@dataclass(frozen=True, slots=True)
class Sameness:
    """Two things are one. other: None where it was not said. sure: also where a frame has both."""

    row: Row
    other: Row = None
    sure: bool = False


@dataclass(frozen=True, slots=True)
class Difference:
    """What was seen at one place is another thing than the rest."""

    row: Row
    other: Row = None


@dataclass(frozen=True, slots=True)
class Boxing:
    """A box was drawn on the picture pointed at: x1, y1, x2, y2 in pixels of its frame."""

    box: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Undoing:
    """The last thing that was said is taken back."""


@dataclass(frozen=True, slots=True)
class Recalling:
    """What was taught so far is asked for."""


Teaching = (
    Naming | PlaceNaming | PlaceRenaming | Sameness | Difference | Boxing | Undoing | Recalling
)

CARDINALS = ("one", "two", "three", "four", "five", "six", "seven", "eight", "nine")
NUMBER = rf"(?:\d{{1,2}}|{'|'.join(CARDINALS)})"
ORDINAL = rf"(?:{'|'.join(ORDINALS)}|last|\d{{1,2}}(?:st|nd|rd|th))"
ROW = rf"(?:(?:the )?(?:number|nr|no|row|picture|result) {NUMBER}|the {ORDINAL}(?: one)?)"
"""How a row of the list is named in words."""
_THIS = r"(?:this|that|it|these|those|they)(?: ones?)?"
_SPOT = r"(?:place|spot|room|corner|area)"
_WORD = r"(?!(?:as|than|from|like|even|anyway|really|all)\b)[a-z][a-z-]*"
_KIND = rf"{_WORD}(?: {_WORD}){{0,2}}"
_LEAD = re.compile(
    r"^(?:(?:no|ok|okay|well|actually|please|hey|and|but|so|yes|remember that|note that|you know"
    r"|remember,),? )+"
)
_TAIL = re.compile(r"[,;]?(?: (?:please|thanks|thank you|now|then|too|instead|from now on))+$")
_SHORT = re.compile(r"\b(that|it|this|here|one|they|these|those|there|you|we)['\u2019](s|re)\b")
_SURE = r"(?P<sure> (?:anyway|even so|really|all the same))?"

_UNDO = re.compile(
    r"(?:undo|revert|cancel)(?: (?:that|it|this|the last(?: one| thing)?))?"
    r"|take (?:that|it) back|scratch that|that was wrong|i (?:did not|didn't) mean that"
    r"|forget (?:that|it|what i (?:just )?(?:said|told you|taught you))"
)
_BOX = re.compile(r"/?box((?:[ ,]+\d{1,5}(?:\.\d{1,3})?){4})")
_RECALL = re.compile(
    r"what (?:did i|have i) (?:teach|taught|tell|told)(?: you)?(?: so far)?"
    r"|what do you know from me|show what i (?:taught|told) you"
)
_PLACE = re.compile(
    rf"(?:we )?(?:call|name|remember) (?:this {_SPOT}|that {_SPOT}|it here) (?:as )?(?P<a>.+)"
    rf"|(?:this|that) {_SPOT} is (?:called )?(?P<b>.+)"
)
_HERE = re.compile(
    r"(?:here is|you are (?:now )?in|we are (?:now )?in|you are (?:now )?at) (?P<name>.+)"
    r"|(?:we )?(?:call|name) here (?P<b>.+)"
)
_RENAMED = re.compile(r"(?:we )?(?:call|rename) the (?P<old>.+?) (?:to )?the (?P<new>.+)")
_NO_PLACE = re.compile(
    r"(?:the )?(?P<a>[a-z' -]+) is (?:no|not a) (?:place|room)(?: any ?more)?"
    r"|(?:forget|remove) the (?:place|room) (?:called )?(?:the )?(?P<b>.+)"
)
_SAME = re.compile(
    rf"(?P<row>{_THIS}|{ROW}|{NUMBER}) (?:is|are) (?:all )?(?:one and )?the (?:very )?same"
    rf"(?: {_KIND})??(?: (?:as|like) (?P<other>{_THIS}|{ROW}|{NUMBER}))?{_SURE}"
)
_BOTH_SAME = re.compile(
    rf"(?P<row>{ROW}|{NUMBER}) and (?P<other>{ROW}|{NUMBER}) are "
    rf"(?:(?:both )?the same(?: {_KIND})?|one(?: {_KIND})?|one and the same(?: {_KIND})?){_SURE}"
)
_OTHER = re.compile(
    rf"(?P<row>{_THIS}|{ROW}|{NUMBER}) (?:is|are) (?:(?:not|never) the same(?: {_KIND})??"
    rf"|an(?:other)? (?:other )?{_KIND}|a different {_KIND}|different(?: {_KIND})?)"
    rf"(?: (?:as|than|from) (?P<other>{_THIS}|{ROW}|{NUMBER}))?"
)
_BOTH_OTHER = re.compile(
    rf"(?P<row>{ROW}|{NUMBER}) and (?P<other>{ROW}|{NUMBER}) are "
    rf"(?:not (?:both )?the same(?: {_KIND})?|two(?: different)? {_KIND}|different(?: {_KIND})?)"
)
_BELONGS = re.compile(
    rf"(?P<row>{_THIS}|{ROW}) (?P<isnt>(?:does|do) not )?belongs? to (?P<owner>.+)"
)
_CALLED = re.compile(
    rf"(?:we |i )?(?:call|name) (?P<row>{_THIS}|{ROW}) (?P<said>.+)"
    rf"|(?P<row2>{_THIS}|{ROW}) (?:is|are) (?:called|named) (?P<said2>.+)"
)
_NAMED = re.compile(rf"(?P<plain>.+?){_SURE}")
_IS = re.compile(rf"(?P<row>{_THIS}|{ROW}) (?:is|are) (?P<isnt>not )?(?P<said>.+)")
_OWNED = re.compile(r"(?:my|our|your|[^\W\d_]+['\u2019]s?|[^\W\d_]+s['\u2019]) .+")
_POSSESSIVE = re.compile(r"mine|ours|[^\W\d_]+['\u2019]s|[^\W\d_]+s['\u2019]")
_DETERMINED = re.compile(r"(?:the|a|an) (?P<noun>.+)")
_SAYS_MORE = """
    above all almost along already always at away back before behind below beside between by
    correct enough false fine for from gone good great here how in inside it just last left like
    lost maybe missing moved near never next nice no nonsense not nothing ok okay old on one
    only other out over perfect quite right same seen so still strange that there they this to
    too true under very was what when where which who why with wrong yes you
"""
_NO_NAME = frozenset(_SAYS_MORE.split())
"""What a name neither is nor begins with: such a sentence says something else."""


def read_teaching(text: str) -> Teaching | None:
    """Return what a sentence teaches, None where it teaches nothing: then it is a question."""
    said = _plain(text)
    if _RECALL.fullmatch(said.rstrip("? ")):
        return Recalling()
    if not said or "?" in text:
        return None
    if found := _BOX.fullmatch(said):
        x1, y1, x2, y2 = (float(edge) for edge in re.findall(r"[\d.]+", found[1]))
        return Boxing((x1, y1, x2, y2))
    if _UNDO.fullmatch(said):
        return Undoing()
    taught = _same_or_not(said) or _place(said) or _surely(said)
    if isinstance(taught, Naming):
        return replace(taught, heard=_written(taught.said, text))
    return taught


def is_lesson(text: str) -> bool:
    """Whether a saying changes what is known, or begins to: not one that asks what was taught."""
    taught = read_teaching(text)
    return taught is not None and not isinstance(taught, Recalling)


def _written(name: str, text: str) -> str:
    """Return a name as it stands in a text: with its capitals."""
    spoken = _spaced(text)
    at = spoken.lower().rfind(name)
    same = len(spoken.lower()) == len(spoken)  # a few letters become two when they are made small
    return spoken[at : at + len(name)] if at >= 0 and same else name


def _spaced(text: str) -> str:
    return " ".join(text.replace("\u2019", "'").split())


def _surely(said: str) -> Teaching | None:
    """Read a naming, and whether it is to hold all the same."""
    found = _NAMED.fullmatch(said)
    naming = _name(found["plain"]) if found else None
    return replace(naming, sure=True) if naming and found and found["sure"] else naming


def _plain(text: str) -> str:
    """Return the sentence in small letters, without what is only polite, and in full."""
    said = _spaced(text).lower().rstrip(".!, ")
    said = _LEAD.sub("", said)
    said = _TAIL.sub("", said)
    said = _SHORT.sub(lambda m: f"{m[1]} {'are' if m[2] == 're' else 'is'}", said)
    return re.sub(r"\b(is|are|does|do)n't\b", r"\1 not", said).strip()


def row_of(said: str | None) -> Row:
    """Return the number that names a row: "number 2", "the second one", "2"; None for this."""
    words = re.findall(r"[a-z]+|\d+", said or "")
    for word in words:
        if word.isdigit():
            return int(word)
        if word in ORDINALS:
            return ORDINALS.index(word) + 1
        if word == "last":
            return LAST
    named = [w for w in words if w in CARDINALS]
    is_number = bool(words) and (words[0] in CARDINALS or "the" in words[:1] or len(words) == 2)
    if named and is_number and words[0] not in ("this", "that", "these", "those"):
        return CARDINALS.index(named[-1]) + 1
    return None


def _same_or_not(said: str) -> Teaching | None:
    for pattern in (_BOTH_SAME, _SAME):
        if found := pattern.fullmatch(said):
            return Sameness(row_of(found["row"]), row_of(found["other"]), bool(found["sure"]))
    for pattern in (_BOTH_OTHER, _OTHER):
        if found := pattern.fullmatch(said):
            return Difference(row_of(found["row"]), row_of(found["other"]))
    return None


def _place(said: str) -> Teaching | None:
    if found := _PLACE.fullmatch(said):
        return _placed(found["a"] or found["b"])
    if found := _HERE.fullmatch(said):
        return _placed(found["name"] or found["b"], here=True)
    if (found := _NO_PLACE.fullmatch(said)) and (found["b"] or _is_name(found["a"])):
        return PlaceRenaming(found["a"] or found["b"], None)
    if found := _RENAMED.fullmatch(said):
        return PlaceRenaming(found["old"], found["new"])
    found = _IS.fullmatch(said)
    if found and not found["isnt"] and row_of(found["row"]) is None:
        noun = found["said"].removeprefix("the ")
        if _is_place(noun):
            return _placed(noun)
    return None


def _placed(name: str, *, here: bool = False) -> PlaceNaming | None:
    anew = name.startswith("anew ")
    plain = re.sub(r"^(?:anew )?(?:the |my |our )?", "", name).strip(" '\"")
    return PlaceNaming(plain, here, anew) if _is_name(plain) else None


def _is_place(noun: str) -> bool:
    """Whether a noun names a room, by itself or at its end: anna's bedroom."""
    places = lexicon().places
    return noun in places or any(noun.endswith(f"s {place}") for place in (*places, "room"))


def _name(said: str) -> Naming | None:
    if found := _BELONGS.fullmatch(said):
        owner = found["owner"]
        whose = "mine" if owner in ("me", "us") else f"{owner.removesuffix(chr(39) + 's')}'s"
        return Naming(row_of(found["row"]), whose, isnt=bool(found["isnt"]))
    if found := _CALLED.fullmatch(said):
        name = found["said"] or found["said2"]
        return Naming(row_of(found["row"] or found["row2"]), name) if _is_name(name) else None
    found = _IS.fullmatch(said)
    if found is None:
        return None
    name = found["said"]
    owned = _OWNED.fullmatch(name) or _POSSESSIVE.fullmatch(name)
    noun = _DETERMINED.fullmatch(name)
    if not (owned or (noun and _is_name(noun["noun"]))):
        return None
    return Naming(row_of(found["row"]), name, isnt=bool(found["isnt"]))


def _is_name(name: str) -> bool:
    words = name.removeprefix("the ").split()
    return 0 < len(words) <= 5 and words[0] not in _NO_NAME
