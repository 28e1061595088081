"""Measure the goals of the association: one table, what is asked for beside what was measured.

    python -m tests.bench.bench_association [--seeds dev|validation|0,3-5] [--part NAME ...]

Parts: nominal (3 h, and the systems side by side), readings (of the paper, where it is silent),
noise (each condition, 3 h), codes (Exp 1), days (22 h), week (speed at 3, 22 and 100 h). Rates are
of the processor, so that other work on the machine does not count. Tune on dev seeds alone;
validation seeds are for looking, once per change that is to be kept.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from time import monotonic

import click
import numpy as np

from assistant.evaluation import exp1, exp2
from assistant.evaluation.commands import parse_seeds
from assistant.evaluation.exp2 import Outcome
from assistant.evaluation.methods import (
    D3A_D,
    D3A_P,
    NAIVE,
    NAIVE_PLUS,
    NON_SPATIAL_METHOD,
    OURS,
    Method,
    filled,
)
from assistant.evaluation.methods import METHODS as SYSTEMS
from assistant.evaluation.tables import Table, as_text, spread, summary
from assistant.evaluation.worlds import (
    DEVELOPMENT,
    VALIDATION,
    Steps,
    World,
    recorded,
    worlds_of,
)
from d3a.metrics import Rate
from d3a.parameters import PAPER

NOISE = ("colour-x2", "pose-0.5", "confusion-20", "false-positives-15")
ALSO = ("pose-0.2", "drift", "flat", "even-patrol")
METHODS = (D3A_D, OURS)
WORSE_FIRST = (NON_SPATIAL_METHOD, NAIVE, D3A_D, D3A_P)
"""The order of accuracies that the paper claims: each must be below the next."""
READINGS: tuple[tuple[str, dict[str, object]], ...] = (
    ("as it is", {}),
    ("similarity as a distance of 0.4 (0.6)", {"min_similarity": 0.6}),
    ("tier 3 in plain metres", {"normalise_by": "none"}),
    ("tier 3 normalised over three axes", {"normalise_by": "space"}),
    ("intervals end after 10 minutes", {"interval_gap_s": 600.0}),
    ("nearest in look", {"nearest_by": "look"}),
    ("no category gate in tiers 2 and 3", {"gate_category": False}),
    ("what moved gets a new id", {"keep_moved_id": False}),
    ("views count alike", {"weigh_by": "count"}),
    ("three frames a cluster", {"min_frames": 3}),
    ("window of 20 frames", {"window_frames": 20}),
    ("memory of 40", {"stm_capacity": 40}),
    ("memory of 10", {"stm_capacity": 10}),
    ("0.75 m", {"d_thresh_m": 0.75}),
)
SPEEDS = {
    3.0: (">= 2,000", ">= 5,000"),
    22.0: (">= 1,200", ">= 5,000"),
    100.0: (">= 1,000", ">= 2,500"),
}
"""Hours, and the detections/s wanted of the paper's and the default profile."""
HEAD = ("", "paper profile", "default profile", "goal: paper", "goal: default")
Row = tuple[str, str, str, str, str]
Found = dict[Method, list[Outcome]]


@dataclass
class Bench:
    """What is measured on, and where recordings are kept."""

    worlds: tuple[World, ...]
    work: Path
    queries: int

    @property
    def seeds(self) -> str:
        return ", ".join(str(world.seed) for world in self.worlds)

    def goals(self, title: str, rows: Sequence[Row]) -> Table:
        return Table(f"{title}, seeds {self.seeds}, strict reading", HEAD, tuple(rows))

    def steps(self, total: int) -> Steps:
        begun = monotonic()

        def tell(share: float, text: str) -> None:
            click.echo(f"{100 * share:3.0f} %  {monotonic() - begun:4.0f} s  {text}", err=True)

        return Steps(tell, total)

    def outcomes(
        self, methods: Sequence[Method], condition: str = "nominal", hours: float = 3.0
    ) -> Found:
        worlds = [World(world.seed, hours) for world in self.worlds]
        steps = self.steps(len(worlds) * len(methods))
        found = exp2.run(
            worlds, self.work, steps, methods=methods, condition=condition, count=self.queries
        )
        return {m: [o for o in found if o.method == m] for m in methods}


