"""Follow a recording folder that grows: each line is read once, as it is written.

A frame is given when its boxes are known to be all there: a box of a later frame has come, or it
was waited for long enough. What comes later still is counted.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from d3a.model import BadInput, Frame, Json
from d3a.readers import parsing, recording
from d3a.readers.base import Skipped
from d3a.readers.embeddings import EMBEDDINGS
from d3a.watch.patience import Patience
from d3a.watch.pictures import is_whole
from d3a.watch.tail import GrowingRows, Tail

LATE = "detection that came after its frame was taken in"


@dataclass(slots=True)
class _Waiting:
    """A frame's line that was read; index: of the frames of the file, from 0."""

    index: int
    number: int
    record: Json
    name: str | None
    since: float


class RecordingFollower(recording.RecordingReader):
    """Frames of a recording folder as it grows; None while there is nothing new.

    Gives the frames that `RecordingReader` gives of the folder in the end, in the same order.
    """

    def __init__(
        self, folder: Path, patience: Patience, *, zone: str | None = None, needs_boxes: bool = True
    ) -> None:
        """Read the facts; needs_boxes: False where a detector looks at the pictures anyway."""
        super().__init__(folder, zone=zone)
        self.facts = replace(self.facts, frames=None)
        self._patience = patience
        self._needs_boxes = needs_boxes
        self._begin()

    def _begin(self) -> None:
        self._frame_lines = Tail(self._folder / recording.FRAMES)
        self._box_lines = Tail(self._folder / recording.DETECTIONS)
        self._held_lines: deque[tuple[int, str, float]] = deque()
        self._rows: parsing.Rows | None = None
        self._vectors = GrowingRows(self._folder / EMBEDDINGS, self._looks.check)
        self._waiting: deque[_Waiting] = deque()
        self._index: dict[str, int] = {}
        self._given: set[str] = set()
        self._read_count = 0
        self._proved = -1

    def __iter__(self) -> Iterator[Frame | None]:  # type: ignore[override]  # it may wait
        """Yield frames as they come, and None at each look that found none."""
        self.skipped = Skipped()
        self._begin()
        parsing.warn_unknown(self._record, recording.FACTS_KNOWN, recording.FACTS, self.skipped)
        self.skipped.join(self._left_out)
        while not self._patience.should_stop():
            has_more = self._look()
            gave = False
            while self._waiting and self._is_ready(self._waiting[0]):
                frame = self._give()
                if frame is not None:
                    gave = True
                    yield frame
                    if self._patience.should_stop():
                        return
            if has_more or gave:
                continue
            if self._patience.is_over():
                break
            yield None
            self._patience.pause()
        if not self._patience.should_stop():
            yield from self._end()

    def _look(self) -> bool:
        """Read what is new: frames first, so that the boxes are at least as new."""
        now = self._patience.clock()
        frames = self._frame_lines.lines()
        self._take_frames(frames, now)
        has_boxes = (self._folder / recording.DETECTIONS).is_file()
        if has_boxes and self._rows is None:
            self._rows = parsing.Rows()
        boxes = self._box_lines.lines(None)
        self._held_lines.extend((number, line, now) for number, line in boxes)
        self._take_boxes(is_last=False)
        if frames or boxes:
            self._patience.grew()
        return bool(frames)

    def _take_frames(self, lines: list[tuple[int, str]], now: float) -> None:
        for number, line in lines:
            record = parsing.json_line(line)
            if record is None:
                if line.strip():
                    where = f"{recording.FRAMES}:{number + 1}"
                    self.skipped.add(parsing.BROKEN_LINE, where)
                continue
            index, self._read_count = self._read_count, self._read_count + 1
            name = _name_of(record)
            if name is not None and name not in self._given:
                self._index.setdefault(name, index)
                if self._rows is not None and name in self._rows:  # its boxes came before it
                    self._proved = max(self._proved, index)
            self._waiting.append(_Waiting(index, number, record, name, now))

    def _take_boxes(self, *, is_last: bool) -> None:
        """Read the boxes' lines; one whose embedding is not written yet holds up those after."""
        while self._held_lines:
            number, line, since = self._held_lines[0]
            record = parsing.json_line(line)
            if record is not None and not (is_last or self._patience.has_settled(since)):
                row = record.get("embedding")
                if isinstance(row, int) and row >= len(self._vectors):
                    return
            self._held_lines.popleft()
            where = f"{recording.DETECTIONS}:{number + 1}"
            if record is not None:
                self._take_box(number, record, where)
            elif line.strip():
                self.skipped.add(parsing.BROKEN_LINE, where)

    def _take_box(self, number: int, record: Json, where: str) -> None:
        parsing.warn_unknown(
            record,
            recording.DETECTION_KNOWN,
            recording.DETECTIONS,
            self.skipped,
        )
        vectors = self._vectors if (self._folder / EMBEDDINGS).is_file() else None
        try:
            detection = self._detection(number, record, vectors, where)
            frame = parsing.frame_name(record.get("frame"))
        except BadInput as error:
            self.skipped.add(parsing.BROKEN_DETECTION, f"{where} ({error})")
            return
        if frame in self._given:
            self.skipped.add(LATE, f"{where} ({frame})")
            return
        assert self._rows is not None  # the lines came from the file
        self._rows.add(frame, detection)
        self._proved = max(self._proved, self._index.get(frame, -1))

    def _is_ready(self, waiting: _Waiting) -> bool:
        """Say whether all that belongs to the frame is there, or was waited for long enough."""
        if self._needs_boxes and self._rows is None:
            return False
        if self._patience.has_settled(waiting.since):
            return True
        if self._needs_boxes and self._proved <= waiting.index:
            return False
        try:
            paths = [
                parsing.inside(self._folder, waiting.record.get(name))
                for name in ("image", "depth")
            ]
        except BadInput:
            return True  # it is counted when the frame is made
        return is_whole(*paths)

    def _give(self) -> Frame | None:
        """Return the first frame that waits, None for a broken one, which is counted."""
        waiting = self._waiting.popleft()
        record, where = waiting.record, f"{recording.FRAMES}:{waiting.number + 1}"
        parsing.warn_unknown(record, recording.FRAME_KNOWN, recording.FRAMES, self.skipped)
        if waiting.name is not None:
            self._index.pop(waiting.name, None)
        try:
            frame = self._frame(record, self._rows)
        except BadInput as error:
            self.skipped.add(parsing.BROKEN_FRAME, f"{where} ({error})")
            return None
        self._given.add(frame.name)
        return frame

    def _end(self) -> Iterator[Frame]:
        """Yield what still waits: nothing more will come."""
        now = self._patience.clock()
        self._take_frames([*self._frame_lines.lines(None), *self._frame_lines.last()], now)
        rest = [*self._box_lines.lines(None), *self._box_lines.last()]
        self._held_lines.extend((number, line, now) for number, line in rest)
        self._take_boxes(is_last=True)
        while self._waiting:
            frame = self._give()
            if frame is not None:
                yield frame
        if self._rows is not None:
            self._rows.count_left(self.skipped)


def _name_of(record: Json) -> str | None:
    try:
        return parsing.frame_name(record.get("frame"))
    except BadInput:  # it is counted when the frame is made
        return None
