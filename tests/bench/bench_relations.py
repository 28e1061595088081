"""Measure every relation on simulated worlds: precision and recall against their solids.

    python -m tests.bench.bench_relations [--hours 3] [--seeds 0 1 2] [--conditions nominal]

A world is written and ingested, and every pair of its objects is related by the planner's own
joins. The worlds are arranged (tests/worlds/arranged.py): a simulated home has nothing beneath its
tables and no box to put a thing into; `--plain` leaves them as they are. Ten of them hold more than
a hundred true pairs of every relation but "in" (90), and take some two minutes of a processor.
near and on are true as truth.jsonl has them; in, together, same place, between and the sides
follow from the solids and the robot's true poses, which are those of the noiseless recording of the
same seed. A thing is under another that truth.jsonl has it under, or that is on it or clear of its
top within its outline; above is the inverse. What is under a roof alone has a line of its own.
All that a question tells is judged: things that were seen once, which are told last, and mistakes
of the detector are among them. "of known" leaves out what the store has not both confirmed, and
`--confirmed` relates nothing else.
What is judged is a pair of stays that were both detected in one frame (for sides and between, what
one keyframe shows), so that what nobody could see is no miss. What is within `EVEN` of the border
(of one side and the other, of the limit of same place, of the ends of between, of the outline that
a thing floats over) is left out: nobody could say, and least that a cup on a desk is over the
outline of one beneath it. Goals: 0.9 noiseless, 0.75 nominal.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np

from assistant.lexicon import VocabularyLexicon
from d3a.answering.facts import Facts
from d3a.answering.joins import GROUNDED, HOLDS, SYMMETRIC, Asked
from d3a.answering.linked import Link, pairs_of
from d3a.answering.match import Candidate
from d3a.answering.moments import Found
from d3a.ingest import ingest
from d3a.model import Box
from d3a.parameters import DEFAULT, Parameters
from d3a.readers.opening import open_source
from d3a.relations import SIDE_M, between
from d3a.simulate import simulate
from d3a.store import open_store
from d3a.store.base import Encounter, StayKey, Store
from d3a.truth import Truth, place_at, read_truth
from grammar.forms import RelationKind
from tests.bench.bench_scale import say
from tests.worlds.arranged import HOLLOW, arranged

GOALS = {"noiseless": 0.9, "nominal": 0.75}
GIVEN: tuple[RelationKind, ...] = ("near", "on", "under")
DERIVED: tuple[RelationKind, ...] = ("above", "in", "together", "same_place")
SIDES: tuple[RelationKind, ...] = ("left_of", "right_of", "in_front_of", "behind")
ROOFED = "  by a roof"
EVEN_M = 0.1
TOUCHING_M = 0.02
"""Rounding of the truth: a thing stands on a top that is this far off."""
Stay = tuple[int, int]
"""A true object and which of its places."""


def box_key(frame: str, box: Box) -> tuple[str, tuple[float, ...]]:
    """Return what names a detection in a keyframe: its frame and its box to a tenth of a pixel."""
    return frame, tuple(round(float(v), 1) for v in box)


@dataclass(frozen=True, slots=True)
class Solid:
    """Centre and size of a true object at one of its places, metres."""

    centre: tuple[float, float, float]
    size: tuple[float, float, float]

    @property
    def top(self) -> float:
        """Return the height of its top."""
        return self.centre[2] + self.size[2] / 2

    @property
    def bottom(self) -> float:
        """Return the height of its underside."""
        return self.centre[2] - self.size[2] / 2


class World:
    """What is true of one recording, and which true stay each stored box shows."""

    def __init__(self, folder: Path, poses: dict[str, list[float]]) -> None:
        self.truth: Truth = read_truth(folder)
        self.poses = poses
        records = [json.loads(line) for line in (folder / "truth.jsonl").open(encoding="utf-8")]
        self.sizes = [tuple(record["size"]) for record in records]
        self.numbers = {one.name: k for k, one in enumerate(self.truth.objects)}
        self.rows = {
            box_key(frame, tuple(box)): row
            for row, (frame, box) in enumerate(
                zip(self.truth.frame, self.truth.box.tolist(), strict=True)
            )
        }
        self.together = self._detected_together()
        self.held = self._held_inside()

    def _detected_together(self) -> set[tuple[Stay, Stay]]:
        """Return every ordered pair of true stays that one frame shows."""
        shown: dict[str, set[Stay]] = defaultdict(set)
        for row, frame in enumerate(self.truth.frame):
            place = self.truth.place_of(row)
            if place is not None:
                shown[frame].add((int(self.truth.owner[row]), place))
        return {(a, b) for stays in shown.values() for a in stays for b in stays if a[0] != b[0]}

    def _held_inside(self) -> set[Stay]:
        """Return the true stays that are in a hollow thing."""
        stays = [(k, n) for k, one in enumerate(self.truth.objects) for n in range(len(one.places))]
        hollow = [stay for stay in stays if self.truth.objects[stay[0]].category in HOLLOW]
        return {a for a in stays for b in hollow if a[0] != b[0] and self.derived("in", a, b)}

    def stay_of(self, frame: str, box: Box) -> Stay | None:
        """Return the true stay that a stored box shows, None for a mistake of the detector."""
        row = self.rows.get(box_key(frame, box))
        place = self.truth.place_of(row) if row is not None else None
        return None if row is None or place is None else (int(self.truth.owner[row]), place)

    def solid(self, stay: Stay) -> Solid:
        """Return the solid of a true stay."""
        centre = self.truth.objects[stay[0]].places[stay[1]].position
        width, depth, height = self.sizes[stay[0]]
        return Solid(centre, (width, depth, height))

    def given(self, kind: str, a: Stay, b: Stay) -> bool | None:
        """Return whether truth.jsonl has the relation while b was at its place.

        None for "on" of what is in a hollow thing: it lies on a board of the shelf, or in a box
        that stands on the table.
        """
        if kind == "on" and a in self.held and self._over(a, b):
            return None
        places = self.truth.objects[b[0]].places
        name = self.truth.objects[b[0]].name
        rows = self.truth.objects[a[0]].places[a[1]].relations
        return any(
            row.kind == kind and row.object == name and place_at(places, row.start_ms) == b[1]
            for row in rows
        )

    def derived(self, kind: str, a: Stay, b: Stay) -> bool | None:
        """Return whether the solids say so, None where nobody could say."""
        one, other = self.solid(a), self.solid(b)
        apart = np.linalg.norm(np.subtract(one.centre, other.centre))
        if kind == "together":
            return (a, b) in self.together or bool(apart <= DEFAULT.together_m)
        if kind == "same_place":
            even = abs(apart - DEFAULT.d_thresh_m) < EVEN_M
            return None if even else bool(apart <= DEFAULT.d_thresh_m)
        if kind == "in":
            hollow = self.truth.objects[b[0]].category in HOLLOW
            inside = other.bottom - TOUCHING_M <= one.bottom and one.centre[2] < other.top
            return hollow and self._over(a, b) and inside
        if one.bottom > other.top + TOUCHING_M and self._is_by_the_border(a, b):
            return None
        return self._over(a, b) and one.bottom >= other.top - TOUCHING_M

    def beneath(self, a: Stay, b: Stay) -> bool | None:
        """Return whether a is under b: beneath its legs, or with b on or over it."""
        parts = (self.given("under", a, b), self.given("on", b, a), self.derived("above", b, a))
        return True if any(parts) else None if None in parts else False

    def true(self, kind: str, a: Stay, b: Stay) -> bool | None:
        """Return whether a relation of two stays holds, None where nobody could say."""
        if kind == "under":
            return self.beneath(a, b)
        if kind == "above":
            return self.beneath(b, a)
        return self.given(kind, a, b) if kind in GIVEN else self.derived(kind, a, b)

    def roofed(self, a: Stay, b: Stay) -> bool | None:
        """Return whether a is beneath the legs of b; what else is under it is none of these."""
        return self.given("under", a, b) or None

    def _is_by_the_border(self, a: Stay, b: Stay) -> bool:
        """Return whether the middle of a is close to the border of b's outline, seen from above."""
        one, other = self.solid(a), self.solid(b)
        beyond = np.abs(np.subtract(one.centre, other.centre))[:2] - np.array(other.size[:2]) / 2
        outside = float(np.linalg.norm(np.maximum(beyond, 0.0)))
        return (outside or float(-beyond.max())) < EVEN_M

    def _over(self, a: Stay, b: Stay) -> bool:
        """Return whether the middle of a is within the outline of b, seen from above."""
        one, other = self.solid(a), self.solid(b)
        apart = np.abs(np.subtract(one.centre, other.centre))[:2]
        return bool((apart <= np.array(other.size[:2]) / 2).all())

    def between(self, a: Stay, b: Stay, c: Stay) -> bool | None:
        """Return whether a lies between b and c, None where nobody could say.

        From it, the two others are on opposite sides: it is in the ball that both are on.
        """
        at, start, end = (np.array(self.solid(stay).centre) for stay in (a, b, c))
        slack = np.linalg.norm(end - start) / 2 - np.linalg.norm(at - (start + end) / 2)
        return None if abs(slack) < EVEN_M else bool(slack > 0)

    def side(self, kind: str, a: Stay, b: Stay, frame: str) -> bool | None:
        """Return whether a is on that side of b in a frame, None where nobody could say."""
        x, y, _, qx, qy, qz, qw = self.poses[frame]
        right = np.array([1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy + qz * qw)])
        ahead = np.array([2 * (qx * qz + qy * qw), 2 * (qy * qz - qx * qw)])
        one, other = (np.array(self.solid(stay).centre[:2]) for stay in (a, b))
        beyond = float(np.linalg.norm(one - other)) - SIDE_M
        if abs(beyond) < EVEN_M:
            return None
        if beyond > 0:
            return False
        depth = [float(ahead @ (p - (x, y))) for p in (one, other)]
        bearing = [
            float(right @ (p - (x, y))) / d for p, d in zip((one, other), depth, strict=True)
        ]
        if kind in ("left_of", "right_of"):
            gap = (bearing[1] - bearing[0]) * min(depth)  # metres to the left, where the nearer is
            return None if abs(gap) < EVEN_M else (gap > 0) is (kind == "left_of")
        shown = [float(np.abs(right) @ self.sizes[stay[0]][:2]) for stay in (a, b)]  # widths
        half = [width / 2 / d for width, d in zip(shown, depth, strict=True)]
        gap = abs(bearing[0] - bearing[1]) - sum(half)
        nearer = depth[1] - depth[0]
        if self._over(a, b) or self._over(b, a):  # on it, under it or in it, before it to nobody
            return None
        if abs(nearer) < EVEN_M or abs(gap) < EVEN_M / max(depth):
            return None
        return gap < 0 and (nearer > 0) is (kind == "in_front_of")


