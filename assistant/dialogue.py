"""Follow-ups: a fragment such as "and the bowl?" merged with the query before it.

Pure functions over formal queries: no screen, no store, no clock.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import datetime, timedelta

from grammar import NotUnderstood, StoreWords, vocabulary
from grammar.forms import (
    ANYTHING,
    FormalQuery,
    ObjectTerm,
    Relation,
    Select,
    TimeSlice,
)
from grammar.fragments import Fragment, Relative, is_list, parse_fragment
from grammar.meaning import AtPlace, Item, Outside, Related, SideBySide, form_of
from grammar.parser import parse
from grammar.tense import follows_now
from grammar.vocabulary import lexicon


@dataclass(frozen=True, slots=True)
class Seen:
    """When the thing spoken of was seen: `before that` ends at its start.

    thing: what it is called, which `it` means after a list of things. place: the room it was in.
    """

    start: datetime
    end: datetime
    thing: ObjectTerm | None = None
    place: str | None = None


def follow(
    text: str,
    *,
    now: datetime,
    words: StoreWords,
    last: FormalQuery | None,
    seen: Seen | None = None,
) -> FormalQuery:
    """Return the query that `text` means after `last`.

    last: the query before, None at the start of a dialogue. seen: the sighting that its answer
    told, which `before that` starts from where the query itself had no time.
    Raises QuestionError.
    """
    if last is None:
        return parse(text, now=now, words=words)
    told = _spoken_of(last) or (seen.thing if seen is not None else None)
    found = parse_fragment(text, now=now, words=words, previous=last, told=told)
    if not isinstance(found, FormalQuery):
        return merge(last, found, seen)
    return _there(found, last, seen)


def _there(query: FormalQuery, last: FormalQuery, seen: Seen | None) -> FormalQuery:
    """Return a whole question with what its `there` means, where the one before tells it.

    On, in or beside what that asked about, else the room that its answer told of another thing.
    """
    plain = query.relation is None and query.place is None and len(query.objects) == 1
    same = query.objects == last.objects[:1] and last.ask != "whether"
    if not plain or not _says_there(query.text) or same:
        return query
    related = last.relation is not None and len(last.objects) == 2 and not last.relation.negated
    if related:
        objects = (query.objects[0], last.objects[1])
        query = replace(query, objects=objects, relation=last.relation)
    told = seen is not None and not related and query.objects != last.objects[:1]
    place = last.place or (seen.place if seen is not None and told else None)
    query = replace(query, place=place, or_places=last.or_places, outside=last.outside)
    form = form_of(query.ask, query.relation, query.time, query.place, query.select)
    return replace(query, form=form)


def _says_there(text: str) -> bool:
    """Whether a text asks of a place by `there`, and not whether there is something."""
    words = ["".join(filter(str.isalpha, word)) for word in text.casefold().split()]
    behind = {"is", "are", "was", "were", "isnt", "arent", "wasnt", "werent", "and", "so"}
    return any(word == "there" and words[k - 1] not in behind for k, word in enumerate(words) if k)


def _spoken_of(last: FormalQuery) -> ObjectTerm | None:
    """Return what a list was asked for around, where it was a pronoun already: that it stays."""
    if not is_list(last) or last.relation is None or len(last.objects) != 2:
        return None
    ground, words = last.objects[1], last.text.lower().strip(" ?!.").split()
    spoken = "it" in words or (words[0].startswith("what") and words[-1] == "them")
    return ground if spoken and not _is_said(ground, last.text) else None


def is_about_the_same(query: FormalQuery, last: FormalQuery | None, text: str) -> bool:
    """Whether a query goes on about the things of the last one, without naming them again.

    Or about the first of them: where was it, after which of them is on the table.
    """
    if last is None or query.objects not in (last.objects, last.objects[:1]):
        return False
    return not any(_is_said(term, text) for term in last.objects)


def is_of_the_listed(
    query: FormalQuery, last: FormalQuery | None, seen: Seen | None, text: str
) -> bool:
    """Whether a query goes on about the thing that was told of a list, by its pronoun alone."""
    if last is None or seen is None or seen.thing is None:
        return False
    if last.objects and not is_list(last):
        return False
    return query.objects[:1] == (seen.thing,) and not _is_said(seen.thing, text)


def _is_said(term: ObjectTerm, text: str) -> bool:
    """Whether a text names an object, in the singular or the plural."""
    said = {vocabulary.singular(word.strip(".,?!")) for word in text.lower().split()}
    return any(word in said for word in term.word.split()[-1:])


def is_beside(query: FormalQuery, seen: Seen | None, last: FormalQuery | None) -> bool:
    """Whether a query asks where a thing was just before or after a sighting: elsewhere, then.

    last: the query before; before that is also before the time that it asked of.
    """
    if seen is None or query.time is None or query.ask != "where":
        return False
    time, asked = query.time, last.time if last is not None else None
    begins, ends = {seen.start}, {seen.end}
    if asked is not None:
        begins.add(asked.start or asked.end or seen.start)
        ends.add(asked.end or asked.start or seen.end)
    before = time.start is None and time.end in begins
    return before or (time.end is None and time.start in ends)


def merge(last: FormalQuery, fragment: Fragment, seen: Seen | None = None) -> FormalQuery:
    """Return `last` with what the fragment changes, in the fragment's words.

    New objects take the place of the figures, or of the ground where the figure was any thing; `the
    red one` keeps the noun. Raises NotUnderstood when `before that` has no time to start from.
    """
    contrary = last.contrary if fragment.query is None else fragment.query.contrary
    if fragment.query is not None:
        merged = replace(fragment.query, contrary=False)
    else:
        merged = _with_items(_with_terms(replace(last, contrary=False), fragment), fragment)
    time = _time(last, fragment, seen)
    select = _select(last, fragment, time)
    ask = fragment.ask or merged.ask
    negated = merged.negated if fragment.negated is None else fragment.negated
    somewhere = merged.relation is not None or merged.place is not None
    now = merged.now if fragment.query is not None else follows_now(fragment.text, ask, last)
    return replace(
        merged,
        text=fragment.text,
        corrections=fragment.corrections,
        ask=ask,
        time=time,
        select=select,
        negated=negated,
        contrary=contrary and negated and ask == "whether" and somewhere,
        now=now and time is None,
        form=form_of(ask, merged.relation, time, merged.place, select),
    )


def _time(last: FormalQuery, fragment: Fragment, seen: Seen | None) -> TimeSlice | None:
    """Return the slice that is asked for now."""
    if fragment.shift is not None:
        return _shifted(last.time, fragment.shift, fragment.text, seen)
    if fragment.relative is not None:
        told = last.ask in ("moved", "missing")  # before and after it moved, not the day asked of
        return _beside(None if told else last.time, fragment.relative, fragment.text, seen)
    if fragment.time is not None:
        return fragment.time
    return last.time if fragment.query is None else fragment.query.time


def _select(last: FormalQuery, fragment: Fragment, time: TimeSlice | None) -> Select:
    """Return which sightings are asked for: before that is the last of them, after it the first."""
    if fragment.select is not None:
        return fragment.select
    if fragment.relative == "before":
        return "last"
    if fragment.relative == "after":
        return "first"
    if fragment.query is not None:
        return fragment.query.select
    newest = last.select == "last" and last.ask == "where" and last.time is None
    return "all" if newest and time is not None else last.select


def _shifted(slice_: TimeSlice | None, shift: timedelta, text: str, seen: Seen | None) -> TimeSlice:
    """Return the slice moved by whole days or elapsed time; local times keep their clock."""
    if slice_ is None:
        if seen is None:
            raise _nothing_before(text)
        midnight = seen.end.replace(hour=0, minute=0, second=0, microsecond=0)
        whole = shift % timedelta(days=1) == timedelta(0)
        slice_ = (
            TimeSlice(midnight, midnight + timedelta(days=1))
            if whole
            else TimeSlice(seen.end, seen.end)
        )
    edge = slice_.start or slice_.end
    if edge is not None and None in (slice_.start, slice_.end):  # the day before `after that`
        last = edge if slice_.start is not None else edge - timedelta(microseconds=1)
        day = last.replace(hour=0, minute=0, second=0, microsecond=0)
        slice_ = TimeSlice(day, day + timedelta(days=1))
    start = slice_.start + shift if slice_.start is not None else None
    end = slice_.end + shift if slice_.end is not None else None
    return TimeSlice(start, end)


def _beside(
    slice_: TimeSlice | None, relative: Relative, text: str, seen: Seen | None
) -> TimeSlice:
    """Return the time before or after the slice, or before or after the answer without one."""
    start = slice_.start if slice_ is not None else None
    end = slice_.end if slice_ is not None else None
    before = start or (seen.start if seen else end)
    after = end or (seen.end if seen else start)
    if relative == "before":
        if before is None:
            raise _nothing_before(text)
        return TimeSlice(None, before)
    if after is None:
        raise _nothing_before(text)
    return TimeSlice(after if relative == "after" else before, None)


def _nothing_before(text: str) -> NotUnderstood:
    return NotUnderstood(text, 0, "No time was spoken of that this could start from.")


def _with_terms(last: FormalQuery, fragment: Fragment) -> FormalQuery:
    """Return the query with its objects replaced or described anew."""
    if not fragment.terms:
        return last
    count = _figures(last)
    figures, grounds = last.objects[:count], last.objects[count:]
    if len(fragment.terms) == 1 and _refers_back(fragment.terms[0], fragment.items):
        target = figures or (ObjectTerm(ANYTHING, "thing"),)
        changed = tuple(_described(term, fragment.terms[0]) for term in target)
        return replace(last, objects=(*changed, *grounds))
    if grounds and all(_is_anything(term) for term in figures):
        return replace(last, objects=(*figures, *fragment.terms))
    return replace(last, objects=(*fragment.terms, *grounds))


def _figures(query: FormalQuery) -> int:
    """Return how many of the objects are figures; the rest are what they are related to."""
    if query.relation is None or query.relation.kind in ("together", "same_place"):
        return len(query.objects)
    grounds = 2 if query.relation.kind == "between" and len(query.objects) > 2 else 1
    return max(len(query.objects) - grounds, 0)


def _refers_back(term: ObjectTerm, items: tuple[Item, ...]) -> bool:
    """Whether a term has no noun of its own: the red one, anna's, the one on the shelf."""
    whose = term.owner or term.not_owner
    looks = term.attributes or term.without or term.other_than
    described = items or looks or whose or term.quantity
    return term.category == ANYTHING and term.word == "thing" and bool(described)


