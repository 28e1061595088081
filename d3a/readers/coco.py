"""Results in the form of the COCO evaluation, with a list of images and a table of their times.

`results.json`: an array of image_id, category_id, bbox and score; `images.json` (or
`annotations.json`, `instances_*.json`): an object with `images` and `categories`; or one file with
`images`, `categories` and `annotations`. `times.csv` says when each image was taken.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from d3a.model import BadInput, Detection, Frame, Json
from d3a.readers import beside, boxes, parsing
from d3a.readers.base import Link, RecordingFacts, Skipped, Stream
from d3a.readers.beside import Beside
from d3a.readers.clock import Clock
from d3a.readers.coco_boxes import layout_of
from d3a.readers.options import CAMERA, POSES, TIMES, Options
from d3a.readers.pictures import FROM_NAMES, TIME_FILES, time_in_name
from d3a.readers.tracks import BROKEN_TIME, read_times

IMAGE_FILES = ("images.json", "annotations.json", "instances.json")
RESULT_FILES = (
    *("results.json", "coco_results.json", "predictions.json", "detections.json"),
    *IMAGE_FILES[1:],
)
FROM_DATES = "date_captured"
OPTIONS = {
    **POSES,
    **CAMERA,
    "times": "FILE of times by image; or names: in the file names; or date_captured",
    "start": TIMES["start"],
    "images": "FILE with the list of images and the categories",
    "box": "xywh (the format's own), xyxy or cxcywh: what the four numbers of a box are",
}
NO_TIME = "no time: no row names the image"
UNKNOWN_IMAGE = "result of an image that is not in the list"
CUT_OFF = "the file is cut off"
CERTAIN_NOTE = "annotations without a score count as certain"
_LOOK = 4096


def looks_like(path: Path) -> bool:
    """Say whether it is, or holds, a file that begins like results or a list of images."""
    names = RESULT_FILES if path.is_dir() else ("",)
    return any(_begins_well(path / name) for name in names)


def _begins_well(path: Path) -> bool:
    if path.suffix.lower() != ".json" or not path.is_file():
        return False
    with path.open("rb") as content:
        start = content.read(_LOOK).lstrip()
    if start.startswith(b"["):
        return b'"image_id"' in start or start[1:].lstrip().startswith(b"]")
    return start.startswith(b"{") and (b'"images"' in start or b'"annotations"' in start)


@dataclass(frozen=True, slots=True)
class Pictured:
    """An image of the list. key: its id as text."""

    key: str
    file: str
    size: tuple[int, int] | None
    captured: str


class CocoReader:
    """Frames of the images in a COCO list, by their times."""

    looked_for = "results.json in COCO's form with images.json and times.csv"

    def __init__(self, source: Path, options: Options) -> None:
        usual = (source / name for name in RESULT_FILES)
        self._results = source if source.is_file() else next(p for p in usual if p.is_file())
        self._options = options
        self._folder = options.folder
        self._said = options.choice("box", boxes.LAYOUTS)
        self._beside = replace(Beside.of(options), detections=None)  # the results are the boxes
        self.skipped = Skipped()
        self._records = _results(self._results, self.skipped)
        listed = _listed(self._results, options)
        self._images = _images(listed, self.skipped)
        self._categories = _categories(listed)
        self._notes: list[str] = []
        self._layout = self._said or self._told_apart()
        clock = options.clock()
        self._times = self._timed(clock, self.skipped)
        self._left_out = self.skipped
        if any(not isinstance(r.get("score"), int | float) for r in self._records[:100]):
            self._notes.append(CERTAIN_NOTE)
        self.facts = RecordingFacts(
            name=options.usual_name,
            zone=options.zone,
            frames=len(self._times),
            classes=tuple(sorted(set(self._categories.values()))),
            notes=beside.undated(self._notes, is_undated=clock.is_undated),
        )

    def _told_apart(self) -> str:
        found = layout_of(self._records, self._images, self._picture, self._results.name)
        self._notes += found.notes
        return found.layout

    def _picture(self, image: Pictured) -> Path | None:
        """Return where the image's file is: below the folder, or where pictures usually are."""
        for name in (image.file, Path(image.file).name):  # the list may be of another machine
            for place in ("", *beside.PICTURE_FOLDERS):
                path = self._folder / place / name
                if path.is_file():
                    return parsing.inside(self._folder, path.relative_to(self._folder).as_posix())
        return None

    def _timed(self, clock: Clock, skipped: Skipped) -> dict[str, int]:
        """Return UTC milliseconds by image id, in order of time."""
        said = self._options.text("times")
        times: dict[str, int] = {}
        if said not in (FROM_NAMES, FROM_DATES):
            times = self._from_table(clock, skipped)
        for image in self._images.values() if said in (FROM_NAMES, FROM_DATES) else ():
            try:
                if said == FROM_NAMES:
                    times[image.key] = time_in_name(Path(image.file).stem, clock)
                else:
                    times[image.key] = clock.ms(image.captured)
            except BadInput as error:
                skipped.add(BROKEN_TIME, f"{image.file} ({error})")
        return dict(sorted(times.items(), key=lambda each: (each[1], each[0])))

    def _from_table(self, clock: Clock, skipped: Skipped) -> dict[str, int]:
        table = self._options.file("times", *TIME_FILES)
        if table is None:
            raise BadInput(
                f"COCO results have no times: put {TIME_FILES[0]} (file_name, time) beside, or "
                "give --reader times=FILE, times=names or times=date_captured"
            )
        names = boxes.FrameNames({image.key: image.file for image in self._images.values()})
        said = read_times(table, clock, skipped)
        times = {names.find(name): time_ms for name, time_ms in said.items()}
        for image in self._images.values():
            if image.key not in times:
                skipped.add(NO_TIME, image.file)
        return {key: time_ms for key, time_ms in times.items() if key in self._images}

    def __iter__(self) -> Iterator[Frame]:
        """Yield a frame for each image that has a time."""
        self.skipped = Skipped()
        self.skipped.join(self._left_out)
        rows = self._rows()
        paths = {self._name(key): self._images[key].file for key in self._times}
        posed, _ = self._beside.read(self._options, paths, self.skipped)
        for key, time_ms in self._times.items():
            image, name = self._images[key], self._name(key)
            try:
                path = self._picture(image)
            except (BadInput, ValueError) as error:
                self.skipped.add(parsing.BROKEN_FRAME, f"image {key} ({error})")
                continue
            if path is None:
                self.skipped.add(parsing.MISSING_PICTURE, image.file)
            yield Frame(
                name=name,
                time_ms=time_ms,
                pose=posed.pose(name, time_ms),
                camera=self._beside.camera(path),
                image=path,
                detections=rows.take(key),
            )

    def _name(self, key: str) -> str:
        file = Path(self._images[key].file)
        return beside.frame_of(file.name if file.is_absolute() else file.as_posix())

    def _rows(self) -> parsing.Rows:
        rows = parsing.Rows()
        for number, record in enumerate(self._records):
            where = f"{self._results.name}: result {number}"
            key = str(record.get("image_id"))
            if key not in self._images:
                self.skipped.add(UNKNOWN_IMAGE, f"{where} (image {parsing.clean_text(key)[:50]})")
                continue
            try:
                rows.add(key, self._detection(number, record, where))
            except BadInput as error:
                self.skipped.add(parsing.BROKEN_DETECTION, f"{where} ({error})")
        return rows

    def _detection(self, number: int, record: Json, where: str) -> Detection:
        category = record.get("category_name", self._categories.get(record.get("category_id")))
        if category is None:
            raise BadInput(f"category {record.get('category_id')!r} has no name in the list")
        numbers = parsing.numbers(record.get("bbox"), 4, "the bbox")
        return Detection(
            category=parsing.category_of(category, self.skipped, where),
            probability=parsing.number(record.get("score", 1.0), "score"),
            box=boxes.as_box(numbers, self._layout),
            row=number,
        )

    def streams(self) -> Sequence[Stream]:
        """Return the results, the list of images with its times, and the poses."""
        times = list(self._times.values())
        found = [
            Stream(self._results.name, "detections", len(self._records)),
            Stream.of("images", "pictures", times),
        ]
        return [*found, *self._beside.streams(self._options)]

    def links(self) -> Sequence[Link]:
        """Return nothing: the format has no tf tree."""
        return ()


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise BadInput(f"{path.name} cannot be read: {error.strerror}") from error


