"""The camera of a folder that may or may not say it: four numbers, a matrix, or JSON."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from d3a import images
from d3a.model import BadInput, Camera, Image
from d3a.readers import parsing
from d3a.readers.options import Options

USUAL_FILES = ("camera.json", "camera-intrinsics.txt", "intrinsics.txt")
Intrinsics = tuple[float, float, float, float]
"""fx, fy, cx, cy in pixels."""


class Lens:
    """Gives frames their camera: its size is the one told, else that of the first sound picture."""

    def __init__(self, intrinsics: Intrinsics | None, size: tuple[int, int] | None = None) -> None:
        """size: width and height that the intrinsics are for, None where nothing says it."""
        self.intrinsics = intrinsics
        self._size = size
        self._camera: Camera | None = None

    @classmethod
    def of(cls, options: Options, known: Intrinsics | None = None) -> Lens:
        """Return the camera of the option `camera`, of the folder's own file, or `known`."""
        said = options.text("camera")
        if said is not None and said.count(",") == 3:
            return cls(_four([parsing.number(part, "camera") for part in said.split(",")]))
        path = options.file("camera", *USUAL_FILES)
        return cls(known) if path is None else cls(*_from_file(path))

    def camera(self, picture: Image | None) -> Camera | None:
        """Return the camera, None without intrinsics or before there was a sound picture."""
        if self._camera is not None or self.intrinsics is None:
            return self._camera
        size = self._size
        if size is None and picture is not None:
            try:
                size = images.size(picture)
            except BadInput:
                return None  # the ingest counts and names it; the next picture may do
        if size is not None:
            self._camera = Camera(*size, *self.intrinsics)
        return self._camera


def _four(values: list[float]) -> Intrinsics:
    fx, fy, cx, cy = values
    if fx <= 0 or fy <= 0:
        raise BadInput(f"the camera's focal lengths {fx:g}, {fy:g} must be above 0: uncalibrated?")
    return fx, fy, cx, cy


def _from_file(path: Path) -> tuple[Intrinsics, tuple[int, int] | None]:
    if path.suffix.lower() != ".json":
        try:
            return _of_matrix(np.loadtxt(path)), None
        except (ValueError, OSError) as error:
            raise BadInput(f"{path.name} is not a 3 x 3 matrix of numbers") from error
    try:
        record: Any = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"{path.name} is not JSON: {error}") from error
    if not isinstance(record, dict):
        raise BadInput(f"{path.name} must be an object with fx, fy, cx, cy")
    if "fx" not in record and ("k" in record or "K" in record):
        matrix = parsing.numbers(record.get("k", record.get("K")), 9, "k")
        intrinsics = _of_matrix(np.reshape(matrix, (3, 3)))
    else:
        names = ("fx", "fy", "cx", "cy")
        intrinsics = _four([parsing.number(record.get(n), f"{path.name}: {n}") for n in names])
    if record.get("width") is None or record.get("height") is None:
        return intrinsics, None
    width, height = (parsing.number(record[n], f"{path.name}: {n}") for n in ("width", "height"))
    return intrinsics, (int(width), int(height))


def _of_matrix(matrix: Any) -> Intrinsics:
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        raise BadInput("a camera's matrix must be 3 x 3, finite numbers")
    return _four([float(matrix[at]) for at in ((0, 0), (1, 1), (0, 2), (1, 2))])
