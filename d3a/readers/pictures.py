"""A plain folder of pictures, with a table that says when each was taken.

`times.csv` (file, time) or `times.txt` (time, file); or the time is in the names, or in what the
camera wrote into the files (EXIF): only where the person says so. Poses, a camera and boxes may lie
beside; without boxes a detector has to look.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from d3a.model import BadInput, Frame
from d3a.readers import beside, boxes, parsing
from d3a.readers.base import Link, RecordingFacts, Skipped, Stream
from d3a.readers.beside import Beside
from d3a.readers.clock import Clock
from d3a.readers.options import TIMES, Options
from d3a.readers.tracks import BROKEN_TIME, read_times

TIME_FILES = (*beside.TIME_FILES, "rgb.txt")
FROM_NAMES, FROM_EXIF = "names", "exif"
OPTIONS = {
    **beside.OPTIONS,
    "times": "FILE of times; or names: each is in its picture's name; or exif: the camera's own",
    "start": TIMES["start"],
}
NO_TIME = "no time: no row names the picture"
_WRITTEN_DATE = re.compile(r"(?<!\d)(\d{4})(\d\d)(\d\d)[-_T]?(\d\d)(\d\d)(\d\d)(\d{3})?(?!\d)")
_COUNT = re.compile(r"(?<![\d.])\d{9,19}(?:\.\d+)?(?![\d.])")
_EXIF_TAKEN, _EXIF_OFFSET, _EXIF_IFD = 0x9003, 0x9011, 0x8769


def looks_like(path: Path) -> bool:
    """Say whether there are pictures in the folder."""
    return path.is_dir() and beside.picture_folder(path) is not None


class PicturesReader:
    """Frames of a folder of pictures, by their times."""

    looked_for = "a folder of pictures with times.csv"

    def __init__(self, source: Path, options: Options) -> None:
        self._folder = beside.picture_folder(source) or source
        self._options = options
        self._said = options.text("times")
        self._table = None
        if self._said not in (FROM_NAMES, FROM_EXIF):
            self._table = options.file("times", *TIME_FILES)
            if self._table is None:
                raise BadInput(
                    f"{source} holds pictures and no table of their times ({TIME_FILES[0]}: file, "
                    "time): give --reader times=FILE, times=names or times=exif"
                )
        self._beside = Beside.of(options)
        self._pictures = beside.pictures_below(self._folder)
        self.skipped = Skipped()
        clock = options.clock()
        self._times = self._timed(clock, self.skipped)
        self._left_out = self.skipped
        self.facts = RecordingFacts(
            name=source.resolve().name,
            zone=options.zone,
            frames=len(self._times),
            notes=beside.undated((), is_undated=clock.is_undated),
        )

    def _timed(self, clock: Clock, skipped: Skipped) -> list[tuple[int, str]]:
        """Return (time, picture's path) by time; what has no time is counted."""
        if self._table is not None:
            times = self._from_table(self._table, clock, skipped)
        else:
            times = self._from_files(clock, skipped)
        return sorted((time_ms, picture) for picture, time_ms in times.items())

    def _from_table(self, table: Path, clock: Clock, skipped: Skipped) -> dict[str, int]:
        paths = {beside.frame_of(picture): picture for picture in self._pictures}
        names = boxes.FrameNames(paths)
        said = read_times(table, clock, skipped)
        times = {paths.get(names.find(name), name): time_ms for name, time_ms in said.items()}
        for picture in self._pictures:
            if picture not in times:
                skipped.add(NO_TIME, picture)
        return times

    def _from_files(self, clock: Clock, skipped: Skipped) -> dict[str, int]:
        times = {}
        for picture in self._pictures:
            try:
                if self._said == FROM_NAMES:
                    times[picture] = time_in_name(Path(picture).stem, clock)
                else:
                    times[picture] = time_in_exif(self._folder / picture, clock)
            except BadInput as error:
                skipped.add(BROKEN_TIME, f"{picture} ({error})")
        return times

    def __iter__(self) -> Iterator[Frame]:
        """Yield a frame for each picture that has a time."""
        self.skipped = Skipped()
        self.skipped.join(self._left_out)
        frames = {}
        for time_ms, picture in self._times:
            try:
                frames[beside.frame_of(picture)] = (time_ms, picture)
            except BadInput as error:
                self.skipped.add(parsing.BROKEN_FRAME, f"{picture[:50]} ({error})")
        paths = {name: picture for name, (_, picture) in frames.items()}
        posed, rows = self._beside.read(self._options, paths, self.skipped)
        for name, (time_ms, picture) in frames.items():
            path = parsing.picture(self._folder, picture, self.skipped)
            yield Frame(
                name=name,
                time_ms=time_ms,
                pose=posed.pose(name, time_ms),
                camera=self._beside.camera(path),
                image=path,
                detections=beside.taken(rows, name),
            )
        if rows is not None:
            rows.count_left(self.skipped)

    def streams(self) -> Sequence[Stream]:
        """Return the pictures, the table of times, and what lies beside."""
        where = self._folder.name + "/"
        times = [time_ms for time_ms, _ in self._times]
        found = [Stream(where, "pictures", len(self._pictures))]
        found.append(
            Stream.of("times" if self._table is None else self._table.name, "times", times)
        )
        return [*found, *self._beside.streams(self._options)]

    def links(self) -> Sequence[Link]:
        """Return nothing: the format has no tf tree."""
        return ()


def time_in_name(stem: str, clock: Clock) -> int:
    """Return the time that a file's name holds: 20240501_100000, or a count since 1970."""
    written = _WRITTEN_DATE.findall(stem)
    if len(written) == 1:
        year, month, day, hour, minute, second, milli = written[0]
        return clock.absolute_ms(f"{year}-{month}-{day}T{hour}:{minute}:{second}.{milli or '000'}")
    counts = _COUNT.findall(stem)
    if len(counts) != 1:
        raise BadInput("its name holds no time, or two")
    return clock.absolute_ms(counts[0])


def time_in_exif(path: Path, clock: Clock) -> int:
    """Return when the camera says that it took the picture; its offset, else the zone's."""
    from PIL import Image, UnidentifiedImageError  # only where it is asked for

    try:
        with Image.open(path) as picture:
            tags = picture.getexif().get_ifd(_EXIF_IFD)
    except (OSError, UnidentifiedImageError, ValueError, SyntaxError) as error:
        raise BadInput("the file is not a picture that can be read") from error
    taken = parsing.clean_text(str(tags.get(_EXIF_TAKEN, "")))
    date, _, hour = taken.partition(" ")
    if not hour:
        raise BadInput("the picture does not say when it was taken")
    offset = parsing.clean_text(str(tags.get(_EXIF_OFFSET, "")))
    return clock.absolute_ms(f"{date.replace(':', '-')}T{hour}{offset}")
