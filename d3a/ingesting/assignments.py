"""What became of each detection, as a file: so that identity can be judged from outside.

While an ingest runs, events go to `FILE.part`, with a mark at each checkpoint; an ingest that goes
on cuts that file at its checkpoint. At the end entries are followed to their stays, and those to
what people made of them since, with what each was. The part goes when the file is whole and in its
place, so that one of them always tells all that the store has.
"""

from __future__ import annotations

import filecmp
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from d3a.ingesting.preparation import LeftOut
from d3a.model import BadInput, Json
from d3a.sightings import Event, entry_name
from d3a.store.base import RecordingRecord, StayKey

UNDECIDED = "not decided: the ingest was stopped before the recording's end"


def check_place(path: Path) -> None:
    """Raise BadInput where no file can be made: to be asked before anything is done."""
    if not path.parent.is_dir():
        raise BadInput(f"{path} cannot be written: {path.parent} is no folder")
    if not os.access(path.parent, os.W_OK | os.X_OK):
        raise BadInput(f"{path} cannot be written: nothing may be made in {path.parent}")


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
            if had.done and path.exists() and not part.exists():
                _put(part, _told_by(path, had))
            if not _cut(part, _end(had.frames) if had.done else _mark(consumed)):
                raise _refusal(path)
        with _writing(path):
            if had.frames == 0 and part.exists():
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

    def finish(self, became: Mapping[StayKey, StayKey], *, done: bool) -> None:
        """Write the file of assignments; the part stays while the recording is not done.

        became: what those stays are that people's corrections took out of the store.
        """
        if self._part is None or self._path is None:
            return
        part = _part_of(self._path)
        with _writing(self._path):
            self._part.flush()
            _put(self._path, _corrected(_resolved(_records(part)), became))
            if done:
                part.unlink()

    def close(self) -> None:
        """Write no more."""
        if self._part is not None and self._path is not None:
            with _writing(self._path):
                self._part.close()

    def _sync(self) -> None:
        if self._part is not None and self._path is not None:
            with _writing(self._path):
                self._part.flush()
                os.fsync(self._part.fileno())

    def _write(self, record: Json) -> None:
        if self._part is not None and self._path is not None:
            with _writing(self._path):
                self._part.write(json.dumps(record, ensure_ascii=False) + "\n")


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    """Tell a disk that is full or fails as what it keeps from being written."""
    try:
        yield
    except OSError as error:
        raise BadInput(
            f"{path} cannot be written: {error.strerror}; when it can be, the same call goes on "
            "from what was stored"
        ) from error


def _part_of(path: Path) -> Path:
    return path.with_name(path.name + ".part")


def _records(part: Path) -> list[Json]:
    with part.open(encoding="utf-8") as lines:
        return [json.loads(line) for line in lines]


def _put(path: Path, lines: Iterable[Json]) -> None:
    """Write a file beside its place and move it there: at no time is half of it to be seen.

    A file that says the same already is left alone.
    """
    beside = path.with_name(path.name + ".new")
    with beside.open("w", encoding="utf-8") as out:
        for line in lines:
            out.write(json.dumps(line, ensure_ascii=False) + "\n")
        out.flush()
        os.fsync(out.fileno())
    if path.exists() and filecmp.cmp(beside, path, shallow=False):
        beside.unlink()
    else:
        beside.replace(path)


def _mark(consumed: int) -> Json:
    return {"consumed": consumed}


def _end(frames: int) -> Json:
    return {"done": frames}


def _told_by(path: Path, had: RecordingRecord) -> list[Json]:
    """Return what a whole file tells as the part that it came of; BadInput where it is not whole.

    A recording that has grown is gone on with from there.
    """
    records: list[Json] = []
    with path.open(encoding="utf-8") as lines:
        for line in lines:
            try:
                told = json.loads(line)
                record = {name: told[name] for name in ("row", "frame", "box")}
                object_id, place, why = told["object_id"], told["place"], told["why"]
            except (ValueError, TypeError, KeyError) as error:
                raise _refusal(path) from error
            if why == UNDECIDED:
                raise _refusal(path)
            entry = None if object_id is None else told.get("was", entry_name((object_id, place)))
            records.append(record | ({"why": why} if entry is None else {"entry": entry}))
    if len(records) < had.detections:
        raise _refusal(path)
    return [*records, _end(had.frames)]


def _refusal(path: Path) -> BadInput:
    return BadInput(
        f"the store has this recording already, and neither {path.name} nor {_part_of(path).name} "
        "tells what became of all of its detections: assignments are written while a recording is "
        "ingested, into a new store"
    )


def _cut(part: Path, mark: Json) -> bool:
    """Cut the file after the mark of the checkpoint, as what follows will happen again.

    Says whether it is there; of two equal marks the later counts: no frame came in between.
    """
    if not part.exists():
        return False
    wanted = json.dumps(mark).encode() + b"\n"
    end = at = 0
    with part.open("r+b") as lines:
        for line in lines:
            at += len(line)
            if line == wanted:
                end = at
        if end > 0:
            lines.truncate(end)
    return end > 0


def _corrected(lines: Iterable[Json], became: Mapping[StayKey, StayKey]) -> Iterable[Json]:
    """Return lines with the ids and places that people's corrections gave to what they name."""
    for line in lines:
        stay = line["object_id"], line["place"]
        if stay in became:
            line |= {"object_id": became[stay][0], "place": became[stay][1]}
            line["was"] = entry_name(stay)  # as it is again once the correction is taken back
        yield line


def _resolved(records: list[Json]) -> Iterable[Json]:
    became = {r["became"]: (r["into"], r["why"]) for r in records if "became" in r}
    seen = [r for r in records if "frame" in r]
    rows = {r["row"]: r for r in seen}  # a frame that is left out is judged again in a rerun
    bare = [r for r in seen if r["row"] is None]
    numbered = sorted(rows.keys() - {None})
    for record in (*(rows[row] for row in numbered), *bare):
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