@dataclass
class Tally:
    """Right, wrong and missed of one relation.

    unknown: those of the missed that the store has not both confirmed.
    """

    right: int = 0
    wrong: int = 0
    missed: int = 0
    unknown: int = 0

    def add(self, other: Tally) -> None:
        """Count another's too."""
        self.right += other.right
        self.wrong += other.wrong
        self.missed += other.missed
        self.unknown += other.unknown

    @property
    def precision(self) -> float:
        """Return the share of what is said that is true."""
        return self.right / (self.right + self.wrong) if self.right + self.wrong else float("nan")

    @property
    def recall(self) -> float:
        """Return the share of what is true that is said."""
        return self.right / (self.right + self.missed) if self.right + self.missed else float("nan")

    @property
    def recall_of_known(self) -> float:
        """Return the share of what is true, and of confirmed things, that is said."""
        known = self.right + self.missed - self.unknown
        return self.right / known if known else float("nan")


def stays_of(world: World, link: Link) -> tuple[Stay | None, Stay | None, str]:
    """Return the true stays that a link's boxes show, and its frame."""
    if link.encounter is not None:
        frame = link.encounter.frame
        a, b = link.boxes()
        return world.stay_of(frame, a), world.stay_of(frame, b), frame
    assert link.sightings is not None
    one, other = link.sightings
    return world.stay_of(one.frame, one.box), world.stay_of(other.frame, other.box), one.frame