def both(
    found: Found,
    value: Callable[[Outcome], float | None],
    digits: int = 2,
    factor: float = 1.0,
) -> tuple[str, str]:
    paper, ours = (spread([value(o) for o in found[m]], digits, factor) for m in METHODS)
    return paper, ours


def nominal(bench: Bench) -> list[Table]:
    found = bench.outcomes(SYSTEMS)
    every = [outcome for outcomes in found.values() for outcome in outcomes]
    rows = [*answers(found), *order(found), *sizes(found), *links(found)]
    return [bench.goals("nominal, 3 h", rows), summary(every, "strict")]


def order(found: Found) -> list[Row]:
    """Say whether each system is above the one before it, and in how many worlds."""
    rows: list[Row] = []
    for worse, better in pairwise(WORSE_FIRST):
        gains = [
            100 * (b.accuracy(perfect=0) - a.accuracy(perfect=0))
            for a, b in zip(found[worse], found[better], strict=True)
        ]
        above = f"{spread(gains, 1)}, {sum(gain > 0 for gain in gains)} of {len(gains)} worlds"
        rows.append((f"points of {better.title} over {worse.title}", above, "", "> 0", ""))
    return rows


def readings(bench: Bench) -> list[Table]:
    """Measure the paper profile under other readings of what the paper leaves open."""
    methods = [
        replace(D3A_D, key=f"reading-{k}", title=title, parameters=PAPER.with_changes(**changes))
        for k, (title, changes) in enumerate(READINGS)
    ]
    found = bench.outcomes(methods)
    head = "reading,ids,stays,duplicates,entries,x,crops x,accuracy nine,six,dropped %,B-cubed"
    columns: tuple[tuple[Callable[[Outcome], float | None], int], ...] = (
        (lambda o: o.size.confirmed_ids, 1),
        (lambda o: o.size.confirmed_stays, 0),
        (lambda o: o.identity.duplicates.mean, 2),
        (lambda o: o.size.entries, 0),
        (lambda o: o.size.smaller.pictures, 1),
        (lambda o: o.size.smaller.crops, 1),
        (lambda o: 100 * o.accuracy(perfect=0), 1),
        (lambda o: 100 * o.accuracy(six=True), 1),
        (lambda o: 100 * o.identity.dropped, 0),
        (lambda o: o.identity.f, 2),
    )
    rows = tuple(
        (m.title, *(spread([value(o) for o in found[m]], digits) for value, digits in columns))
        for m in methods
    )
    wanted = ("goal", "20-35", "70-110", "<= 1.3", "", ">= 12", ">= 12", ">= 62", "", "", "")
    title = f"readings of the paper, 3 h, seeds {bench.seeds}, strict reading"
    return [Table(title, tuple(head.split(",")), (*rows, wanted))]


def answers(found: Found) -> list[Row]:
    plus = {o.world: o.accuracy(perfect=0) for o in found[NAIVE_PLUS]}
    nine = both(found, lambda o: o.accuracy(perfect=0), 1, 100)
    six = both(found, lambda o: o.accuracy(six=True), 1, 100)
    measured = both(found, lambda o: o.accuracy(), 1, 100)
    lead = both(found, lambda o: o.accuracy(perfect=0) - plus[o.world], 1, 100)
    false = both(found, lambda o: o.false_answers, 1, 100)
    rows: list[Row] = [
        ("accuracy over nine, %", *nine, ">= 62", ">= 88"),
        ("accuracy over six, %", *six, "report", ">= 83"),
        ("accuracy, Perfect measured, %", *measured, "report", ">= 84"),
        ("points over Naive+", *lead, "report", ">= 8"),
        ("false answers, Attribute, %", *false, "report", "<= 15"),
    ]
    for level, goal in (("category", ">= .40"), ("attribute", ">= .60")):
        shares = both(found, share_at(level))
        rows.append((f"MRR, {level}", *both(found, mrr_at(level)), "report", goal))
        rows.append((f"MRR over ceiling, {level}", *shares, "report", "report"))
    return rows


