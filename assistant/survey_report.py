"""A recording's survey as lines for a person: what is there, what is missing, what that costs."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime, tzinfo
from statistics import median
from typing import TYPE_CHECKING
from zoneinfo import ZoneInfo

from assistant.intake_report import duration

if TYPE_CHECKING:
    from d3a.ingesting.survey import Lack, Survey
    from d3a.readers.base import Stream

PARTS = {
    "image": "a picture",
    "depth": "depth",
    "pose": "a pose",
    "camera": "intrinsics",
    "located": "depth, pose and intrinsics at once",
    "detections": "a detector's answer",
}
MOST_CATEGORIES = 8
MOST_GAPS = 3


def lines(found: Survey, source: str, format_name: str) -> Iterator[str]:
    """Yield the survey."""
    from d3a.ingesting.survey import lacks

    facts = found.facts
    zone: tzinfo = UTC if facts.zone is None else ZoneInfo(facts.zone)
    yield f"source      {source} (format {format_name})"
    site = f", site {facts.site}" if facts.site else ""
    yield f"recording   {facts.name}{site}, {facts.zone or 'no time zone: times below are UTC'}"
    for note in facts.notes:
        yield f"note        {note}"
    if found.streams:
        yield "parts"
        for stream in found.streams:
            yield f"  {stream.name}: {_stream(stream, zone)}{_covers(found, stream)}"
    if found.links:
        yield "tf tree"
        for link in found.links:
            how = "fixed" if link.is_fixed else f"{link.count} transforms"
            yield f"  {link.parent} -> {link.child} ({how})"
    yield f"frames      {_stream(found.frames, zone)}"
    for part, said in PARTS.items():
        if found.frames.count:
            yield f"  {found.having[part]} with {said}"
    yield from _gaps(found, zone)
    yield from _looked(found)
    yield from _left_out(found)
    yield from _lacking(list(lacks(found)), source)


def _stream(stream: Stream, zone: tzinfo) -> str:
    parts = [str(stream.count)]
    if stream.kind != "frames":
        parts.insert(0, stream.kind)
    if stream.rate_hz is not None:
        rate = stream.rate_hz
        often = rate >= 0.1
        parts.append(f"{rate:.3g} a second" if often else f"one each {duration(1 / rate)}")
    if stream.first_ms is not None and stream.last_ms is not None:
        parts.append(f"{_time(stream.first_ms, zone)} to {_time(stream.last_ms, zone)}")
    if stream.longest_gap_s is not None:
        gap_s = stream.longest_gap_s
        parts.append(f"longest gap {f'{gap_s:.3g} s' if gap_s < 10 else duration(gap_s)}")
    return ", ".join(parts)


def _covers(found: Survey, stream: Stream) -> str:
    share = found.coverage.get(stream.name)
    return "" if share is None else f", spans {share:.0%} of the frames' time"


def _time(time_ms: int, zone: tzinfo) -> str:
    try:
        moment = datetime.fromtimestamp(time_ms / 1000, UTC).astimezone(zone)
    except (OverflowError, ValueError, OSError):
        return f"{time_ms} ms"
    return moment.isoformat(sep=" ", timespec="milliseconds")


def _gaps(found: Survey, zone: tzinfo) -> Iterator[str]:
    if not found.gaps:
        return
    longest = "; ".join(
        f"{duration(gap.seconds)} after {_time(gap.start_ms, zone)}"
        for gap in found.gaps[:MOST_GAPS]
    )
    more = "; …" if len(found.gaps) > MOST_GAPS else ""
    yield f"gaps        {len(found.gaps)}, ten usual steps or longer: {longest}{more}"


def _looked(found: Survey) -> Iterator[str]:
    """Yield what the boxes are, and what the decoded pictures showed."""
    if found.detections:
        names = ", ".join(
            f"{name} {count}" for name, count in found.categories.most_common(MOST_CATEGORIES)
        )
        more = ", …" if len(found.categories) > MOST_CATEGORIES else ""
        yield f"detections  {found.detections} of {len(found.categories)} kinds: {names}{more}"
        yield f"  {found.positions} with a position, {found.embeddings} with an embedding"
    sampled = found.sampled
    if sampled.pictures:
        sizes = ", ".join(f"{w} x {h}" for (w, h), _ in sampled.sizes.most_common())
        yield f"pictures    {sizes} ({sampled.pictures} decoded to see)"
    if sampled.covered:
        middle = f", {median(sampled.depth_m):.3g} m in the middle" if sampled.depth_m else ""
        yield f"depth       {median(sampled.covered):.0%} of a picture{middle}"
    for problem in sampled.problems:
        yield f"  {problem}"


def _left_out(found: Survey) -> Iterator[str]:
    counts = found.skipped.counts
    if counts:
        yield f"left out    {sum(counts.values())}"
    for reason, count in sorted(counts.items()):
        named = found.skipped.examples.get(reason, [])
        more = ", …" if count > len(named) else ""
        yield f"  {count} x {reason}: {', '.join(named)}{more}"


def _lacking(missing: list[Lack], source: str) -> Iterator[str]:
    if missing:
        yield "missing"
    for lack in missing:
        yield f"  {lack.what}: {lack.cost}. {lack.remedy[0].upper()}{lack.remedy[1:]}."
    needed = [lack.what for lack in missing if lack.needed]
    if needed:
        yield f"verdict     not yet: it needs {' and '.join(needed)}"
    else:
        yield f"verdict     it can be taken in: d3a ingest {source}"