def _results(path: Path, skipped: Skipped) -> list[Json]:
    """Return the results of an array, as far as it goes, or of an object's `annotations`."""
    text = _text(path).strip()
    if not text.startswith("["):
        annotations = _object(path).get("annotations")
        if not isinstance(annotations, list):
            raise BadInput(f"{path.name} has no array of results, and no annotations")
        return _objects(annotations, path.name, skipped)
    decoder, at = json.JSONDecoder(), 1
    values: list[Any] = []
    while True:
        while at < len(text) and text[at] in ", \n\r\t":
            at += 1
        if text[at : at + 1] == "]":
            break
        try:
            value, at = decoder.raw_decode(text, at)
        except ValueError:
            skipped.add(CUT_OFF, f"{path.name} (after result {len(values) - 1})")
            break
        values.append(value)
    return _objects(values, path.name, skipped)


def _objects(values: Sequence[Any], file: str, skipped: Skipped) -> list[Json]:
    for number, value in enumerate(values):
        if not isinstance(value, dict):
            skipped.add(parsing.BROKEN_DETECTION, f"{file}: result {number} (no object)")
    return [value for value in values if isinstance(value, dict)]


def _object(path: Path) -> Json:
    try:
        value = json.loads(_text(path))
    except ValueError as error:
        raise BadInput(f"{path.name} is not JSON: {error}") from error
    if not isinstance(value, dict):
        raise BadInput(f"{path.name} must be an object with images and categories")
    return value


