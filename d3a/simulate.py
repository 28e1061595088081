"""Write seeded recordings with the paper's statistics (Evaluation, Table 2), with their truth.

A room of boxes is driven through by a robot whose pose drifts; things hide each other, are moved
by people, look alike and are mistaken. The recording is a plain folder, read like any other.
"""

from __future__ import annotations

import json
import shutil
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from d3a.model import BadInput, Json
from d3a.simulation import truth, writer
from d3a.simulation.conditions import CONDITIONS, NOMINAL, Condition, codes, named
from d3a.simulation.patrol import Track, frames_in, idle_share, patrol, reported
from d3a.simulation.sensor import Reports, expose, loose_solids, report
from d3a.simulation.world import World, build

__all__ = [
    "CONDITIONS",
    "NOMINAL",
    "Condition",
    "Simulated",
    "codes",
    "is_whole",
    "named",
    "simulate",
]


@dataclass(frozen=True, slots=True)
class Simulated:
    """What was written: counts to compare with the paper's Table 2."""

    folder: Path
    condition: str
    seed: int
    hours: float
    objects: int
    movers: int
    moves: tuple[int, ...]
    frames: int
    detections: int
    false_positives: int
    objects_seen: int

    def to_json(self) -> Json:
        """Return the counts as a JSON record."""
        mean = float(np.mean(self.moves)) if self.moves else 0.0
        return {
            "folder": str(self.folder),
            "condition": self.condition,
            "seed": self.seed,
            "hours": self.hours,
            "objects": self.objects,
            "static": self.objects - self.movers,
            "movers": self.movers,
            "moves_mean": round(mean, 2),
            "moves_max": max(self.moves, default=0),
            "frames": self.frames,
            "detections": self.detections,
            "false_positives": self.false_positives,
            "objects_seen": self.objects_seen,
        }


class _Streams(dict[str, np.random.Generator]):
    """A generator of its own for every part, so that a condition changes only what it names."""

    def __init__(self, seed: int) -> None:
        super().__init__()
        self._seed = seed

    def __missing__(self, part: str) -> np.random.Generator:
        self[part] = np.random.default_rng([self._seed, zlib.crc32(part.encode())])
        return self[part]


def detections_in(hours: float) -> int:
    """Return how many detections the paper's robot makes: 2,558 in 3 h, 13,565 in 22 h."""
    active = frames_in(hours) * (1 - idle_share(hours))
    return max(1, round(active * 2558 / 991))


def simulate(
    out: Path,
    *,
    hours: float = 3,
    seed: int = 0,
    condition: str | Condition = "nominal",
    depth: bool = True,
    arrange: Callable[[World], World] | None = None,
) -> Simulated:
    """Write the world of `seed` under `condition` to the folder `out`, with truth.jsonl.

    The same seed and hours give the same things, moves and rounds under every condition but
    `even-patrol`; the same arguments give the same bytes. depth: write a depth image per frame.
    arrange: changes the seed's world before the robot drives, for worlds of one's own.
    Raises BadInput for an unknown condition, for hours outside of 0.05 to 200, and where `out`
    holds anything but a simulated recording.
    """
    chosen = named(condition)
    if not 0.05 <= hours <= 200:
        raise BadInput(f"{hours} hours; 0.05 to 200 will do")
    _prepare(out)
    streams = _Streams(seed)
    world = build(hours, streams["world"])
    world = world if arrange is None else arrange(world)
    track = patrol(world, hours, chosen.even_patrol, streams["patrol"])
    believed = reported(track, chosen, streams["pose"])
    positions = world.positions(track.times)
    loose = loose_solids(world, positions)
    exposures = expose(world, track, loose, positions)
    reports = report(world, track, believed, exposures, detections_in(hours), chosen, streams)
    reports = _embedded(reports, chosen, world, streams)
    name, dim = writer.embedding_name(chosen, len(world.things))
    hours_name = f"{hours:g}".replace(".", "p")
    title = f"{writer.SIMULATED}{hours_name}h-{seed}-{chosen.name}"
    writer.write_facts(out, title, name, dim, whole=False)
    writer.write_frames(out, believed, chosen, depth)
    writer.write_detections(out, reports, reports.embedding)
    if depth:
        fixed, _ = world.fixed()
        writer.write_depth(out, track, fixed, loose, chosen.depth > 0, streams["depth image"])
    empty = truth.emptiness(world, track, loose)  # last: who finds a truth finds all of the world
    writer.write_truth(out, world, reports, empty, truth.relations(world))
    writer.write_facts(out, title, name, dim, whole=True)
    return _summary(out, chosen, seed, hours, world, track, reports)


def _embedded(reports: Reports, condition: Condition, world: World, streams: _Streams) -> Reports:
    """Replace looks by instance codes where the condition says so; a code without a bit is lost."""
    if not condition.codes:
        return reports
    bits, kept = writer.codes(reports, condition, len(world.things), streams["codes"])
    rows = np.flatnonzero(kept)
    return replace(
        reports,
        thing=reports.thing[rows],
        frame=reports.frame[rows],
        category=[reports.category[k] for k in rows],
        probability=reports.probability[rows],
        box=reports.box[rows],
        position=reports.position[rows],
        embedding=bits[rows],
    )


def _prepare(out: Path) -> None:
    """Make the folder; an older simulation in it is replaced, anything else is left alone."""
    if out.exists() and any(out.iterdir()):
        if not _is_simulated(out):
            raise BadInput(f"{out} exists and was not simulated; name an empty or new folder")
        for path in _written(out):
            if path.is_dir():
                shutil.rmtree(path)
            else:
                path.unlink()
    out.mkdir(parents=True, exist_ok=True)


def is_whole(folder: Path) -> bool:
    """Whether a simulated recording is there to its end."""
    facts = _facts(folder)
    return (folder / "truth.jsonl").exists() and facts is not None and "unfinished" not in facts


def _is_simulated(out: Path) -> bool:
    facts = _facts(out)
    return facts is not None and str(facts.get("recording")).startswith(writer.SIMULATED)


def _facts(folder: Path) -> Json | None:
    try:
        facts = json.loads((folder / "recording.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):  # what cannot be told is somebody's own
        return None
    return facts if isinstance(facts, dict) else None


def _written(out: Path) -> Iterator[Path]:
    names = ("recording.json", "frames.jsonl", "detections.jsonl", "embeddings.npy", "truth.jsonl")
    return (out / name for name in (*names, "depth") if (out / name).exists())


def _summary(
    out: Path,
    condition: Condition,
    seed: int,
    hours: float,
    world: World,
    track: Track,
    reports: Reports,
) -> Simulated:
    stays = np.bincount([stand.thing for stand in world.stands], minlength=len(world.things))
    moves = tuple(int(count) - 1 for count in stays if count > 1)
    return Simulated(
        folder=out,
        condition=condition.name,
        seed=seed,
        hours=hours,
        objects=len(world.things),
        movers=len(moves),
        moves=moves,
        frames=len(track.times),
        detections=len(reports.frame),
        false_positives=int((reports.thing < 0).sum()),
        objects_seen=len(set(reports.thing.tolist()) - {-1}),
    )
