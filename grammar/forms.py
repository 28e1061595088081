"""The formal query: the contract between the grammar and everything that answers.

Table 1 of the paper gives three forms (Q1 objects, Q2 objects in relation, Q3 places and times);
a `FormalQuery` is the record that carries any of them, with what the paper's notation leaves out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta, timezone
from typing import Any, Literal, cast, get_args

Json = dict[str, Any]
Form = Literal["Q1", "Q2", "Q3"]
Ask = Literal[
    "whether", "where", "when", "what", "count", "how_long", "how_often", "moved", "missing"
]
Select = Literal["last", "first", "all", "usual"]
Bound = Literal["least", "most", "exactly"]
RelationKind = Literal[
    "together",
    "near",
    "on",
    "under",
    "in",
    "behind",
    "in_front_of",
    "left_of",
    "right_of",
    "between",
    "above",
    "same_place",
]
FORMS: tuple[Form, ...] = get_args(Form)
ASKS: tuple[Ask, ...] = get_args(Ask)
SELECTS: tuple[Select, ...] = get_args(Select)
BOUNDS: tuple[Bound, ...] = get_args(Bound)
RELATION_KINDS: tuple[RelationKind, ...] = get_args(RelationKind)
ANYTHING = "object"
"""The category of "thing", "anything" and "something": it matches every object."""
VARIABLES = "xyzwvutsrqponm"


class D3AError(Exception):
    """Base of every error over bad input or a failing store; `d3a.D3AError` is this one.

    It is here because formal queries are made of either side, and d3a stands on them.
    """


class FormError(D3AError, ValueError):
    """A record that is not a formal query: says the field, what stood and what may stand there."""


def _one_of(field: str, value: object, allowed: tuple[str, ...]) -> None:
    if value not in allowed:
        raise FormError(f"{field} is {value!r}; it must be one of {', '.join(allowed)}")


@dataclass(frozen=True, slots=True)
class Where:
    """A relation that describes an object: the table *next to the door*."""

    kind: RelationKind
    object: ObjectTerm
    negated: bool = False

    def __post_init__(self) -> None:
        _one_of("where.kind", self.kind, RELATION_KINDS)

    def to_json(self) -> Json:
        """Return the JSON record of formal-query, nested object and all."""
        return {"kind": self.kind, "negated": self.negated, "object": self.object.to_json()}


@dataclass(frozen=True, slots=True)
class ObjectTerm:
    """One object of the question: a noun with what must and must not hold of it.

    category: singular, after synonyms ("mug" is "cup"); `ANYTHING` for "thing".
    word: the noun as said, singular, after spelling correction; matching ranks by it.
    attributes, without: words in spoken order. owner: "me", "you", or a lower-case name.
    bound: how `quantity` is meant: two cups are at least two. not_owner: whose it must not be.
    or_else: what will do as well, a pink cup or a red one. other_than: what it must not be, a red
    thing other than a cup. None of either has these, a number or a place of its own.
    """

    category: str
    word: str = ""
    attributes: tuple[str, ...] = ()
    without: tuple[str, ...] = ()
    owner: str | None = None
    quantity: int | None = None
    where: Where | None = None
    var: str = "x"
    bound: Bound = "least"
    not_owner: str | None = None
    or_else: tuple[ObjectTerm, ...] = ()
    other_than: tuple[ObjectTerm, ...] = ()

    def __post_init__(self) -> None:
        if not all(map(_is_plain, (*self.or_else, *self.other_than))):
            raise FormError("or_else and other_than are told by no more than a noun, looks, owners")
        if self.bound != "least":
            _one_of("bound", self.bound, BOUNDS)
            if self.quantity is None:
                raise FormError(f"bound is {self.bound!r} of no quantity; say of how many")
        if not self.category:
            raise FormError("an object has an empty category; it must be a noun")
        if not self.word:
            object.__setattr__(self, "word", self.category)

    def chain(self) -> Iterator[ObjectTerm]:
        """Yield the object, what describes it, and what describes that."""
        term: ObjectTerm | None = self
        while term is not None:
            yield term
            term = term.where.object if term.where is not None else None

    def to_json(self) -> Json:
        """Return the JSON record of formal-query, every field present.

        Those from `bound` on, which it does not know, only where they say something. A kind that
        is left out is a word that must not hold, so `without` ends in those of `other_than`.
        """
        more = {
            "bound": self.bound if self.bound != "least" else None,
            "not_owner": self.not_owner,
            "or_else": [term.to_json() for term in self.or_else] or None,
            "other_than": [term.to_json() for term in self.other_than] or None,
        }
        return {
            "var": self.var,
            "category": self.category,
            "word": self.word,
            "attributes": list(self.attributes),
            "without": [*self.without, *_kinds(self.other_than)],
            "owner": self.owner,
            "quantity": self.quantity,
            "where": self.where.to_json() if self.where else None,
        } | {name: said for name, said in more.items() if said is not None}


def _kinds(terms: tuple[ObjectTerm, ...]) -> tuple[str, ...]:
    """Return the nouns of terms that say nothing else."""
    return tuple(term.word for term in terms if term == ObjectTerm(term.category, term.word))


def _is_plain(term: ObjectTerm) -> bool:
    """Whether a term says no more than a noun, looks and whose it is."""
    said = (term.quantity, term.where, *term.or_else, *term.other_than)
    return all(each is None for each in said)


@dataclass(frozen=True, slots=True)
class Relation:
    """A relation between the objects of a query, which are its arguments in spoken order."""

    kind: RelationKind
    negated: bool = False

    def __post_init__(self) -> None:
        _one_of("relation.kind", self.kind, RELATION_KINDS)

    def to_json(self) -> Json:
        """Return the JSON record of formal-query."""
        return {"kind": self.kind, "negated": self.negated}


@dataclass(frozen=True, slots=True)
class TimeSlice:
    """A slice [start, end) of aware times; an open end is None, a point has start == end.

    Times are kept with the fixed offset that their zone had then, as JSON writes them: a time
    that a zone has twice or never equals no time of another zone, not even its own ISO form.
    """

    start: datetime | None = None
    end: datetime | None = None

    def __post_init__(self) -> None:
        for name, moment in (("start", self.start), ("end", self.end)):
            if moment is not None and moment.tzinfo is None:
                raise FormError(f"time.{name} {moment.isoformat()} has no offset; add one")
            if moment is not None:
                object.__setattr__(self, name, _with_fixed_offset(moment))
        if self.start is not None and self.end is not None and self.end < self.start:
            raise FormError(
                f"time ends at {self.end.isoformat()}, before it starts at {self.start.isoformat()}"
            )

    @property
    def is_point(self) -> bool:
        """Whether the slice is a point in time: what was true then is asked."""
        return self.start is not None and self.start == self.end

    def to_json(self) -> Json:
        """Return ISO strings with offset, or None for an open end."""
        return {
            "start": self.start.isoformat() if self.start else None,
            "end": self.end.isoformat() if self.end else None,
        }


@dataclass(frozen=True, slots=True)
class Correction:
    """A word that was read as another: what was said, what was taken, and where it stands."""

    said: str
    taken: str
    position: int

    def to_json(self) -> Json:
        """Return the correction as a record."""
        return {"said": self.said, "taken": self.taken, "position": self.position}


@dataclass(frozen=True, slots=True)
class FormalQuery:
    """A question in formal form (paper, Table 1: Q1, Q2, Q3).

    objects: the arguments of `relation` in spoken order, figure first; empty for `moved` and
    `missing` without an object. place: a named region, never an object.
    select: which of the sightings; `usual` asks where a thing habitually lies.
    outside: the place is one where it must not be: the cup that is not in the kitchen.
    or_places: further places: in the kitchen or the hall, and `outside` in neither.
    contrary: a denied `whether` asks for a sighting of which it does not hold, as a denied `when`
    does: was it ever not in the hall; else, as in is there no cup, if there is none of which it
    holds.
    now: it is asked for what is so, not for what was ever seen: is it in the hall, did I leave it
    there, since when is it there. Of a time that is named it says nothing.
    corrections: the words that were read as others; no part of what is asked, so not compared.
    """

    text: str
    form: Form
    ask: Ask
    objects: tuple[ObjectTerm, ...] = ()
    relation: Relation | None = None
    place: str | None = None
    time: TimeSlice | None = None
    select: Select = "all"
    negated: bool = False
    outside: bool = False
    or_places: tuple[str, ...] = ()
    contrary: bool = False
    now: bool = False
    corrections: tuple[Correction, ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        _one_of("form", self.form, FORMS)
        _one_of("ask", self.ask, ASKS)
        _one_of("select", self.select, SELECTS)
        if (self.outside or self.or_places) and self.place is None:
            raise FormError("outside of no place, or another place of none; say of which")
        denied = self.negated and self.ask == "whether"
        if self.contrary and not (denied and (self.relation or self.place is not None)):
            raise FormError("contrary is said of a denied whether alone, of a relation or a place")
        if len(self.objects) > len(VARIABLES):
            raise FormError(f"{len(self.objects)} objects; at most {len(VARIABLES)} will do")
        named = tuple(
            term if term.var == VARIABLES[i] else replace(term, var=VARIABLES[i])
            for i, term in enumerate(self.objects)
        )
        object.__setattr__(self, "objects", named)

    @property
    def terms(self) -> tuple[ObjectTerm, ...]:
        """The objects, each followed by what describes it."""
        return tuple(term for each in self.objects for term in each.chain())

    @property
    def seeks_absence(self) -> bool:
        """Whether relation and place must fail to hold, as in when was the cup not in the hall.

        Is there no cup on the table is settled by looking for a cup on the table.
        """
        return self.negated and (self.ask != "whether" or self.contrary)

    @property
    def formal(self) -> str:
        """The paper's notation, for reading; see `grammar.notation.formal`."""
        from grammar.notation import formal  # it is written of this record

        return formal(self)

    def to_json(self) -> Json:
        """Return the JSON record of formal-query.

        Those after `negated`, which it does not know, only where they say something.
        """
        record: Json = {
            "text": self.text,
            "form": self.form,
            "ask": self.ask,
            "objects": [term.to_json() for term in self.objects],
            "relation": self.relation.to_json() if self.relation else None,
            "place": self.place,
            "time": self.time.to_json() if self.time else None,
            "select": self.select,
            "negated": self.negated,
            "formal": self.formal,
        }
        if self.outside:
            record["outside"] = True
        if self.or_places:
            record["or_places"] = list(self.or_places)
        if self.contrary:
            record["contrary"] = True
        if self.now:
            record["now"] = True
        if self.corrections:
            record["corrections"] = [each.to_json() for each in self.corrections]
        return record

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> FormalQuery:
        """Read what `to_json` wrote; `formal` is derived and not read.

        Raises FormError with the field and what may stand there.
        """
        try:
            relation, time = record["relation"], record["time"]
            return cls(
                text=str(record["text"]),
                form=cast("Form", record["form"]),
                ask=cast("Ask", record["ask"]),
                objects=tuple(_term_from_json(term) for term in record["objects"]),
                relation=Relation(relation["kind"], bool(relation["negated"]))
                if relation
                else None,
                place=record["place"],
                time=TimeSlice(_moment(time["start"]), _moment(time["end"])) if time else None,
                select=cast("Select", record["select"]),
                negated=bool(record["negated"]),
                outside=bool(record.get("outside", False)),
                or_places=tuple(record.get("or_places", ())),
                contrary=bool(record.get("contrary", False)),
                now=bool(record.get("now", False)),
                corrections=tuple(Correction(**said) for said in record.get("corrections", ())),
            )
        except KeyError as error:
            raise FormError(f"the field {error.args[0]!r} is missing") from error
        except (TypeError, AttributeError) as error:
            raise FormError(f"not a formal query: {error}") from error


