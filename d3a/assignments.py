"""What became of each detection, as a file: so that identity can be judged from outside.

While an ingest runs, events go to `FILE.part`, with a mark at each checkpoint; an ingest that goes
on cuts that file at its checkpoint. At the end entries are followed to their stays. The part goes
when the file is whole and in its place, so that one of them always tells all that the store has.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import IO

from d3a.model import BadInput, Json
from d3a.preparation import LeftOut
from d3a.sightings import Event
from d3a.store.base import RecordingRecord

UNDECIDED = "not decided: the ingest was stopped before the recording's end"


class AssignmentLog:
    """Takes events in; with no path all of it does nothing."""

    def __init__(self, path: Path | None, part: IO[str] | None) -> None:
        self._path = path
        self._part = part

    @classmethod
    def open(cls, path: Path | None, consumed: int, had: RecordingRecord) -> AssignmentLog:
        """Begin a file, or go on with that of an ingest that was interrupted.

        consumed: frames at the checkpoint to go on from. had: what the store has of the recording.
        Raises BadInput where that is anything, and no file tells what became of its detections.
        """
        if path is None:
            return cls(None, None)
        part = _part_of(path)
        if had.frames > 0:
            _cut(part, _end(had.frames) if had.done else _mark(consumed))
        elif part.exists():
            part.unlink()
        return cls(path, part.open("a", encoding="utf-8"))

    def events(self, events: Iterable[Event]) -> None:
        """Note what became of detections and entries."""
        for event in events:
            self._write(event.to_json())

    def left_out(self, frame: str, left_out: Iterable[LeftOut]) -> None:
        """Note detections that never reached the tiers."""
        for each in left_out:
            detection = each.detection
            box = list(detection.box)
            self._write({"row": detection.row, "frame": frame, "box": box, "why": each.why})

    def mark(self, consumed: int) -> None:
        """Note a checkpoint, safely on disk before the store has it."""
        self._write(_mark(consumed))
        self._sync()

    def end(self, frames: int) -> None:
        """Note the checkpoint that ends a recording of so many frames; it has no consumed ones."""
        self._write(_end(frames))
        self._sync()

    def finish(self, *, done: bool) -> None:
        """Write the file of assignments; the part stays while the recording is not done."""
        if self._part is None or self._path is None:
            return
        self._part.flush()
        part = _part_of(self._path)
        _put(self._path, _resolved(_records(part)))
        if done:
            part.unlink()

    def close(self) -> None:
        """Write no more."""
        if self._part is not None:
            self._part.close()

    def _sync(self) -> None:
        if self._part is not None:
            self._part.flush()
            os.fsync(self._part.fileno())

    def _write(self, record: Json) -> None:
        if self._part is not None:
            self._part.write(json.dumps(record, ensure_ascii=False) + "\n")


def _part_of(path: Path) -> Path:
    return path.with_name(path.name + ".part")


def _records(part: Path) -> list[Json]:
    with part.open(encoding="utf-8") as lines:
        return [json.loads(line) for line in lines]


def _put(path: Path, lines: Iterable[Json]) -> None:
    """Write a file beside its place and move it there: at no time is half of it to be seen."""
    beside = path.with_name(path.name + ".new")
    with beside.open("w", encoding="utf-8") as out:
        for line in lines:
            out.write(json.dumps(line, ensure_ascii=False) + "\n")
        out.flush()
        os.fsync(out.fileno())
    beside.replace(path)


def _mark(consumed: int) -> Json:
    return {"consumed": consumed}


def _end(frames: int) -> Json:
    return {"done": frames}


def _cut(part: Path, mark: Json) -> None:
    """Cut the file after the mark of the checkpoint; what follows will happen again.

    Of two equal marks the later counts: no frame was taken in between.
    """
    wanted = json.dumps(mark).encode() + b"\n"
    end = at = 0
    if part.exists():
        with part.open("r+b") as lines:
            for line in lines:
                at += len(line)
                if line == wanted:
                    end = at
            if end > 0:
                lines.truncate(end)
                return
    raise BadInput(
        f"the store has this recording already, and {part.name} does not tell what became of its "
        "detections: assignments are written while a recording is ingested, into a new store"
    )


def _resolved(records: list[Json]) -> Iterable[Json]:
    became = {r["became"]: (r["into"], r["why"]) for r in records if "became" in r}
    seen = [r for r in records if "frame" in r]
    for record in sorted(seen, key=lambda r: (r["row"] is None, r["row"] or 0)):
        entry, why = record.get("entry"), record.get("why")
        while entry in became:
            entry, why = became[entry]
        object_id = place = None
        if entry is not None and "/" in entry:
            object_id, _, number = entry.rpartition("/")
            place, why = int(number), None
        elif entry is not None:
            why = UNDECIDED
        line = {"row": record["row"], "frame": record["frame"], "box": record["box"]}
        yield line | {"object_id": object_id, "place": place, "why": why}
