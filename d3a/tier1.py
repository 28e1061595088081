"""Tier 1: cluster detections across adjacent frames. The only user of scikit-learn.

Paper: "Tier 1 - Clustering across adjacent frames", appendix (DBSCAN, weighted average). The
readings where the paper is silent are at their place in the code.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from d3a.frozen import maker
from d3a.geometry import iou
from d3a.model import Detection
from d3a.parameters import Parameters, Weighing
from d3a.sightings import FrameRef, Interval, Scene

Floats = NDArray[np.float64]
Embedding = NDArray[np.float32]
MIN_SAMPLES = 2
"""DBSCAN's density: a detection and one neighbour. Three lose a third of all objects."""


@dataclass(slots=True, eq=False)
class Member:
    """A detection in the window. label: the entry it was counted in, None while it is noise."""

    ref: FrameRef
    detection: Detection
    label: int | None = None
    neighbours: list[Member] = field(default_factory=list, repr=False)


@dataclass(frozen=True, slots=True)
class Cluster:
    """The unified representation of a cluster: a_g of the paper, with what it was made of.

    weight: summed probability. position (3,), NaN where unknown. embedding (d,): the weighted
    mean, None without pictures. label: an entry that holds detections of this cluster already.
    """

    category: str
    weight: float
    position: Floats
    embedding: Embedding | None
    views: tuple[Interval, ...]
    members: tuple[Member, ...]
    label: int | None


class SlidingWindow:
    """The last frames' detections, clustered anew with every frame (paper: sliding window w).

    Consecutive windows overlap, and the paper does not say what happens to a detection that is in
    ten of them. Here labels are carried over and each detection is counted once, in the first
    window that clusters it; to aggregate each window afresh would weigh a detection up to ten
    times. A pause starts a new window: frames on its two sides are not adjacent.
    """

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters
        self.frames: deque[tuple[int, list[Member]]] = deque()

    def push(self, scene: Scene) -> tuple[list[Cluster], list[Member]]:
        """Take a frame in; return clusters of what is not counted yet, and what became noise."""
        parameters = self._parameters
        now = scene.ref.time_ms
        noise: list[Member] = []
        if self.frames and now - self.frames[-1][0] > parameters.window_gap_s * 1000:
            noise += self.drain()
        while len(self.frames) >= parameters.window_frames:
            noise += _uncounted(self.frames.popleft()[1])
        fresh = [Member(scene.ref, detection) for detection in scene.detections]
        self._connect(fresh)
        self.frames.append((now, fresh))
        return self._clusters(), noise

    def drain(self) -> list[Member]:
        """Empty the window; return what no cluster had a use for."""
        noise = [m for _, members in self.frames for m in _uncounted(members)]
        self.frames.clear()
        return noise

    def _connect(self, fresh: list[Member]) -> None:
        """Link the new detections with all of the window that they are near to."""
        window = [m for _, members in self.frames for m in members] + fresh
        if not fresh or len(window) < MIN_SAMPLES:
            return
        near = np.argwhere(np.asarray(distances(fresh, window, self._parameters)) <= 1.0)
        offset = len(window) - len(fresh)
        for i, j in near.tolist():
            if j < offset + i:  # each pair once, none with itself
                fresh[i].neighbours.append(window[j])
                window[j].neighbours.append(fresh[i])

    def _clusters(self) -> list[Cluster]:
        members = [m for _, each in self.frames for m in each]
        if self._parameters.clustering == "dbscan":
            groups = dbscan(members, self._parameters)
        else:
            groups = components(members)
        found = []
        for group in groups:
            # DBSCAN alone would let two boxes of one frame be a cluster; "if an object is only
            # seen in one frame of a sliding window, our algorithm will characterize it as noise".
            frames = {m.ref.name for m in group}
            if len(frames) >= self._parameters.min_frames and any(m.label is None for m in group):
                found.append(aggregate(group, self._parameters.weigh_by))
        return found

    def images(self) -> set[str]:
        """Return the keys of the pictures that the window may still need."""
        return {m.ref.image for _, members in self.frames for m in members if m.ref.image}

    def to_state(self) -> list[tuple[FrameRef, Detection, int | None]]:
        """Return the window's detections with their labels, in order."""
        return [(m.ref, m.detection, m.label) for _, each in self.frames for m in each]

    def times(self) -> list[int]:
        """Return the times of the window's frames; one may hold no detection."""
        return [time_ms for time_ms, _ in self.frames]

    def restore(
        self, times: Iterable[int], members: Iterable[tuple[FrameRef, Detection, int | None]]
    ) -> None:
        """Rebuild the window that `times` and `to_state` described."""
        self.frames.clear()
        by_time: dict[int, list[Member]] = {}
        for ref, detection, label in members:
            by_time.setdefault(ref.time_ms, []).append(Member(ref, detection, label))
        for time_ms in times:
            fresh = by_time.get(time_ms, [])
            self._connect(fresh)
            self.frames.append((time_ms, fresh))