def _with_fixed_offset(moment: datetime) -> datetime:
    """Return the same instant with the offset of its zone; an hour that was skipped moves on."""
    there = moment.astimezone(UTC).astimezone(moment.tzinfo)
    return there.replace(tzinfo=timezone(cast("timedelta", there.utcoffset())), fold=0)


def _moment(value: str | None) -> datetime | None:
    if value is None:
        return None
    try:
        return datetime.fromisoformat(value)
    except ValueError as error:
        raise FormError(f"{value!r} is not an ISO time with an offset") from error


def _term_from_json(record: Mapping[str, Any]) -> ObjectTerm:
    where = record["where"]
    others = tuple(_term_from_json(term) for term in record.get("other_than", ()))
    without, kinds = tuple(record["without"]), _kinds(others)
    if without[len(without) - len(kinds) :] == kinds:
        without = without[: len(without) - len(kinds)]
    return ObjectTerm(
        category=record["category"],
        word=record["word"],
        attributes=tuple(record["attributes"]),
        without=without,
        owner=record["owner"],
        quantity=record["quantity"],
        where=Where(where["kind"], _term_from_json(where["object"]), bool(where["negated"]))
        if where
        else None,
        var=record["var"],
        bound=cast("Bound", record.get("bound", "least")),
        not_owner=record.get("not_owner"),
        or_else=tuple(_term_from_json(term) for term in record.get("or_else", ())),
        other_than=others,
    )
