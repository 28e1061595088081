"""The tf tree of a bag: transforms between coordinate frames over time, and the way up to the map.

A transform is a `Pose`: the child's frame in its parent's. Times are nanoseconds.
"""

from __future__ import annotations

from array import array
from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from d3a.model import Pose, Position
from d3a.readers.base import Link
from d3a.readers.tracks import between, nearest_at

IDENTITY = Pose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
OPTICAL = Pose((0.0, 0.0, 0.0), (-0.5, 0.5, -0.5, 0.5))
"""A camera's optical frame (x right, y down, z ahead) in a body's (x ahead, y left, z up)."""
MOST_ASIDE = 100_000
"""Samples of links that lead not to the camera are let go from this many on."""


@dataclass(frozen=True, slots=True)
class Reach:
    """How far transforms reach in time, nanoseconds.

    between_ns: two that are so near may be interpolated. beyond_ns: so long one holds where no
    other is near; a robot at 1 m/s is then as many metres on.
    """

    between_ns: float
    beyond_ns: float


Seven = Sequence[float]
"""x y z in metres, and the quaternion x y z w."""


def rotated(quaternion: Seven, vector: Seven) -> Position:
    """Return the vector turned by a unit quaternion."""
    qx, qy, qz, qw = quaternion
    vx, vy, vz = vector
    tx, ty, tz = 2 * (qy * vz - qz * vy), 2 * (qz * vx - qx * vz), 2 * (qx * vy - qy * vx)
    return (
        vx + qw * tx + (qy * tz - qz * ty),
        vy + qw * ty + (qz * tx - qx * tz),
        vz + qw * tz + (qx * ty - qy * tx),
    )


def composed(parent: Pose, child: Pose) -> Pose:
    """Return the child's pose in the frame that the parent's is in; of q and -q that with w >= 0.

    The covariance is the parent's.
    """
    x, y, z = rotated(parent.quaternion, child.position)
    px, py, pz = parent.position
    ax, ay, az, aw = parent.quaternion
    bx, by, bz, bw = child.quaternion
    turn = (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )
    if turn[3] < 0:
        turn = (-turn[0], -turn[1], -turn[2], -turn[3])
    return Pose((px + x, py + y, pz + z), turn, parent.covariance)


class Samples:
    """Transforms of one link by time, in any order; of two at one time the later said one holds."""

    def __init__(self) -> None:
        self._times = array("q")
        self._values = array("d")
        self._is_sorted = True

    def __len__(self) -> int:
        return len(self._times)

    def add(self, time_ns: int, values: Seven) -> None:
        """Keep a transform (seven numbers)."""
        if self._times and time_ns <= self._times[-1]:
            if time_ns == self._times[-1]:  # drivers repeat the last one
                self._values[-7:] = array("d", values)
                return
            self._is_sorted = False
        self._times.append(time_ns)
        self._values.extend(values)

    def at(self, time_ns: int, reach: Reach) -> Pose | None:
        """Return the transform at a time: between the two around it where they are near enough.

        Else the nearest, which holds for a while; None where it is farther off.
        """
        self._sort()
        after = bisect_left(self._times, time_ns)
        if after < len(self._times) and self._times[after] == time_ns:
            return self._pose(after)
        if 0 < after < len(self._times):
            before_ns, after_ns = self._times[after - 1], self._times[after]
            if after_ns - before_ns <= reach.between_ns:
                share = (time_ns - before_ns) / (after_ns - before_ns)
                return between(self._pose(after - 1), self._pose(after), share)
        held = nearest_at(self._times, time_ns, reach.beyond_ns)
        return None if held is None else self._pose(held)

    def _pose(self, number: int) -> Pose:
        x, y, z, qx, qy, qz, qw = self._values[7 * number : 7 * number + 7]
        return Pose((x, y, z), (qx, qy, qz, qw))

    def _sort(self) -> None:
        if self._is_sorted:
            return
        last = {time_ns: number for number, time_ns in enumerate(self._times)}
        order = sorted(last)
        values = array("d")
        for time_ns in order:
            values.extend(self._values[7 * last[time_ns] : 7 * last[time_ns] + 7])
        self._times, self._values, self._is_sorted = array("q", order), values, True


@dataclass(slots=True)
class Edge:
    """A link of the tree. fixed: its transform from /tf_static, which holds at all times."""

    parent: str
    child: str
    samples: Samples = field(default_factory=Samples)
    fixed: Pose | None = None
    count: int = 0

    def at(self, time_ns: int, reach: Reach) -> Pose | None:
        """Return the child in its parent at a time, None where nothing near says it."""
        return self.fixed if self.fixed is not None else self.samples.at(time_ns, reach)


class Tree:
    """All links that a bag tells of."""

    def __init__(self) -> None:
        self._edges: dict[tuple[str, str], Edge] = {}
        self._since_pruned = 0

    def add(self, parent: str, child: str, time_ns: int | None, pose: Pose) -> None:
        """Keep a transform; time_ns None: it holds always."""
        edge = self._edges.setdefault((parent, child), Edge(parent, child))
        edge.count += 1
        if time_ns is None:
            edge.fixed = pose
        else:
            edge.samples.add(time_ns, (*pose.position, *pose.quaternion))
            self._since_pruned += 1

    def prune(self, frames: Sequence[str], otherwise: Mapping[str, str]) -> None:
        """Let go of samples that no way up from these frames passes, when they have become many.

        otherwise: child -> parent, where something else than tf tells that. A link that is passed
        only once a later one shows up told nothing of use before.
        """
        if self._since_pruned < MOST_ASIDE:
            return
        self._since_pruned = 0
        passed = {id(edge) for frame in frames for edge in self.way_up(frame, otherwise)}
        for edge in self._edges.values():
            if id(edge) not in passed:
                edge.samples = Samples()

    def links(self) -> list[Link]:
        """Return the links, each parent's together."""
        return [
            Link(edge.parent, edge.child, edge.fixed is not None, edge.count)
            for edge in sorted(self._edges.values(), key=lambda e: (e.parent, e.child))
        ]

    def disputed(self) -> list[str]:
        """Return the frames that have several parents; the one told most often counts."""
        children = [edge.child for edge in self._edges.values()]
        return sorted({child for child in children if children.count(child) > 1})

    def frames(self) -> set[str]:
        """Return the names of all frames."""
        return {name for edge in self._edges.values() for name in (edge.parent, edge.child)}

    def way_up(self, frame: str, otherwise: Mapping[str, str] | None = None) -> Iterator[Edge]:
        """Yield the links from a frame to the top, each once even where they run in a circle."""
        above: dict[str, Edge] = {}
        for edge in self._edges.values():
            if edge.child not in above or edge.count > above[edge.child].count:
                above[edge.child] = edge
        seen = set()
        while frame not in seen:
            seen.add(frame)
            if frame in above:
                yield above[frame]
                frame = above[frame].parent
            elif otherwise is not None and frame in otherwise:
                frame = otherwise[frame]
