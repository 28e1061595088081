"""Default profile: which things were seen in one frame, as intervals with their best frame."""

from __future__ import annotations

import math
from collections.abc import Set
from dataclasses import fields
from itertools import combinations
from operator import itemgetter

from d3a.frozen import maker
from d3a.ledger import Ledger
from d3a.model import Detection, Json
from d3a.parameters import Parameters
from d3a.sightings import FrameRef
from d3a.store.base import LEAST_SIGMA_M, Apart, Encounter, StayKey

Pair = tuple[StayKey, StayKey]
_encounter = maker(Encounter)
"""Each pair of things in a frame makes one."""
_FIELDS = tuple(f.name for f in fields(Encounter))
MOST_SIGMA_M = 0.5
"""What is less sure is no measurement: without depth all that a frame shows is put at one range."""


class Encounters:
    """The encounters that may still grow; those that changed are written with the rest."""

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters
        self._open: dict[Pair, Encounter] = {}
        self._dirty: set[Pair] = set()

    def add(self, ref: FrameRef, seen: list[tuple[StayKey, Detection]], ledger: Ledger) -> None:
        """Take in what one frame shows: stays, no two of them the same, with their detections."""
        gap_ms = self._parameters.interval_gap_s * 1000
        longest_ms = self._parameters.max_interval_s * 1000
        for (a, one), (b, other) in combinations(sorted(seen, key=itemgetter(0)), 2):
            if a[0] == b[0]:
                continue
            pair = (a, b)
            old = self._open.get(pair)
            if old is not None and ref.time_ms - old.end_ms <= gap_ms:
                if ref.time_ms - old.start_ms <= longest_ms:
                    self._open[pair] = _grown(old, ref, one, other)
                    self._dirty.add(pair)
                    continue
                start_ms = old.end_ms + 1
            else:
                start_ms = ref.time_ms
            if old is not None and pair in self._dirty:
                ledger.put_encounter(old)
            self._open[pair] = _encounter(
                a[0], b[0], a[1], b[1], start_ms, ref.time_ms, ref.name, one.box, other.box,
                one.probability * other.probability, ref.image, 1, ref.recording, ref.viewer,
                apart(one, other),
            )  # fmt: skip
            self._dirty.add(pair)

    def write(self, ledger: Ledger) -> None:
        """Put what changed into the ledger."""
        self._write(self._dirty, ledger)

    def write_some(self, ids: Set[str], ledger: Ledger) -> None:
        """Put what changed of some objects into the ledger."""
        self._write({p for p in self._dirty if p[0][0] in ids or p[1][0] in ids}, ledger)

    def _write(self, pairs: set[Pair], ledger: Ledger) -> None:
        for pair in pairs:
            ledger.put_encounter(self._open[pair])
        self._dirty = self._dirty - pairs

    def prune(self) -> None:
        """Forget what a pause has closed, once it is written."""
        newest = max((each.end_ms for each in self._open.values()), default=0)
        gap_ms = self._parameters.interval_gap_s * 1000
        kept = {p: e for p, e in self._open.items() if newest - e.end_ms <= gap_ms}
        self._open = kept

    def forget(self, ids: Set[str]) -> None:
        """Forget the encounters of objects that are no more, or not in memory."""
        kept = {p: e for p, e in self._open.items() if p[0][0] not in ids and p[1][0] not in ids}
        self._open = kept
        self._dirty &= kept.keys()

    def rename(self, was: StayKey, becomes: StayKey) -> None:
        """Go on under a stay's new name; all of its object is written, under that name by now."""
        for pair in sorted(pair for pair in self._open if was in pair):
            self._dirty.discard(pair)
            other = self._open.pop(pair).renamed({was: becomes})
            if other is None:
                continue
            key = (other.object_a, other.place_a), (other.object_b, other.place_b)
            known = self._open.get(key)
            if known is None or known.end_ms <= other.end_ms:  # else that is what goes on
                self._open[key] = other

    def to_state(self) -> Json:
        """Return the open encounters as JSON."""
        kept = (self._open[pair] for pair in sorted(self._open))
        return {"open": [{name: getattr(each, name) for name in _FIELDS} for each in kept]}

    def restore(self, record: Json) -> None:
        """Go on where `to_state` was called."""
        for each in record["open"]:
            (ax, ay, aw, ah), (bx, by, bw, bh) = each.pop("box_a"), each.pop("box_b")
            viewer, far = each.pop("viewer"), each.pop("apart")
            encounter = Encounter(
                **each,
                box_a=(ax, ay, aw, ah),
                box_b=(bx, by, bw, bh),
                viewer=None if viewer is None else tuple(viewer),
                apart=None if far is None else tuple(far),
            )
            a = (encounter.object_a, encounter.place_a)
            self._open[a, (encounter.object_b, encounter.place_b)] = encounter


def _grown(old: Encounter, ref: FrameRef, one: Detection, other: Detection) -> Encounter:
    stays = old.object_a, old.object_b, old.place_a, old.place_b, old.start_ms, ref.time_ms
    probability = one.probability * other.probability
    both = _mean(old.apart, apart(one, other))
    if probability <= old.probability:
        return _encounter(
            *stays, old.frame, old.box_a, old.box_b, old.probability, old.image, old.seen + 1,
            old.recording, old.viewer, both,
        )  # fmt: skip
    return _encounter(
        *stays, ref.name, one.box, other.box, probability, ref.image, old.seen + 1,
        ref.recording, ref.viewer, both,
    )  # fmt: skip


def apart(one: Detection, other: Detection) -> Apart | None:
    """Return how far a frame's detection is from another, None where it does not tell.

    Covariances are those of what was measured from the camera: the error of its place, which both
    share, is not in them. Equal positions are one estimate for all that the frame shows.
    """
    if one.position is None or other.position is None or one.position == other.position:
        return None
    if one.covariance is None or other.covariance is None:
        return None
    (x, y, z), (at_x, at_y, at_z) = one.position, other.position
    a, b = one.covariance, other.covariance
    sigma = math.sqrt((a[0] + a[4] + a[8] + b[0] + b[4] + b[8]) / 3)
    return None if sigma > MOST_SIGMA_M else (at_x - x, at_y - y, at_z - z, sigma)


def _mean(one: Apart | None, other: Apart | None) -> Apart | None:
    """Return the mean of two measurements, weighted by how sure they are."""
    if one is None or other is None:
        return one or other
    sure = max(one[3], LEAST_SIGMA_M) ** -2
    share = sure / (sure + max(other[3], LEAST_SIGMA_M) ** -2)
    rest = 1.0 - share
    return (
        share * one[0] + rest * other[0],
        share * one[1] + rest * other[1],
        share * one[2] + rest * other[2],
        math.sqrt(share / sure),
    )