def _uncounted(members: list[Member]) -> list[Member]:
    for m in members:
        for other in m.neighbours:
            other.neighbours.remove(m)
    return [m for m in members if m.label is None]


def distances(rows: Sequence[Member], columns: Sequence[Member], parameters: Parameters) -> Floats:
    """Return how far apart detections are, (n, m): at most 1 where they are neighbours.

    max(metres / d_thresh, (1 - cosine) / (1 - min_similarity)), infinite between categories: both
    of the paper's thresholds hold literally, as they would not for concatenated features. What is
    unknown (no position, no picture) does not separate.
    """
    places = _positions(rows)[:, None] - _positions(columns)[None]
    metres = np.nan_to_num(np.sqrt(np.sum(places**2, axis=2)), nan=0.0)
    unlike = 1.0 - _cosines(rows, columns)
    scaled = np.maximum(metres / parameters.d_thresh_m, unlike / (1 - parameters.min_similarity))
    names = np.array([m.detection.category for m in columns])
    same = np.array([m.detection.category for m in rows])[:, None] == names[None]
    return np.where(same, scaled, np.inf)


def _positions(members: Sequence[Member]) -> Floats:
    unknown = (np.nan, np.nan, np.nan)
    return np.array([m.detection.position or unknown for m in members], dtype=np.float64)


def _cosines(rows: Sequence[Member], columns: Sequence[Member]) -> Floats:
    length = next((len(e) for m in columns if (e := m.detection.embedding) is not None), None)
    if length is None:
        return np.ones((len(rows), len(columns)))
    none = np.zeros(length, dtype=np.float32)

    def stack(members: Sequence[Member]) -> Embedding:
        embeddings = (m.detection.embedding for m in members)
        return np.stack([none if e is None else e for e in embeddings])

    left, right = stack(rows), stack(columns)
    known = np.any(left, axis=1, keepdims=True) & np.any(right, axis=1)
    return np.where(known, (left @ right.T).astype(np.float64), 1.0)


def components(members: Sequence[Member]) -> list[list[Member]]:
    """Return the groups that chains of neighbours connect, those of one member left out.

    With two samples every detection that has a neighbour is a core of DBSCAN, whose clusters then
    are these components; to keep the links with the window spares it the whole matrix.
    """
    seen: set[int] = set()
    groups = []
    for start in members:
        if id(start) in seen or not start.neighbours:
            continue
        seen.add(id(start))
        group, waiting = [], [start]
        while waiting:
            member = waiting.pop()
            group.append(member)
            for other in member.neighbours:
                if id(other) not in seen:
                    seen.add(id(other))
                    waiting.append(other)
        groups.append(group)
    return _ordered(groups, members)


