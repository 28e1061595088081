"""What became of each detection, as a file: so that identity can be judged from outside.

While an ingest runs, events go to `FILE.part`, with a mark at each checkpoint; an ingest that goes
on cuts that file at its checkpoint. At the end entries are followed to their stays.
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

UNDECIDED = "not decided: the ingest was stopped before the recording's end"


class AssignmentLog:
    """Takes events in; with no path all of it does nothing."""

    def __init__(self, path: Path | None, part: IO[str] | None) -> None:
        self._path = path
        self._part = part

    @classmethod
    def open(cls, path: Path | None, consumed: int, is_known: bool) -> AssignmentLog:
        """Begin a file, or go on with that of an ingest that was interrupted.

        consumed: frames at the checkpoint to go on from. Raises BadInput where the store has
        (part of) the recording, and no file tells what became of its detections.
        """
        if path is None:
            return cls(None, None)
        part = _part_of(path)
        if is_known:
            _cut(part, consumed)
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
        self._write({"consumed": consumed})
        if self._part is not None:
            self._part.flush()
            os.fsync(self._part.fileno())

    def close(self, *, done: bool) -> None:
        """Write the file of assignments; the part stays while the recording is not done."""
        if self._part is None or self._path is None:
            return
        self._part.close()
        part = _part_of(self._path)
        with self._path.open("w", encoding="utf-8") as out:
            for line in _resolved(_records(part)):
                out.write(json.dumps(line, ensure_ascii=False) + "\n")
        if done:
            part.unlink()

    def _write(self, record: Json) -> None:
        if self._part is not None:
            self._part.write(json.dumps(record, ensure_ascii=False) + "\n")


def _part_of(path: Path) -> Path:
    return path.with_name(path.name + ".part")


def _records(part: Path) -> list[Json]:
    with part.open(encoding="utf-8") as lines:
        return [json.loads(line) for line in lines]


def _cut(part: Path, consumed: int) -> None:
    """Cut the file after the mark of the checkpoint; what follows will happen again."""
    kept: list[str] = []
    if part.exists():
        with part.open(encoding="utf-8") as lines:
            for line in lines:
                kept.append(line)
                if line == json.dumps({"consumed": consumed}) + "\n":
                    part.write_text("".join(kept), encoding="utf-8")
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
