"""A store as files for other programs: COCO, CSV, and a recording that can be ingested again.

Boxes are in the pixels of the pictures that are written: the store keeps some smaller than they
were taken. Names of files are numbers or what is left of a name without anything but letters,
digits, dots and dashes: words of a recording never become paths.
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta, tzinfo
from pathlib import Path
from typing import Any

import numpy as np

from d3a.answering.places import room_of
from d3a.model import BadInput, Box, Json
from d3a.store.base import (
    Keyframe,
    ObjectRecord,
    RecordingRecord,
    Sighting,
    StayKey,
    StayRecord,
    Store,
)

FORMATS = ("coco", "csv", "recording")
COLUMNS = (
    "object_id", "place", "category", "names", "x", "y", "z", "room", "first", "last", "seen",
    "intervals", "last_absent", "frame", "keyframe", "keyframe_time", "probability",
    "box_x1", "box_y1", "box_x2", "box_y2", "tentative",
)  # fmt: skip
_FORMULA = tuple("=+-@\t\r")


@dataclass(frozen=True, slots=True)
class Exported:
    """How much was written: objects, places, intervals, pictures; and where."""

    out: Path
    objects: int
    places: int
    intervals: int
    pictures: int

    def to_json(self) -> Json:
        """Return the counts."""
        names = ("objects", "places", "intervals", "pictures")
        return {"out": str(self.out), **{name: getattr(self, name) for name in names}}


def export(
    store: Store, out: Path, format_name: str, *, ids: Collection[str] | None, zone: tzinfo
) -> Exported:
    """Write a store, or what it holds of some objects, into a new or empty folder.

    CSV writes the file `out`, which must not exist. Raises BadInput for a target that is in the
    way, OSError where it cannot be written.
    """
    if format_name not in FORMATS:
        raise BadInput(f"unknown format {format_name!r}; there are {', '.join(FORMATS)}")
    taken = out.exists() and (format_name == "csv" or not out.is_dir() or any(out.iterdir()))
    if taken:
        raise BadInput(f"{out} is there already; name a new one")
    content = _Content.read(store, ids)
    if format_name == "csv":
        out.parent.mkdir(parents=True, exist_ok=True)
        pictures = _write_csv(content, store, out, zone)
    elif format_name == "coco":
        pictures = _write_coco(content, store, out, zone)
    else:
        pictures = _write_recordings(content, store, out, zone)
    counted = len(content.objects), len(content.stays), len(content.sightings)
    return Exported(out, *counted, pictures)


@dataclass(frozen=True, slots=True)
class _Content:
    """What is exported, by key."""

    objects: dict[str, ObjectRecord]
    stays: dict[StayKey, StayRecord]
    sightings: list[Sighting]

    @classmethod
    def read(cls, store: Store, ids: Collection[str] | None) -> _Content:
        asked = None if ids is None else sorted(ids)
        return cls(
            {record.object_id: record for record in store.objects(ids=asked)},
            {record.key: record for record in store.stays(object_ids=asked)},
            store.sightings(object_ids=asked),
        )


def _iso(time_ms: int, zone: tzinfo) -> str:
    moment = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(milliseconds=time_ms)
    return moment.astimezone(zone).isoformat(timespec="milliseconds")


def _moment(sighting: Sighting) -> int:
    return sighting.start_ms if sighting.keyframe_ms is None else sighting.keyframe_ms


# csv
def _write_csv(content: _Content, store: Store, out: Path, zone: tzinfo) -> int:
    """Write a row a stay, with its likeliest sighting as the keyframe."""
    best: dict[StayKey, Sighting] = {}
    counted: dict[StayKey, int] = {}
    for s in content.sightings:
        counted[s.stay] = counted.get(s.stay, 0) + 1
        if s.stay not in best or s.probability > best[s.stay].probability:
            best[s.stay] = s
    regions = store.regions()
    with out.open("x", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(COLUMNS)
        for key, stay in sorted(content.stays.items()):
            room = room_of(regions, stay.position, stay.site)
            place = [*(stay.position or ("", "", "")), plain_cell(room or "")]
            rows.writerow(
                [
                    *_who(content.objects[stay.object_id], stay),
                    *place,
                    _iso(stay.first_ms, zone),
                    _iso(stay.last_ms, zone),
                    stay.seen,
                    counted.get(key, 0),
                    "" if stay.last_absent_ms is None else _iso(stay.last_absent_ms, zone),
                    *_keyframe_cells(best.get(key), zone),
                    int(stay.tentative),
                ]
            )
    return 0


def _who(record: ObjectRecord, stay: StayRecord) -> list[object]:
    names = "; ".join(f"{n.word} of {n.owner}" if n.owner else n.word for n in record.names)
    return [
        plain_cell(record.object_id),
        stay.place,
        plain_cell(record.category),
        plain_cell(names),
    ]


def _keyframe_cells(best: Sighting | None, zone: tzinfo) -> list[object]:
    if best is None:
        return [""] * 8
    shown = [plain_cell(best.frame), plain_cell(best.image or ""), _iso(_moment(best), zone)]
    return [*shown, best.probability, *best.box]


def plain_cell(text: str) -> str:
    """Return text that no spreadsheet takes for a formula: an apostrophe is put before it."""
    return f"'{text}" if text.startswith(_FORMULA) else text


# pictures
@dataclass(slots=True)
class _Pictures:
    """Writes each stored picture once, under a number; tells by how much its boxes shrink."""

    store: Store
    folder: Path
    written: dict[str, tuple[str, float, float, int, int]]

    def of(self, key: str | None) -> tuple[str, float, float, int, int] | None:
        """Return (file, x scale, y scale, width, height), None where there is no picture."""
        if key is None:
            return None
        if key not in self.written:
            picture = self.store.keyframe(key)
            if picture is None:
                return None
            self.written[key] = self._write(picture)
        return self.written[key]

    def _write(self, picture: Keyframe) -> tuple[str, float, float, int, int]:
        from d3a.images import decode

        height, width = decode(picture.jpeg).shape[:2]
        name = f"{len(self.written) + 1:06d}.jpg"
        self.folder.mkdir(parents=True, exist_ok=True)
        (self.folder / name).write_bytes(picture.jpeg)
        return name, width / picture.width, height / picture.height, width, height


def _scaled(box: Box, x: float, y: float) -> list[float]:
    return [box[0] * x, box[1] * y, box[2] * x, box[3] * y]


# coco
def _write_coco(content: _Content, store: Store, out: Path, zone: tzinfo) -> int:
    """Write annotations.json and images/: a picture a keyframe, a box a sighting."""
    pictures = _Pictures(store, out / "images", {})
    out.mkdir(parents=True, exist_ok=True)
    categories = sorted({record.category for record in content.objects.values()})
    numbers = {name: number for number, name in enumerate(categories, 1)}
    images: dict[str, Json] = {}
    annotations: list[Json] = []
    for s in content.sightings:
        shown = pictures.of(s.image)
        if shown is None or s.image is None:
            continue
        name, x, y, width, height = shown
        fresh = {
            "id": len(images) + 1,
            "file_name": name,
            "width": width,
            "height": height,
            "date_captured": _iso(_moment(s), zone),
            "d3a_frame": s.frame,
            "d3a_recording": s.recording,
            "d3a_image": s.image,
        }
        image = images.setdefault(s.image, fresh)
        category = numbers[content.objects[s.object_id].category]
        annotations.append(_annotation(s, len(annotations) + 1, image["id"], category, (x, y)))
    record = {
        "info": {"description": "keyframes of a d3a store", "version": "1"},
        "licenses": [],
        "images": list(images.values()),
        "annotations": annotations,
        "categories": [{"id": n, "name": name} for name, n in numbers.items()],
    }
    (out / "annotations.json").write_text(
        json.dumps(record, ensure_ascii=False, indent=1) + "\n", encoding="utf-8"
    )
    return len(images)


def _annotation(
    s: Sighting, number: int, image: int, category: int, scale: tuple[float, float]
) -> Json:
    x1, y1, x2, y2 = _scaled(s.box, *scale)
    return {
        "id": number,
        "image_id": image,
        "category_id": category,
        "bbox": [x1, y1, x2 - x1, y2 - y1],
        "area": (x2 - x1) * (y2 - y1),
        "iscrowd": 0,
        "score": s.probability,
        "d3a_object": s.object_id,
        "d3a_place": s.place,
        "d3a_start_ms": s.start_ms,
        "d3a_end_ms": s.end_ms,
    }


# recording
def _write_recordings(content: _Content, store: Store, out: Path, zone: tzinfo) -> int:
    """Write a recording folder; a folder each inside of `out` where there are several."""
    by_name: dict[str, list[Sighting]] = {}
    for sighting in content.sightings:
        by_name.setdefault(sighting.recording, []).append(sighting)
    known = {record.name: record for record in store.recordings()}
    total = 0
    for number, name in enumerate(sorted(by_name) or [""], 1):
        folder = out if len(by_name) < 2 else out / f"{number:02d}-{_file_name(name)}"
        folder.mkdir(parents=True, exist_ok=True)
        total += _write_recording(
            content, store, folder, zone, by_name.get(name, []), known.get(name)
        )
    return total


def _file_name(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9.-]+", "-", name).strip("-.")[:60] or "recording"


def _write_recording(
    content: _Content,
    store: Store,
    folder: Path,
    zone: tzinfo,
    sightings: list[Sighting],
    record: RecordingRecord | None,
) -> int:
    looks = _write_looks(content, folder, sightings)
    _write_facts(content, store, folder, record, looks)
    pictures = _Pictures(store, folder / "images", {})
    frames: dict[tuple[int, str], Json] = {}
    detections: list[tuple[tuple[int, str], Json]] = []
    for s in sightings:
        shown = pictures.of(s.image)
        key = (_moment(s), s.frame)
        frame = frames.setdefault(key, _frame(s, zone))
        if shown is not None:
            frame["image"] = f"images/{shown[0]}"
        scale = (1.0, 1.0) if shown is None else shown[1:3]
        detections.append((key, _detection(s, content, looks, scale)))
    _write_lines(folder / "frames.jsonl", (frames[key] for key in sorted(frames)))
    ordered = sorted(detections, key=lambda each: (each[0], each[1]["category"], each[1]["box"]))
    _write_lines(folder / "detections.jsonl", (line for _, line in ordered))
    return len(pictures.written)


def _write_looks(content: _Content, folder: Path, sightings: list[Sighting]) -> dict[str, int]:
    """Write embeddings.npy, a row an object that has a look; return the rows by id."""
    ids = sorted({s.object_id for s in sightings})
    looks = {i: e for i in ids if (e := content.objects[i].embedding) is not None}
    if looks:
        np.save(folder / "embeddings.npy", np.stack(list(looks.values())).astype(np.float32))
    return {object_id: row for row, object_id in enumerate(looks)}


def _write_facts(
    content: _Content,
    store: Store,
    folder: Path,
    record: RecordingRecord | None,
    looks: dict[str, int],
) -> None:
    first = next(iter(looks), None)
    look = None if first is None else content.objects[first]
    embedding = None
    if look is not None and look.embedding is not None:
        embedding = {"name": look.embedding_model, "dim": len(look.embedding)}
    facts = {
        "schema": 1,
        "recording": f"{record.name if record else 'store'} (keyframes)",
        "site": record.site if record else "",
        "zone": store.meta("zone"),
        "camera": None,
        "embedding": embedding,
        "map": None,
        "now": store.meta("now"),
        "classes": store.meta("classes"),
        "regions": [
            {"name": region.name, "polygon": [list(corner) for corner in region.polygon]}
            for region in store.regions()
        ],
    }
    text = json.dumps(facts, ensure_ascii=False, indent=2) + "\n"
    (folder / "recording.json").write_text(text, encoding="utf-8")


def _frame(s: Sighting, zone: tzinfo) -> Json:
    pose = None if s.viewer is None else list(s.viewer)
    fields: Json = {"frame": s.frame, "time": _iso(_moment(s), zone), "pose": pose}
    return {**fields, "pose_covariance": None, "image": None, "depth": None}


def _detection(
    s: Sighting, content: _Content, looks: dict[str, int], scale: tuple[float, float]
) -> Json:
    stay = content.stays[s.stay]
    covariance = None if stay.covariance is None else list(stay.covariance)
    return {
        "frame": s.frame,
        "category": s.category or content.objects[s.object_id].category,
        "probability": s.probability,
        "box": _scaled(s.box, *scale),
        "position": None if stay.position is None else list(stay.position),
        "covariance": covariance,
        "embedding": looks.get(s.object_id),
    }


def _write_lines(path: Path, lines: Iterator[Any]) -> None:
    with path.open("w", encoding="utf-8") as file:
        file.writelines(json.dumps(line, ensure_ascii=False) + "\n" for line in lines)
