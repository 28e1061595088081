"""Exp 4: the clusters of one object with and without space (paper, "Non-spatial" baseline).

The paper shows crops of its pink cup; a simulated world has no pictures, so the clusters are
shown on the map: where each detection was reported, which id and stay it went to.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from assistant.evaluation.methods import D3A_D, NON_SPATIAL_METHOD, OURS, Method, filled
from assistant.evaluation.worlds import Steps, World, recorded
from d3a.truth import Truth

METHODS = (NON_SPATIAL_METHOD, D3A_D, OURS)


@dataclass(frozen=True, slots=True)
class Clusters:
    """What one method made of the detections that Non-spatial put under the object's id.

    rows (n,): detections; position (n, 3): as reported; owner (n,): the true object, -1 none;
    shows (n,): its name, "" none; cluster (n,): "id/place", "" where left out. objects: true
    objects in the object's own id.
    """

    method: Method
    target: str
    position: NDArray[np.float64]
    owner: NDArray[np.intp]
    shows: tuple[str, ...]
    cluster: tuple[str, ...]
    objects: int
    ids: int
    stays: int


def run(world: World, work: Path, steps: Steps) -> list[Clusters]:
    """Return the clusters around one moved object of the world, by each method."""
    source = recorded(world, "nominal", work)
    target = chosen_object(source.truth)
    found, rows = [], np.zeros(0, dtype=np.intp)
    for method in METHODS:
        steps.begin(f"{world.title}: clusters of {source.truth.objects[target].name}")
        with filled(method, source, work / "stores") as run_:
            kept = run_.assignments
            if not len(rows):
                rows = _rows_beside(source.truth, kept, target)
            ids = {stay[0] for row in rows if (stay := kept[row]) is not None}
            stays = {stay for row in rows if (stay := kept[row]) is not None}
            own = Counter(
                stay[0]
                for row in source.truth.objects[target].detections
                if (stay := kept[row]) is not None
            )
            best = own.most_common(1)[0][0] if own else None
            mixed = {
                int(source.truth.owner[row])
                for row, stay in enumerate(kept)
                if stay is not None and stay[0] == best and source.truth.owner[row] >= 0
            }
            found.append(
                Clusters(
                    method=method,
                    target=source.truth.objects[target].name,
                    position=source.truth.position[rows],
                    owner=source.truth.owner[rows],
                    shows=tuple(_name(source.truth, row) for row in rows.tolist()),
                    cluster=tuple(_label(kept[row]) for row in rows),
                    objects=len(mixed),
                    ids=len(ids),
                    stays=len(stays),
                )
            )
    return found


def chosen_object(truth: Truth) -> int:
    """Return the object that tells most: it moved, was seen at two places, and has look-alikes."""

    def worth(k: int) -> tuple[bool, int, int]:
        one = truth.objects[k]
        places = Counter(truth.place_of(row) for row in one.detections)
        seen = sum(count >= 3 for place, count in places.items() if place is not None)
        alike = sum(o.category == one.category and o.colour == one.colour for o in truth.objects)
        return (seen >= 2 and alike >= 2, seen, len(one.detections))

    return max(range(len(truth.objects)), key=lambda k: (worth(k), -k))


def _rows_beside(
    truth: Truth, kept: tuple[tuple[str, int] | None, ...], target: int
) -> NDArray[np.intp]:
    """Return the detections under the id that holds most of the target's, and the target's own."""
    own = set(truth.objects[target].detections)
    counts = Counter(stay[0] for row in own if (stay := kept[row]) is not None)
    best = counts.most_common(1)[0][0] if counts else None
    beside = {row for row, stay in enumerate(kept) if stay is not None and stay[0] == best}
    return np.array(sorted(own | beside), dtype=np.intp)


def _name(truth: Truth, row: int) -> str:
    owner = int(truth.owner[row])
    return truth.objects[owner].name if owner >= 0 else ""


def _label(stay: tuple[str, int] | None) -> str:
    return f"{stay[0]}/{stay[1]}" if stay is not None else ""
