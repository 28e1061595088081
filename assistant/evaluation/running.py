"""Run the experiments and write their report: the function behind `d3a evaluate`."""

from __future__ import annotations

import importlib.util
import json
import math
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from assistant.evaluation import exp1, exp2, exp3, exp4, paper, report, tables
from assistant.evaluation.judging import Reading
from assistant.evaluation.methods import METHODS
from assistant.evaluation.questions import POSITIVES
from assistant.evaluation.tables import Table
from assistant.evaluation.worlds import DEVELOPMENT, Progress, Steps, World, worlds_of
from d3a.answer import SCHEMA
from d3a.model import BadInput, Json
from d3a.parameters import Parameters

Experiment = Literal["exp1", "exp2", "exp3", "exp4"]
EXPERIMENTS: tuple[Experiment, ...] = ("exp1", "exp2", "exp3", "exp4")
LONG_HOURS = 22.0
REPORT = "report.html"
RESULTS = "results.json"


def quiet(share: float, text: str) -> None:
    """Report nothing."""


@dataclass(frozen=True, slots=True)
class Evaluation:
    """What the experiments gave; those that were not run are empty."""

    reading: Reading
    worlds: tuple[World, ...]
    exp1: tuple[exp1.Point, ...] = ()
    exp2: tuple[exp2.Outcome, ...] = ()
    exp3: tuple[exp3.Growth, ...] = ()
    exp4: tuple[exp4.Clusters, ...] = ()

    def tables(self) -> list[Table]:
        """Return the tables of the experiments that were run, the summary first."""
        return [table for table, _ in self._sections(plots=False)]

    def to_json(self) -> Json:
        """Return every figure: the worlds, the tables, and per experiment a list of records.

        The tables are as people see them, text with the paper's figure beside ours; the records
        are numbers, one of each method and world. What is not known is null.
        """
        record: Json = {
            "schema": SCHEMA,
            "reading": self.reading,
            "worlds": [world.title for world in self.worlds],
            "tables": _plain(self.tables()),
            "contradictions": list(paper.contradictions()),
        }
        return record | {name: _plain(getattr(self, name)) for name in EXPERIMENTS}

    def html(self) -> str:
        """Return the report, one self-contained page. Needs matplotlib."""
        names = ", ".join(world.title for world in self.worlds)
        hours = sorted({f"{world.hours:g} h" for world in self.worlds if world.folder is None})
        lead = (
            f"Worlds: {names}{' (' + ', '.join(hours) + ')' if hours else ''}"
            f"{self._long()}. Figures are means over the worlds ± their standard deviation (of a "
            "sample; one world has none). Grey "
            f"columns are the paper's, of its one laboratory.{self._asked()}",
            "Every question went as a sentence through the grammar, the planner and a store; the "
            "truth was joined afterwards, by the box of each keyframe.",
        )
        return report.page("D3A: the paper's four experiments", lead, self._sections(plots=True))

    def _long(self) -> str:
        """Say how long the simulated worlds of Exp 3 are."""
        worlds = [growth.world for growth in self.exp3]
        hours = sorted({f"{world.hours:g} h" for world in worlds if world.folder is None})
        return f"; simulated ones of Exp 3 are of {', '.join(hours)}" if hours else ""

    def _asked(self) -> str:
        """Say how many questions a figure of Exp 2 stands on."""
        if not self.exp2:
            return ""
        queries = max(cell.queries for outcome in self.exp2 for cell in outcome.cells)
        return f" Each world was asked {queries} questions of each form at each precision."

    def _sections(self, *, plots: bool) -> list[tuple[Table, str | None]]:
        found: list[tuple[Table, str | None]] = []
        if plots:
            from assistant.evaluation import plots as draw
        if self.exp2:
            plot = draw.accuracy(self.exp2, self.reading) if plots else None
            found.append((tables.summary(self.exp2, self.reading), plot))
            found.append((tables.retrieval(self.exp2, self.reading), None))
        if self.exp1:
            found.append((tables.exp1(self.exp1), draw.exp1(self.exp1) if plots else None))
        if self.exp3:
            found.append((tables.exp3(self.exp3), draw.exp3(self.exp3) if plots else None))
        if self.exp4:
            found.append((tables.exp4(self.exp4), draw.exp4(self.exp4) if plots else None))
        return found


def evaluate(
    which: Sequence[Experiment] = EXPERIMENTS,
    worlds: Sequence[World] | None = None,
    report_dir: Path | None = None,
    progress: Progress = quiet,
    *,
    reading: Reading = "strict",
    count: int = POSITIVES,
    work: Path | None = None,
    long_hours: float = LONG_HOURS,
) -> Evaluation:
    """Run experiments on worlds; write report.html and results.json where a folder is named.

    worlds: None for the development seeds at 3 h. Exp 1 takes the first three: a given recording
    has no codes, and takes no part in it. Exp 3 takes the first three, simulated ones at
    `long_hours` where they are shorter; Exp 4 the first world.
    count: queries of each form and world. work: where simulated recordings are kept for another
    run; None forgets them. Raises BadInput (also where matplotlib is missing and a report is
    asked for) and StoreError.
    """
    chosen = tuple(worlds) if worlds is not None else worlds_of(DEVELOPMENT)
    if not chosen:
        raise BadInput("no world to evaluate on; name a seed or a recording")
    if report_dir is not None and importlib.util.find_spec("matplotlib") is None:
        raise BadInput("a report needs matplotlib; pip install 'd3a[report]' brings it")
    with ExitStack() as stack:
        if work is None:
            work = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="d3a-evaluate-")))
        found = _run(which, chosen, work, progress, reading, count, long_hours)
    if report_dir is not None:
        report_dir.mkdir(parents=True, exist_ok=True)
        (report_dir / REPORT).write_text(found.html(), encoding="utf-8")
        text = json.dumps(found.to_json(), indent=1) + "\n"
        (report_dir / RESULTS).write_text(text, encoding="utf-8")
    progress(1.0, "done")
    return found


def _run(
    which: Sequence[Experiment],
    worlds: tuple[World, ...],
    work: Path,
    progress: Progress,
    reading: Reading,
    count: int,
    long_hours: float,
) -> Evaluation:
    coded = [world for world in worlds if world.folder is None][:3]
    long = [w if w.folder else World(w.seed, max(w.hours, long_hours)) for w in worlds[:3]]
    sizes = {
        "exp1": len(coded) * len(exp1.RATES) * len(exp1.METHODS),
        "exp2": len(worlds) * len(METHODS),
        "exp3": len(long) * len(exp3.METHODS),
        "exp4": len(exp4.METHODS),
    }
    steps = Steps(progress, sum(sizes[name] for name in which))
    return Evaluation(
        reading=reading,
        worlds=worlds,
        exp1=tuple(exp1.run(coded, work, steps)) if "exp1" in which else (),
        exp2=tuple(exp2.run(worlds, work, steps, reading=reading, count=count))
        if "exp2" in which
        else (),
        exp3=tuple(exp3.run(long, work, steps)) if "exp3" in which else (),
        exp4=tuple(exp4.run(worlds[0], work, steps)) if "exp4" in which else (),
    )


def _plain(value: Any) -> Any:
    """Return a result as JSON values; methods, worlds and parameters by their names."""
    if isinstance(value, Parameters):
        return value.profile
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: _plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, dict):
        return {str(key): _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, Path):
        return value.name
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
