"""How networks write down what they found: recognised from an output's shape and numbers.

A network is shown a plain grey picture once. Which kind it is follows from the shapes of what comes
out, given how many classes there are; where two kinds have one shape, from the numbers: places of
a grid in pixels, in cells, or as shares of the picture.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from d3a.detectors.feeding import BGR_255, CENTRE, CORNER, IMAGENET, RGB_1, STRETCH
from d3a.detectors.onnx_file import shape_text
from d3a.model import BadInput

Floats = NDArray[np.float32]
Outputs = Sequence[NDArray[Any]]
_STRIDES = ((8, 16, 32), (8, 16, 32, 64))
"""Pixels a cell of the grids that networks with one candidate a cell look with."""
_MOST_SHARE = 2.0
"""Places that are shares of the picture are about 0 to 1; in pixels most are far above this."""


@dataclass(frozen=True, slots=True)
class Layout:
    """A way to write candidates down, and what such networks are shown.

    pixels, fit: see `feeding`. overlaps: several candidates may stand for one thing.
    """

    name: str
    pixels: str
    fit: str
    overlaps: bool = True


LAYOUTS: Mapping[str, Layout] = {
    layout.name: layout
    for layout in (
        Layout("yolo8", RGB_1, CENTRE),
        Layout("yolo5", RGB_1, CENTRE),
        Layout("yolox", BGR_255, CORNER),
        Layout("end2end", RGB_1, CENTRE, overlaps=False),
        Layout("rtdetr", RGB_1, STRETCH, overlaps=False),
        Layout("detr", IMAGENET, STRETCH, overlaps=False),
    )
}
"""yolo8: box and classes (YOLO v8, v9, 11, 12). yolo5: box, objectness, classes (v5, v6, v7).
yolox: the same on grids. end2end: corners, score, class number (v10, or exported with nms).
rtdetr: box and classes as shares. detr: the same, with a class for nothing at the end."""


@dataclass(frozen=True, slots=True)
class Candidates:
    """What a network proposes: boxes (n, 4) x1 y1 x2 y2 in its input's pixels, scores (n, c)."""

    boxes: Floats
    scores: Floats


@dataclass(frozen=True, slots=True)
class Reading:
    """How the outputs of one network are read.

    size: the input's height and width. boxes, scores: which output; the same one where candidates
    are in one piece. is_turned: candidates are columns. is_share: places are shares of the input.
    is_logit: scores are before the sigmoid or softmax. grid (n, 3): column, row and stride of each
    candidate's cell where places count from it, else None.
    """

    layout: Layout
    classes: int
    size: tuple[int, int]
    boxes: int
    scores: int
    is_turned: bool = False
    is_share: bool = False
    is_logit: bool = False
    grid: Floats | None = None

    def candidates(self, outputs: Outputs, which: int = 0) -> Candidates:
        """Return the candidates of picture number `which` of the batch."""
        table = self.table(outputs[self.boxes], which)
        if self.layout.name == "end2end":
            return self._ended(table)
        if self.boxes != self.scores:
            scores = self.table(outputs[self.scores], which)
            return Candidates(self._corners(table), self._chances(scores))
        if self.layout.name in ("yolo5", "yolox"):
            chances = self._chances(table[:, 5 : 5 + self.classes]) * table[:, 4:5]
        else:
            chances = self._chances(table[:, 4 : 4 + self.classes])
        return Candidates(self._corners(table), chances)

    def table(self, output: NDArray[Any], which: int = 0) -> Floats:
        """Return one picture's output with a candidate a row."""
        table = np.asarray(output[which], dtype=np.float32)
        return table.T if self.is_turned else table

    def _ended(self, table: Floats) -> Candidates:
        numbers = np.nan_to_num(table[:, 5], nan=-1.0)
        known = np.flatnonzero((numbers >= 0) & (numbers < self.classes))
        scores = np.zeros((len(table), self.classes), dtype=np.float32)
        scores[known, numbers[known].astype(np.intp)] = table[known, 4]
        return Candidates(table[:, :4] * self._unit(), scores)

    def _corners(self, table: Floats) -> Floats:
        centre, sides = table[:, :2], table[:, 2:4]
        if self.grid is not None:
            stride = self.grid[:, 2:]
            centre = (centre + self.grid[:, :2]) * stride
            sides = np.exp(np.minimum(sides, 20.0)) * stride
        corners = np.concatenate([centre - sides / 2, centre + sides / 2], axis=1)
        return np.asarray(corners * self._unit(), dtype=np.float32)

    def _unit(self) -> Floats:
        height, width = self.size if self.is_share else (1, 1)
        return np.array([width, height, width, height], dtype=np.float32)

    def _chances(self, scores: Floats) -> Floats:
        if not self.is_logit:
            return scores[:, : self.classes]
        if self.layout.name == "detr":
            powers = np.exp(scores - scores.max(axis=1, keepdims=True))
            return np.asarray((powers / powers.sum(axis=1, keepdims=True))[:, : self.classes])
        return np.asarray(1 / (1 + np.exp(-np.clip(scores[:, : self.classes], -60, 60))))


