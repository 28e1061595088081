"""From ranked moments to the record of the answer: keyframes, counts and the value asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime

from d3a.answer import Answer, RankedKeyframe
from d3a.answering.distinct import least_number
from d3a.answering.moments import Entry, total_ms
from d3a.answering.run import Run, milliseconds
from d3a.answering.steps import FindObjects
from d3a.frozen import maker
from d3a.model import Json
from d3a.rank import Ranked, entry_score
from d3a.store.base import Sighting
from grammar.forms import VARIABLES, TimeSlice

_ranked_keyframe = maker(RankedKeyframe)


def conclude(run: Run, limit: int) -> Answer:
    """Return the answer of a finished run, cut to `limit` keyframes, without its sentence."""
    keyframes, truncated = _keyframes(run, limit)
    moments = run.standing(one.moment for one in run.ranked)
    objects = {e.sighting.object_id for moment in moments for e in moment.entries[: run.figures]}
    least = least_of(run) or run.surely
    return Answer(
        text=run.query.text,
        status=run.status,
        reason=run.reason,
        query=run.query,
        count=max(len(objects), run.counted),
        value=_value(run, least),
        least=least,
        apart=run.apart,
        denied=len(run.denied.get(VARIABLES[0], ())),
        precision=next((s.precision for s in run.steps if isinstance(s, FindObjects)), None),
        keyframes=tuple(keyframes),
        otherwise=_otherwise(run),
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
    run.find_spots([e for one in run.ranked[: max(limit, 1)] for e in one.moment.entries])
    for group, one in enumerate(run.ranked, 1):
        entries = one.moment.entries
        if len(out) >= max(limit, 1):
            break
        number = group if len(entries) > 1 else None
        for entry, why in zip(entries, one.why, strict=True):
            out.append(keyframe(run, entry, len(out) + 1, one.score, why, group=number))
    kept = _whole_moments(out, limit)
    return kept, len(kept) < sum(len(one.moment.entries) for one in run.ranked)


def within(answer: Answer, limit: int) -> Answer:
    """Return the answer with at most `limit` keyframes, and whether any were left out."""
    kept = _whole_moments(answer.keyframes, limit)
    if len(kept) == len(answer.keyframes):
        return answer
    return replace(answer, keyframes=tuple(kept), truncated=True)


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
    )


def _otherwise(run: Run) -> RankedKeyframe | None:
    if run.otherwise is None:
        return None
    entry = run.otherwise.figure
    score, why = entry_score(entry)
    if run.refused:
        why["refused"] = list(run.refused)
    return keyframe(run, entry, 1, min(1.0, score), why)


def least_of(run: Run) -> int:
    """Return how many of the found objects must be different things, over their categories."""
    of: dict[str, list[Sighting]] = {}
    for moment in run.standing(one.moment for one in run.ranked):
        for entry in moment.entries[: run.figures]:
            of.setdefault(entry.candidate.record.category, []).append(entry.sighting)
    return sum(least_number(sightings) for sightings in of.values())


def _value(run: Run, least: int) -> float | None:
    """Return the number asked for: objects that must be different, seconds, sightings.

    Of things that were together: how many were so at once.
    """
    if run.query.ask == "count":
        return float(least if run.figures == 1 else run.figures)
    if run.query.ask == "how_often":
        return float(len(run.ranked))
    if run.query.ask == "how_long":
        return total_ms(_clipped(run, run.ranked)) / 1000
    return None


def _clipped(run: Run, ranked: Sequence[Ranked]) -> list[tuple[int, int]]:
    """Return the moments' intervals inside of the asked slice."""
    time = run.query.time
    if time is None or time.is_point:  # how long around that moment
        time = TimeSlice()
    low, high = milliseconds(time.start), milliseconds(time.end)
    spans = [(one.moment.start_ms, one.moment.end_ms) for one in ranked]
    return [
        (start if low is None else max(start, low), end if high is None else min(end, high))
        for start, end in spans
        if (low is None or end >= low) and (high is None or start <= high)
    ]


def _moment(run: Run, at_ms: int | None) -> datetime | None:
    """Return milliseconds as an aware time in the zone of `now`."""
    if at_ms is None:
        return None
    return datetime.fromtimestamp(at_ms / 1000, tz=run.now.tzinfo)
