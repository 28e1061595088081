"""Terminals settled by both their neighbours: commas, `and`, predicates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from grammar.cursor import Tag
from grammar.forms import ANYTHING
from grammar.nouns import PREDICATES, Attribute, Noun

_SUPPORTS = ("on", "in", "under", "above")
"""Relations that a thing has to one other at a time."""


def tidied(tags: list[Tag]) -> list[Tag]:
    """Return the terminals with what only both neighbours tell."""
    kinds = {tag_.type for tag_ in tags}
    for settled, needed in _SETTLING:
        if not needed or not kinds.isdisjoint(needed):  # most say little of all this
            tags = settled(tags)
    return tags


def _ones(tags: list[Tag]) -> list[Tag]:
    """Read `one` in a list as the noun before it: a red cup or a blue one."""
    out = list(tags)
    for i, tag_ in enumerate(out):
        k = i - 1
        while k > 0 and out[k].type in ("DET", "OWNER", "ATTR", "NOT_ATTR", "NUMBER"):
            k -= 1
        if (
            tag_.type == "ONE"
            and k > 0
            and out[k].type in ("AND", "OR")
            and out[k - 1].type == "NOUN"
        ):
            out[i] = Tag("NOUN", out[k - 1].value, tag_.word)
    return out


def _said_of_all(tags: list[Tag]) -> list[Tag]:
    """Say of each look what is said after their noun: red or blue cups without handles."""
    last = next((i for i in range(len(tags) - 1, 0, -1) if tags[i].type == "NOUN"), 0)
    end = last + 1
    while end < len(tags) and tags[end].type in (*_CLAUSE_HEADS, *_CLAUSE_PARTS):
        end += 1
    clause = tags[last + 1 : end]
    if not clause or clause[0].type not in _CLAUSE_HEADS:
        return tags
    out: list[Tag] = []
    for i, tag_ in enumerate(tags):
        out.append(tag_)
        spread = (
            tag_.type == "NOUN" and tag_.word.start == tags[last].word.start
        )  # it was said once
        if spread and i < last and tags[i + 1].type == "OR":
            out += clause
    return out


def _lacking(tags: list[Tag]) -> list[Tag]:
    """Say last what the things asked for are without: cups but no bowls on the table."""
    at = next((i for i, t in enumerate(tags) if t.type == "LACKS"), 0)
    if not at:
        return tags
    end = next(i + 1 for i in range(at, len(tags)) if tags[i].type == "NOUN")
    lacks = Tag("THAT_NOT_REL", "together", tags[at].word)
    return [*tags[:at], *tags[end:], lacks, *tags[at + 1 : end]]


def _carried(tags: list[Tag]) -> list[Tag]:
    """Say of what is on a thing where it is: a bed with a teddy on it is a teddy on a bed."""
    at = next((i for i, t in enumerate(tags) if t.type == "CARRIES"), 0)
    if not at:
        return tags
    link = next(i for i, t in enumerate(tags) if t.type == "REL")
    first = link
    while first and tags[first - 1].type in _NOUN_PHRASE:
        first -= 1
    carries = Tag("REL", tags[at].value, tags[at].word)
    return [*tags[:first], *tags[link + 1 : at], carries, *tags[first:link], *tags[at + 1 :]]


def _either_look(tags: list[Tag]) -> list[Tag]:
    """Tell looks of which one must hold: a cup that is red or blue, which cups are red or blue."""
    for i in range(1, len(tags) - 1):
        if [t.type for t in tags[i - 1 : i + 2]] != ["ATTR", "OR", "ATTR"]:
            continue
        first = i - 1
        while tags[first - 1].type in ("ATTR", "OR", "OR_LOOK"):
            first -= 1
        led = tags[first - 1]
        if led.type == "NOUN" and isinstance(led.value, Noun) and led.value.category == ANYTHING:
            led = Tag("_THAT_IS", 0, led.word)  # something red or blue
            tags, i = [*tags[:first], led, *tags[first:]], i + 1
        ends = all(t.type in ("ATTR", "OR", "OR_LOOK") for t in tags[first:])
        if led.type == "BE" and ends and tags[0].type in ("_WHICH", "_HOWMANY"):
            far = any(t.type == "REL" for t in tags)
            tags = [*tags[: first - 1], Tag("_THAT_IS", far, led.word), *tags[first:]]
        elif led.type != "_THAT_IS":
            continue
        tags = [*tags[:i], replace(tags[i], type="OR_LOOK"), *tags[i + 1 :]]
    return tags


def _owners_first(tags: list[Tag]) -> list[Tag]:
    """Say whose they are before how many: exactly two of anna's cups."""
    for i in range(len(tags) - 1):
        if tags[i].type == "NUMBER" and tags[i + 1].type in ("OWNER", "DET"):
            first = i - (i > 0 and tags[i - 1].type in ("_MOST", "_EXACTLY"))
            tags = [*tags[:first], tags[i + 1], *tags[first : i + 1], *tags[i + 2 :]]
    return tags


