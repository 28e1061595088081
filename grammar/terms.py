"""The rules of question.lark below the question: verbs, objects and what is said of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from grammar.alternatives import either_of
from grammar.forms import ANYTHING, Bound, ObjectTerm, RelationKind
from grammar.lalr import Token
from grammar.meaning import (
    AtPlace,
    Choice,
    Group,
    Here,
    Item,
    MeaningError,
    Outside,
    Related,
    SideBySide,
    Things,
)
from grammar.nouns import Attribute, Noun, Pattern


@dataclass(frozen=True, slots=True)
class Change:
    """What one word or phrase adds to an object."""

    attributes: tuple[str, ...] = ()
    without: tuple[str, ...] = ()
    owner: str | None = None
    quantity: int | None = None
    bound: Bound = "least"
    not_owner: str | None = None
    other_than: tuple[ObjectTerm, ...] = ()
    either: tuple[tuple[str, ...], ...] = ()


@dataclass(frozen=True, slots=True)
class Act:
    """A verb of seeing or leaving. kind: SEE, LEAVE or FINDS."""

    kind: str


@dataclass(frozen=True, slots=True)
class Aux:
    """An auxiliary: present, past, do, did, have or can."""

    value: str


@dataclass(frozen=True, slots=True)
class Passive:
    """A verb that the things themselves have: seen, gone; and where."""

    items: tuple[Item, ...] = ()


def items_of(words: tuple[Any, ...]) -> tuple[Item, ...]:
    """Return the items of the tails among `words`."""
    tails = (w.items if isinstance(w, Passive) else w for w in words)
    return tuple(item for tail in tails if isinstance(tail, tuple) for item in tail)


class Terms:
    """question.lark from `things` down; each method bears its rule's name."""

    # -- verbs ------------------------------------------------------------------------------------

    def aux(self, token: Token) -> Aux:
        """aux: BE | AUX."""
        return Aux(str(token.value))

    def act(self, token: Token) -> Act:
        """act: SEE | LEAVE | FINDS."""
        return Act(token.type)

    def passive(self, *words: Any) -> Passive:
        """passive: act tail? | GO tail?."""
        return Passive(items_of(words))

    # -- things -----------------------------------------------------------------------------------

    def things(self, group: Group, *items: Any) -> Things:
        """things: group (_joint? item)*."""
        return Things(group, _joined(items))

    def tail(self, *items: Any) -> tuple[Item, ...]:
        """tail: item (_joint? item)*."""
        return _joined(items)

    def related(self, link: tuple[RelationKind, bool], group: Group) -> Related:
        """item: link group."""
        kind, negated = link
        return Related(kind, group, negated)

    def link(self, token: Token) -> tuple[RelationKind, bool]:
        """link: REL."""
        return (token.value, False)

    def link_not(self, token: Token) -> tuple[RelationKind, bool]:
        """link: THAT_NOT_REL."""
        return (token.value, True)

    def at_place(self, token: Token) -> AtPlace:
        """item: AT_PLACE."""
        return AtPlace(str(token.value))

    def outside(self, token: Token) -> Outside:
        """item: NOT_AT_PLACE."""
        return Outside(str(token.value))

    def here(self, _token: Token) -> Here:
        """item: HERE."""
        return Here()

    def side_by_side(self, token: Token) -> SideBySide:
        """item: SIDE_BY_SIDE."""
        return SideBySide("same_place" if token.value == "same_place" else "together")

    def group(self, *words: Any) -> Group:
        """group: thing (AND thing | OR thing)*."""
        terms = tuple(w for w in words if isinstance(w, ObjectTerm))
        joints = [w for w in words if isinstance(w, Token)]
        either = [n for n, w in enumerate(joints) if w.type == "OR" and w.value != "and"]
        if 0 < len(either) < len(joints):  # a red or blue cup and a bowl
            terms, joints = _looks_joined(terms, joints, either)
        choice = any(w.type == "OR" for w in joints)
        return Group(terms, choice, apart=any(w.value == "and" for w in joints))

    def thing(self, *words: Any) -> ObjectTerm:
        """thing: DET? OWNER? pre* head post*."""
        return self.term(next(w for w in words if isinstance(w, Noun)), words)

    def term(self, noun: Noun, words: tuple[Any, ...]) -> ObjectTerm:
        """Return the object of a noun with all that the words around it say."""
        changes = [w for w in words if isinstance(w, Change)]
        owner = next(
            (str(w.value) for w in words if isinstance(w, Token) and w.type == "OWNER"), None
        )
        owners = [c.owner for c in changes if c.owner]
        counted = next((c for c in changes if c.quantity is not None), None)
        lacking = next((c.not_owner for c in changes if c.not_owner), None)
        base = noun.term or ObjectTerm(noun.category, noun.said)
        others = tuple(other for c in changes for other in c.other_than)
        if any(other == ObjectTerm(base.category, other.word) for other in others):
            raise MeaningError("it leaves out what it asks for", state=False)
        found = ObjectTerm(
            category=base.category,
            word=base.word,
            attributes=(*base.attributes, *(a for c in changes for a in c.attributes)),
            without=(*base.without, *(a for c in changes for a in c.without)),
            owner=owners[0] if owners else owner or base.owner,
            quantity=counted.quantity if counted else base.quantity,
            where=base.where,
            bound=counted.bound if counted else base.bound,
            not_owner=lacking or base.not_owner,
            or_else=base.or_else,
            other_than=(*base.other_than, *others),
        )
        either = next((c.either for c in changes if c.either), ())
        return _looking_either(found, either) if either else found

    def quantity(self, token: Token) -> Change:
        """pre: NUMBER."""
        return Change(quantity=token.value)

    def at_most(self, token: Token) -> Change:
        """pre: _MOST NUMBER."""
        return Change(quantity=token.value, bound="most")

    def exactly(self, token: Token) -> Change:
        """pre: _EXACTLY NUMBER."""
        return Change(quantity=token.value, bound="exactly")

    def attribute(self, token: Token) -> Change:
        """pre: ATTR."""
        return Change(attributes=(_said(token),))

    def lacking(self, token: Token) -> Change:
        """pre: NOT_ATTR."""
        return Change(without=(_said(token),))

    def head(self, token: Token) -> Noun:
        """head: NOUN | ONE."""
        value = token.value
        return value if isinstance(value, Noun) else Noun(ANYTHING, "thing", known=False)

    def having(self, *tokens: Token) -> Change:
        """post: _THAT_IS ATTR+."""
        return Change(attributes=tuple(_said(t) for t in tokens))

    def having_either(self, *tokens: Token) -> Change:
        """post: _THAT_IS ATTR+ (OR_LOOK ATTR+)+."""
        looks: list[tuple[str, ...]] = [()]
        for token in tokens:
            if token.type == "OR_LOOK":
                looks.append(())
            else:
                looks[-1] = (*looks[-1], _said(token))
        return Change(either=tuple(looks))

    def lacking_all(self, *tokens: Token) -> Change:
        """post: _THAT_IS_NOT ATTR+."""
        return Change(without=tuple(_said(t) for t in tokens))

    def with_part(self, *tokens: Token) -> Change:
        """post: _WITH_PART DET? ATTR* PART."""
        return Change(attributes=_part(tokens))

    def without_part(self, *tokens: Token) -> Change:
        """post: _WITHOUT_PART DET? ATTR* PART."""
        return Change(without=_part(tokens))

    def except_attribute(self, *tokens: Token) -> Change:
        """post: _EXCEPT DET? OWNER? ATTR+ ONE?."""
        return Change(without=tuple(_said(t) for t in tokens if t.type == "ATTR"))

    def except_noun(self, *tokens: Token) -> Change:
        """post: _EXCEPT DET? OWNER? ATTR* NOUN."""
        looks = tuple(_said(token) for token in tokens if token.type == "ATTR")
        owner = next((str(token.value) for token in tokens if token.type == "OWNER"), None)
        noun: Any = tokens[-1].value
        return Change(other_than=(ObjectTerm(noun.category, noun.said, looks, owner=owner),))

    def owned(self, token: Token) -> Change:
        """post: _THAT_IS? OWNED."""
        return Change(owner=str(token.value))

    def not_owned(self, *tokens: Token) -> Change:
        """post: _THAT_IS_NOT OWNED | _EXCEPT OWNER ONE?."""
        return Change(not_owner=str(tokens[0].value))


