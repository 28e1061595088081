"""Reading of the formal notation: a line to its tree by notation.lark, the tree to a query."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace
from datetime import datetime, timedelta
from functools import lru_cache
from pathlib import Path
from typing import Any, cast

from lark import Lark, Token, Tree
from lark.exceptions import UnexpectedInput

from grammar.errors import NotUnderstood
from grammar.forms import (
    ASKS,
    FORMS,
    RELATION_KINDS,
    SELECTS,
    Ask,
    Bound,
    Form,
    FormalQuery,
    FormError,
    ObjectTerm,
    Relation,
    RelationKind,
    Select,
    TimeSlice,
    Where,
)
from grammar.notation import SIGNS, TIME, ask_unsaid, form_unsaid
from grammar.vocabulary.lexicon import lexicon


@dataclass
class _Object:
    """What the predicates say of one variable."""

    words: list[str] = field(default_factory=list)
    without: list[str] = field(default_factory=list)
    said: str | None = None
    owner: str | None = None
    not_owner: str | None = None
    quantity: int | None = None
    bound: Bound = "least"
    related: tuple[str, str, bool] | None = None
    or_else: list[str] = field(default_factory=list)
    other_than: list[str] = field(default_factory=list)


@dataclass
class _Line:
    """A line taken apart, before it is a query."""

    objects: dict[str, _Object] = field(default_factory=dict)
    found: list[list[str]] = field(default_factory=list)
    stored: bool = False
    relation: Relation | None = None
    places: list[str] = field(default_factory=list)
    outside: bool = False
    time: TimeSlice | None = None
    timed: bool = False
    settings: dict[str, str] = field(default_factory=dict)


@lru_cache(maxsize=1)
def _parser() -> Lark:
    grammar = Path(__file__).with_name("notation.lark").read_text(encoding="utf-8")
    return Lark(grammar, parser="lalr", maybe_placeholders=False)


def read(text: str, now: datetime) -> FormalQuery:
    """Return the query of a line, as `grammar.notation.read` promises."""
    try:
        tree = _parser().parse(text)
    except UnexpectedInput as error:
        position = error.pos_in_stream if error.pos_in_stream is not None else len(text)
        position = len(text) if position < 0 else position
        raise NotUnderstood(
            text, position, f"The notation breaks off at “{text[position : position + 20]}”."
        ) from error
    try:
        return _Reader(text, now).query(tree)
    except (FormError, ValueError, OverflowError) as error:
        raise NotUnderstood(text, 0, f"The notation makes no query: {error}.") from error


class _Reader:
    """Walks the tree of one line."""

    def __init__(self, text: str, now: datetime) -> None:
        self.text, self.now, self.line = text, now, _Line()

    def query(self, tree: Tree[Token]) -> FormalQuery:
        """Return the query of the whole line."""
        for part in tree.children:
            if isinstance(part, Tree):
                match part.data:
                    case "predicates":
                        for predicate in part.children:
                            self._predicate(cast("Tree[Token]", predicate))
                    case "call":
                        self._call(part)
                    case _:
                        for clause in part.children:
                            self._clause(cast("Tree[Token]", clause))
        return self._built()

    def _predicate(self, tree: Tree[Token]) -> None:
        children = list(tree.children)
        negated = isinstance(children[0], Token) and children[0].type == "NOT"
        word = _text(children[1 if negated else 0])
        var, *rest = (str(child) for child in children[2 if negated else 1 :])
        if word == "time" and not rest and not negated and var == TIME:
            self.line.timed = True
            return
        thing = self.line.objects.setdefault(var, _Object())
        match tree.data:
            case "holds":
                (thing.without if negated else thing.words).append(word)
            case "relates":
                self.line.objects.setdefault(rest[0], _Object())
                if word in ("or", "other") and not negated:
                    (thing.or_else if word == "or" else thing.other_than).append(rest[0])
                else:
                    thing.related = (word, rest[0], negated)
            case "counts":
                thing.bound = _bound(rest[0] if len(rest) > 1 else "")
                thing.quantity = int(rest[-1])
            case _ if word == "said" and not negated:
                thing.said = json.loads(rest[0])
            case _ if word == "of" and negated:
                thing.not_owner = json.loads(rest[0])
            case _ if word == "of":
                thing.owner = json.loads(rest[0])
            case _:
                raise FormError(f"{word}(x, …) is unknown; said and of take a text")

    def _call(self, tree: Tree[Token]) -> None:
        finder, *arguments = tree.children
        if str(finder).lower().startswith("stc"):
            self.line.stored = True
        else:
            self.line.found.append([])
        for argument in arguments:
            self._argument(cast("Tree[Token]", argument))

    def _argument(self, tree: Tree[Token]) -> None:
        match tree.data:
            case "call":
                self._call(tree)
            case "place":
                self._placed(_text(tree.children[-1]), outside=len(tree.children) == 3)
            case "named":
                negated = len(tree.children) == 2
                self._named(str(tree.children[-1]), negated=negated)
            case _:
                self._bounded([_moment_text(child) for child in tree.children])

    def _placed(self, place: str, *, outside: bool) -> None:
        if self.line.places and self.line.outside != outside:
            raise FormError(
                "it is in one place and not in another; one of them goes without saying"
            )
        self.line.places.append(place)
        self.line.outside = outside

    def _named(self, name: str, *, negated: bool) -> None:
        if name in self.line.objects and not negated:
            if not self.line.found:
                self.line.found.append([])
            self.line.found[-1].append(name)
        elif name in RELATION_KINDS:
            self.line.relation = Relation(name, negated)
        elif name == TIME:
            self.line.time = self.line.time or TimeSlice()
        else:
            raise FormError(f"{name} is no variable and no relation")

    def _bounded(self, parts: list[str]) -> None:
        """Read `1600 >= t >= 1300`, `t = …`; the variable stands between or at one end."""
        start: str | None = None
        end: str | None = None
        for left, op, right in zip(parts[::2], parts[1::2], parts[2::2], strict=False):
            bound, below = (
                (right, op in (">=", ">", "≥"))
                if left == TIME
                else (
                    left,
                    op in ("<=", "<", "≤"),
                )
            )
            if op == "=":
                start = end = bound
            elif below:
                start = bound
            else:
                end = bound
        self.line.time = self._slice(start, end)

    def _slice(self, start: str | None, end: str | None) -> TimeSlice:
        """Return the slice of two times; a clock time is the last one gone by."""
        first = self._moment(start, None) if start else None
        last = self._moment(end, first) if end else None
        if start == end:
            last = first
        return TimeSlice(first, last)

    def _moment(self, text: str, after: datetime | None) -> datetime:
        if "T" in text:
            moment = datetime.fromisoformat(text)
            return moment if moment.tzinfo else moment.replace(tzinfo=self.now.tzinfo)
        digits = text.replace(":", "").zfill(4)
        hour, minute = int(digits[:-2]), int(digits[-2:])
        if hour > 24 or minute > 59:
            raise FormError(f"{text} is no clock time")
        day = (after or self.now).replace(hour=0, minute=0, second=0, microsecond=0)
        moment = (day + timedelta(days=hour // 24)).replace(hour=hour % 24, minute=minute)
        if after is None and moment > self.now:
            return moment - timedelta(days=1)
        return moment + timedelta(days=1) if after is not None and moment < after else moment

    def _clause(self, tree: Tree[Token]) -> None:
        name, *value = (str(child) for child in tree.children)
        if tree.data == "text" and name == "said":
            self.line.settings["said"] = json.loads(value[0])
        elif tree.data == "setting" and name in ("form", "ask", "select"):
            self.line.settings[name] = value[0]
        elif tree.data == "flag" and name in ("negated", "contrary", "now"):
            self.line.settings[name] = ""
        else:
            raise FormError(
                f"{name} is unknown here; form, ask, select, negated, now and said are not"
            )

    # -- the query ------------------------------------------------------------------------------

    def _built(self) -> FormalQuery:
        line, settings = self.line, self.line.settings
        terms = self._terms()
        relation = line.relation
        if (
            not settings
            and line.stored
            and relation is None
            and line.time is None
            and len(terms) > 1
        ):
            relation = Relation("together")  # the paper's Q2: both found in STc is together
        ask = settings.get("ask") or ask_unsaid(relation, line.time, stored=line.stored)
        form = settings.get("form") or form_unsaid(relation, stored=line.stored)
        select = settings.get("select", "all")
        for value, allowed in ((ask, ASKS), (form, FORMS), (select, SELECTS)):
            if value not in allowed:
                raise FormError(f"{value} must be one of {', '.join(allowed)}")
        return FormalQuery(
            text=settings.get("said", self.text),
            form=cast("Form", form),
            ask=cast("Ask", ask),
            objects=terms,
            relation=relation,
            place=line.places[0] if line.places else None,
            or_places=tuple(line.places[1:]),
            outside=line.outside,
            time=line.time,
            select=cast("Select", select),
            negated="negated" in settings,
            contrary="contrary" in settings,
            now="now" in settings,
        )

    def _terms(self) -> tuple[ObjectTerm, ...]:
        groups = self.line.found or [list(self.line.objects)]
        return tuple(self._term(t) for group in groups for t in self._bound_apart(group))

    def _bound_apart(self, group: list[str]) -> list[_Object]:
        """Bind the paper's `pink(x), cup(y)` to one object: attributes go with the next noun.

        What `write` wrote has bound them already. Of several OIc.find each finds one object;
        where there is one alone, `cup(x), bowl(y)` are two.
        """
        if "said" in self.line.settings:
            return [self.line.objects[var] for var in group]
        several = len(self.line.found) > 1
        out: list[_Object] = []
        waiting: list[str] = []
        for i, var in enumerate(group):
            thing = self.line.objects[var]
            alone = len(thing.words) == 1 and thing == _Object(words=thing.words)
            describes = alone and (several or _is_look(thing.words[0]))
            if describes and i + 1 < len(group):
                waiting += thing.words
                continue
            out.append(replace(thing, words=[*waiting, *thing.words]))
            waiting = []
        return out

    def _term(self, thing: _Object, depth: int = 0) -> ObjectTerm:
        if not thing.words:
            raise FormError("an object has no category")
        if depth > 8:
            raise FormError("objects describe each other in a circle")
        where = None
        if thing.related is not None:
            said, var, negated = thing.related
            kind = said.replace(" ", "_")
            inner = self._term(self.line.objects[var], depth + 1)
            where = Where(cast("RelationKind", kind), inner, negated)
        words = thing.words if "said" in self.line.settings else _noun_last(thing.words)
        return ObjectTerm(
            category=words[-1],
            word=thing.said or "",
            attributes=tuple(words[:-1]),
            without=tuple(thing.without),
            owner=thing.owner,
            quantity=thing.quantity,
            where=where,
            bound=thing.bound,
            not_owner=thing.not_owner,
            or_else=tuple(self._term(self.line.objects[v], depth + 1) for v in thing.or_else),
            other_than=tuple(self._term(self.line.objects[v], depth + 1) for v in thing.other_than),
        )


def _noun_last(words: list[str]) -> list[str]:
    """Return the predicates of an object with its noun last: cup(x), red(x) is a red cup, too."""
    nouns = [row for row, word in enumerate(words) if not _is_look(word)]
    if not nouns or not _is_look(words[-1]):
        return words
    noun = nouns[-1]
    return [*words[:noun], *words[noun + 1 :], words[noun]]


def _is_look(word: str) -> bool:
    """Whether a word describes, by itself or after its shade: blue, light-blue, dark blue."""
    looks = lexicon().attributes
    if word in looks:
        return True
    return word.replace("-", " ").rpartition(" ")[2] in looks and not lexicon().known_noun(word)


def _bound(sign: str) -> Bound:
    """Return how a number is meant that has this sign before it."""
    signs: dict[str, Bound] = {sign.strip(): bound for bound, sign in SIGNS.items()}
    if sign not in signs | {">=": "least"}:
        raise FormError(f"{sign} stands before no number; =, <= and >= do")
    return signs.get(sign, "least")


def _text(node: Tree[Token] | Token) -> str:
    """Return the word of a node: a string as it stands, a name with spaces for underscores."""
    token = cast("Token", node.children[0] if isinstance(node, Tree) else node)
    return str(json.loads(token)) if token.type == "STRING" else str(token).replace("_", " ")


def _moment_text(node: Any) -> str:
    token = node.children[0] if isinstance(node, Tree) else node
    return str(token)
