"""The rules of question.lark as meanings; each method bears its rule's name and keeps no state."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from grammar.forms import ANYTHING
from grammar.lalr import Token
from grammar.meaning import (
    THING,
    AtPlace,
    Group,
    Here,
    Item,
    Meaning,
    MeaningError,
    Related,
    SideBySide,
    Things,
)
from grammar.nouns import Attribute, Noun, Whose
from grammar.terms import Act, Aux, Change, Passive, Terms, items_of


def _happened(words: tuple[Any, ...]) -> None:
    """Refuse `did the parcel arrive`: with did, things need a verb of being somewhere."""
    if _aux(words) in ("do", "did") and not any(isinstance(w, Passive) for w in words):
        raise MeaningError("it asks what a thing does")


def _things(words: tuple[Any, ...]) -> Things:
    """Return the one Things among `words`, with the items of a tail added."""
    found = next((w for w in words if isinstance(w, Things)), Things())
    return found.with_items(items_of(words))


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
    terms = tuple(replace(t, attributes=(*t.attributes, *attributes)) for t in things.group.terms)
    return replace(things, group=replace(things.group, terms=terms))


def _owned(words: tuple[Any, ...]) -> Things:
    """Return the things among `words` as those whose they are said to be, or not to be."""
    things = _things(words)
    whose = next(w.value for w in words if isinstance(w, Token) and isinstance(w.value, Whose))
    if things.group is None:
        raise MeaningError("it names no thing", state=False)
    has = any(isinstance(w, Token) and w.type == "HAVE" for w in words)
    if has and any(term.owner not in (None, whose.owner) for term in things.group.terms):
        raise MeaningError("it asks who has what is another's")  # does anna have my keys
    terms = tuple(
        replace(term, not_owner=whose.owner) if whose.isnt else replace(term, owner=whose.owner)
        for term in things.group.terms
    )
    return replace(things, group=replace(things.group, terms=terms))


def _but(words: tuple[Any, ...]) -> Things:
    """Return anything where it is said to be, but what is left out."""
    others = tuple(term for w in words if isinstance(w, Change) for term in w.other_than)
    return Things(Group((replace(THING, other_than=others),)), items_of(words))


_ITEMS = ("thing", "object", "item", "stuff", "belonging")
_EVERY = ("everything", "all")
"""What is listed where nothing is asked: everything in the hall."""


class Meanings(Terms):
    """question.lark -> Meaning."""

    def start(self, meaning: Meaning) -> Meaning:
        """Rule start: question."""
        return meaning

    # -- fragments -------------------------------------------------------------------------------

    def only_things(self, things: Things) -> Meaning:
        """Rule fragment: things."""
        return Meaning(None, things)

    def only_tail(self, items: tuple[Item, ...]) -> Meaning:
        """Rule fragment: tail."""
        return Meaning(None, Things(None, items))

    def only_changes(self, *words: Any) -> Meaning:
        """Rule fragment: DET? OWNER? pre+ | DET? OWNER | DET? OWNER? post."""
        nothing = Noun(ANYTHING, "thing", known=False)
        return Meaning(None, Things(Group((self.term(nothing, words),))))

    def asking_where(self) -> Meaning:
        """Rule fragment: _WHERE."""
        return Meaning("where")

    def asking_when(self) -> Meaning:
        """Rule fragment: _WHEN."""
        return Meaning("when")

    def asking_count(self) -> Meaning:
        """Rule fragment: _HOWMANY."""
        return Meaning("count")

    def asking_how_long(self) -> Meaning:
        """Rule fragment: _HOWLONG."""
        return Meaning("how_long")

    def asking_how_often(self) -> Meaning:
        """Rule fragment: _HOWOFTEN."""
        return Meaning("how_often")

    # -- where, when ---------------------------------------------------------------------------

    def where_act(self, *words: Any) -> Meaning:
        """Rule where: _WHERE aux WHO act things."""
        newest = _acts(words) != "SEE" or _aux(words) == "can"
        return Meaning("where", _things(words), newest=newest)

    def where_is(self, *words: Any) -> Meaning:
        """Rule where: _WHERE aux things passive?."""
        _happened(words)
        return Meaning("where", _things(words), newest=_aux(words) != "past")

    def when_act(self, *words: Any) -> Meaning:
        """Rule when: _WHEN aux WHO act things."""
        return Meaning("when", _things(words))

    def when_is(self, *words: Any) -> Meaning:
        """Rule when: _WHEN aux things passive?."""
        _happened(words)
        return Meaning("when", _things(words))

    def moved_when(self, *words: Any) -> Meaning:
        """Rule when: _WHEN aux things MOVED tail?."""
        return Meaning("moved", _things(words))

    def when_gone(self, *words: Any) -> Meaning:
        """Rule when: _WHEN aux things MISSING tail?. The last time that it was seen."""
        return Meaning("when", _things(words), select="last")

    # -- whether ---------------------------------------------------------------------------------

    def whether_act(self, *words: Any) -> Meaning:
        """Rule whether: aux WHO act things."""
        act = _acts(words)
        if act == "FINDS" and _aux(words) == "can":
            return Meaning("where", _things(words), newest=True)
        doer = next((w.value for w in words if isinstance(w, Token) and w.type == "WHO"), "")
        if act == "LEAVE" and doer in ("you", "u", "the robot") and not _things(words).items:
            raise MeaningError("it asks what the robot did")
        return Meaning("whether", _things(words))

    def whether_in(self, _aux: Aux, place: Token, _have: Token, things: Things) -> Meaning:
        """Rule whether: aux AT_PLACE HAVE things."""
        return Meaning("whether", things.with_items((AtPlace(str(place.value)),)))

    def count_in(self, things: Things, _aux: Aux, place: Token, _have: Token) -> Meaning:
        """Rule count: _HOWMANY things aux AT_PLACE HAVE."""
        return Meaning("count", things.with_items((AtPlace(str(place.value)),)))

    def whether_there(self, *words: Any) -> Meaning:
        """Rule whether: aux THERE things."""
        return Meaning("whether", _things(words))

    def whether_is(self, *words: Any) -> Meaning:
        """Rule whether: aux things."""
        things = _things(words)
        if _aux(words) in ("did", "do", "can"):
            raise MeaningError("it asks what a thing does")
        if not things.items:
            raise MeaningError("it does not say where or in what relation")
        return Meaning("whether", things)

    def whether_tail(self, *words: Any) -> Meaning:
        """Rule whether: _WHETHER things aux tail."""
        return Meaning("whether", _things(words))

    def whether_owned(self, *words: Any) -> Meaning:
        """Rule whether: aux things IS_OWNED | aux POSSESSOR HAVE things."""
        return Meaning("whether", _owned(words))

    def whether_attribute(self, *words: Any) -> Meaning:
        """Rule whether: aux things PREDICATE+."""
        return Meaning("whether", _described(_things(words), _predicates(words)))

    # -- what, which -----------------------------------------------------------------------------

    def what_tail(self, *words: Any) -> Meaning:
        """Rule what: _WHAT aux tail."""
        things = _things(words)
        if all(isinstance(item, SideBySide) for item in things.items):
            raise MeaningError("it names no thing")
        return Meaning("what", things)

    def what_but(self, *words: Any) -> Meaning:
        """Rule what: _WHAT aux tail but+. What is left out is left out of the things asked for."""
        return Meaning("what", _but(words))

    def what_moved_but(self, *words: Any) -> Meaning:
        """Rule moved: _WHAT aux? MOVED tail? but+."""
        return Meaning("moved", _but(words))

    def what_missing_but(self, *words: Any) -> Meaning:
        """Rule missing: _WHAT aux MISSING tail? but+."""
        return Meaning("missing", _but(words))

    def what_attribute(self, *words: Any) -> Meaning:
        """Rule what: _WHAT tail? aux PREDICATE+."""
        thing = replace(THING, attributes=_predicates(words))
        return Meaning("what", Things(Group((thing,)), items_of(words)))

    def what_owned(self, *words: Any) -> Meaning:
        """Rule what: _WHAT tail? aux IS_OWNED | _WHAT aux POSSESSOR HAVE tail?."""
        return Meaning("what", _owned((Things(Group((THING,))), *words)))

    def what_ground(self, aux: Aux, things: Things, stranded: Token) -> Meaning:
        """Rule what: _WHAT aux things STRANDED. It asks where: on some thing."""
        related = Related(stranded.value, Group((THING,)))
        return Meaning("where", things.with_items((related,)), newest=aux.value != "past")

    def shown_ground(self, things: Things, stranded: Token) -> Meaning:
        """Rule what: _SHOW things STRANDED."""
        meaning: Meaning = self.what_ground(Aux("present"), things, stranded)
        return meaning

    def what_passive(self, *words: Any) -> Meaning:
        """Rule what: _WHAT aux passive."""
        return Meaning("what", _things(words))

    def what_is(self, *words: Any) -> Meaning:
        """Rule what: _WHAT aux things."""
        things = _things(words)
        described = things.group is not None and things.group.terms[0].attributes
        placed = (Related, AtPlace, Here) if described else (Related, AtPlace)
        if not any(isinstance(item, placed) for item in things.items):
            raise MeaningError("it asks what a thing is")
        return Meaning("what", things)

    def what_act(self, *words: Any) -> Meaning:
        """Rule what: _WHAT aux WHO act tail?."""
        return Meaning("what", _things(words))

    def shown(self, *words: Any) -> Meaning:
        """Rule what: _SHOW things."""
        return Meaning("what", _things(words))

    def which_tail(self, *words: Any) -> Meaning:
        """Rule which: _WHICH things aux tail."""
        return Meaning("what", _things(words))

    def which_act(self, *words: Any) -> Meaning:
        """Rule which: _WHICH things aux WHO act tail?."""
        return Meaning("what", _things(words))

    def which_attribute(self, *words: Any) -> Meaning:
        """Rule which: _WHICH things aux PREDICATE+."""
        return Meaning("what", _described(_things(words), _predicates(words)))

    def which_owned(self, *words: Any) -> Meaning:
        """Rule which: _WHICH things aux IS_OWNED | _WHICH things aux POSSESSOR HAVE tail?."""
        return Meaning("what", _owned(words))

    def which_ground(self, ground: Things, _aux: Aux, things: Things, stranded: Token) -> Meaning:
        """Rule which: _WHICH things aux things STRANDED."""
        if ground.group is None:
            raise MeaningError("it names no thing", state=False)
        kind: Any = stranded.value
        return Meaning("where", things.with_items((Related(kind, ground.group),)), newest=True)

    def which_put(self, ground: Things, *words: Any) -> Meaning:
        """Rule which: _WHICH things aux WHO act things STRANDED. Which drawer did I put it in."""
        things = next(word for word in words if isinstance(word, Things))
        meaning: Meaning = self.which_ground(ground, words[0], things, words[-1])
        return meaning

    def which_pied(self, kind: Token, ground: Things, *words: Any) -> Meaning:
        """Rule which: PIED _WHICH things aux things. On which shelf is the book."""
        if ground.group is None:
            raise MeaningError("it names no thing", state=False)
        relation: Any = kind.value
        things = _things(words)
        return Meaning("where", things.with_items((Related(relation, ground.group),)), newest=True)

    # -- how many, how long, how often -------------------------------------------------------------

    def count(self, *words: Any) -> Meaning:
        """Rule count: _HOWMANY things."""
        return Meaning("count", _things(words))

    def count_tail(self, *words: Any) -> Meaning:
        """Rule count: _HOWMANY things aux THERE? tail?."""
        return Meaning("count", _things(words))

    def count_act(self, *words: Any) -> Meaning:
        """Rule count: _HOWMANY things aux WHO act? tail?."""
        return Meaning("count", _things(words))

    def count_attribute(self, *words: Any) -> Meaning:
        """Rule count: _HOWMANY things aux PREDICATE+."""
        return Meaning("count", _described(_things(words), _predicates(words)))

    def count_owned(self, *words: Any) -> Meaning:
        """Rule count: _HOWMANY things aux IS_OWNED | _HOWMANY things aux POSSESSOR HAVE tail?."""
        return Meaning("count", _owned(words))

    def count_with(self, things: Things, _aux: Aux, owner: Things, _have: Token) -> Meaning:
        """Rule count: _HOWMANY things aux things HAVE."""
        group = owner.group or Group(())
        return Meaning("count", things.with_items((Related("together", group), *owner.items)))

    def how_long(self, *words: Any) -> Meaning:
        """Rule lasting: _HOWLONG aux things passive?."""
        things = _things(words)
        if not things.items and not _acts(words) and _aux(words) in ("present", "past"):
            raise MeaningError("it asks for a size")
        return Meaning("how_long", things)

    def how_long_act(self, *words: Any) -> Meaning:
        """Rule lasting: _HOWLONG aux WHO act things."""
        return Meaning("how_long", _things(words))

    def how_often(self, *words: Any) -> Meaning:
        """Rule often: _HOWOFTEN aux things passive?."""
        _happened(words)
        return Meaning("how_often", _things(words))

    def how_often_act(self, *words: Any) -> Meaning:
        """Rule often: _HOWOFTEN aux WHO act things."""
        return Meaning("how_often", _things(words))

    def moved_by(self, _aux: Aux, mover: Token, _moved: Token, things: Things) -> Meaning:
        """Rule moved: aux WHO MOVED things. Whether anyone did is seen, who did is not."""
        if mover.value not in ("anyone", "anybody", "someone", "somebody", "i", "we", "they"):
            raise MeaningError("it asks what somebody does")
        return Meaning("moved", things)

    # -- moved, missing, said -------------------------------------------------------------------

    def what_moved(self, *words: Any) -> Meaning:
        """Rule moved: _WHAT aux? MOVED tail?."""
        return Meaning("moved", _things(words))

    def things_moved(self, *words: Any) -> Meaning:
        """Rule moved: aux things MOVED tail?."""
        return Meaning("moved", _things(words))

    def what_missing(self, *words: Any) -> Meaning:
        """Rule missing: _WHAT aux MISSING tail?."""
        return Meaning("missing", _things(words))

    def things_missing(self, *words: Any) -> Meaning:
        """Rule missing: aux things MISSING tail?."""
        return Meaning("missing", _things(words))

    def anything_missing(self, *words: Any) -> Meaning:
        """Rule missing: aux passive."""
        raise MeaningError("it names no thing", state=False)

    def lost(self, *words: Any) -> Meaning:
        """Rule said: things aux? MISSING tail?. Of anything it is asked if it is gone."""
        group = _things(words).group
        if group is not None and group.terms[0].category == ANYTHING:
            return Meaning("missing", _things(words))
        return Meaning("where", _things(words), newest=True)

    def short(self, things: Things) -> Meaning:
        """Rule said: things. `anything on the bed` asks whether there is."""
        terms = things.group.terms if things.group else ()
        if terms and terms[0].word in _EVERY:
            return Meaning("what", things)
        if things.items and terms and terms[0].category == ANYTHING and not terms[0].attributes:
            return Meaning("what" if terms[0].word in _ITEMS else "whether", things)
        return Meaning("where", things, newest=True)

    def told(self, *words: Any) -> Meaning:
        """Rule said: WHO aux? act things."""
        seen = isinstance(words[0], Token) and words[0].value in ("you", "u", "ya")
        return Meaning("whether" if seen else "where", _things(words), newest=True)
