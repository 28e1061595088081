"""An OccupancyGrid of a bag, as the floor plan that a store keeps."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from d3a.floor_map import FREE, MOST_CELLS, OCCUPIED, UNKNOWN, FloorMap
from d3a.model import BadInput
from d3a.readers.ros_topics import frame_id_of

WALL, OPEN = 65, 25
"""Percent: what map_server's usual thresholds make a wall, and what free floor."""


def floor_of(grid: Any, top: str) -> FloorMap:
    """Return an OccupancyGrid as a floor plan; what is between free and a wall is not known.

    top: the frame that poses are in. Raises BadInput for a map in another, or one that cannot be.
    """
    if frame_id_of(grid) not in ("", top):
        raise BadInput(f"it is in {frame_id_of(grid)}, and poses are in {top}")
    info = grid.info
    width, height = int(info.width), int(info.height)
    if not 0 < width * height <= MOST_CELLS or len(grid.data) != width * height:
        raise BadInput(f"the map of {width} x {height} cells has {len(grid.data)}")
    if not 0 < float(info.resolution) < 1000:
        raise BadInput(f"the map's resolution is {info.resolution} m")
    values = np.asarray(grid.data, dtype=np.int16).reshape(height, width)
    cells = np.where(values >= WALL, OCCUPIED, np.where(values <= OPEN, FREE, UNKNOWN))
    cells = np.where(values < 0, UNKNOWN, cells).astype(np.int8)
    origin = info.origin
    x, y = float(origin.position.x), float(origin.position.y)
    q = origin.orientation
    yaw = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))
    if not all(map(math.isfinite, (x, y, yaw))):
        raise BadInput("the map's origin is not finite")
    return FloorMap(cells, float(info.resolution), (x, y, yaw))