def recognise(
    outputs: Outputs, size: tuple[int, int], classes: int, said: str | None = None
) -> Reading:
    """Return how to read a network, by what it gave for a grey picture.

    size: height and width of its input. classes: how many it has names for. said: the layout's
    name, where the person knows it. Raises BadInput where no layout fits or two do, with the
    shapes that were found and what would do.
    """
    tables = [number for number, each in enumerate(outputs) if each.ndim == 3]
    found = [
        *_of_two(outputs, tables, size, classes),
        *_of_one(outputs, tables, size, classes),
    ]
    fitting = [reading for reading in found if said in (None, reading.layout.name)]
    if not fitting and found:
        raise BadInput(
            f"the model's output {_shapes(outputs)} has not the layout {said!r} with {classes} "
            f"classes; it would be {found[0].layout.name}"
        )
    if not fitting:
        raise BadInput(_unknown(outputs, tables, classes))
    first, names = fitting[0], [reading.layout.name for reading in fitting]
    if "end2end" in names and first.layout.name != "end2end":  # nothing grey tells these apart
        raise BadInput(
            f"the model's output {_shapes(outputs)} may be of the layout {first.layout.name} or "
            "end2end: say which (layout=...)"
        )
    return first


def _of_two(
    outputs: Outputs, tables: Sequence[int], size: tuple[int, int], classes: int
) -> Iterator[Reading]:
    """Yield the readings with boxes in one output, and classes in another.

    With three or four classes both are as wide; what has numbers below zero is no box.
    """
    for boxes in sorted(tables, key=lambda number: bool((outputs[number] < 0).any())):
        for scores in tables:
            more = outputs[scores].shape[2] - classes
            alike = outputs[boxes].shape[1] == outputs[scores].shape[1]
            if boxes == scores or not alike or outputs[boxes].shape[2] != 4 or more not in (0, 1):
                continue
            layout = LAYOUTS["detr" if more else "rtdetr"]
            reading = Reading(layout, classes, size, boxes, scores)
            yield replace(
                reading,
                is_share=_are_shares(reading.table(outputs[boxes])[:, :2]),
                is_logit=_are_logits(outputs[scores]),
            )


def _of_one(
    outputs: Outputs, tables: Sequence[int], size: tuple[int, int], classes: int
) -> Iterator[Reading]:
    """Yield the readings with all of a candidate in one piece; of two alike the likelier first."""
    # A network that outlines things as well has a number more for each of its masks.
    masks = sum(each.shape[1] for each in outputs if each.ndim == 4)
    for number in tables:
        rows, columns = outputs[number].shape[1:]
        for name, width in (("yolo8", classes + 4), ("yolo5", classes + 5), ("end2end", 6)):
            is_row = columns in (width, width + masks)
            is_column = rows in (width, width + masks) and name != "end2end"
            if is_row or is_column:
                reading = Reading(LAYOUTS[name], classes, size, number, number, not is_row)
                yield from _by_numbers(reading, reading.table(outputs[number]))


def _by_numbers(reading: Reading, table: Floats) -> Iterator[Reading]:
    """Yield the readings of one shape, as the numbers for a grey picture tell them apart."""
    centre = table[:, :2]
    if reading.layout.name == "end2end":
        yield replace(reading, is_share=_are_shares(table[:, :4]) and bool(table[:, :4].any()))
        return
    shares = _are_shares(centre)
    if reading.layout.name == "yolo8":
        is_logit = _are_logits(table[:, 4 : 4 + reading.classes])
        both = [LAYOUTS["yolo8"], LAYOUTS["rtdetr"]]
        # A few hundred rows of shares are a transformer's, whose pictures are not letterboxed.
        for layout in both[::-1] if shares and not reading.is_turned else both:
            yield replace(reading, layout=layout, is_share=shares, is_logit=is_logit)
        return
    on_grid = [
        replace(reading, layout=LAYOUTS["yolox"], grid=None if in_pixels else grid)
        for grid in _grids(reading.size)
        if len(grid) == len(table)
        for in_pixels in (float(np.median(centre)) > grid[:, 2].min(initial=1.0),)
    ]
    plain = replace(reading, is_share=shares)
    # YOLO v6 has kept the column of the objectness, and writes 1 there.
    yield from [plain, *on_grid] if bool((table[:, 4] == 1).all()) else [*on_grid, plain]


def _are_shares(places: Floats) -> bool:
    return bool(np.abs(places).max(initial=0.0) <= _MOST_SHARE)


def _are_logits(scores: NDArray[Any]) -> bool:
    """Say whether they cannot be chances: some are below 0, or above 1."""
    return bool(scores.min(initial=0.0) < 0 or scores.max(initial=0.0) > 1)


def _grids(size: tuple[int, int]) -> Iterator[Floats]:
    """Yield (n, 3) column, row and stride of each cell, row by row, the finest grid first."""
    height, width = size
    for strides in _STRIDES:
        cells = []
        for stride in strides:
            rows, columns = np.mgrid[0 : height // stride, 0 : width // stride]
            cells.append(np.stack([columns, rows, np.full_like(rows, stride)], axis=2))
        yield np.concatenate([each.reshape(-1, 3) for each in cells]).astype(np.float32)


def _shapes(outputs: Outputs) -> str:
    return " and ".join(shape_text(each.shape) for each in outputs)


def _unknown(outputs: Outputs, tables: Sequence[int], classes: int) -> str:
    """Return what was found, what would do, and for how many classes it would be something."""
    widths = sorted({min(outputs[number].shape[1:]) for number in tables})
    near = [
        f"{width} numbers a candidate would be {width - 4} classes (yolo8) or {width - 5} (yolo5, "
        "yolox)"
        for width in widths
        if width > 6
    ]
    hint = f" {'; '.join(near)}: is the list of classes the right one?" if near else ""
    return (
        f"the model's output {_shapes(outputs)} has no known layout with {classes} classes. "
        f"A candidate needs {classes + 4} numbers (yolo8), {classes + 5} (yolo5, yolox) or 6 "
        f"(end2end); or one output has 4 and another {classes} (rtdetr) or {classes + 1} (detr)."
        f"{hint}"
    )
