"""Where the robot looked: consecutive frames from nearly one viewpoint are one `View`.

Compact, because a robot that stands still for an hour has looked once; and the unit of negative
evidence, because a thing hidden in one frame is hidden in the next from the same place too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from d3a.geometry import heading
from d3a.model import Camera, Json, Pose
from d3a.parameters import Parameters
from d3a.store.base import View

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
        fresh = self._view(time_ms, pose, camera)
        if self.open is not None and self._goes_on(self.open, fresh):
            self.open = replace(self.open, end_ms=time_ms, frames=self.open.frames + 1)
            return None
        ended, self.open = self.open, fresh
        return ended

    def _view(self, time_ms: int, pose: Pose | None, camera: Camera | None) -> View:
        bare = View(time_ms, time_ms, 1, self.site, self.recording)
        if pose is None:
            return bare
        half = None if camera is None else math.atan(camera.width / 2 / camera.fx)
        return replace(
            bare,
            x=pose.position[0],
            y=pose.position[1],
            yaw=heading(pose),
            half_angle=half,
            range_m=self.parameters.view_range_m,
        )

    def _goes_on(self, old: View, new: View) -> bool:
        """Compare with the view's first frame, so that a slow drift ends it too."""
        if new.start_ms - old.end_ms > self.parameters.interval_gap_s * 1000:
            return False
        if old.x is None or new.x is None:
            return old.x is new.x
        assert old.y is not None and new.y is not None  # noqa: PT018  set together with x
        assert old.yaw is not None and new.yaw is not None  # noqa: PT018
        moved = math.hypot(new.x - old.x, new.y - old.y)
        return (
            moved < self.parameters.view_step_m
            and angle_between(new.yaw, old.yaw) < self.parameters.view_turn_rad
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