def _extraposed(tags: list[Tag]) -> list[Tag]:
    """Put a clause said of what is asked for after it: `what is on the table that is not red`."""
    at = next((i for i, t in enumerate(tags) if t.type in _CLAUSES and t.value is True), 0)
    if not at:
        return tags
    end = at + 1
    while end < len(tags) and tags[end].type in ("ATTR", "OWNED", "OR_LOOK", *_CLAUSES):
        end += 1
    clause, rest = tags[at:end], [*tags[:at], *tags[end:]]
    relation = next((i for i, t in enumerate(rest) if t.type == "REL"), len(rest))
    named = any(t.type in ("NOUN", "ONE") for t in rest[:relation])
    if rest[0].type == "_WHAT" and not named:
        thing = Tag("NOUN", Noun(ANYTHING, "thing", known=True), rest[0].word)
        return [Tag("_WHICH", rest[0].value, rest[0].word), thing, *clause, *rest[1:]]
    figure = next(i for i, t in enumerate(rest) if t.type in ("NOUN", "ONE"))
    return [*rest[: figure + 1], *clause, *rest[figure + 1 :]]


_CLAUSES = ("_THAT_IS", "_THAT_IS_NOT", "_NOT_MADE_OF")
_CLAUSE_HEADS = (*_CLAUSES, "_MADE_OF", "_WITH_PART", "_WITHOUT_PART")
_CLAUSE_PARTS = ("ATTR", "DET", "PART", "OWNED")


def _excepted(tags: list[Tag]) -> list[Tag]:
    """Let what is excepted be of the things asked for: `what is on it but the cup and the bowl`.

    So where anything is asked for; of a certain thing it says which one, of its ground or of it.
    """
    at = next((i for i, t in enumerate(tags) if t.type == "_EXCEPT"), 0)
    end = _except_end(tags, at)
    if at and tags[end - 1].type != "NOUN":
        return _one_excepted(tags, at)
    if not at:
        return tags
    joints = ("AND", "OR")
    others = [Tag("_EXCEPT", 0, t.word) if t.type in joints else t for t in tags[at:end]]
    before, after = tags[:at], tags[end:]
    figure = next((i for i, t in enumerate(before) if t.type in ("NOUN", "ONE")), None)
    asked = before[1:2] and before[1].type in ("BE", "AUX")
    bare = before[0].type == "_WHAT" and not (asked and tags[2].type in ("NOUN", "DET"))
    if bare:
        others = [replace(t, type="_BUT") if t.type == "_EXCEPT" else t for t in others]
        return [*before, *after, *others]
    noun = before[figure].value if figure is not None else None
    if figure is None or not (isinstance(noun, Noun) and noun.category == ANYTHING):
        return tags
    return [*before[: figure + 1], *others, *before[figure + 1 :], *after]


def _one_excepted(tags: list[Tag], at: int) -> list[Tag]:
    """Let one that is excepted be of the things asked for: cups on it besides the red one."""
    end = at + 1
    while end < len(tags) and tags[end].type in ("DET", "OWNER", "ATTR", "ONE"):
        end += 1
    figure = next((i for i, t in enumerate(tags) if t.type in ("NOUN", "ONE")), at)
    placed = any(t.type in _PLACING for t in tags[figure:at])
    if not placed or end < len(tags):
        return tags
    return [*tags[: figure + 1], *tags[at:end], *tags[figure + 1 : at]]