def dbscan(members: Sequence[Member], parameters: Parameters) -> list[list[Member]]:
    """Return the same groups by scikit-learn's DBSCAN over the precomputed metric (appendix)."""
    if len(members) < MIN_SAMPLES:
        return []
    from sklearn.cluster import DBSCAN

    matrix = np.minimum(distances(members, members, parameters), 2.0)  # DBSCAN refuses infinity
    np.fill_diagonal(matrix, 0.0)
    labels = DBSCAN(eps=1.0, min_samples=MIN_SAMPLES, metric="precomputed").fit_predict(matrix)
    groups: dict[int, list[Member]] = {}
    for member, label in zip(members, labels, strict=True):
        if label >= 0:
            groups.setdefault(int(label), []).append(member)
    return _ordered(list(groups.values()), members)


def _ordered(groups: list[list[Member]], members: Sequence[Member]) -> list[list[Member]]:
    place = {id(m): i for i, m in enumerate(members)}
    inside = [sorted(group, key=lambda m: place[id(m)]) for group in groups]
    return sorted(inside, key=lambda group: place[id(group[0])])


def aggregate(group: Sequence[Member], weigh_by: Weighing = "probability") -> Cluster:
    """Return what a cluster's uncounted detections add up to: the paper's first aggregation.

    All means are weighted by probability; the appendix's weight "encodes the frequency of
    detections", which may also mean their count. A cluster that two labelled chains grew into
    keeps the older label for what is new.
    """
    fresh = [m for m in group if m.label is None]
    weights = np.array([m.detection.probability for m in fresh])
    weights = np.maximum(weights, 1e-6)  # a detector may say 0; a mean needs some weight
    if weigh_by == "count":
        weights = np.ones(len(fresh))
    positions = _positions(fresh)
    known = ~np.isnan(positions[:, 0])
    position = np.full(3, np.nan)
    if known.any():
        position = np.average(positions[known], axis=0, weights=weights[known])
    pictured = [i for i, m in enumerate(fresh) if m.detection.embedding is not None]
    embedding = None
    if pictured:
        stack = np.stack([_embedding(fresh[i]) for i in pictured])
        embedding = np.average(stack, axis=0, weights=weights[pictured]).astype(np.float32)
    return Cluster(
        category=fresh[0].detection.category,
        weight=float(weights.sum()),
        position=position,
        embedding=embedding,
        views=tuple(Interval.of(m.ref, m.detection) for m in fresh),
        members=tuple(fresh),
        label=min((m.label for m in group if m.label is not None), default=None),
    )


def _embedding(member: Member) -> Embedding:
    assert member.detection.embedding is not None
    return member.detection.embedding


# Default profile


@dataclass(frozen=True, slots=True)
class Thing:
    """One thing in one frame: a detection, and the categories its boxes were given."""

    detection: Detection
    votes: tuple[tuple[str, float], ...]
    rows: tuple[Detection, ...]

    def unplaced(self) -> Thing:
        """Return it without where it is and how large, where its range was wrong."""
        nowhere = replace(self.detection, position=None, covariance=None, extent_m=None)
        return replace(self, detection=nowhere)


_thing = maker(Thing)
"""Each detection makes one."""


def things(detections: Sequence[Detection], parameters: Parameters) -> list[Thing]:
    """Return the things of a frame: boxes that nearly coincide are one thing named twice.

    The strongest box stands for it, the others add their votes (a chair that is also called a
    bench). Default profile: it replaces the window, as its tier 2 needs no second frame.
    """
    if len(detections) < 2:
        return [_thing(d, ((d.category, d.probability),), (d,)) for d in detections]
    free = dict.fromkeys(range(len(detections)))
    found = []
    for i in sorted(free, key=lambda i: (-detections[i].probability, i)):
        if i not in free:
            continue
        del free[i]
        box = detections[i].box
        same = [j for j in free if iou(box, detections[j].box) >= parameters.double_box_iou]
        for j in same:
            del free[j]
        rows = [detections[i], *(detections[j] for j in same)]
        votes: dict[str, float] = {}
        for each in rows:
            votes[each.category] = max(votes.get(each.category, 0.0), each.probability)
        found.append(_thing(detections[i], tuple(sorted(votes.items())), tuple(rows)))
    return found
