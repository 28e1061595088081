"""A floor plan from ROS map_server: which cells of the map are walls, for the chat's map view.

A YAML file names a picture (`pgm`, or any that OpenCV reads), metres a pixel, the pose of the lower
left pixel and two thresholds (nav2 and ROS 1 agree but for cells that lie on a threshold: nav2's
reading is taken). The store keeps the cells; rooms may be given in pixels of that picture.
"""

from __future__ import annotations

import base64
import math
import re
import zlib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from d3a.model import BadInput, Json
from d3a.store.base import Store
from d3a.store.limits import MAX_META_BYTES

MAP = "map"
"""Key of the store's meta that names the key of the map in use."""
RECORDED_MAP = "map:recorded"
"""Key of a map that came with a recording, where nobody had imported one."""
OCCUPIED, FREE, UNKNOWN = 100, 0, -1
"""Of a cell, as in nav_msgs/OccupancyGrid."""
MOST_CELLS = 64_000_000
_NEEDED = ("image", "resolution", "origin", "occupied_thresh", "free_thresh")
_LINE = re.compile(r"^([A-Za-z_]\w*)\s*:\s*(.*?)\s*$")
_TOKEN = re.compile(rb"(?:\s|#[^\n]*\n)*(\S+)")


@dataclass(frozen=True, slots=True)
class FloorMap:
    """Cells of a floor, row 0 at the bottom (y grows with rows, as in an OccupancyGrid).

    cells: (h, w) of OCCUPIED, FREE or UNKNOWN. resolution: metres a cell. origin: x, y in metres
    and yaw in radians, counterclockwise, of the corner of cell (0, 0) in the map frame.
    """

    cells: NDArray[np.int8] = field(repr=False)
    resolution: float
    origin: tuple[float, float, float]

    def point(self, column: float, row: float) -> tuple[float, float]:
        """Return x, y in metres of a point of the grid; (0, 0) is its lower left corner."""
        x0, y0, yaw = self.origin
        x, y = column * self.resolution, row * self.resolution
        return (
            x0 + math.cos(yaw) * x - math.sin(yaw) * y,
            y0 + math.sin(yaw) * x + math.cos(yaw) * y,
        )

    def of_pixel(self, u: float, v: float) -> tuple[float, float]:
        """Return x, y in metres of a point of the picture; (0, 0) is its upper left corner."""
        return self.point(u, self.cells.shape[0] - v)

    def at(self, x: float, y: float) -> int:
        """Return what the map says of a point in metres, UNKNOWN outside of it."""
        x0, y0, yaw = self.origin
        dx, dy = x - x0, y - y0
        column = math.floor((math.cos(yaw) * dx + math.sin(yaw) * dy) / self.resolution)
        row = math.floor((-math.sin(yaw) * dx + math.cos(yaw) * dy) / self.resolution)
        height, width = self.cells.shape
        return int(self.cells[row, column]) if 0 <= row < height and 0 <= column < width else -1

    def to_json(self) -> Json:
        """Return the map as a store keeps it; raises BadInput for one that is too large."""
        packed = zlib.compress(np.ascontiguousarray(self.cells).tobytes(), 9)
        text = base64.b64encode(packed).decode("ascii")
        if len(text) > MAX_META_BYTES - 1_000:
            raise BadInput(
                f"the map of {self.cells.shape[1]} x {self.cells.shape[0]} cells takes "
                f"{len(text)} bytes, at most {MAX_META_BYTES - 1_000} are kept: crop it, or save "
                "it with a coarser resolution"
            )
        height, width = self.cells.shape
        return {
            "width": width,
            "height": height,
            "resolution": self.resolution,
            "origin": list(self.origin),
            "cells": text,
        }

    @classmethod
    def from_json(cls, record: Json) -> FloorMap:
        """Return what `to_json` wrote."""
        plain = zlib.decompress(base64.b64decode(record["cells"]))
        cells = np.frombuffer(plain, dtype=np.int8).reshape(record["height"], record["width"])
        x, y, yaw = record["origin"]
        return cls(cells, record["resolution"], (x, y, yaw))


def stored_map(store: Store) -> FloorMap | None:
    """Return the floor plan that a store keeps, None where it has none."""
    key = store.meta(MAP)
    record = None if key is None else store.meta(str(key))
    return None if record is None else FloorMap.from_json(record)


def read_map(path: Path) -> FloorMap:
    """Return the map of a map_server YAML file; its picture lies relative to it.

    Raises BadInput for a file or picture that is missing or broken, with what was found.
    """
    facts = _facts(path)
    missing = [name for name in _NEEDED if name not in facts]
    if missing:
        raise BadInput(f"{path.name} has no {', '.join(missing)}: it is no map_server map")
    mode = facts.get("mode", "trinary")
    if mode not in ("trinary", "scale", "raw"):
        raise BadInput(f"{path.name}: mode {mode!r} is not trinary, scale or raw")
    resolution = _number(path, facts, "resolution")
    origin = _numbers(path, facts["origin"])
    if resolution <= 0:
        raise BadInput(f"{path.name}: a resolution of {resolution} m is not above 0")
    values, alpha = _picture(path.parent / facts["image"])
    cells = _raw(values) if mode == "raw" else _trinary(path, facts, values)
    if alpha is not None:
        cells = np.where(alpha < 255, UNKNOWN, cells)
    return FloorMap(np.ascontiguousarray(cells[::-1], dtype=np.int8), resolution, origin)