def _except_end(tags: list[Tag], at: int) -> int:
    """Return the tag after all that is excepted at `at`: other than the cup and my bowl."""
    end = last = at + 1
    while end < len(tags) and tags[end].type in _LISTED:
        end += 1
        last = end if tags[end - 1].type == "NOUN" else last
    return last


_LISTED = ("DET", "OWNER", "ATTR", "NOUN", "AND", "OR", "_EXCEPT")


def _fronted(tags: list[Tag]) -> list[Tag]:
    """Put a place that is said first last: `in the hall were the keys on the hook`."""
    if not tags or tags[0].type not in ("AT_PLACE", "REL"):
        return tags
    asks = (i for i, t in enumerate(tags) if t.type in ("BE", "AUX") or t.type[0] == "_")
    first = next(asks, 0)
    front = [t for t in tags[:first] if t.type != "COMMA"]
    return [*tags[first:], *front]


def _inverted(tags: list[Tag]) -> list[Tag]:
    """Put a place said between `is` and its thing last: `is in the kitchen a knife`."""
    kinds = [t.type for t in tags]
    first = 1 + (kinds[1:2] == ["THERE"])
    if kinds[:1] != ["BE"] or kinds[first : first + 1] not in (["AT_PLACE"], ["REL"], ["HERE"]):
        return tags
    end = first + 1
    if kinds[first] == "REL":
        end = next((i + 1 for i in range(end, len(kinds)) if kinds[i] in ("NOUN", "ONE")), end)
    if kinds[end : end + 1] not in (["DET"], ["NUMBER"], ["OWNER"]):
        return tags
    return [*tags[:first], *tags[end:], *tags[first:end]]


def _commas(tags: list[Tag]) -> list[Tag]:
    """Make a comma between nouns of a list an `and`, and drop any other."""
    out: list[Tag] = []
    for i, tag_ in enumerate(tags):
        if tag_.type != "COMMA":
            out.append(tag_)
            continue
        before = out[-1].type if out else ""
        after = tags[i + 1].type if i + 1 < len(tags) else ""
        listed = any(t.type in ("AND", "OR") for t in tags[i + 1 :])
        if (
            before in ("NOUN", "ONE")
            and after in ("NOUN", "DET", "OWNER", "ATTR", "NUMBER")
            and listed
        ):
            out.append(Tag("AND", ",", tag_.word))
    return out


_NOUN_PHRASE = ("DET", "OWNER", "NUMBER", "ATTR", "NOUN")
_PLACING = ("REL", "THAT_NOT_REL")


def _supports(joint: Tag, after: list[Tag], before: list[Tag]) -> bool:
    """Whether a thing is said to lie on one thing and on another: each is asked for alone.

    Near both is one place; on the table and on the chair, or on the table and the chair, are two.
    """
    kinds = [t.value for t in before if t.type in _PLACING]
    following = after[0] if after else joint
    if following.type == "REL":
        return following.value in _SUPPORTS and following.value in kinds
    if not kinds or kinds[-1] not in _SUPPORTS:
        return False
    return following.type in _NOUN_PHRASE and before[-1].type in ("NOUN", "ONE")


