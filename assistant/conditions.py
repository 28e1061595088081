"""What of a question's relation and place was judged, in words: on the table, two together."""

from __future__ import annotations

from assistant.english import counted, listed, neither
from assistant.phrases import asked_place, definite, described, numbered, plain_place, term_of
from d3a.answer import Answer
from d3a.plan import numbers_together
from grammar.forms import FormalQuery, ObjectTerm

_RELATIONS = {
    "together": "with",
    "near": "next to",
    "in_front_of": "in front of",
    "left_of": "left of",
    "right_of": "right of",
    "same_place": "in the same place as",
}


def condition_words(answer: Answer, query: FormalQuery) -> str:
    """Return relation and place of the question, as far as they were judged: " on the table"."""
    related = _related_words(answer, query)
    grounds = {term.word for term in query.objects[1:]} if related else set()
    if query.place is None or plain_place(query.place) in grounds:
        return related  # under the desk: at which desk goes without saying
    if f"in the {query.place}" in answer.unjudged:
        return related
    absent = query.relation is None and query.seeks_absence
    places = _places_words(query, query.place, denied=absent != query.outside)
    place = f" {places}"
    # not on the counter in the kitchen would deny the kitchen too
    return f"{place} but{related}" if related and is_denied(query) else f"{related}{place}"


def _places_words(query: FormalQuery, place: str, *, denied: bool) -> str:
    """Return the places of a question: not in the kitchen, in the kitchen or in the hall."""
    places = [asked_place(query, each) for each in (place, *query.or_places)]
    if len(places) == 1:
        return f"not {places[0]}" if denied else places[0]
    return neither(places) if denied else " or ".join(places)


def is_denied(query: FormalQuery) -> bool:
    """Whether what was found is what the relation does not hold of: the cups without a bowl.

    A whether that is denied as a whole looked for what it denies: that was found with it.
    """
    denied = query.relation is not None and query.relation.negated
    return denied != query.seeks_absence


def _related_words(answer: Answer, query: FormalQuery) -> str:
    if query.relation is not None and len(query.objects) < 2:
        alone = query.relation.kind  # among things of one kind
        denied = "not " if is_denied(query) else ""
        return "" if alone in answer.unjudged else f" {denied}{alone}"
    if query.relation is None:
        several = numbers_together(query) and "together" not in answer.unjudged
        return " at once" if several else ""
    grounds = query.objects[1:]
    plain = f"the {described(grounds[-1])}"
    if any(condition.endswith(plain) for condition in answer.unjudged):
        return ""
    kind = _RELATIONS.get(query.relation.kind, query.relation.kind)
    kind = _denied_kind(kind) if is_denied(query) else kind
    # where all of them were is said once, after the last
    own = ["" if term.where == grounds[-1].where else _where_it_was(answer, query, term)
           for term in query.objects]  # fmt: skip
    told = [_ground(answer, query, t) + o for t, o in zip(grounds, own[1:], strict=True)]
    return f" {kind} {listed(told)}{_where_it_was(answer, query, grounds[-1])}{own[0]}"


def _ground(answer: Answer, query: FormalQuery, term: ObjectTerm) -> str:
    """Return what things were related to: the table, two cups."""
    several = term.quantity is not None and term.quantity > 1 and term.bound == "least"
    if term.quantity is not None and several and not term.owner:
        return counted(term.quantity, described(term, answer.unjudged))
    return definite(term, numbered(query, term, answer.unjudged))


def _denied_kind(kind: str) -> str:
    """Return the words of a relation that does not hold: without, not on."""
    return "without" if kind == "with" else f"not {kind}"


def _where_it_was(answer: Answer, query: FormalQuery, term: ObjectTerm) -> str:
    """Return what else was said of where an object of the question was: " with the bowl"."""
    if term.where is None:
        return ""
    inner = term.where.object
    plain = f"the {described(inner)}"
    if any(condition.endswith(plain) for condition in answer.unjudged):
        return ""
    kind = _RELATIONS.get(term.where.kind, term.where.kind)
    thing = definite(inner, numbered(query, inner, answer.unjudged))
    kind = _denied_kind(kind) if term.where.negated else kind
    return f" {kind} {thing}{_where_it_was(answer, query, inner)}"


def gathered_words(answer: Answer, query: FormalQuery) -> str:
    """Return "two cups" where it is told of so many things together; "" where it is not.

    Asked how many there were, as many as there were.
    """
    numbers = numbers_together(query)
    told = condition_words(answer, query) and not is_denied(query)
    if not told or not numbers or numbers[0] < 2:
        return ""
    number = round(answer.value) if query.ask == "count" and answer.value else numbers[0]
    return counted(number, described(term_of(query), answer.unjudged))