def _listed(results: Path, options: Options) -> Json:
    """Return the object that lists images and categories."""
    path = options.file("images", *IMAGE_FILES)
    if options.text("images") is None:
        if not _text(results).lstrip().startswith("["):
            path = results
        elif path is None:
            found = sorted(options.folder.glob("instances_*.json"))
            path = found[0] if len(found) == 1 else None
    if path is None:
        raise BadInput(
            f"{results.name} names images by number: put their list ({IMAGE_FILES[0]} with images "
            "and categories) beside, or give --reader images=FILE"
        )
    return _object(path)


def _images(listed: Json, skipped: Skipped) -> dict[str, Pictured]:
    """Return the list's images by id; broken entries are counted."""
    entries = listed.get("images")
    if not isinstance(entries, list):
        raise BadInput("the list of images has no array `images`")
    images = {}
    for number, entry in enumerate(entries):
        try:
            if not isinstance(entry, dict):
                raise BadInput("it is no object")  # noqa: TRY301
            key = parsing.frame_name(entry.get("id"))
            file = entry.get("file_name")
            if not isinstance(file, str) or not file:
                raise BadInput("it has no file_name")  # noqa: TRY301
            size = None
            if isinstance(entry.get("width"), int) and isinstance(entry.get("height"), int):
                size = (entry["width"], entry["height"])
            images[key] = Pictured(key, file, size, str(entry.get("date_captured", "")))
        except BadInput as error:
            skipped.add(parsing.BROKEN_FRAME, f"image {number} of the list ({error})")
    return images


def _categories(listed: Mapping[str, Any]) -> dict[Any, str]:
    entries = listed.get("categories")
    named = [e for e in entries if isinstance(e, dict)] if isinstance(entries, list) else []
    return {
        entry["id"]: parsing.clean_text(entry["name"])
        for entry in named
        if isinstance(entry.get("id"), int | str) and isinstance(entry.get("name"), str)
    }
