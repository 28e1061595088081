"""Where the robot looked: consecutive frames from nearly one viewpoint are one `View`.

Compact, because a robot that stands still for an hour has looked once; and the unit of negative
evidence, because a thing hidden in one frame is hidden in the next from the same place too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from d3a.frozen import maker
from d3a.geometry import heading
from d3a.model import Camera, Json, Pose
from d3a.parameters import Parameters
from d3a.store.base import View

_view = maker(View)
"""Each frame makes one."""
SITE_FIELDS = ("start_ms", "end_ms", "frames", "x", "y", "yaw", "half_angle", "range_m")


def angle_between(a: float, b: float) -> float:
    """Return the smaller angle between two directions, radians, 0 to pi."""
    return abs((a - b + math.pi) % (2 * math.pi) - math.pi)


@dataclass(slots=True)
class Coverage:
    """Grows views frame by frame; `closed` holds those that ended since they were last taken."""

    parameters: Parameters
    site: str
    recording: str
    open: View | None = None

    def add(self, time_ms: int, pose: Pose | None, camera: Camera | None) -> View | None:
        """Take a frame in; return the view that ended with it, if one did."""
        old = self.open
        if old is not None and self._goes_on(old, time_ms, pose):
            self.open = _view(
                old.start_ms, time_ms, old.frames + 1, old.site, old.recording,
                old.x, old.y, old.yaw, old.half_angle, old.range_m,
            )  # fmt: skip
            return None
        self.open = self._view(time_ms, pose, camera)
        return old

    def _view(self, time_ms: int, pose: Pose | None, camera: Camera | None) -> View:
        if pose is None:
            return View(time_ms, time_ms, 1, self.site, self.recording)
        half = None if camera is None else math.atan(camera.width / 2 / camera.fx)
        (x, y, _), reach_m = pose.position, self.parameters.view_range_m
        yaw = heading(pose)
        return View(time_ms, time_ms, 1, self.site, self.recording, x, y, yaw, half, reach_m)

    def _goes_on(self, old: View, time_ms: int, pose: Pose | None) -> bool:
        """Compare with the view's first frame, so that a slow drift ends it too."""
        if time_ms - old.end_ms > self.parameters.interval_gap_s * 1000:
            return False
        if old.x is None or old.y is None or old.yaw is None or pose is None:
            return old.x is None and pose is None
        moved = math.hypot(pose.position[0] - old.x, pose.position[1] - old.y)
        return (
            moved < self.parameters.view_step_m
            and angle_between(heading(pose), old.yaw) < self.parameters.view_turn_rad
        )

    def to_state(self) -> Json | None:
        """Return the open view as JSON."""
        view = self.open
        return None if view is None else {name: getattr(view, name) for name in SITE_FIELDS}

    def restore(self, record: Json | None) -> None:
        """Go on with the view that `to_state` described."""
        self.open = None
        if record is not None:
            self.open = View(**record, site=self.site, recording=self.recording)