def _trinary(path: Path, facts: dict[str, str], values: NDArray[np.uint8]) -> NDArray[np.int64]:
    """Return the cells; what is between the thresholds ("scale" grades it) is not known."""
    negate = _number(path, {"negate": facts.get("negate", "0")}, "negate") != 0
    occupied = _number(path, facts, "occupied_thresh")
    free = _number(path, facts, "free_thresh")
    if not 0 <= free < occupied <= 1:
        raise BadInput(f"{path.name}: thresholds {free} and {occupied} are not in 0..1, in order")
    probability = values / 255.0 if negate else (255.0 - values) / 255.0
    return np.where(probability >= occupied, OCCUPIED, np.where(probability <= free, FREE, UNKNOWN))


def _raw(values: NDArray[np.uint8]) -> NDArray[np.int64]:
    """Return cells that are occupancies already, 0 to 100; 255 and the like are unknown."""
    known = values <= OCCUPIED
    return np.where(known, np.where(values >= OCCUPIED // 2, OCCUPIED, FREE), UNKNOWN)


def _facts(path: Path) -> dict[str, str]:
    """Return the keys of a flat YAML file as text: all that a map_server writes."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise BadInput(f"{path.name} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise BadInput(f"{path.name} is no YAML file: it is not UTF-8 text") from error
    facts: dict[str, str] = {}
    waiting: str | None = None
    for raw in text.splitlines():
        line = re.sub(r"(^|\s)#.*$", "", raw)
        if not line.strip() or line.strip() in ("---", "..."):
            continue
        item = re.match(r"^\s*-\s+(\S.*?)\s*$", line)
        if item and waiting is not None:  # a list, an entry a line
            facts[waiting] = f"{facts[waiting]}, {item[1]}".lstrip(", ")
            continue
        found = _LINE.match(line)
        if found is None:
            raise BadInput(
                f"{path.name} is no map_server map: it has the line {raw.strip()[:60]!r}"
            )
        waiting = found[1]
        facts[waiting] = found[2].strip("\"'")
    return facts


def _number(path: Path, facts: dict[str, str], name: str) -> float:
    text = {"true": "1", "false": "0"}.get(facts[name].lower(), facts[name])
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise BadInput(f"{path.name}: {name} {facts[name]!r} is no number")
    return value


def _numbers(path: Path, text: str) -> tuple[float, float, float]:
    parts = [part for part in re.split(r"[\s,]+", text.strip("[] ")) if part]
    if len(parts) not in (2, 3):
        raise BadInput(f"{path.name}: origin {text!r} is not [x, y, yaw]")
    x, y, yaw = (_number(path, {"origin": part}, "origin") for part in (*parts, "0")[:3])
    return x, y, yaw


def _picture(path: Path) -> tuple[NDArray[np.uint8], NDArray[np.uint8] | None]:
    """Return grey values (h, w) of a picture, 0 black to 255 white, and its opacity, if it has."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise BadInput(f"the map's picture {path.name} cannot be read: {error.strerror}") from error
    if content[:2] in (b"P2", b"P5"):
        return _pgm(path.name, content), None
    return _decoded(path.name, content)


def _decoded(name: str, content: bytes) -> tuple[NDArray[np.uint8], NDArray[np.uint8] | None]:
    from d3a import images

    try:
        return images.decode_grey(content)
    except BadInput as error:
        raise BadInput(f"the map's picture {name}: {error}") from error


def _pgm(name: str, content: bytes) -> NDArray[np.uint8]:
    tokens: list[bytes] = []
    at = 0
    while len(tokens) < 4:
        found = _TOKEN.match(content, at)
        if found is None:
            raise BadInput(f"the map's picture {name} is cut off in its header")
        tokens.append(found[1])
        at = found.end()
    try:
        width, height, most = (int(token) for token in tokens[1:])
    except ValueError:
        raise BadInput(f"the map's picture {name} has no sound header") from None
    if width < 1 or height < 1 or width * height > MOST_CELLS or not 0 < most < 65_536:
        raise BadInput(f"the map's picture {name} claims {width} x {height} of {most}")
    values = _samples(tokens[0], content, at, width * height, wide=most > 255)
    if values is None:
        raise BadInput(f"the map's picture {name} is cut off")
    scaled = values.reshape(height, width).astype(np.float64) * 255 / most
    return np.asarray(np.clip(np.rint(scaled), 0, 255), dtype=np.uint8)


def _samples(
    kind: bytes, content: bytes, at: int, count: int, *, wide: bool
) -> NDArray[np.int64] | None:
    """Return the picture's numbers, None where there are too few."""
    if kind == b"P5":  # one white space, then the bytes; two a number are big-endian
        size = count * (2 if wide else 1)
        body = content[at + 1 : at + 1 + size]
        if len(body) < size:
            return None
        return np.frombuffer(body, dtype=">u2" if wide else "u1").astype(np.int64)
    try:
        numbers = [int(part) for part in re.sub(rb"#[^\n]*", b"", content[at:]).split()]
    except ValueError:
        return None
    return np.array(numbers[:count], dtype=np.int64) if len(numbers) >= count else None
