"""Frames, poses and detections: s_i and a_ij of the paper (Problem Formulation)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grammar.forms import D3AError as D3AError

Json = dict[str, Any]
Box = tuple[float, float, float, float]
"""x1, y1, x2, y2 in pixels from the frame's top left."""
Position = tuple[float, float, float]
"""x, y, z in metres in the map frame."""
Image = Path | bytes | NDArray[np.uint8]
"""An encoded picture (file or bytes), or decoded pixels (h, w, 3), RGB."""
Depth = Path | bytes | NDArray[np.float32]
"""A 16-bit PNG in millimetres (file or bytes), or decoded metres (h, w); 0 and NaN: nothing."""


class BadInput(D3AError):  # noqa: N818  the name says what it is, as QuestionError's kin do
    """Input that cannot be used: says what was found and what would do."""


@dataclass(frozen=True, slots=True)
class Camera:
    """A pinhole camera: size and focal lengths in pixels, principal point from the top left."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float

    def __post_init__(self) -> None:
        numbers = (self.width, self.height, self.fx, self.fy, self.cx, self.cy)
        if not all(math.isfinite(n) for n in numbers) or min(numbers[:4]) <= 0:
            raise BadInput(f"camera {numbers} must have finite numbers, size and focal length > 0")


@dataclass(frozen=True, slots=True)
class Pose:
    """The camera's optical frame (x right, y down, z forward) in the map frame.

    position: metres. quaternion: x y z w, made unit length here.
    covariance: 36 numbers, row-major over x y z rotX rotY rotZ, or None where unknown.
    """

    position: Position
    quaternion: tuple[float, float, float, float]
    covariance: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        norm = math.sqrt(sum(q * q for q in self.quaternion))
        if not all(map(math.isfinite, (*self.position, norm))) or norm < 1e-6:
            raise BadInput(f"pose {self.position} {self.quaternion} is not finite, or no rotation")
        if self.covariance is not None and (
            len(self.covariance) != 36 or not all(map(math.isfinite, self.covariance))
        ):
            raise BadInput("a pose covariance needs 36 finite numbers")
        unit = tuple(q / norm for q in self.quaternion)
        object.__setattr__(self, "quaternion", unit)


@dataclass(frozen=True, slots=True)
class Detection:
    """One object in one frame: a_ij of the paper (Approach, "Pre-processing each frame").

    box: x1, y1, x2, y2 in pixels from the frame's top left.
    position: metres in the map frame, None without depth and pose; covariance: its 3 x 3
    row-major, None where unknown. ranged: False where how far off it is was assumed.
    extent_m: width and height of the thing, from depth.
    embedding: (d,), unit length, None without a picture. row: its number in the recording's file
    of detections, from 0, so that identity can be judged from outside.
    """

    category: str
    probability: float
    box: Box
    position: Position | None = None
    covariance: tuple[float, ...] | None = None
    ranged: bool = True
    extent_m: tuple[float, float] | None = None
    embedding: NDArray[np.float32] | None = field(default=None, repr=False, compare=False)
    row: int | None = None

    def __post_init__(self) -> None:
        if not self.category.strip():
            raise BadInput("a detection has an empty category")
        if not (0.0 <= self.probability <= 1.0):  # also refuses NaN
            raise BadInput(f"probability {self.probability} is outside of 0..1")
        x1, y1, x2, y2 = self.box
        if not all(map(math.isfinite, self.box)) or x2 <= x1 or y2 <= y1:
            raise BadInput(f"box {self.box} must be finite with x2 > x1 and y2 > y1")
        if self.position is not None and not all(map(math.isfinite, self.position)):
            raise BadInput(f"position {self.position} is not finite")


@dataclass(frozen=True, slots=True)
class Frame:
    """One moment of a recording: s_i = <p_robot,i, d_i, f_i> with the detector's boxes, if any.

    name: the recording's own frame number or name. time_ms: UTC milliseconds, acquisition.
    detections: None where no detector has looked yet, () where it found nothing.
    depth_scale: counts a metre in a depth PNG; 1000 is millimetres.
    """

    name: str
    time_ms: int
    pose: Pose | None = None
    camera: Camera | None = None
    image: Image | None = field(default=None, repr=False, compare=False)
    depth: Depth | None = field(default=None, repr=False, compare=False)
    detections: tuple[Detection, ...] | None = None
    depth_scale: float = 1000.0