def _is_anything(term: ObjectTerm) -> bool:
    return term.category == ANYTHING and not term.attributes and term.owner is None


def _described(term: ObjectTerm, change: ObjectTerm) -> ObjectTerm:
    """Return the object with new attributes in the place of those of their kind.

    What would have done as well does not after `the red one`: it is one of what was asked for.
    """
    kinds = lexicon().attributes
    new = {kinds.get(word, word) for word in (*change.attributes, *change.without)}
    kept = tuple(word for word in term.attributes if kinds.get(word, word) not in new)
    lacking = tuple(word for word in term.without if word not in change.attributes)
    return replace(
        term,
        attributes=(*kept, *change.attributes),
        without=(*lacking, *change.without),
        owner=change.owner or (term.owner if change.not_owner is None else None),
        not_owner=change.not_owner or (term.not_owner if change.owner is None else None),
        quantity=change.quantity or term.quantity,
        bound=change.bound if change.quantity else term.bound,
        or_else=change.or_else if new or change.owner or change.not_owner else term.or_else,
        other_than=(*term.other_than, *change.other_than),
    )


def _with_items(query: FormalQuery, fragment: Fragment) -> FormalQuery:
    """Return the query with a new place, or a new relation in the place of the old one."""
    for item in fragment.items:
        count = _figures(query)
        match item:
            case AtPlace():
                query = replace(query, place=item.name, or_places=item.others, outside=False)
            case Outside():
                query = replace(query, place=item.name, or_places=item.others, outside=True)
            case SideBySide():
                query = replace(query, relation=Relation(item.kind))
            case Related():
                objects = (*query.objects[:count], *item.group.terms)
                relation = Relation(item.kind, item.negated)
                query = replace(_nowhere(query), objects=objects, relation=relation)
            case _:
                query = _nowhere(query)
    return query


def _nowhere(query: FormalQuery) -> FormalQuery:
    """Return the query without its places."""
    return replace(query, place=None, or_places=(), outside=False)
