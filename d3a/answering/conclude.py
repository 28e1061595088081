"""From ranked moments to the record of the answer: keyframes, counts and the value asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime, timedelta
from operator import attrgetter

import numpy as np

from d3a.answer import Answer, RankedKeyframe
from d3a.answering import columns
from d3a.answering.distinct import least_number
from d3a.answering.missed import first_missed
from d3a.answering.moments import Entry, merged, single, total_ms
from d3a.answering.run import Run, milliseconds
from d3a.answering.steps import FindObjects, FindStretches
from d3a.frozen import maker
from d3a.model import Json
from d3a.rank import LEAST_OF_BEST, entry_score, is_tentative
from d3a.store.base import Sighting, Spans
from grammar.forms import VARIABLES, TimeSlice

_ranked_keyframe = maker(RankedKeyframe)
_BY_END = attrgetter("last", "rank")
_TICK = timedelta(milliseconds=1)
"""Times are kept in milliseconds."""


def conclude(run: Run, limit: int) -> Answer:
    """Return the answer of a finished run, cut to `limit` keyframes, without its sentence."""
    stayed = _stayed(run)
    keyframes, truncated = _keyframes(run, limit)
    moments = run.standing(one.moment for one in run.ranked)
    objects = {e.sighting.object_id for moment in moments for e in moment.entries[: run.figures]}
    least = least_of(run) or run.surely
    every = {spans.ids[of] for spans in run.spans.values() for of in np.unique(spans.of).tolist()}
    return Answer(
        text=run.query.text,
        status=run.status,
        reason=run.reason,
        query=run.query,
        count=max(len(objects), len(every), run.counted),
        value=_value(run, least, stayed),
        least=least,
        amounts=_amounts(run),
        kinds=_kinds(run),
        stayed=tuple([_span(run, span) for span in stayed]),
        in_view=_in_view_ms(run) / 1000 if stayed else 0.0,
        doubted=tuple([m.figure.candidate.record.category for m in run.doubted]),
        apart=run.apart,
        denied=len(run.denied.get(VARIABLES[0], ())),
        alike=len(run.found[VARIABLES[0]].candidates),
        named_alone=run.named_alone,
        precision=next((s.precision for s in run.steps if isinstance(s, FindObjects)), None),
        keyframes=tuple(keyframes),
        otherwise=_otherwise(run),
        perhaps=_perhaps(run, limit),
        unjudged=tuple(run.unjudged),
        suggestions=run.suggestions,
        message=run.message,
        last_looked=_moment(run, run.last_looked_ms),
        looked_then=run.looked_then,
        truncated=truncated or run.cut,
    )


def _keyframes(run: Run, limit: int) -> tuple[list[RankedKeyframe], bool]:
    """Return the keyframes of the moments, cut as `within` does."""
    out: list[RankedKeyframe] = []
    entries_of: list[Entry] = []
    run.find_spots([e for one in run.ranked[: max(limit, 1)] for e in one.moment.entries])
    for group, one in enumerate(run.ranked, 1):
        entries = one.moment.entries
        if len(out) >= max(limit, 1):
            break
        number = group if len(entries) > 1 else None
        for entry, why in zip(entries, one.why, strict=True):
            shown = keyframe(run, entry, len(out) + 1, one.score, why, group=number)
            out.append(_within_slice(run, shown))
            entries_of.append(entry)
    kept = _whole_moments(out, limit)
    likely = [k for k in kept if k.score >= LEAST_OF_BEST * max(each.score for each in kept)]
    for told in {k.rank: k for k in (*kept[:1], *sorted(likely, key=_BY_END)[-1:])}.values():
        kept[told.rank - 1] = _with_missed(run, told, entries_of[told.rank - 1])
    return kept, len(kept) < sum(len(one.moment.entries) for one in run.ranked)


def _with_missed(run: Run, shown: RankedKeyframe, entry: Entry) -> RankedKeyframe:
    """Return a keyframe that is told in words with when its place was first looked at without it.

    It is read for these alone: it takes a query.
    """
    if shown.last_absent is None or entry.stay is None:
        return shown
    missed_ms = first_missed(run.store, entry.stay, entry.sighting.end_ms)
    return replace(shown, first_missed=_moment(run, missed_ms))


def within(answer: Answer, limit: int) -> Answer:
    """Return the answer with at most `limit` keyframes, and whether any were left out."""
    kept, perhaps = _whole_moments(answer.keyframes, limit), answer.perhaps[: max(limit, 1)]
    if len(kept) == len(answer.keyframes) and len(perhaps) == len(answer.perhaps):
        return answer
    return replace(answer, keyframes=tuple(kept), perhaps=perhaps, truncated=True)


def _whole_moments(keyframes: Sequence[RankedKeyframe], limit: int) -> list[RankedKeyframe]:
    """Return the first keyframes, the objects of one moment together or not at all.

    Only the first moment may be cut, where it alone has more objects than the limit.
    """
    kept = list(keyframes[: max(limit, 0)])
    if len(kept) < len(keyframes) and kept and kept[-1].group is not None:
        group = kept[-1].group
        if keyframes[len(kept)].group == group and kept[0].group != group:
            return [k for k in kept if k.group != group]
    return kept


def keyframe(
    run: Run,
    entry: Entry,
    rank: int,
    score: float,
    why: Json,
    *,
    group: int | None = None,
) -> RankedKeyframe:
    """Return one entry of a moment as the answer shows it."""
    sighting, stay = entry.sighting, entry.stay
    position = stay.position if stay is not None else None
    absent = stay.last_absent_ms if stay is not None else None
    gone = absent if absent is not None and absent > sighting.end_ms else None
    start = _moment(run, sighting.start_ms)
    end = start if sighting.end_ms == sighting.start_ms else _moment(run, sighting.end_ms)
    assert start is not None
    assert end is not None
    spot = run.spot(entry)
    return _ranked_keyframe(
        rank=rank,
        score=score,
        object_id=sighting.object_id,
        category=entry.candidate.record.category,
        frame=sighting.frame,
        probability=sighting.probability,
        box=sighting.box,
        start=start,
        end=end,
        position=position,
        place=spot.place,
        near=spot.near,
        vague=spot.vague,
        seen=sighting.seen,
        last_absent=_moment(run, gone),
        image=sighting.image,
        why=why,
        group=group,
        beyond=spot.beyond,
        within=None,
        first_missed=None,
    )


def _within_slice(run: Run, shown: RankedKeyframe) -> RankedKeyframe:
    """Return a keyframe with the part of its interval in the asked slice, where it goes beyond.

    A slice ends before its end. Around a moment and of a change what lies outside is asked for.
    """
    time = run.query.time
    if time is None or time.is_point:
        return shown
    first, last = shown.start, shown.end
    if time.start is not None and first < time.start <= last:
        first = time.start.astimezone(first.tzinfo)
    if time.end is not None and first < time.end <= last:
        last = (time.end - _TICK).astimezone(last.tzinfo)
    is_whole = (first, last) == (shown.start, shown.end)
    return shown if is_whole else replace(shown, within=(first, last))


def _otherwise(run: Run) -> RankedKeyframe | None:
    if run.perhaps:
        return _perhaps(run, 1)[0]
    if run.otherwise is None:
        return None
    entry = run.otherwise.figure
    score, why = entry_score(entry)
    if run.refused:
        why["refused"] = list(run.refused)
    if run.looked:
        why["looked"] = list(run.looked)
    return _with_missed(run, keyframe(run, entry, 1, min(1.0, score), why), entry)


def _perhaps(run: Run, limit: int) -> tuple[RankedKeyframe, ...]:
    """Return what may be what was asked for, as many of the likeliest as are told.

    Where several descriptions will do, each tells the looks of the one that it may be.
    """
    told = run.perhaps[: max(limit, 1)]
    several = any(term.or_else for term in run.query.objects)
    refused = {"refused": list(run.refused)} if run.refused else {}
    run.find_spots([one.moment.figure for one in told])
    return tuple(
        keyframe(
            run,
            one.moment.figure,
            number,
            one.score,
            why | ({"refused": [*why["attributes"]]} if several else refused),
        )
        for number, one in enumerate(told, 1)
        for why in one.why
    )


def least_of(run: Run) -> int:
    """Return how many of the found objects must be different things, over their categories.

    What was seen too seldom to be confirmed may be a mistake: it is one at least where all is so.
    """
    if run.spans:
        return sum(_least_of_many(run, var, spans) for var, spans in run.spans.items())
    moments = run.standing(one.moment for one in run.ranked)
    entries = [
        entry
        for moment in moments
        for entry in moment.entries[: run.figures]
        if entry.sighting.object_id not in run.elsewhere
    ]
    return _least(entries) or min(len(entries), 1)


def _least(entries: Sequence[Entry]) -> int:
    return sum(_least_by_kind(entries).values())


def _least_by_kind(entries: Sequence[Entry]) -> dict[str, int]:
    """Return how many things there must be of each category."""
    of: dict[str, list[Sighting]] = {}
    for entry in entries:
        if not is_tentative(entry):
            of.setdefault(entry.candidate.record.category, []).append(entry.sighting)
    return {kind: least_number(sightings) for kind, sightings in of.items()}


def _kinds(run: Run) -> tuple[tuple[str, int], ...]:
    """Return how many things there must be of each category that is listed."""
    if run.query.ask not in ("what", "whether"):
        return ()
    if run.spans:
        many = [_least_by_kind_of_many(run, var, spans) for var, spans in run.spans.items()]
        return tuple(each for least in many for each in least.items())
    moments = run.standing(one.moment for one in run.ranked)
    entries = [entry for moment in moments for entry in moment.entries[: run.figures]]
    return tuple(_least_by_kind(entries).items())


def _amounts(run: Run) -> tuple[tuple[int, int], ...]:
    """Return the least and the most of each of several objects that were counted at once."""
    if run.query.ask != "count" or run.query.relation is not None or len(run.query.objects) < 2:
        return ()
    entries = [m.figure for m in run.standing(one.moment for one in run.ranked)]
    out: list[tuple[int, int]] = []
    for term in run.query.objects:
        if term.var in run.spans:
            spans = run.spans[term.var]
            out.append((_least_of_many(run, term.var, spans), len(np.unique(spans.of))))
            continue
        own = run.found[term.var].candidates
        its = [entry for entry in entries if own.get(entry.sighting.object_id) is entry.candidate]
        out.append((_least(its), len({entry.sighting.object_id for entry in its})))
    return tuple(out)


def _stayed(run: Run) -> list[tuple[int, int]]:
    """Return from when to when it was so, in the asked slice; of what is so still, since when.

    Then what was seen before that is told, too.
    """
    if not run.stretches or not run.ranked:
        return []
    found = next(step for step in run.steps if isinstance(step, FindStretches))
    if not found.newest:
        shown = {one.moment.figure.sighting.object_id for one in run.ranked}
        every = found.var in run.spans  # of which those are told that were chosen
        so = (one for one in run.stretches if every or one.object_id in shown)
        spans = [(one.start_ms, one.end_ms) for one in so]
        return merged(_clipped(run, spans))
    best = run.ranked[0].moment.figure.sighting.object_id
    newest = [one for one in run.stretches if one.object_id == best][-1]
    if newest.before is not None and run.otherwise is None:
        table = run.found[found.var]
        table.stays |= run.facts.stays_of([newest.before])
        run.otherwise = single(table, newest.before)
    return [(newest.start_ms, newest.end_ms)]


def _span(run: Run, span: tuple[int, int]) -> tuple[datetime, datetime]:
    start, end = (_moment(run, at_ms) for at_ms in span)
    assert start is not None
    assert end is not None
    return start, end


def _in_view_ms(run: Run) -> int:
    """Return for how long it was seen to be so, in the asked slice."""
    if not run.spans:
        return total_ms(_clipped(run, [(m.start_ms, m.end_ms) for m, *_ in run.ranked]))
    low, high = _asked_span(run)
    start, end = (np.concatenate(each) for each in zip(*_occasions(run), strict=True))
    start = start if low is None else np.maximum(start, low)
    end = end if high is None else np.minimum(end, high)
    return int(columns.covered_ms(np.zeros_like(start), start, end, 1)[0])


def _occasions(run: Run) -> list[tuple[columns.Ints, columns.Ints]]:
    """Return when it was so, of each variable with more than is told."""
    return [
        (run.so[var].start_ms, run.so[var].end_ms) if var in run.so else columns.occasions(spans)
        for var, spans in run.spans.items()
    ]


def _value(run: Run, least: int, stayed: Sequence[tuple[int, int]]) -> float | None:
    """Return the number asked for: objects that must be different, seconds, sightings.

    Of things that were together: how many were so at once.
    """
    if run.query.ask == "count":
        return float(least if run.figures == 1 else run.figures)
    if run.query.ask == "how_often":
        return float(sum(len(start) for start, _ in _occasions(run)) or len(run.ranked))
    if run.query.ask == "how_long" and stayed and _lasts_still(run):  # until now, as it is told
        now_ms = milliseconds(run.now)
        assert now_ms is not None
        return (now_ms - stayed[0][0]) / 1000
    if run.query.ask == "how_long":
        return (total_ms(stayed) if stayed else _in_view_ms(run)) / 1000
    return None


def _lasts_still(run: Run) -> bool:
    """Whether it is asked how long something has been so, and is so still."""
    return any(isinstance(step, FindStretches) and step.newest for step in run.steps)


def _least_of_many(run: Run, var: str, spans: Spans) -> int:
    """Return how many objects must be different things, over their categories; see `least_of`."""
    return sum(_least_by_kind_of_many(run, var, spans).values()) or min(len(spans), 1)


def _least_by_kind_of_many(run: Run, var: str, spans: Spans) -> dict[str, int]:
    candidates = run.found[var].candidates
    kinds = [candidates[name].record.category for name in spans.ids]
    number = {kind: n for n, kind in enumerate(dict.fromkeys(kinds))}
    kind_of = np.array([number[kind] for kind in kinds], dtype=np.int64)[spans.of]
    sure = ~np.array([candidates[name].record.tentative for name in spans.ids])[spans.of]
    parts = {kind: spans.chosen((kind_of == n) & sure) for kind, n in number.items()}
    return {
        kind: columns.least_number(part.of, part.start_ms, part.end_ms)
        for kind, part in parts.items()
    }


def _clipped(run: Run, spans: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return the intervals inside of the asked slice."""
    low, high = _asked_span(run)
    return [
        (start if low is None else max(start, low), end if high is None else min(end, high))
        for start, end in spans
        if (low is None or end >= low) and (high is None or start <= high)
    ]


def _asked_span(run: Run) -> tuple[int | None, int | None]:
    """Return the ends of the asked slice; of a point none: how long around that moment."""
    time = run.query.time
    if time is None or time.is_point:
        time = TimeSlice()
    return milliseconds(time.start), milliseconds(time.end)


def _moment(run: Run, at_ms: int | None) -> datetime | None:
    """Return milliseconds as an aware time in the zone of `now`."""
    if at_ms is None:
        return None
    return datetime.fromtimestamp(at_ms / 1000, tz=run.now.tzinfo)
