"""How much is read where far more was seen than can be told: the likeliest things, newest first.

A memory of months holds thousands of sightings of a common thing and a person is told fifty. So
that a question takes as long after a year as after a day, the rest is not read: objects that fit
the word and the looks best come first, of these the newest stays. What was cut is said
(`truncated`), and the objects are still counted, all of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import prod

from d3a.answering.match import Candidate
from d3a.answering.moments import Found, joined
from d3a.answering.run import Run, milliseconds
from d3a.answering.steps import (
    FilterPlace,
    FindEdge,
    FindSightings,
    Gather,
    JudgeAttributes,
    KeepOften,
    KeepPresent,
    KeepThen,
    KeepUsual,
    Relate,
)
from d3a.rank import LEAST_OF_BEST, TENTATIVE
from d3a.store.base import Sighting

READ_A_KEYFRAME = 2
"""Sightings that are read for each keyframe that may be shown."""
MOST_JOINED = 10_000
"""Sightings of either thing of a relation that are joined at most: the newest of them."""
AS_GOOD = 0.9
"""Objects this near to the best in worth are as good: then the newer one comes first."""
COUNTED = ("count", "how_long", "how_often")
_SIFTING = (FindEdge, KeepOften, KeepThen, KeepUsual)
_UNREAD = ("same_place", "between")


def find_bounded(run: Run, step: FindSightings) -> None:
    """Find the sightings of a step that takes no more than the answer can tell."""
    table = run.found[step.var]
    start, end = milliseconds(step.start), milliseconds(step.end)
    most = READ_A_KEYFRAME * run.limit
    found: list[Sighting] = []
    tiers = _tiers(table, (AS_GOOD, LEAST_OF_BEST) if step.select == "all" else (LEAST_OF_BEST,))
    for ids in tiers:
        left = most - len(found)
        if left > 0 and ids:
            oldest = step.select == "first"
            found += run.facts.newest(ids, left, start, end, oldest=oldest)
    table.sightings = joined(found)
    if len(found) >= most:
        last = None if end is None else end - 1
        run.counted = run.facts.count_seen(table.ids, start, last)
        run.cut = True


def find_joined(run: Run, step: FindSightings) -> None:
    """Find the sightings of a step that others are joined with, or that are counted.

    Of a relation at any time no more of a thing are joined than `MOST_JOINED`: all of its things
    are looked for from then on, or until then where the first is asked for. What is counted is
    read whole.
    """
    table = run.found[step.var]
    start, end = milliseconds(step.start), milliseconds(step.end)
    counted = run.query.ask in COUNTED
    joins = run.query.relation is not None or any(isinstance(s, Gather) for s in run.steps)
    if joins and start is None and end is None and not counted:
        _reach(run, oldest=run.query.select == "first")
        start = run.since_ms or None
        end = None if run.until_ms is None else run.until_ms + 1
    table.sightings = run.facts.sightings(table.ids, start, end)


def _reach(run: Run, *, oldest: bool) -> None:
    """Note from when on, or until when, the things found so far are joined."""
    for var in run.found.keys() - run.reached:
        reach = run.facts.reach(run.found[var].ids, MOST_JOINED, oldest=oldest)
        if reach is None:
            continue
        run.cut = True
        if oldest:
            run.until_ms = reach if run.until_ms is None else min(run.until_ms, reach)
        else:
            run.since_ms = max(run.since_ms, reach)
    run.reached |= run.found.keys()


def joins_late(run: Run) -> bool:
    """Whether what stood in a relation is counted over more sightings than are read whole.

    So what was together, of the figure in a place or anywhere, and of one kind the most at once.
    What stood otherwise is found by where it was, at any time.
    """
    joins = [step for step in run.steps if isinstance(step, Relate | Gather)]
    if len(joins) != 1 or run.rooms or any(isinstance(step, _SIFTING) for step in run.steps):
        return False
    (join,) = joins
    if join.negated or run.query.ask not in COUNTED:
        return False
    slices = {var: slice_of(run, var) for var in join.vars}
    if isinstance(join, Gather):
        known = join.most and len(join.vars) == 1
    else:
        known = join.keep == "moments" and len(join.vars) == 2
    if join.kind == "together":
        judged = any(isinstance(step, JudgeAttributes | KeepPresent) for step in run.steps)
        known = known and not judged
    else:
        placed = any(isinstance(step, FilterPlace) for step in run.steps)
        known = known and join.kind not in _UNREAD and not placed
        known = known and {*slices.values()} == {(None, None)}
    if not known or not all(run.found[var].candidates for var in join.vars):
        return False
    return any(run.facts.are_many(run.found[var].ids, *when) for var, when in slices.items())


def slice_of(run: Run, var: str) -> tuple[int | None, int | None]:
    """Return the closed interval that the sightings of a variable are asked for in."""
    find = next(s for s in run.steps if isinstance(s, FindSightings) and s.var == var)
    start, end = milliseconds(find.start), milliseconds(find.end)
    return start, None if end is None else end - 1


def finds_stays_late(run: Run) -> bool:
    """Whether stays are read of what meets in time alone: of thousands of sightings one in ten.

    So of one relation that two things must stand in at once, where nothing else narrows it.
    """
    relates = [step for step in run.steps if isinstance(step, Relate)]
    if not run.cut or len(relates) != 1 or run.rooms:
        return False
    relate = relates[0]
    at_once = relate.kind != "same_place" and not relate.negated and relate.keep == "moments"
    more = any(isinstance(s, FilterPlace | KeepPresent | JudgeAttributes) for s in run.steps)
    if not at_once or more or len(relate.vars) != 2:
        return False
    return all(run.found[var].candidates for var in relate.vars)


def keep_reached(run: Run, tables: Sequence[Found]) -> None:
    """Drop what was seen before the time from which a relation is looked for, or after its end.

    What describes a thing may have moved that time on, after the thing was found.
    """
    if run.since_ms:
        for table in tables:
            table.sightings = [s for s in table.sightings if s.end_ms >= run.since_ms]
    if run.until_ms is not None:
        for table in tables:
            table.sightings = [s for s in table.sightings if s.start_ms <= run.until_ms]


def _tiers(table: Found, shares: tuple[float, ...]) -> list[list[str]]:
    """Return the ids by worth: at least so large a share of the best's; the last take the rest."""
    worth = {name: worth_of(table.candidates[name]) for name in table.ids}
    best = max(worth.values(), default=0.0)
    tiers: list[list[str]] = [[] for _ in (*shares, 0.0)]
    place_of = {value: sum(value < share * best for share in shares) for value in {*worth.values()}}
    for name, value in worth.items():
        tiers[place_of[value]].append(name)
    return tiers


def worth_of(candidate: Candidate) -> float:
    """Return the part of a moment's score that its object alone decides."""
    told = candidate.match
    if candidate.attributes:  # of thousands of things most are asked without
        told *= prod(candidate.attributes.values())
    return told * TENTATIVE if candidate.record.tentative else told
