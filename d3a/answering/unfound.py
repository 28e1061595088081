"""The honest no: why nothing was found, and the nearest true keyframe outside of what was asked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from d3a.answering.attributes import merged_shades, seen_colours
from d3a.answering.conclude import least_of
from d3a.answering.distinct import may_be_one, things_of
from d3a.answering.moments import Found, Moment, in_slice, single
from d3a.answering.places import last_look, newest_look
from d3a.answering.points import edge_of, looked_at
from d3a.answering.run import Run, milliseconds
from d3a.colours import is_colour
from d3a.plan import ExplainEmpty
from d3a.rank import LEAST_OF_BEST, rank
from d3a.store.base import Sighting, StayKey
from grammar.forms import ANYTHING, ObjectTerm


def explain_empty(run: Run, step: ExplainEmpty) -> None:
    """Set status, reason, the keyframe to tell instead, and suggestions of a run without finds.

    "Did you see the cup and the bowl?" is a no when either was not seen: the other is told.
    """
    unseen = [] if run.moments is not None else [v for v in step.vars if not run.found[v].sightings]
    if run.ranked and not (unseen and run.query.ask == "whether"):
        if _is_another_number(run):
            return
        if edge_of(run.query) is not None:  # what was found may be of before and after
            run.looked_then = _looked_then(run, step)
        elif run.query.ask == "whether" and run.query.negated:
            _tell_elsewhere(run, step)
        elif run.query.ask == "moved":
            _tell_where_from(run)
        return
    run.status = "not_found"
    best = run.ranked[0].moment if run.ranked else None
    run.ranked = []
    run.spans.clear()
    if not run.facts.categories():
        run.reason = "empty"
        return
    var = unseen[0] if unseen else step.vars[0]
    _say_which(run, var)
    for name, term in zip(_needed(run, var), _terms(run, var), strict=True):
        if not run.found[name].known:
            _unknown(run, term.category, term.word)
            _say_which(run, name)
            return
    _why(run, step, var)
    run.otherwise = run.otherwise or best
    run.find_landmarks()


def _tell_elsewhere(run: Run, step: ExplainEmpty) -> None:
    """Tell where it was too in the slice, of which it is asked whether it was not there."""
    var = step.vars[0]
    sifted = run.before_place.get(var) or run.before_relation.get(var)
    if not sifted or run.otherwise is not None or run.query.select != "all":
        return
    shown = {e.sighting.stay for one in run.ranked for e in one.moment.entries}
    away = [s for s in sifted if s.stay not in shown]
    run.otherwise = _newest(run.found[var], away) if away else None


def _tell_where_from(run: Run) -> None:
    """Tell where the one thing that moved was before its newest move; of several each is a row."""
    if len({name for one in run.ranked for name in one.moment.ids}) > 1:
        return
    least = max(one.score for one in run.ranked) * LEAST_OF_BEST
    likely = [one.moment for one in run.ranked if one.score >= least]
    moved = max(likely, key=lambda moment: moment.end_ms).figure
    before = run.came_from.get((moved.sighting.stay, moved.sighting.start_ms))
    table = run.found[run.var_of(moved)]  # of several that are asked for it may be any
    run.otherwise = None if before is None else single(table, before)


def _is_another_number(run: Run) -> bool:
    """Say whether fewer or more were seen than a yes or no was asked of: a no with their number.

    Too few are they where all objects are, though two ids may be one thing; too many where those
    are that must be different things.
    """
    term = run.query.objects[0] if run.query.objects else ObjectTerm(ANYTHING)
    if run.query.ask != "whether" or term.quantity is None or run.figures > 1:
        return False
    standing = {id(moment) for moment in run.standing(one.moment for one in run.ranked)}
    ranked = [one for one in run.ranked if id(one.moment) in standing]
    number = len({one.moment.figure.sighting.object_id for one in ranked})
    number = max(number, *(len(np.unique(spans.of)) for spans in run.spans.values()), 0)
    judged = term.bound != "least" and not run.unjudged  # of four cups two may be wooden
    different = least_of(run)
    surely = different if judged else 0
    few = number < term.quantity and term.bound != "most"
    if not few and surely <= term.quantity:
        return False
    least = max(one.score for one in ranked) * LEAST_OF_BEST
    likely = [one.moment for one in ranked if one.score >= least]
    run.status, run.reason, run.ranked = "not_found", "never", []
    run.spans.clear()
    run.counted, run.surely = number, different
    run.otherwise = max(likely, key=lambda moment: moment.end_ms)
    run.find_landmarks()
    return True


def _why(run: Run, step: ExplainEmpty, var: str) -> None:
    """Set the reason of a no for a variable whose word is known, and what to tell instead."""
    run.reason = "never"
    table = run.found[var]
    run.looked_then = _looked_then(run, step)
    if table.refused and not table.candidates:
        _tell_refused(run, var)
        return
    if run.query.ask == "moved" and run.term(var).category != ANYTHING:
        _seen_apart(run, step, var)
        return
    if run.query.ask in ("moved", "missing") or not table.candidates:
        return
    for name in dict.fromkeys((var, *(term.var for term in run.query.objects))):
        if run.found[name].gone:  # or what it stood in the relation to left
            run.reason, run.otherwise = "gone", _newest(run.found[name], run.found[name].gone)
            _say_which(run, name)
            return
    sifted = run.before_relation.get(var) or run.before_place.get(var)
    if sifted and run.until_ms is not None:  # these are the oldest, what is told is the newest
        sifted = run.store.edges(table.ids, "last")
        table.stays |= run.facts.stays_of(sifted)
    outside = [] if sifted else _outside(run, step, var)
    if sifted or outside:
        run.reason = "not_there" if sifted else "not_then"
        if run.otherwise is None and not _is_anything_somewhere(run, var):
            run.otherwise = _newest(table, sifted) if sifted else outside[0]


def _is_anything_somewhere(run: Run, var: str) -> bool:
    """Whether anything at all was asked for, at a place: what was elsewhere says nothing of it."""
    term, somewhere = run.term(var), run.query.relation is not None or run.query.place is not None
    return somewhere and term.category == ANYTHING and not (term.attributes or term.without)


def _tell_refused(run: Run, var: str) -> None:
    """Tell the newest of what the word means, where none of it has the attributes asked for.

    Where some of it may have them after all, tell that, each thing once.
    """
    table, term = run.found[var], run.term(var)
    maybe = [candidate for candidate in table.refused if candidate.attributes]
    meant = Found({c.record.object_id: c for c in maybe or table.refused})
    meant.stays = run.facts.stays(meant.ids)
    newest = run.store.edges(meant.ids, "last")
    if maybe:
        run.perhaps = rank([single(meant, s) for s in newest], "all", spread=False)
    run.otherwise = run.perhaps[0].moment if run.perhaps else _newest(meant, newest)
    run.refused = (*term.attributes, *(f"not {word}" for word in term.without))
    if any(map(is_colour, merged_shades(term.attributes))) and not maybe and run.otherwise:
        told = seen_colours(run.facts.looks([run.otherwise.figure.candidate.record]))
        run.looked = told.get(0, ())


def _seen_apart(run: Run, step: ExplainEmpty, var: str) -> None:
    """Note at how many places the word's things were seen, where any two may be one that moved.

    So they may where no round showed both, or where the one was last seen before the other was
    first: within a round, too, a thing may be carried. Else tell what left its place and was not
    seen again.
    """
    from d3a.answering.changes import by_object, left_places  # what was found does without

    table, time = run.found[var], looked_at(step.time)
    start, end = milliseconds(time.start), milliseconds(time.end)
    inside = [s for s in table.sightings if in_slice(s, start, end)]
    seen = by_object(inside)
    things = things_of(
        replace(
            table.candidates[name].record,
            first_ms=sightings[0].start_ms,
            last_ms=max(s.end_ms for s in sightings),
        )
        for name, sightings in seen.items()
    )
    alike: dict[str, list[Sighting]] = {}
    for sighting in inside:
        kind = table.candidates[sighting.object_id].record.category
        alike.setdefault(kind, []).append(sighting)
    if len(set(things.values())) < len(seen) or any(map(may_be_one, alike.values())):
        run.apart = len({s.stay for s in inside})
        newest = {s.stay: s for s in sorted(inside, key=lambda s: s.end_ms)}
        run.perhaps = rank([single(table, s) for s in newest.values()], "last", spread=False)
        run.otherwise = run.perhaps[0].moment
    elif gone := [s for left in left_places(run, var) for s in left.sightings if s in inside]:
        run.reason, run.otherwise = "gone", _newest(table, gone)


def _looked_then(run: Run, step: ExplainEmpty) -> bool | None:
    """Return whether there was a look in the asked slice; None where no time was asked for.

    Where a room is asked for and the poses are known, whether the look was into it. One that was
    never looked into was not at any time.
    """
    if step.time is None:
        return False if _is_unvisited(run, step.place) else None
    time = looked_at(step.time)
    start, end = milliseconds(time.start), milliseconds(time.end)
    views = run.store.views(start_ms=start, end_ms=None if end is None else end - 1)
    region = run.region(step.place) if step.place is not None else None
    if region is None or any(view.x is None for view in views):
        return bool(views)
    return last_look(views, region) is not None


def _is_unvisited(run: Run, place: str | None) -> bool:
    """Whether a place is one that no look was ever into, as far as all poses are known."""
    region = run.region(place)
    if region is None or run.query.outside:
        return False
    if newest_look(run.store, region, run.facts.last_view_ms()) is not None:
        return False
    return all(view.x is not None for view in run.store.views())


def _say_which(run: Run, var: str) -> None:
    """Note which of several objects the no is about, as said."""
    if len(run.query.objects) > 1 and var != run.query.objects[0].var:
        term = run.term(var)
        said = " ".join((*term.attributes, term.word))
        run.message = f"The answer is about “{said}”."


def _needed(run: Run, var: str) -> list[str]:
    """Return the variables without which there is no answer: both of what was together."""
    together = run.query.relation is not None and run.query.relation.kind == "together"
    return [term.var for term in run.query.objects] if together else [var]


def _terms(run: Run, var: str) -> list[ObjectTerm]:
    return [run.term(name) for name in _needed(run, var)]


def _unknown(run: Run, category: str, word: str) -> None:
    """No category, taught name or class is this word: tell the nearest that there are."""
    run.status = "unknown_object"
    run.reason = "not_recognisable" if run.facts.classes() is not None else "never"
    spelled = {run.lexicon.canonical(c): c for c in run.facts.categories()}
    names = [name.word for name in run.facts.names()]
    near = [*run.lexicon.nearest(word, [*names, *spelled])]
    if word != category:
        near += run.lexicon.nearest(category, [*names, *spelled])
    run.suggestions = tuple(dict.fromkeys(near))[:3]


def _newest(table: Found, sightings: Sequence[Sighting]) -> Moment | None:
    """Return the likely moment that is nearest to now, of each place its newest alone.

    How likely it lay in the place asked for, or stood in the relation, is no part of that.
    """
    newest: dict[StayKey, Sighting] = {}
    for sighting in sorted(sightings, key=lambda s: (s.end_ms, s.start_ms)):
        newest[sighting.stay] = sighting
    anywhere = replace(table, place={}, held={})
    ordered = rank([single(anywhere, s) for s in newest.values()], "last", spread=False)
    return ordered[0].moment if ordered else None


def _outside(run: Run, step: ExplainEmpty, var: str) -> list[Moment]:
    """Return sightings outside of the slice, the nearest in time first."""
    if step.time is None:
        return []
    table = run.found[var]
    time = looked_at(step.time)
    start, end = milliseconds(time.start), milliseconds(time.end)
    found: list[Sighting] = []
    if start is not None:
        found += run.store.edges(table.ids, "last", before_ms=start)
    if end is not None:
        found += run.store.edges(table.ids, "first", after_ms=end)
    if not found:
        return []
    table.stays = run.facts.stays(table.ids)

    def apart(sighting: Sighting) -> tuple[int, int, str]:
        before = start - sighting.end_ms if start is not None else 0
        after = sighting.start_ms - end if end is not None else 0
        return (max(before, after, 0), sighting.start_ms, sighting.object_id)

    return [single(table, sighting) for sighting in sorted(found, key=apart)]
