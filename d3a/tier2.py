"""Tier 2, paper profile: filter clusters across windows against the short-term memory.

Paper: "Tier 2 - Filtering across multiple sliding windows", its three cases to the letter. The
default profile's operators for the same step are in `likelihood.py` and `tracker.py`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from d3a.parameters import Parameters
from d3a.sightings import joined
from d3a.stm import Entry, ShortTermMemory
from d3a.tier1 import Cluster

Floats = NDArray[np.float64]
Embedding = NDArray[np.float32]


def apart_m(a: Floats, b: Floats) -> float:
    """Return the distance of two places; 0 where one is unknown, as that cannot separate."""
    metres = float(np.linalg.norm(a - b))
    return 0.0 if math.isnan(metres) else metres


def weighted(a: Floats, weight_a: float, b: Floats, weight_b: float) -> NDArray[np.float64]:
    """Return the weighted average of two positions; an unknown one has no say."""
    if np.isnan(a).any():
        return b
    if np.isnan(b).any():
        return a
    return (a * weight_a + b * weight_b) / (weight_a + weight_b)


def weighted_look(
    a: Embedding | None, weight_a: float, b: Embedding | None, weight_b: float
) -> Embedding | None:
    """Return the weighted average of two embeddings, None where neither is known."""
    if a is None or b is None:
        return b if a is None else a
    return ((a * weight_a + b * weight_b) / (weight_a + weight_b)).astype(np.float32)


class Filter:
    """Puts clusters into the STM; gives out instances and entries."""

    def __init__(self, stm: ShortTermMemory, parameters: Parameters) -> None:
        self.stm = stm
        self._parameters = parameters
        self.next_serial = 1
        self.next_instance = 1
        self.instance_of: dict[int, int] = {}

    def place(self, cluster: Cluster) -> tuple[Entry, bool]:
        """Return the entry that the cluster belongs to, and whether it is a new one.

        A new one is not in the STM yet: the caller makes room first (eviction is tier 3's).
        """
        if cluster.label is not None and (known := self.stm.get(cluster.label)) is not None:
            return known, False  # tier 1 has seen that it is this one: its chain goes on
        parameters = self._parameters
        # The paper gates by category in tier 1; without the gate here, ids mix categories.
        category = cluster.category if parameters.gate_category else None
        near = self.stm.near_in_look(category, cluster.embedding, parameters.min_similarity)
        if not near:
            return self._entry(cluster, self._instance_of_label(cluster), None), True  # case 3
        alike, cosine = max(near, key=lambda each: (each[1], -each[0].serial))
        # "the closest n_id of nearIDs": in space; to take the most alike costs places and ids.
        entries = [entry for entry, _ in near] if parameters.nearest_by == "space" else [alike]
        closest, metres = min(
            ((entry, apart_m(self.stm.position(entry), cluster.position)) for entry in entries),
            key=lambda each: (each[1], each[0].serial),
        )
        if metres <= parameters.d_thresh_m:
            return closest, False  # case 1
        if not parameters.keep_moved_id:
            return self._entry(cluster, self._instance_of_label(cluster), None), True
        # Case 2, "the same object has moved": it inherits the id of the entry it is most like.
        # That is right once in ten times; the likeness is kept, so that a reader can judge.
        return self._entry(cluster, alike.instance, (alike.serial, cosine)), True

    def _instance_of_label(self, cluster: Cluster) -> int:
        """Return the instance a chain had before its entry was evicted, else a new one."""
        known = None if cluster.label is None else self.instance_of.get(cluster.label)
        if known is not None:
            return known
        self.next_instance += 1
        return self.next_instance - 1

    def _entry(
        self, cluster: Cluster, instance: int, moved_from: tuple[int, float] | None
    ) -> Entry:
        times = [view.start_ms for view in cluster.views]
        self.next_serial += 1
        return Entry(
            serial=self.next_serial - 1,
            instance=instance,
            category=cluster.category,
            weight=cluster.weight,
            seen=len(cluster.views),
            first_ms=min(times),
            last_ms=max(times),
            intervals=joined(cluster.views, self._parameters),
            moved_from=moved_from,
        )

    def aggregate(self, entry: Entry, cluster: Cluster) -> None:
        """Merge a cluster into its entry: the second aggregation, weighted averages."""
        position = weighted(
            self.stm.position(entry), entry.weight, cluster.position, cluster.weight
        )
        look = weighted_look(
            self.stm.embedding(entry), entry.weight, cluster.embedding, cluster.weight
        )
        self.stm.write(entry, position, look)
        entry.weight += cluster.weight
        entry.seen += len(cluster.views)
        entry.first_ms = min(entry.first_ms, *(view.start_ms for view in cluster.views))
        entry.last_ms = max(entry.last_ms, *(view.start_ms for view in cluster.views))
        entry.intervals = joined([*entry.intervals, *cluster.views], self._parameters)