def sizes(found: Found) -> list[Row]:
    duplicates = both(found, lambda o: o.identity.duplicates.mean)
    smaller = both(found, lambda o: o.size.smaller.pictures, 1)
    crops = both(found, lambda o: o.size.smaller.crops, 1)
    right = both(found, lambda o: precision(o.identity.absent))
    noticed = both(found, lambda o: recall(o.identity.absent))
    return [
        ("B-cubed F", *both(found, lambda o: o.identity.f), "report", ">= .88"),
        ("ids, confirmed", *both(found, lambda o: o.size.confirmed_ids, 1), "20-35", ""),
        ("confirmed stays", *both(found, lambda o: o.size.confirmed_stays, 1), "70-110", "truth"),
        ("stays truly seen twice", *both(found, lambda o: o.size.truly, 1), "", ""),
        ("stays against truth, %", *both(found, off_truth, 1, 100), "report", "<= 15"),
        ("duplicates per object", *duplicates, "<= 1.3", "<= 1.2"),
        ("entries with a picture each (1.3 MB) against Naive, x", *smaller, ">= 12", ">= 12"),
        ("the same with crops of their boxes, x", *crops, ">= 12", ">= 12"),
        ("last_absent precision", *right, "", ">= .9"),
        ("last_absent recall", *noticed, "", ">= .5"),
        ("detections/s of the processor", *both(found, speed, 0), ">= 2,000", ">= 5,000"),
    ]


def links(found: Found) -> list[Row]:
    paper, ours = (pool([o.identity.links for o in found[m]]) for m in METHODS)
    rows: list[Row] = []
    for name, count in (("precision", "given"), ("recall", "wanted")):
        shown = [f"{getattr(r, name):.2f} of {getattr(r, count)}" for r in (paper, ours)]
        rows.append((f"links of moved, {name}", shown[0], shown[1], "report", "report"))
    return rows


def noise(bench: Bench) -> list[Table]:
    rows: list[Row] = []
    for condition in (*NOISE, *ALSO):
        found = bench.outcomes(METHODS, condition)
        goal = ">= 78" if condition in NOISE else "report"
        shown = both(found, lambda o: o.accuracy(six=True), 1, 100)
        rows.append((f"accuracy over six, {condition}", *shown, "report", goal))
        rows.append((f"B-cubed F, {condition}", *both(found, lambda o: o.identity.f), "report", ""))
    return [bench.goals("noise, 3 h", rows)]


def codes(bench: Bench) -> list[Table]:
    rates = exp1.RATES
    worlds = bench.worlds[:3]
    steps = bench.steps(len(worlds) * len(rates) * 2)
    points = exp1.run(worlds, bench.work, steps, rates=rates, methods=METHODS)
    rows: list[Row] = []
    for fpr in rates:
        for order in exp1.ORDERS:
            here = [
                [p.miss[order] for p in points if (p.method, p.fpr) == (m, fpr)] for m in METHODS
            ]
            shown = [spread(values) for values in here]
            rows.append(
                (f"Exp 1 miss, fpr {fpr:g}, by {order}", shown[0], shown[1], "rise, dip", "<= .25")
            )
    short = Bench(worlds, bench.work, bench.queries)
    return [short.goals("Exp 1", rows)]


