"""The report's plots, as SVG text; the only user of matplotlib (extra `report`)."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from assistant.evaluation.exp1 import ORDERS, Point
from assistant.evaluation.exp2 import Outcome
from assistant.evaluation.exp3 import Growth
from assistant.evaluation.exp4 import Clusters
from assistant.evaluation.judging import Reading
from assistant.evaluation.tables import by_method

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MARKERS = "os^vDPX*<>ph."
"""A shape a true object, those with most detections first; the last is of all others."""
COLOURS = ("#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#888888")


def _figure(columns: int, height: float) -> tuple[Figure, list[Any]]:
    from matplotlib.figure import Figure  # half a second to import, and an extra

    figure = Figure(figsize=(4.6 * columns, height), layout="constrained")
    axes = figure.subplots(1, columns, squeeze=False)[0]
    return figure, list(axes)


def _svg(figure: Figure) -> str:
    import matplotlib as mpl

    out = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": "d3a", "svg.fonttype": "none"}):
        nothing = dict.fromkeys(("Creator", "Date", "Format", "Type"))
        figure.savefig(out, format="svg", metadata=nothing)
    text = out.getvalue()
    return text[text.index("<svg") :]


def exp1(points: Sequence[Point]) -> str:
    """Return miss rate and MRR@50 over fpr, a line per method and order."""
    figure, axes = _figure(2, 3.6)
    methods = list(dict.fromkeys(point.method for point in points))
    rates = sorted({point.fpr for point in points})
    for ax, (name, label) in zip(axes, (("miss", "miss rate"), ("mrr", "MRR@50")), strict=True):
        for colour, method in zip(COLOURS, methods, strict=False):
            for order, style in zip(ORDERS, ("-", "--"), strict=True):
                rows = [
                    [getattr(p, name)[order] for p in points if (p.method, p.fpr) == (method, r)]
                    for r in rates
                ]
                means = [float(np.mean(row)) for row in rows]
                deviations = [float(np.std(row)) for row in rows]
                title = f"{method.title}, by {order}"
                ax.errorbar(
                    rates, means, deviations, color=colour, ls=style, label=title, capsize=2
                )
        ax.set(xlabel="false positive rate of the bits", ylabel=label, ylim=(-0.03, 1.03))
        ax.grid(alpha=0.3)
    lines, labels = axes[1].get_legend_handles_labels()
    figure.legend(lines, labels, loc="outside lower center", ncols=3, fontsize=7)
    return _svg(figure)


def accuracy(outcomes: Sequence[Outcome], reading: Reading) -> str:
    """Return accuracy over six cells and MRR@50 by level, a bar per method."""
    figure, axes = _figure(2, 3.6)
    grouped = by_method(outcomes)
    names = [method.title for method in grouped]
    values = [[100 * o.accuracy(reading, six=True) for o in group] for group in grouped.values()]
    at = np.arange(len(names))
    axes[0].barh(
        at,
        [np.mean(v) for v in values],
        xerr=[np.std(v) for v in values],
        color=[COLOURS[k % len(COLOURS)] for k in at],
    )
    axes[0].set_yticks(at, names, fontsize=8)
    axes[0].invert_yaxis()
    axes[0].set(xlabel="accuracy over six cells, %", xlim=(0, 100))
    levels = ("category", "attribute", "any")
    width = 0.8 / max(1, len(grouped))
    for k, (method, group) in enumerate(grouped.items()):
        means = [float(np.mean([o.mrr(level, reading) for o in group])) for level in levels]
        place = np.arange(len(levels)) + k * width
        axes[1].bar(place, means, width, label=method.title, color=COLOURS[k % len(COLOURS)])
    ceilings = [float(np.mean([o.ceiling(level) for o in outcomes])) for level in levels]
    middle = np.arange(len(levels)) + 0.4 - width / 2
    axes[1].hlines(ceilings, middle - 0.42, middle + 0.42, color="black", lw=1, label="ceiling")
    axes[1].set_xticks(middle, levels)
    axes[1].set(ylabel="MRR@50", ylim=(0, 1))
    lines, labels = axes[1].get_legend_handles_labels()
    figure.legend(lines, labels, loc="outside lower center", ncols=4, fontsize=7)
    return _svg(figure)


def exp3(grown: Sequence[Growth]) -> str:
    """Return cumulative stays over the robot's working hours, on a logarithmic scale."""
    figure, (ax,) = _figure(1, 3.6)
    methods = list(dict.fromkeys(g.method for g in grown))
    for g in grown:
        colour = COLOURS[methods.index(g.method) % len(COLOURS)]
        label = g.method.title if g is next(x for x in grown if x.method == g.method) else None
        ax.plot(g.hours, g.stays, color=colour, label=label)
        if g.confirmed != g.stays:
            ax.plot(
                g.hours, g.confirmed, color=colour, ls=":", label=label and f"{label}, confirmed"
            )
    ax.set(xlabel="working hours", ylabel="stays in the store", yscale="log")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=7)
    return _svg(figure)


def exp4(found: Sequence[Clusters]) -> str:
    """Return a map per method: a dot a detection, its colour the id, its shape the true object."""
    figure, axes = _figure(len(found), 4.6)
    names = [name for name, _ in _counted([name for c in found for name in c.shows])]
    shapes = {name: _MARKERS[min(k, len(_MARKERS) - 1)] for k, name in enumerate(names)}
    for ax, clusters in zip(axes, found, strict=True):
        ids = [label.rpartition("/")[0] for label in clusters.cluster]
        most = [name for name, _ in _counted(ids) if name]
        for name in names:
            rows = np.array([row for row, shown in enumerate(clusters.shows) if shown == name])
            if not len(rows):
                continue
            ax.scatter(
                clusters.position[rows, 0],
                clusters.position[rows, 1],
                c=[_shade(ids[row], most) for row in rows],
                s=14,
                marker=shapes[name],
                alpha=0.7,
                linewidths=0,
            )
        ax.set(title=f"{clusters.method.title}\n{clusters.ids} ids, {clusters.stays} stays")
        ax.set(xlabel="x, m", ylabel="y, m", aspect="equal")
    told = names[: len(_MARKERS) - 1]
    for name in told:
        axes[0].scatter([], [], c="#555555", s=14, marker=shapes[name], label=name or "a mistake")
    if len(names) > len(told):
        axes[0].scatter([], [], c="#555555", s=14, marker=_MARKERS[-1], label="other things")
    figure.legend(
        loc="outside lower center",
        ncols=6,
        fontsize=7,
        title="shape: what it shows; colour: its id",
    )
    return _svg(figure)


def _counted(values: Sequence[str]) -> list[tuple[str, int]]:
    counts: dict[str, int] = {}
    for value in values:
        counts[value] = counts.get(value, 0) + 1
    return sorted(counts.items(), key=lambda pair: (-pair[1], pair[0]))


def _shade(name: str, most: Sequence[str]) -> str:
    """Return an id's colour: the biggest clusters have their own, what was dropped is grey."""
    if not name:
        return "#dddddd"
    place = most.index(name)
    return COLOURS[place % len(COLOURS)] if place < 2 * len(COLOURS) else "#555555"
