"""Measure the goals of the association: one table, what is asked for beside what was measured.

    python -m tests.bench.bench_association [--seeds dev|validation|0,3-5] [--part NAME ...]

Parts: nominal (3 h), noise (each condition, 3 h), codes (Exp 1), days (22 h), week (100 h, speed).
Tune on dev seeds alone; validation seeds are for looking, once per change that is to be kept.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np

from assistant.evaluation import exp1, exp2
from assistant.evaluation.commands import parse_seeds
from assistant.evaluation.exp2 import Outcome
from assistant.evaluation.methods import D3A_D, NAIVE_PLUS, OURS, Method, filled
from assistant.evaluation.tables import Table, as_text, spread
from assistant.evaluation.worlds import (
    DEVELOPMENT,
    VALIDATION,
    Steps,
    World,
    recorded,
    worlds_of,
)
from d3a.metrics import Rate

NOISE = ("colour-x2", "pose-0.5", "confusion-20", "false-positives-15")
ALSO = ("pose-0.2", "drift", "flat", "even-patrol")
PARTS = ("nominal", "noise", "codes", "days", "week")
METHODS = (D3A_D, OURS)
Row = tuple[str, str, str, str, str]
Found = dict[Method, list[Outcome]]


@dataclass
class Bench:
    """What is measured on, and where recordings are kept."""

    worlds: tuple[World, ...]
    work: Path
    queries: int

    def steps(self, total: int) -> Steps:
        return Steps(
            lambda share, text: click.echo(f"{100 * share:3.0f} %  {text}", err=True), total
        )

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


def nominal(bench: Bench) -> list[Row]:
    found = bench.outcomes((NAIVE_PLUS, *METHODS))
    return [*answers(found), *sizes(found), *links(found)]


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
        ("detections/s, 3 h", *both(found, speed, 0), ">= 2,000", ">= 5,000"),
    ]


def links(found: Found, prefix: str = "") -> list[Row]:
    paper, ours = (pool([o.identity.links for o in found[m]]) for m in METHODS)
    rows: list[Row] = []
    for name, count in (("precision", "given"), ("recall", "wanted")):
        shown = [f"{getattr(r, name):.2f} of {getattr(r, count)}" for r in (paper, ours)]
        rows.append((f"{prefix}links of moved, {name}", shown[0], shown[1], "report", "report"))
    return rows


def noise(bench: Bench) -> list[Row]:
    rows: list[Row] = []
    for condition in (*NOISE, *ALSO):
        found = bench.outcomes(METHODS, condition)
        goal = ">= 78" if condition in NOISE else "report"
        shown = both(found, lambda o: o.accuracy(six=True), 1, 100)
        rows.append((f"accuracy over six, {condition}", *shown, "report", goal))
        rows.append((f"B-cubed F, {condition}", *both(found, lambda o: o.identity.f), "report", ""))
    return rows


def codes(bench: Bench) -> list[Row]:
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
    return rows


def days(bench: Bench) -> list[Row]:
    short = Bench(bench.worlds[:3], bench.work, bench.queries)
    found = short.outcomes(METHODS, hours=22.0)
    nine = both(found, lambda o: o.accuracy(perfect=0), 1, 100)
    right = both(found, lambda o: precision(o.identity.absent))
    noticed = both(found, lambda o: recall(o.identity.absent))
    return [
        ("22 h: accuracy over nine, %", *nine, "report", ">= 80"),
        ("22 h: B-cubed F", *both(found, lambda o: o.identity.f), "report", "report"),
        ("22 h: stays, confirmed", *both(found, lambda o: o.size.confirmed_stays, 1), "report", ""),
        ("22 h: stays truly seen twice", *both(found, lambda o: o.size.truly, 1), "", ""),
        ("22 h: detections/s", *both(found, speed, 0), ">= 1,200", ">= 5,000"),
        ("22 h: last_absent precision", *right, "", ">= .9"),
        ("22 h: last_absent recall", *noticed, "", ">= .5"),
        *links(found, "22 h: "),
    ]


def week(bench: Bench) -> list[Row]:
    """Time one world at 3 h and at 100 h, without depth images: they are read, not associated."""
    seed = bench.worlds[0].seed
    cost: dict[tuple[Method, float], float] = {}
    for hours in (3.0, 100.0):
        source = recorded(World(seed, hours), "nominal", bench.work / "flat", depth=False)
        for method in METHODS:
            with filled(method, source, bench.work / "stores") as run:
                cost[method, hours] = run.associate_s / run.detections
                click.echo(f"{method.title}, {hours:g} h: {run.associate_s:.1f} s", err=True)
    speeds = tuple(f"{1 / cost[m, 100.0]:,.0f}" for m in METHODS)
    ratios = tuple(f"{cost[m, 100.0] / cost[m, 3.0]:.2f}" for m in METHODS)
    return [
        ("100 h: detections/s", speeds[0], speeds[1], ">= 1,000", ">= 2,500"),
        ("cost per detection, 100 h over 3 h", ratios[0], ratios[1], "report", "<= 2"),
    ]


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
@click.option("--part", "parts", multiple=True, type=click.Choice(PARTS), help="All by default.")
@click.option("--queries", default=45, show_default=True)
@click.option("--keep", type=click.Path(file_okay=False, path_type=Path))
def main(seeds: str, parts: tuple[str, ...], queries: int, keep: Path | None) -> None:
    """Print the goals of the association, measured."""
    named = {"dev": DEVELOPMENT, "validation": VALIDATION}
    chosen = named[seeds] if seeds in named else parse_seeds(seeds)
    measures = {"nominal": nominal, "noise": noise, "codes": codes, "days": days, "week": week}
    head = ("", "paper profile", "default profile", "goal: paper", "goal: default")
    with tempfile.TemporaryDirectory(prefix="d3a-bench-") as scratch:
        bench = Bench(worlds_of(chosen), keep or Path(scratch), queries)
        for part in parts or PARTS:
            title = f"{part}, seeds {', '.join(map(str, chosen))}, strict reading"
            click.echo(as_text(Table(title, head, tuple(measures[part](bench)))) + "\n")


if __name__ == "__main__":
    main()