def everything(store: Store, *, confirmed: bool) -> Found:
    """Return all objects with all of their sightings, as a question for anything finds them."""
    facts = Facts(store)
    records = [r for r in store.objects(embeddings=False) if not (confirmed and r.tentative)]
    found = Found({record.object_id: Candidate(record, 1.0) for record in records})
    found.sightings = facts.sightings(found.ids, None, None)
    found.stays = facts.stays(found.ids)
    return found


def judged(
    world: World, store: Store, parameters: Parameters, *, confirmed: bool
) -> Iterator[tuple[str, Tally]]:
    """Yield each relation with its tally, and of "under" what is so by a roof alone."""
    found = everything(store, confirmed=confirmed)
    facts, lexicon = Facts(store), VocabularyLexicon()
    carriers = facts.carriers(lexicon)
    usual = {kind: facts.usual_grounds(kind, lexicon) for kind in GROUNDED}
    encounters = store.encounters()
    known = {name for name, one in found.candidates.items() if not one.record.tentative}
    sure = {
        world.stay_of(seen.frame, seen.box) for seen in found.sightings if seen.object_id in known
    }
    for kind in (*GIVEN, *DERIVED, *SIDES):
        once = kind in SYMMETRIC
        asked = Asked(kind, found, found, parameters, once=once, usual=usual, carriers=carriers)
        related = asked.judged(asked.links(encounters))
        pairs = [
            (link, bool(p >= HOLDS))
            for link, p in zip(related.links, related.probability, strict=True)
        ]
        if kind in SIDES:
            yield kind, _sides(world, kind, pairs)
        else:
            yield kind, _stays(world, kind, pairs, sure)
        if kind == "under":
            yield ROOFED, _stays(world, ROOFED, pairs, sure)
    yield "between", _between(world, found, encounters, parameters)


