"""The rules of question.lark as meanings; each method bears its rule's name and keeps no state."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from lark import Token, Transformer, v_args

from grammar.forms import ANYTHING, ObjectTerm, RelationKind
from grammar.meaning import (
    AtPlace,
    Choice,
    Group,
    Here,
    Item,
    Meaning,
    MeaningError,
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


def _happened(words: tuple[Any, ...]) -> None:
    """Refuse `did the parcel arrive`: with did, things need a verb of being somewhere."""
    if _aux(words) in ("do", "did") and not any(isinstance(w, Passive) for w in words):
        raise MeaningError("it asks what a thing does")


def _things(words: tuple[Any, ...]) -> Things:
    """Return the one Things among `words`, with the items of a tail added."""
    found = next((w for w in words if isinstance(w, Things)), Things())
    return found.with_items(_items(words))


def _items(words: tuple[Any, ...]) -> tuple[Item, ...]:
    tails = (w.items if isinstance(w, Passive) else w for w in words)
    return tuple(item for tail in tails if isinstance(tail, tuple) for item in tail)


def _aux(words: tuple[Any, ...]) -> str:
    return next((w.value for w in words if isinstance(w, Aux)), "")


def _acts(words: tuple[Any, ...]) -> str:
    return next((w.kind for w in words if isinstance(w, Act)), "")


def _predicates(words: tuple[Any, ...]) -> tuple[str, ...]:
    return tuple(
        w.value.said for w in words if isinstance(w, Token) and isinstance(w.value, Attribute)
    )


def _described(things: Things, attributes: tuple[str, ...]) -> Things:
    """Return the things with `attributes` added to each object."""
    if things.group is None:
        return things
    terms = tuple(
        ObjectTerm(
            t.category,
            t.word,
            (*t.attributes, *attributes),
            t.without,
            t.owner,
            t.quantity,
            t.where,
        )
        for t in things.group.terms
    )
    return Things(Group(terms, things.group.choice), things.items)


@v_args(inline=True)
class Meanings(Transformer[Token, Any]):
    """question.lark -> Meaning."""

    def start(self, meaning: Meaning) -> Meaning:
        """start: question."""
        return meaning

    # -- fragments -------------------------------------------------------------------------------

    def only_things(self, things: Things) -> Meaning:
        """fragment: things."""
        return Meaning(None, things)

    def only_tail(self, items: tuple[Item, ...]) -> Meaning:
        """fragment: tail."""
        return Meaning(None, Things(None, items))

    def only_changes(self, *words: Any) -> Meaning:
        """fragment: DET? OWNER? pre+ | DET? OWNER | DET? OWNER? post."""
        nothing = Noun(ANYTHING, "thing", known=False)
        return Meaning(None, Things(Group((self._term(nothing, words),))))

    def asking_where(self) -> Meaning:
        """fragment: _WHERE."""
        return Meaning("where")

    def asking_when(self) -> Meaning:
        """fragment: _WHEN."""
        return Meaning("when")

    def asking_count(self) -> Meaning:
        """fragment: _HOWMANY."""
        return Meaning("count")

    def asking_how_long(self) -> Meaning:
        """fragment: _HOWLONG."""
        return Meaning("how_long")

    def asking_how_often(self) -> Meaning:
        """fragment: _HOWOFTEN."""
        return Meaning("how_often")

    # -- where, when ---------------------------------------------------------------------------

    def where_act(self, *words: Any) -> Meaning:
        """where: _WHERE aux WHO act things."""
        newest = _acts(words) != "SEE" or _aux(words) == "can"
        return Meaning("where", _things(words), newest=newest)

    def where_is(self, *words: Any) -> Meaning:
        """where: _WHERE aux things passive?."""
        _happened(words)
        return Meaning("where", _things(words), newest=_aux(words) != "past")

    def where_within(self, place: Token, *words: Any) -> Meaning:
        """where: _WHERE AT_PLACE aux things passive?."""
        meaning: Meaning = self.where_is(*words)
        return replace(meaning, things=meaning.things.with_items((AtPlace(str(place.value)),)))

    def when_act(self, *words: Any) -> Meaning:
        """when: _WHEN aux WHO act things."""
        return Meaning("when", _things(words))

    def when_is(self, *words: Any) -> Meaning:
        """when: _WHEN aux things passive?."""
        _happened(words)
        return Meaning("when", _things(words))

    def moved_when(self, *words: Any) -> Meaning:
        """when: _WHEN aux things MOVED tail?."""
        return Meaning("moved", _things(words))

    # -- whether ---------------------------------------------------------------------------------

    def whether_act(self, *words: Any) -> Meaning:
        """whether: aux WHO act things."""
        act = _acts(words)
        if act == "FINDS" and _aux(words) == "can":
            return Meaning("where", _things(words), newest=True)
        return Meaning("whether", _things(words))

    def whether_in(self, _aux: Aux, place: Token, _have: Token, things: Things) -> Meaning:
        """whether: aux AT_PLACE HAVE things."""
        return Meaning("whether", things.with_items((AtPlace(str(place.value)),)))

    def count_in(self, things: Things, _aux: Aux, place: Token, _have: Token) -> Meaning:
        """count: _HOWMANY things aux AT_PLACE HAVE."""
        return Meaning("count", things.with_items((AtPlace(str(place.value)),)))

    def whether_there(self, *words: Any) -> Meaning:
        """whether: aux THERE things."""
        return Meaning("whether", _things(words))

    def whether_is(self, *words: Any) -> Meaning:
        """whether: aux things."""
        things = _things(words)
        if _aux(words) in ("did", "do", "can", "have"):
            raise MeaningError("it asks what a thing does")
        if not things.items:
            raise MeaningError("it does not say where or in what relation")
        return Meaning("whether", things)

    def whether_tail(self, *words: Any) -> Meaning:
        """whether: _WHETHER things aux tail."""
        return Meaning("whether", _things(words))

    def whether_attribute(self, *words: Any) -> Meaning:
        """whether: aux things PREDICATE+."""
        return Meaning("whether", _described(_things(words), _predicates(words)))

    # -- what, which -----------------------------------------------------------------------------

    def what_tail(self, *words: Any) -> Meaning:
        """what: _WHAT aux tail."""
        things = _things(words)
        if all(isinstance(item, SideBySide) for item in things.items):
            raise MeaningError("it names no thing")
        return Meaning("what", things)

    def what_passive(self, *words: Any) -> Meaning:
        """what: _WHAT aux passive."""
        return Meaning("what", _things(words))

    def what_is(self, *words: Any) -> Meaning:
        """what: _WHAT aux things."""
        things = _things(words)
        if not any(isinstance(item, Related | AtPlace) for item in things.items):
            raise MeaningError("it asks what a thing is")
        return Meaning("what", things)

    def what_act(self, *words: Any) -> Meaning:
        """what: _WHAT aux WHO act tail?."""
        return Meaning("what", _things(words))

    def shown(self, *words: Any) -> Meaning:
        """what: _SHOW things."""
        return Meaning("what", _things(words))

    def which_tail(self, *words: Any) -> Meaning:
        """which: _WHICH things aux tail."""
        return Meaning("what", _things(words))

    def which_act(self, *words: Any) -> Meaning:
        """which: _WHICH things aux WHO act tail?."""
        return Meaning("what", _things(words))

    def which_attribute(self, *words: Any) -> Meaning:
        """which: _WHICH things aux PREDICATE+."""
        return Meaning("what", _described(_things(words), _predicates(words)))

    # -- how many, how long, how often -------------------------------------------------------------

    def count(self, *words: Any) -> Meaning:
        """count: _HOWMANY things."""
        return Meaning("count", _things(words))

    def count_tail(self, *words: Any) -> Meaning:
        """count: _HOWMANY things aux THERE? tail?."""
        return Meaning("count", _things(words))

    def count_act(self, *words: Any) -> Meaning:
        """count: _HOWMANY things aux WHO act? tail?."""
        return Meaning("count", _things(words))

    def count_attribute(self, *words: Any) -> Meaning:
        """count: _HOWMANY things aux PREDICATE+."""
        return Meaning("count", _described(_things(words), _predicates(words)))

    def how_long(self, *words: Any) -> Meaning:
        """lasting: _HOWLONG aux things passive?."""
        things = _things(words)
        if not things.items and not _acts(words) and _aux(words) in ("present", "past"):
            raise MeaningError("it asks for a size")
        return Meaning("how_long", things)

    def how_long_act(self, *words: Any) -> Meaning:
        """lasting: _HOWLONG aux WHO act things."""
        return Meaning("how_long", _things(words))

    def how_often(self, *words: Any) -> Meaning:
        """often: _HOWOFTEN aux things passive?."""
        _happened(words)
        return Meaning("how_often", _things(words))

    def how_often_act(self, *words: Any) -> Meaning:
        """often: _HOWOFTEN aux WHO act things."""
        return Meaning("how_often", _things(words))

    # -- moved, missing, said -------------------------------------------------------------------

    def what_moved(self, *words: Any) -> Meaning:
        """moved: _WHAT aux? MOVED tail?."""
        return Meaning("moved", _things(words))

    def things_moved(self, *words: Any) -> Meaning:
        """moved: aux things MOVED tail?."""
        return Meaning("moved", _things(words))

    def what_missing(self, *words: Any) -> Meaning:
        """missing: _WHAT aux MISSING tail?."""
        return Meaning("missing", _things(words))

    def things_missing(self, *words: Any) -> Meaning:
        """missing: aux things MISSING tail?."""
        return Meaning("missing", _things(words))

    def anything_missing(self, *words: Any) -> Meaning:
        """missing: aux passive."""
        raise MeaningError("it names no thing", state=False)

    def lost(self, *words: Any) -> Meaning:
        """said: things aux? MISSING tail?."""
        return Meaning("where", _things(words), newest=True)

    def short(self, things: Things) -> Meaning:
        """said: things."""
        return Meaning("where", things, newest=True)

    def told(self, *words: Any) -> Meaning:
        """said: WHO aux? act things."""
        seen = isinstance(words[0], Token) and words[0].value in ("you", "u", "ya")
        return Meaning("whether" if seen else "where", _things(words), newest=True)

    # -- verbs ------------------------------------------------------------------------------------

    def aux(self, token: Token) -> Aux:
        """aux: BE | AUX."""
        return Aux(str(token.value))

    def act(self, token: Token) -> Act:
        """act: SEE | LEAVE | FINDS."""
        return Act(token.type)

    def passive(self, *words: Any) -> Passive:
        """passive: act tail? | GO tail?."""
        return Passive(_items(words))

    # -- things -----------------------------------------------------------------------------------

    def things(self, group: Group, *items: Any) -> Things:
        """things: group (OR_ITEM? item)*."""
        return Things(group, _or_items(items))

    def tail(self, *items: Any) -> tuple[Item, ...]:
        """tail: item (OR_ITEM? item)*."""
        return _or_items(items)

    def related(self, link: tuple[RelationKind, bool], group: Group) -> Related:
        """item: link group."""
        kind, negated = link
        return Related(kind, group, negated)

    def link(self, token: Token) -> tuple[RelationKind, bool]:
        """link: REL."""
        return (token.value, False)  # type: ignore[return-value]

    def link_not(self, token: Token) -> tuple[RelationKind, bool]:
        """link: THAT_NOT_REL."""
        return (token.value, True)  # type: ignore[return-value]

    def at_place(self, token: Token) -> AtPlace:
        """item: AT_PLACE."""
        return AtPlace(str(token.value))

    def here(self, _token: Token) -> Here:
        """item: HERE."""
        return Here()

    def side_by_side(self, token: Token) -> SideBySide:
        """item: SIDE_BY_SIDE."""
        return SideBySide("same_place" if token.value == "same_place" else "together")

    def group(self, *words: Any) -> Group:
        """group: thing (AND thing | OR thing)*."""
        terms = tuple(w for w in words if isinstance(w, ObjectTerm))
        return Group(terms, any(isinstance(w, Token) and w.type == "OR" for w in words))

    def thing(self, *words: Any) -> ObjectTerm:
        """thing: DET? OWNER? pre* head post*."""
        return self._term(next(w for w in words if isinstance(w, Noun)), words)

    def _term(self, noun: Noun, words: tuple[Any, ...]) -> ObjectTerm:
        """Return the object of a noun with all that the words around it say."""
        changes = [w for w in words if isinstance(w, Change)]
        owner = next(
            (str(w.value) for w in words if isinstance(w, Token) and w.type == "OWNER"), None
        )
        owners = [c.owner for c in changes if c.owner]
        quantities = [c.quantity for c in changes if c.quantity is not None]
        base = noun.term or ObjectTerm(noun.category, noun.said)
        return ObjectTerm(
            category=base.category,
            word=base.word,
            attributes=(*base.attributes, *(a for c in changes for a in c.attributes)),
            without=(*base.without, *(a for c in changes for a in c.without)),
            owner=owners[0] if owners else owner or base.owner,
            quantity=quantities[0] if quantities else base.quantity,
            where=base.where,
        )

    def quantity(self, token: Token) -> Change:
        """pre: NUMBER."""
        return Change(quantity=token.value)  # type: ignore[arg-type]

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
        noun: Any = tokens[-1].value
        return Change(without=(noun.said,))

    def owned(self, token: Token) -> Change:
        """post: OWNED."""
        return Change(owner=str(token.value))


def _part(tokens: tuple[Token, ...]) -> tuple[str, ...]:
    """Return `red`, `striped` for red stripes, but `white shade` for a part that has its own look."""
    words = tuple(_said(t) for t in tokens if t.type != "DET")
    return words if isinstance(tokens[-1].value, Pattern) else (" ".join(words),)


def _or_items(words: tuple[Any, ...]) -> tuple[Item, ...]:
    """Return the items; two that `or` joins become one Choice of both."""
    found: list[Item] = []
    either = False
    for word in words:
        if isinstance(word, Token):
            either = True
        elif either and found:
            before = found.pop()
            options = before.options if isinstance(before, Choice) else (before,)
            found.append(Choice((*options, word)))
            either = False
        else:
            found.append(word)
    return tuple(found)


def _said(token: Token) -> str:
    """Return the word of an attribute or of a part."""
    value: Any = token.value
    return value.said if isinstance(value, Attribute) else str(value)