def _joined_attributes(tags: list[Tag]) -> list[Tag]:
    """Drop `and` between attributes, before a relation, and after another `and`."""
    out: list[Tag] = []
    for i, tag_ in enumerate(tags):
        before = out[-1].type if out else ""
        after = tags[i + 1].type if i + 1 < len(tags) else ""
        if tag_.type == "AND" and _supports(tag_, tags[i + 1 :], out):
            two = after not in _PLACING and any(t.type in _PLACING for t in tags[i + 1 :])
            tag_ = Tag("UNKNOWN" if two else "OR", "and", tag_.word)  # it on a and that on b
        if tag_.type == "AND":
            attributes = before == "ATTR" and after == "ATTR"
            ground = after in (
                "REL",
                "AT_PLACE",
                "NOT_AT_PLACE",
                "SIDE_BY_SIDE",
                "THAT_NOT_REL",
                "_WITH_PART",
                "_MADE_OF",
                "_NOT_MADE_OF",
                "_THAT_IS",
                "_THAT_IS_NOT",
                "_WITHOUT_PART",
                "_EXCEPT",
                "",
            )
            if after in _PLACING and any(t.type in _PLACING for t in out):
                out.append(Tag("AND_ITEM", "and", tag_.word))
                continue
            if attributes or ground or before in ("AND", ""):
                continue
        denied = any(t.type == "_THAT_IS_NOT" for t in out)
        if tag_.type == "OR" and denied and (before, after) == ("ATTR", "ATTR"):
            continue  # that is neither red nor white
        if tag_.type == "OR" and after in ("REL", "AT_PLACE"):
            tag_ = Tag("OR_ITEM", tag_.value, tag_.word)
        out.append(tag_)
    return out


def _owned_alike(tags: list[Tag]) -> list[Tag]:
    """Give a thing after `and` or `or` the owner of the one before it: anna's shoes and bag."""
    if all(t.type != "OWNER" for t in tags):
        return tags
    out: list[Tag] = []
    owner: Tag | None = None
    for i, tag_ in enumerate(tags):
        if tag_.type not in ("OWNER", "ATTR", "NOUN", "AND", "OR"):
            owner = None
        elif tag_.type == "OWNER":
            owner = tag_
        bare = i > 0 and tags[i - 1].type in ("AND", "OR") and tag_.type in ("ATTR", "NOUN")
        if bare and owner is not None:
            out.append(Tag("OWNER", owner.value, tag_.word))
        out.append(tag_)
    return out


def _things_described(tags: list[Tag]) -> list[Tag]:
    """Put attributes before their noun in `something red`."""
    out: list[Tag] = []
    for tag_ in tags:
        noun = out[-1] if out else None
        if (
            tag_.type == "ATTR"
            and noun is not None
            and noun.type == "NOUN"
            and isinstance(noun.value, Noun)
            and noun.value.category == "object"
        ):
            out.insert(len(out) - 1, tag_)
            continue
        out.append(tag_)
    return out


def _predicates(tags: list[Tag]) -> list[Tag]:
    """Tell the attribute that is said of a noun: `is the cup red`."""
    out: list[Tag] = []
    placed = bool(tags) and tags[0].type in ("_WHERE", "_SEEK")
    for i, tag_ in enumerate(tags):
        if tag_.type == "ATTR" and isinstance(tag_.value, Attribute):
            rest = tags[i:]
            ends = all(t.type == "ATTR" for t in rest)
            follows = i > 0 and out[-1].type in ("NOUN", "ONE", "PREDICATE", "BE", "AUX")
            if ends and follows:
                kind = "PREDICATE" if tag_.value.kind in PREDICATES else "STATE"
                if placed and kind == "STATE":
                    continue  # where is the star drawn: what became of it is no place
                out.append(Tag(kind, tag_.value, tag_.word))
                continue
        out.append(tag_)
    return out


_SETTLING: tuple[tuple[Callable[[list[Tag]], list[Tag]], tuple[str, ...]], ...] = (
    (_owners_first, ("NUMBER",)),
    (_ones, ("ONE",)),
    (_lacking, ("LACKS",)),
    (_carried, ("CARRIES",)),
    (_said_of_all, ("OR",)),
    (_either_look, ("OR",)),
    (_fronted, ("AT_PLACE", "REL")),
    (_commas, ("COMMA",)),
    (_joined_attributes, ("AND", "OR")),
    (_owned_alike, ("OWNER",)),
    (_things_described, ("ATTR",)),
    (_inverted, ("AT_PLACE", "REL", "HERE")),
    (_extraposed, (*_CLAUSES, "OR")),
    (_predicates, ("ATTR",)),
    (_excepted, ("_EXCEPT",)),
)
"""What settles terminals, in this order, and one of which terminals it needs to do anything."""
