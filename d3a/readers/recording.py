"""A recording as a folder: frames, detections and embeddings that somebody else made.

`recording.json`, `frames.jsonl`, `detections.jsonl` (optional: then a detector is needed),
`embeddings.npy` (optional). `truth.jsonl` is never read.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from d3a.floor_map import read_map
from d3a.model import BadInput, Camera, Detection, Frame, Json, Pose
from d3a.readers import parsing
from d3a.readers.base import Link, RecordingFacts, Regions, Skipped, Stream
from d3a.readers.beside import line_count
from d3a.readers.embeddings import EMBEDDINGS, EmbeddingFacts, Vectors
from d3a.store.limits import MAX_TEXT

FACTS = "recording.json"
FRAMES = "frames.jsonl"
DETECTIONS = "detections.jsonl"
SCHEMA = 1
BROKEN_MAP = "broken map"
BROKEN_EMBEDDING = "broken embedding, not used"
FACTS_KNOWN = frozenset(
    {"schema", "recording", "site", "zone", "camera", "embedding", "map"}
    | {"now", "regions", "classes", "unfinished"}
)
FRAME_KNOWN = frozenset(["frame", "time", "pose", "pose_covariance", "image", "depth"])
DETECTION_KNOWN = frozenset(
    {"frame", "category", "probability", "box", "position", "embedding", "covariance"}
)


def looks_like(folder: Path) -> bool:
    """Say whether the folder has this format's two files."""
    return (folder / FACTS).is_file() and (folder / FRAMES).is_file()


