"""A video file, with a table of poses beside it and, where known, the time of its start.

`tour.mp4` with `tour.poses.csv`, or a folder with one video and `poses.csv`. Frames are numbered
from 0. Their times are the video's own, counted from `start`, or those of a table of times.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from d3a.images import Pixels
from d3a.model import BadInput, Frame
from d3a.readers import beside, parsing
from d3a.readers.base import Link, RecordingFacts, Skipped, Stream
from d3a.readers.beside import Beside
from d3a.readers.clock import Clock
from d3a.readers.options import TIMES, Options
from d3a.readers.tracks import read_times
from d3a.videos import Video

SUFFIXES = frozenset({".mp4", ".m4v", ".mov", ".avi", ".mkv", ".webm", ".mpg", ".mpeg", ".ogv"})
OPTIONS = {**beside.OPTIONS, **TIMES}
ENDS_EARLY = "the video ends before its header says"
NO_TIME = "no time: no row names the frame"


def videos_in(path: Path) -> list[Path]:
    """Return the video itself, or those in a folder, by name."""
    if path.is_file():
        return [path] if path.suffix.lower() in SUFFIXES else []
    return sorted(p for p in path.iterdir() if p.suffix.lower() in SUFFIXES and p.is_file())


def looks_like(path: Path) -> bool:
    """Say whether it is a video's name, or a folder with one."""
    return bool(videos_in(path))


class VideoReader:
    """Frames of a video, in its order."""

    looked_for = "a video file, or a folder with one"

    def __init__(self, source: Path, options: Options) -> None:
        found = videos_in(source)
        if len(found) != 1:
            names = ", ".join(each.name for each in found[:5])
            raise BadInput(f"{source} has {len(found)} videos ({names}): name the one to read")
        prefix = f"{source.stem}." if source.is_file() else ""
        self._options = options
        self._beside = Beside.of(options, prefix)
        self._times_file = options.file("times", *(prefix + name for name in beside.TIME_FILES))
        self._video = Video.open(found[0])
        self.skipped = Skipped()
        clock = options.clock()
        times = self._times(clock, self.skipped)
        is_dated = clock.start_ms is not None or (times is not None and not clock.is_undated)
        self.facts = RecordingFacts(
            name=options.usual_name,
            zone=options.zone,
            frames=self._video.frames or None,
            notes=beside.undated((), is_undated=not is_dated),
        )

    def _times(self, clock: Clock, skipped: Skipped) -> dict[str, int] | None:
        """Return the times of the table by the number of the frame, None without a table."""
        if self._times_file is None:
            return None
        said = read_times(self._times_file, clock, skipped)
        return {(str(int(n)) if n.isascii() and n.isdigit() else n): t for n, t in said.items()}

    def __iter__(self) -> Iterator[Frame]:
        """Yield a frame for each picture that can be decoded."""
        shots = ((s.number, s.seconds, s.pixels) for s in self._video.shots())
        return self._frames(shots)

    def outline(self) -> Iterator[Frame]:
        """Yield the frames that the header promises, the first picture in place of each."""
        first = next(self._video.shots(), None)
        pixels = None if first is None else first.pixels
        count, rate = self._video.frames, self._video.rate
        return self._frames((n, n / rate, pixels) for n in range(count))

    def _frames(self, shots: Iterator[tuple[int, float, Pixels | None]]) -> Iterator[Frame]:
        self.skipped = Skipped()
        clock = self._options.clock()
        times = self._times(clock, self.skipped)
        names = {f"{n:06d}": str(n) for n in range(self._video.frames)}
        posed, rows = self._beside.read(self._options, names, self.skipped)
        number = -1
        for number, seconds, pixels in shots:
            name = f"{number:06d}"
            time_ms = clock.origin_ms + round(seconds * 1000)
            if times is not None and str(number) not in times:
                self.skipped.add(NO_TIME, name)
                continue
            if times is not None:
                time_ms = times[str(number)]
            if pixels is None:
                self.skipped.add(parsing.BROKEN_FRAME, f"{name} (it cannot be decoded)")
                continue
            yield Frame(
                name=name,
                time_ms=time_ms,
                pose=posed.pose(name, time_ms),
                camera=self._beside.camera(pixels),
                image=pixels,
                detections=beside.taken(rows, name),
            )
        if number + 1 < self._video.frames:
            where = f"after frame {number} of {self._video.frames}"
            self.skipped.add(ENDS_EARLY, where)
        if rows is not None:
            rows.count_left(self.skipped)

    def streams(self) -> Sequence[Stream]:
        """Return the video as its header has it, and what lies beside."""
        video, name = self._video, self._video.path.name
        rate = f"{video.width} x {video.height} at {video.rate:g} pictures/s"
        found = [Stream(name, f"video, {rate}", video.frames)]
        if self._times_file is not None:
            times = self._times(self._options.clock(), Skipped()) or {}
            found.append(Stream.of(self._times_file.name, "times", list(times.values())))
        return [*found, *self._beside.streams(self._options)]

    def links(self) -> Sequence[Link]:
        """Return nothing: the format has no tf tree."""
        return ()