def _looks_joined(
    terms: tuple[ObjectTerm, ...], joints: list[Token], either: list[int]
) -> tuple[tuple[ObjectTerm, ...], list[Token]]:
    """Return terms and joints with what differs in its looks alone as one thing of either look."""
    joined = [terms[0]]
    left: list[Token] = []
    for n, term in enumerate(terms[1:]):
        one = either_of((joined[-1], term), looks_alone=True) if n in either else None
        if one is None:
            left.append(joints[n])
            joined.append(term)
        else:
            joined[-1] = one
    return tuple(joined), left


def _looking_either(term: ObjectTerm, either: tuple[tuple[str, ...], ...]) -> ObjectTerm:
    """Return a thing that has one of several looks beside its own."""
    if term.or_else:
        raise MeaningError("it says too much about one thing", state=False)
    first, *others = (replace(term, attributes=(*term.attributes, *look)) for look in either)
    plain = (
        replace(other, quantity=None, bound="least", where=None, other_than=()) for other in others
    )
    return replace(first, or_else=tuple(plain))


def _part(tokens: tuple[Token, ...]) -> tuple[str, ...]:
    """Return `red`, `striped` for red stripes, but `white shade` for a part with its own look."""
    words = tuple(_said(t) for t in tokens if t.type != "DET")
    return words if isinstance(tokens[-1].value, Pattern) else (" ".join(words),)


def _joined(words: tuple[Any, ...]) -> tuple[Item, ...]:
    """Return the items: two that `or` joins become one Choice; `and` says more of what is asked."""
    found: list[Item] = []
    joint = said = ""
    for word in words:
        if isinstance(word, Token):
            joint, said = word.type, str(word.value)
            continue
        if joint == "OR_ITEM" and found:
            before = found.pop()
            choice = before if isinstance(before, Choice) else Choice((before,))
            word = Choice((*choice.options, word), choice.apart or said == "and")
        elif joint == "AND_ITEM" and isinstance(word, Related):
            word = replace(word, of_figure=True)
        found.append(word)
        joint = ""
    return tuple(found)


def _said(token: Token) -> str:
    """Return the word of an attribute or of a part."""
    value: Any = token.value
    return value.said if isinstance(value, Attribute) else str(value)
