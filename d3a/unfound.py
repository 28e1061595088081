"""The honest no: why nothing was found, and the nearest true keyframe outside of what was asked."""

from __future__ import annotations

from collections.abc import Sequence

from d3a.moments import Moment, single
from d3a.plan import ExplainEmpty
from d3a.rank import rank
from d3a.run import Run, milliseconds
from d3a.store.base import Sighting


def explain_empty(run: Run, step: ExplainEmpty) -> None:
    """Set status, reason, the keyframe to tell instead, and suggestions of a run without finds."""
    run.status = "not_found"
    if not run.categories():
        run.reason = "empty"
        return
    for term in run.query.objects:
        if not run.found[term.var].known and (term is run.query.objects[0] or _needed(run)):
            _unknown(run, term.category, term.word)
            if term is not run.query.objects[0]:
                run.message = f"“{term.word}” is neither a category nor a taught name here."
            return
    figure = run.found[step.var]
    if not figure.candidates:
        run.reason = "never"
        return
    if run.before_relation or run.before_place:
        run.reason = "not_there"
        run.otherwise = _newest(run.before_relation or run.before_place)
        run.find_landmarks()
        return
    outside = _outside(run, step)
    if outside:
        run.reason = "not_then"
        run.otherwise = outside[0]
        run.find_landmarks()
        return
    run.reason = "never"


def _needed(run: Run) -> bool:
    """Whether the query cannot be answered without its other objects."""
    return run.query.relation is not None and run.query.relation.kind == "together"


def _unknown(run: Run, category: str, word: str) -> None:
    """No category, taught name or class is this word: tell the nearest that there are."""
    run.status = "unknown_object"
    run.reason = "not_recognisable" if run.classes() is not None else "never"
    spelled = {run.lexicon.canonical(c): c for c in run.categories()}
    names = [name.word for name in run.store.names()]
    near = [*run.lexicon.nearest(word, [*names, *spelled])]
    if word != category:
        near += run.lexicon.nearest(category, [*names, *spelled])
    run.suggestions = tuple(dict.fromkeys(near))[:3]


def _newest(moments: Sequence[Moment]) -> Moment | None:
    ordered = rank(moments, "last", spread=False)
    return ordered[0].moment if ordered else None


def _outside(run: Run, step: ExplainEmpty) -> list[Moment]:
    """Return sightings outside of the slice, the nearest in time first."""
    if step.time is None:
        return []
    table = run.found[step.var]
    start, end = milliseconds(step.time.start), milliseconds(step.time.end)
    found: list[Sighting] = []
    if start is not None:
        found += run.store.edges(table.ids, "last", before_ms=start)
    if end is not None:
        found += run.store.edges(table.ids, "first", after_ms=end)
    if not found:
        return []
    table.stays = {stay.key: stay for stay in run.store.stays(object_ids=table.ids)}

    def apart(sighting: Sighting) -> tuple[int, int, str]:
        before = start - sighting.end_ms if start is not None else 0
        after = sighting.start_ms - end if end is not None else 0
        return (max(before, after, 0), sighting.start_ms, sighting.object_id)

    return [single(table, sighting) for sighting in sorted(found, key=apart)]