def _between(
    world: World, found: Found, encounters: Sequence[Encounter], parameters: Parameters
) -> Tally:
    """Judge every three that one keyframe shows, the two others in either order once."""
    by_frame: dict[tuple[StayKey, str], list[Link]] = defaultdict(list)
    for link in Asked("between", found, found, parameters).links(encounters):
        if link.encounter is not None:
            by_frame[link.figure, link.encounter.frame].append(link)
    threes = [
        (one, two)
        for links in by_frame.values()
        for one, two in combinations(links, 2)
        if one.ground[0] != two.ground[0]
    ]
    left, right = (pairs_of(list(links), found, found) for links in zip(*threes, strict=True))
    tally = Tally()
    shared = np.ones(len(threes), dtype=np.bool_)
    for (one, two), p in zip(threes, between(left, right, shared), strict=True):
        (a, b, _), (_, c, _) = stays_of(world, one), stays_of(world, two)
        if a is None or b is None or c is None or len({a[0], b[0], c[0]}) < 3:
            continue
        true = world.between(a, b, c)
        if true is not None:
            _count(tally, said=bool(p >= HOLDS), true=true)
    return tally


def _sides(world: World, kind: RelationKind, pairs: list[tuple[Link, bool]]) -> Tally:
    tally = Tally()
    for link, said in pairs:
        a, b, frame = stays_of(world, link)
        if link.encounter is None or a is None or b is None or a[0] == b[0]:
            continue
        true = world.side(kind, a, b, frame)
        if true is not None:
            _count(tally, said=said, true=true)
    return tally


def _stays(
    world: World,
    kind: str,
    pairs: list[tuple[Link, bool]],
    confirmed: set[Stay | None],
) -> Tally:
    said: set[tuple[Stay, Stay]] = set()
    mistaken: set[tuple[StayKey, StayKey]] = set()
    for link, holds in pairs:
        a, b, _ = stays_of(world, link)
        if not holds:
            continue
        if a is None or b is None:
            mistaken.add((link.figure, link.ground))
        elif a[0] != b[0]:
            said.add((a, b))
    if kind in SYMMETRIC:
        said |= {(b, a) for a, b in said}
    tally = Tally(wrong=len(mistaken) * (2 if kind in SYMMETRIC else 1))
    if kind == ROOFED:  # of these the recall counts alone
        tally.wrong = 0
    for pair in sorted(said | world.together):
        true = world.roofed(*pair) if kind == ROOFED else world.true(kind, *pair)
        if true is not None:
            _count(tally, said=pair in said, true=true)
            tally.unknown += true and pair not in said and not confirmed.issuperset(pair)
    return tally


def _count(tally: Tally, *, said: bool, true: bool) -> None:
    tally.right += said and true
    tally.wrong += said and not true
    tally.missed += true and not said


def main() -> None:
    """Print a table a condition."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--hours", type=float, default=3.0)
    options.add_argument("--seeds", type=int, nargs="+", default=list(range(10)))
    options.add_argument("--conditions", nargs="+", default=list(GOALS))
    options.add_argument("--plain", action="store_true", help="the seeds' worlds as they are")
    options.add_argument("--confirmed", action="store_true", help="without what was seen once")
    given = options.parse_args()
    total: dict[tuple[str, str], Tally] = defaultdict(Tally)
    for seed in given.seeds:
        with tempfile.TemporaryDirectory() as folder:
            for condition, kind, tally in measured(
                Path(folder), given.hours, seed, given.conditions, given.plain, given.confirmed
            ):
                total[condition, kind].add(tally)
    for condition in given.conditions:
        goal = GOALS.get(condition)
        say(f"{condition}, {given.hours:g} h, seeds {given.seeds}, goal {goal}")
        say("  relation       precision  recall  of known   true   said")
        for (of, kind), tally in total.items():
            if of == condition:
                true, told = tally.right + tally.missed, tally.right + tally.wrong
                line = f"  {kind:13s} {tally.precision:10.2f} {tally.recall:7.2f}"
                say(f"{line} {tally.recall_of_known:9.2f} {true:6d} {told:6d}")


def measured(
    folder: Path, hours: float, seed: int, conditions: list[str], plain: bool, confirmed: bool
) -> Iterator[tuple[str, str, Tally]]:
    """Yield the tallies of a seed's world under each condition."""
    still = folder / "true"
    change = None if plain else arranged
    simulate(still, hours=hours, seed=seed, condition="noiseless", depth=False, arrange=change)
    frames = [json.loads(line) for line in (still / "frames.jsonl").open(encoding="utf-8")]
    poses = {frame["frame"]: frame["pose"] for frame in frames}
    for condition in conditions:
        recording = folder / condition
        simulate(recording, hours=hours, seed=seed, condition=condition, arrange=change)
        with closing(open_store(str(folder / f"{condition}.db"))) as store:
            ingest(open_source(recording), store, DEFAULT)
            world = World(recording, poses)
            for kind, tally in judged(world, store, DEFAULT, confirmed=confirmed):
                yield condition, kind, tally


if __name__ == "__main__":
    main()
