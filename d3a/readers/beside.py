"""What may lie beside a recording's pictures: poses, the camera, and a detector's boxes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from d3a.model import Camera, Detection, Image, Pose
from d3a.readers import boxes, parsing
from d3a.readers.base import Skipped, Stream
from d3a.readers.cameras import Lens
from d3a.readers.options import CAMERA, DETECTIONS, POSES, Options
from d3a.readers.tracks import Track, read_track

OPTIONS: Mapping[str, str] = {**POSES, **CAMERA, **DETECTIONS}
POSE_FILES = ("poses.csv", "poses.txt", "groundtruth.txt")
POSE_GAP_S = 0.5
"""The pose is taken between two that are this near; a robot at 1 m/s is then half a metre on."""
NO_POSE = "no pose near in time"
UNDATED_NOTE = "seconds count from an unknown start: put at 1 January 2000; start=TIME tells it"
TIME_FILES = ("times.csv", "times.txt", "timestamps.csv", "timestamps.txt")
PICTURE_SUFFIXES = frozenset(
    {".jpg", ".jpeg", ".png", ".bmp", ".webp", ".tif", ".tiff", ".ppm", ".pgm"}
)
PICTURE_FOLDERS = ("images", "rgb", "color", "colour", "pictures")


@dataclass(frozen=True, slots=True)
class Beside:
    """The files that go with pictures: those that were named, or lie there under a usual name."""

    lens: Lens
    poses: Path | None
    pose_gap_ms: float
    detections: Path | None
    layout: str | None

    @classmethod
    def of(cls, options: Options, prefix: str = "") -> Beside:
        """Return what the options and the folder have; prefix: of the names of usual files."""
        return cls(
            Lens.of(options),
            options.file("poses", *(prefix + name for name in POSE_FILES)),
            options.positive("pose-gap", POSE_GAP_S) * 1000,
            options.file("detections", *(prefix + name for name in boxes.USUAL_FILES)),
            options.choice("box", boxes.LAYOUTS),
        )

    def read(
        self, options: Options, frames: Mapping[str, str], skipped: Skipped
    ) -> tuple[Posed, parsing.Rows | None]:
        """Return the poses and the boxes, None where no file has any.

        frames: frame -> path of its picture, by which the files may name it.
        """
        names = boxes.FrameNames(frames)
        track = Track() if self.poses is None else read_track(self.poses, options.clock(), skipped)
        by_name = {names.find(said): pose for said, pose in track.by_name.items()}
        posed = Posed(self, Track(track.times, track.poses, by_name), skipped)
        if self.detections is None:
            return posed, None
        return posed, boxes.read_boxes(self.detections, names, self.layout, skipped)

    def camera(self, picture: Image | None) -> Camera | None:
        """Return the camera, None where nothing tells its intrinsics."""
        return self.lens.camera(picture)

    def streams(self, options: Options) -> Iterator[Stream]:
        """Yield the tables beside, for `d3a doctor`."""
        if self.poses is not None:
            track = read_track(self.poses, options.clock(), Skipped())
            if track.times:
                yield Stream.of(self.poses.name, "poses", track.times)
            else:  # by the frames' names
                yield Stream(self.poses.name, "poses", len(track.by_name))
        if self.detections is not None:
            yield Stream(self.detections.name, "detections", line_count(self.detections))


@dataclass(frozen=True, slots=True)
class Posed:
    """Poses for frames; those without one are counted, where there are any poses at all."""

    beside: Beside
    track: Track
    skipped: Skipped

    def pose(self, name: str, time_ms: int) -> Pose | None:
        """Return the frame's own pose, else the one at its time."""
        if self.beside.poses is None:
            return None
        pose = self.track.by_name.get(name) or self.track.at(time_ms, self.beside.pose_gap_ms)
        if pose is None:
            self.skipped.add(NO_POSE, name)
        return pose


def taken(rows: parsing.Rows | None, name: str) -> tuple[Detection, ...] | None:
    """Return a frame's boxes, None where no detector has looked."""
    return None if rows is None else rows.take(name)


def is_picture(path: Path) -> bool:
    """Say whether the name is that of a picture; nothing is opened."""
    return path.suffix.lower() in PICTURE_SUFFIXES and not path.name.startswith(".")


def picture_folder(folder: Path) -> Path | None:
    """Return where the folder's pictures are: itself, or a folder below of a usual name."""
    for place in (folder, *(folder / name for name in PICTURE_FOLDERS)):
        if place.is_dir() and any(is_picture(each) for each in place.iterdir()):
            return place
    return None


def pictures_below(folder: Path) -> list[str]:
    """Return the paths of the pictures in a folder and below it, as they are from there, sorted."""
    found = (each for each in folder.rglob("*") if is_picture(each) and each.is_file())
    return sorted(each.relative_to(folder).as_posix() for each in found)


def frame_of(picture: str) -> str:
    """Return the frame's name for a picture's path: the path without its ending."""
    return parsing.frame_name(Path(picture).with_suffix("").as_posix())


def undated(notes: Sequence[str], *, is_undated: bool) -> tuple[str, ...]:
    """Return the notes, and the one that says that no date is known where that is so."""
    return (*notes, UNDATED_NOTE) if is_undated else tuple(notes)


def line_count(path: Path) -> int:
    """Return how many lines say something, without the heading of a `.csv`."""
    with path.open("rb") as lines:
        count = sum(1 for line in lines if line.strip())
    return max(count - 1, 0) if path.suffix.lower() == ".csv" else count