class RecordingReader:
    """Frames of a recording folder, in the order of its file."""

    looked_for = f"{FACTS} and {FRAMES}"

    def __init__(self, folder: Path, *, zone: str | None = None) -> None:
        self._folder = folder
        self.skipped, self._left_out = Skipped(), Skipped()
        self._record = self._read_facts()
        self._camera = _camera(self._record.get("camera"))
        self._looks = EmbeddingFacts.of(self._record.get("embedding"), FACTS)
        self.facts = RecordingFacts(
            name=self._text("recording") or folder.resolve().name,
            site=self._text("site") or "",
            zone=parsing.zone_of(zone or self._text("zone")),
            frames=line_count(folder / FRAMES),
            classes=_classes(self._record.get("classes")),
            embedding_model=self._looks.name,
            now=self._now(),
            regions=_regions(self._record.get("regions")),
            map=self._map(self._left_out),
        )

    def _map(self, skipped: Skipped) -> Json | None:
        """Return the floor plan that the folder brings; a broken one is counted."""
        try:
            path = parsing.inside(self._folder, self._record.get("map"))
            return None if path is None else read_map(path).to_json()
        except BadInput as error:
            skipped.add(BROKEN_MAP, str(error))
            return None

    def _read_facts(self) -> Json:
        try:
            record = json.loads((self._folder / FACTS).read_text(encoding="utf-8-sig"))
        except (OSError, ValueError, RecursionError) as error:
            raise BadInput(f"{FACTS} is not JSON: {error}") from error
        if not isinstance(record, dict) or record.get("schema") != SCHEMA:
            raise BadInput(f"{FACTS} must be an object with schema {SCHEMA}")
        if record.get("unfinished"):
            raise BadInput(
                f"{self._folder} is not whole: what wrote it was interrupted, as {FACTS} says; "
                f"write it anew, a simulated one with the same d3a simulate {self._folder}"
            )
        return record

    def _text(self, name: str) -> str | None:
        value = self._record.get(name)
        if value is not None and not isinstance(value, str):
            raise BadInput(f"{FACTS}: {name} must be text, not {value!r}")
        if value is not None and len(value) > MAX_TEXT:
            raise BadInput(
                f"{FACTS}: {name} has {len(value)} characters, at most {MAX_TEXT} are kept"
            )
        return parsing.clean_text(value) if value else None

    def _now(self) -> str | None:
        now = self._text("now")
        if now is not None:
            parsing.time_ms(now)
        return now

    def __iter__(self) -> Iterator[Frame]:
        """Yield frames in the file's order; the ingest counts those that go back in time."""
        self.skipped = Skipped()
        parsing.warn_unknown(self._record, FACTS_KNOWN, FACTS, self.skipped)
        self.skipped.join(self._left_out)
        rows = self._detections()
        for number, record in parsing.json_lines(self._folder / FRAMES, self.skipped):
            parsing.warn_unknown(record, FRAME_KNOWN, FRAMES, self.skipped)
            try:
                frame = self._frame(record, rows)
            except BadInput as error:
                self.skipped.add(parsing.BROKEN_FRAME, f"{FRAMES}:{number + 1} ({error})")
            else:
                yield frame
        if rows is not None:
            rows.count_left(self.skipped)

    def streams(self) -> Sequence[Stream]:
        """Return the files of the folder, the frames with their times."""
        times: list[int] = []
        for _, record in parsing.json_lines(self._folder / FRAMES, Skipped()):
            with suppress(BadInput):  # it is counted where the frames are read
                times.append(parsing.time_ms(record.get("time")))
        found = [Stream.of(FRAMES, "frames listed", times)]
        if (self._folder / DETECTIONS).is_file():
            found.append(Stream(DETECTIONS, "detections", line_count(self._folder / DETECTIONS)))
        embeddings = self._looks.read(self._folder)
        if embeddings is not None:
            found.append(Stream(EMBEDDINGS, "embeddings", len(embeddings)))
        return found

    def links(self) -> Sequence[Link]:
        """Return nothing: poses are the camera's in the map."""
        return ()

    def _frame(self, record: Json, rows: parsing.Rows | None) -> Frame:
        name = parsing.frame_name(record.get("frame"))
        time_ms = parsing.time_ms(record.get("time"))
        return Frame(
            name=name,
            time_ms=time_ms,
            pose=self._pose(record, name),
            camera=self._camera,
            image=parsing.picture(self._folder, record.get("image"), self.skipped),
            depth=parsing.picture(self._folder, record.get("depth"), self.skipped),
            detections=None if rows is None else rows.take(name),
        )

    def _pose(self, record: Json, name: str) -> Pose | None:
        """Return the pose; a broken one is counted, and the frame goes on without."""
        if record.get("pose") is None:
            return None
        try:
            x, y, z, *turn = parsing.numbers(record["pose"], 7, "the pose")
            covariance = self._covariance(record.get("pose_covariance"), name)
            return Pose((x, y, z), (turn[0], turn[1], turn[2], turn[3]), covariance)
        except BadInput as error:
            self.skipped.add("broken pose", f"{name} ({error})")
            return None

    def _covariance(self, given: Any, name: str) -> tuple[float, ...] | None:
        """Return the pose's covariance; a broken one is counted, and the pose goes on without."""
        try:
            return None if given is None else parsing.covariance_of(given)
        except BadInput as error:
            self.skipped.add("broken pose covariance", f"{name} ({error})")
            return None

    def _detections(self) -> parsing.Rows | None:
        path = self._folder / DETECTIONS
        if not path.is_file():
            return None
        rows = parsing.Rows()
        embeddings = self._looks.read(self._folder)
        for number, record in parsing.json_lines(path, self.skipped):
            where = f"{DETECTIONS}:{number + 1}"
            parsing.warn_unknown(record, DETECTION_KNOWN, DETECTIONS, self.skipped)
            try:
                detection = self._detection(number, record, embeddings, where)
                rows.add(parsing.frame_name(record.get("frame")), detection)
            except BadInput as error:
                self.skipped.add(parsing.BROKEN_DETECTION, f"{where} ({error})")
        return rows

    def _detection(
        self, number: int, record: Json, embeddings: Vectors | None, where: str
    ) -> Detection:
        position = record.get("position")
        if position is not None:
            x, y, z = parsing.numbers(position, 3, "the position")
            position = (x, y, z)
        return Detection(
            category=parsing.category_of(record.get("category"), self.skipped, where),
            probability=parsing.number(record.get("probability"), "probability"),
            box=parsing.box_of(record.get("box")),
            position=position,
            covariance=parsing.spread_of(record.get("covariance"), self.skipped, where),
            embedding=self._embedding(record.get("embedding"), embeddings, where),
            row=number,
        )

    def _embedding(
        self, row: Any, embeddings: Vectors | None, where: str
    ) -> NDArray[np.float32] | None:
        """Return the embedding; a broken one is counted, and the detection goes on without."""
        try:
            return self._looks.vector(row, embeddings)
        except BadInput as error:
            self.skipped.add(BROKEN_EMBEDDING, f"{where} ({error})")
            return None


def _camera(record: Any) -> Camera | None:
    if record is None:
        return None
    if not isinstance(record, dict):
        raise BadInput(f"{FACTS}: camera must be an object or null")
    names = ("width", "height", "fx", "fy", "cx", "cy")
    width, height, *rest = (parsing.number(record.get(n), f"camera.{n}") for n in names)
    return Camera(int(width), int(height), *rest)


def _classes(names: Any) -> tuple[str, ...]:
    if not isinstance(names, list | None):
        raise BadInput(f"{FACTS}: classes must be a list of names, or null")
    return tuple(parsing.clean_text(str(name)) for name in names or ())


def _regions(records: Any) -> Regions:
    if not isinstance(records, list | None):
        raise BadInput(f"{FACTS}: regions must be a list, or null")
    polygons = []
    for record in records or ():
        polygon = record.get("polygon") if isinstance(record, dict) else None
        if not isinstance(polygon, list) or not isinstance(record.get("name"), str):
            raise BadInput(f"{FACTS}: a region needs a name and a polygon")
        corners = [parsing.numbers(c, 2, "a corner") for c in polygon]
        if len(corners) < 3:
            raise BadInput(f"{FACTS}: region {record['name']!r} needs three corners or more")
        name = parsing.clean_text(record["name"])
        polygons.append((name, tuple((c[0], c[1]) for c in corners)))
    return Regions(tuple(polygons))