def days(bench: Bench) -> list[Table]:
    short = Bench(bench.worlds[:3], bench.work, bench.queries)
    found = short.outcomes(METHODS, hours=22.0)
    nine = both(found, lambda o: o.accuracy(perfect=0), 1, 100)
    right = both(found, lambda o: precision(o.identity.absent))
    noticed = both(found, lambda o: recall(o.identity.absent))
    rows = [
        ("accuracy over nine, %", *nine, "report", ">= 80"),
        ("B-cubed F", *both(found, lambda o: o.identity.f), "report", "report"),
        ("stays, confirmed", *both(found, lambda o: o.size.confirmed_stays, 1), "report", ""),
        ("stays truly seen twice", *both(found, lambda o: o.size.truly, 1), "", ""),
        ("detections/s of the processor", *both(found, speed, 0), ">= 1,200", ">= 5,000"),
        ("last_absent precision", *right, "", ">= .9"),
        ("last_absent recall", *noticed, "", ">= .5"),
        *links(found),
    ]
    return [short.goals("22 h", rows)]


def week(bench: Bench) -> list[Table]:
    """Time one world of each length, without depth images: they are read, not associated."""
    first = Bench(bench.worlds[:1], bench.work, bench.queries)
    seed, steps = first.worlds[0].seed, bench.steps(len(SPEEDS) * (1 + len(METHODS)))
    cost: dict[tuple[Method, float], float] = {}
    rows: list[Row] = []
    for hours, goals in SPEEDS.items():
        steps.begin(f"{hours:g} h: the recording")
        source = recorded(World(seed, hours), "nominal", bench.work / "flat", depth=False)
        for method in METHODS:
            steps.begin(f"{hours:g} h: {method.title}")
            with filled(method, source, bench.work / "stores") as run:
                cost[method, hours] = run.associate_s / run.detections
            click.echo(f"{1 / cost[method, hours]:,.0f} detections/s", err=True)
        paper, ours = (f"{1 / cost[method, hours]:,.0f}" for method in METHODS)
        rows.append((f"{hours:g} h: detections/s of the processor", paper, ours, *goals))
    paper, ours = (f"{cost[method, 100.0] / cost[method, 3.0]:.2f}" for method in METHODS)
    rows.append(("cost per detection, 100 h over 3 h", paper, ours, "report", "<= 2"))
    return [first.goals("speed", rows)]


MEASURES: dict[str, Callable[[Bench], list[Table]]] = {
    "nominal": nominal,
    "readings": readings,
    "noise": noise,
    "codes": codes,
    "days": days,
    "week": week,
}


def mrr_at(level: str) -> Callable[[Outcome], float]:
    return lambda o: o.mrr(level)


def share_at(level: str) -> Callable[[Outcome], float]:
    return lambda o: o.mrr(level) / o.ceiling(level)


def off_truth(o: Outcome) -> float:
    return abs(o.size.confirmed_stays / o.size.truly - 1)


def speed(o: Outcome) -> float:
    return o.detections / o.associate_s


def precision(rate: Rate) -> float | None:
    return rate.precision if rate.given else None


def recall(rate: Rate) -> float | None:
    return rate.recall if rate.wanted else None


def pool(rates: Sequence[Rate]) -> Rate:
    sums = np.sum([(r.right, r.given, r.met, r.wanted) for r in rates], axis=0)
    return Rate(*(int(v) for v in sums))


@click.command()
@click.option("--seeds", default="dev", show_default=True, help="dev, validation, or 0,3-5.")
@click.option("--part", "parts", multiple=True, type=click.Choice(list(MEASURES)))
@click.option("--queries", default=45, show_default=True)
@click.option("--keep", type=click.Path(file_okay=False, path_type=Path))
def main(seeds: str, parts: tuple[str, ...], queries: int, keep: Path | None) -> None:
    """Print the goals of the association, measured: all parts, or those that are named."""
    named = {"dev": DEVELOPMENT, "validation": VALIDATION}
    chosen = named[seeds] if seeds in named else parse_seeds(seeds)
    with tempfile.TemporaryDirectory(prefix="d3a-bench-") as scratch:
        bench = Bench(worlds_of(chosen), keep or Path(scratch), queries)
        for part in parts or tuple(MEASURES):
            for table in MEASURES[part](bench):
                click.echo(as_text(table) + "\n")


if __name__ == "__main__":
    main()
