"""Where a thing is of which one is meant, as the wallet or my keys: where its newest likeness was.

What was carried comes back as a new object as often as not, so that an old id may say that a thing
is where it was hours ago. Where no round ever showed two of what may be meant, it is one thing by
all that was seen, and it is at its newest place.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from d3a.answering import columns
from d3a.answering.departures import Looks
from d3a.answering.distinct import ROUND_GAP_MS, least_number
from d3a.answering.moments import Entry, Moment
from d3a.answering.run import Run
from d3a.rank import LEAST_OF_BEST
from d3a.store.base import Sighting


def at_newest_likeness(
    run: Run,
    var: str,
    moments: list[Moment],
    newest: Mapping[str, Sighting],
    before: Sequence[Sighting] | None,
) -> list[Moment]:
    """Return the moments without those that a known thing's newest likeness tells to be over.

    newest: of every object of the moments. before: all that was seen of what may be meant, where
    not all of it is found any more. What has an owner is one thing for whoever asks; else a moment
    is over where its place was looked at again since: in a room that nobody looked into there may
    be another. What is large and stays is never elsewhere.
    """
    table = run.found[var]
    last = _newest_likeness(run, var, newest, table.sightings if before is None else before)
    if last is None:
        return moments
    stay = {name for name, _ in run.facts.landmarks(run.lexicon).stays}
    others = {name for name in table.candidates if name != last} - stay
    is_own = run.term(var).owner is not None
    kept: list[Moment] = []
    for moment in moments:
        its = (e for e in moment.entries if e.sighting.object_id in others)
        old = [e for e in its if run.var_of(e) == var]
        if not old or not all(is_own or _was_looked_at(run, e, newest) for e in old):
            kept.append(moment)
    if moments and not kept:
        table.gone.append(newest[last])
    return kept


def _was_looked_at(run: Run, entry: Entry, newest: Mapping[str, Sighting]) -> bool:
    """Whether a later round looked at the place where an object was seen last."""
    if entry.stay is None:
        return False
    since_ms = newest[entry.sighting.object_id].end_ms + ROUND_GAP_MS
    views = [view for view in run.store.views(start_ms=since_ms) if view.start_ms >= since_ms]
    last_ms = max((view.end_ms for view in views), default=0)
    return bool(Looks(views).at(entry.stay, last_ms))


def _newest_likeness(
    run: Run, var: str, newest: Mapping[str, Sighting], before: Sequence[Sighting]
) -> str | None:
    """Return the object seen last among those that are about as likely meant as the best.

    None where one round showed two of them: which of several is meant, nobody knows.
    """
    table, ids = run.found[var], {s.object_id for s in before}
    worth = {
        name: c.match * math.prod(c.attributes.values())
        for name, c in table.candidates.items()
        if name in ids
    }
    least = LEAST_OF_BEST * max(worth.values(), default=0.0)
    likely = [name for name in sorted(worth) if worth[name] >= least]
    sure = {name for name in likely if not table.candidates[name].record.tentative}
    if least_number([newest[name] for name in sure]) > 1:  # told by little, as mostly
        return None
    if var in run.newest_alone:
        seen = run.facts.spans(sorted(sure), None, None)
        if columns.least_number(seen.of, seen.start_ms, seen.end_ms) > 1:
            return None
    elif least_number([s for s in before if s.object_id in sure]) > 1:
        return None
    return max(likely, key=lambda name: (newest[name].end_ms, name), default=None)
