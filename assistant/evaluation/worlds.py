"""Where the recordings of an evaluation come from: seeds, or a folder that is given."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from zoneinfo import ZoneInfo

from assistant.english import listed
from d3a.ingesting.lacking import Lacking
from d3a.model import BadInput
from d3a.readers.recording import RecordingReader
from d3a.simulate import NOMINAL, Condition, is_whole, named, simulate
from d3a.truth import Truth, read_truth

DEVELOPMENT = (0, 1, 2, 3, 4)
VALIDATION = (100, 101, 102, 103, 104)
_FILES = ("recording.json", "frames.jsonl", "detections.jsonl", "truth.jsonl")
Progress = Callable[[float, str], None]
"""Told the share that is done, 0 to 1, and what is being done."""


@dataclass(frozen=True, slots=True)
class World:
    """A world to evaluate on: a seed and its length, or a recording folder with its truth."""

    seed: int = 0
    hours: float = 3.0
    folder: Path | None = None

    @property
    def title(self) -> str:
        """What the world is called in tables."""
        return self.folder.name if self.folder else f"seed {self.seed}"

    def has(self, condition: str | None) -> bool:
        """Whether the world can be had under a condition; a given recording is as it is."""
        return self.folder is None or condition in (None, NOMINAL.name)


@dataclass(frozen=True, slots=True)
class Recorded:
    """A recording on disk with its truth and the zone of its home."""

    folder: Path
    truth: Truth
    zone: ZoneInfo


def recorded(
    world: World, condition: str | Condition, work: Path, *, depth: bool = True
) -> Recorded:
    """Return the world's recording under a condition, simulated into `work` if it is not there.

    Raises BadInput where a given recording is asked for under another condition, or lacks truth.
    """
    chosen = named(condition)
    if world.folder is not None:
        if not world.has(chosen.name):
            raise BadInput(f"{world.folder} is given as it is; {chosen.name} needs a seed")
        return _read(world.folder)
    folder = work / f"{world.hours:g}h-{world.seed}-{chosen.name}"
    if not is_whole(folder):
        simulate(folder, hours=world.hours, seed=world.seed, condition=chosen, depth=depth)
    return _read(folder)


def _read(folder: Path) -> Recorded:
    missing = [name for name in _FILES if not (folder / name).is_file()]
    if missing:
        raise BadInput(
            f"{folder} is no recording that can be judged: it has no {listed(missing)}; "
            f"d3a simulate {folder} writes one with its truth"
        )
    reader = RecordingReader(folder)
    return Recorded(folder, read_truth(folder), ZoneInfo(reader.facts.zone or "UTC"))


def lacks(folder: Path) -> list[str]:
    """Return what a given recording lacks for all that can be judged, a sentence each.

    Raises BadInput where it cannot be judged at all.
    """
    lacking = Lacking()
    for frame in RecordingReader(_read(folder).folder):
        lacking.add(posed=frame.pose is not None, detections=frame.detections or ())
    return lacking.say()


def worlds_of(seeds: tuple[int, ...], hours: float = 3.0) -> tuple[World, ...]:
    """Return a world per seed."""
    return tuple(World(seed, hours) for seed in seeds)


class Steps:
    """Counts steps of known number and tells the share done."""

    def __init__(self, progress: Progress, total: int) -> None:
        self._progress, self._total, self._done = progress, max(total, 1), 0

    def begin(self, text: str) -> None:
        """Tell that the next step begins."""
        self._progress(min(1.0, self._done / self._total), text)
        self._done += 1
