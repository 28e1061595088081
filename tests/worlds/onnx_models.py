"""Small networks that really find things by their colour, written as ONNX files by hand.

Every cell of a grid has a score for each colour: how much more of one channel there is than of the
others. Boxes are the cells, written down the way of each layout.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]
CLASSES: Mapping[str, tuple[float, float, float]] = {
    "cup": (1.0, -1.0, -1.0),
    "bowl": (-1.0, 1.0, -1.0),
    "book": (-1.0, -1.0, 1.0),
}
"""What is found: weights of red, green and blue."""
LAYOUTS = ("yolo8", "yolo8-rows", "yolo5", "yolox", "end2end", "detr", "rtdetr", "rtdetr-one")
CELL = 16
BIAS = -5.0


def varint(value: int) -> bytes:
    out = b""
    while value > 0x7F:
        out += bytes([value & 0x7F | 0x80])
        value >>= 7
    return out + bytes([value])


def field(number: int, value: bytes | str | int) -> bytes:
    if isinstance(value, int):
        return varint(number << 3) + varint(value)
    content = value.encode() if isinstance(value, str) else value
    return varint(number << 3 | 2) + varint(len(content)) + content


class Graph:
    """Nodes and weights of a network, in the order they are added."""

    def __init__(self) -> None:
        self._nodes = b""
        self._weights = b""
        self._count = 0

    def weight(self, values: NDArray[np.float32] | NDArray[np.int64]) -> str:
        name = self._name()
        kind = 7 if values.dtype == np.int64 else 1
        dims = b"".join(field(1, size) for size in values.shape)
        self._weights += field(
            5, dims + field(2, kind) + field(8, name) + field(9, values.tobytes())
        )
        return name

    def node(self, kind: str, *inputs: str, **attributes: int | Sequence[int]) -> str:
        name = self._name()
        content = b"".join(field(1, each) for each in inputs) + field(2, name) + field(4, kind)
        for key, value in attributes.items():
            if isinstance(value, int):
                body = field(1, key) + field(3, value) + field(20, 2)
            else:
                body = field(1, key) + b"".join(field(8, v) for v in value) + field(20, 7)
            content += field(5, body)
        self._nodes += field(1, content)
        return name

    def _name(self) -> str:
        self._count += 1
        return f"t{self._count}"

    def model(
        self,
        inputs: Mapping[str, Sequence[int | str]],
        outputs: Mapping[str, Sequence[int | str]],
        metadata: Mapping[str, str] | None = None,
    ) -> bytes:
        graph = self._nodes + field(2, "g") + self._weights
        graph += b"".join(field(11, value_of(*each)) for each in inputs.items())
        graph += b"".join(field(12, value_of(*each)) for each in outputs.items())
        said = b"".join(
            field(14, field(1, key) + field(2, value)) for key, value in (metadata or {}).items()
        )
        return field(1, 8) + field(7, graph) + field(8, field(2, 13)) + said


def value_of(name: str, shape: Sequence[int | str]) -> bytes:
    sizes = (field(1, size) if isinstance(size, int) else field(2, size) for size in shape)
    dims = b"".join(field(1, size) for size in sizes)
    return field(1, name) + field(2, field(1, field(1, 1) + field(2, dims)))


def finder(
    path: Path,
    layout: str = "yolo8",
    *,
    size: tuple[int, int] = (48, 64),
    batch: int = 1,
    names: str | None = None,
    objectness: float = 1.0,
    input_shape: Sequence[int | str] | None = None,
) -> Path:
    """Write a network that finds CLASSES in pictures of size (height, width), in cells of CELL.

    layout: of LAYOUTS. names: what the metadata says of the classes. input_shape: what the file
    says, where that is not so.
    """
    graph = Graph()
    strides = (8, 16, 32) if layout == "yolox" else (CELL,)
    parts = [_scores(graph, layout, stride) for stride in strides]
    scores = parts[0] if len(parts) == 1 else graph.node("Concat", *parts, axis=2)
    cells = np.concatenate([_cells(size, stride) for stride in strides])  # (n, 4) cx cy w h
    out = _written(graph, layout, scores, cells, (size, batch, objectness))
    metadata = {} if names is None else {"names": names}
    shape = input_shape or (batch, 3, *size)
    model = graph.model({"images": shape}, dict.fromkeys(out, (batch, "n", "k")), metadata)
    path.write_bytes(model)
    return path


def _scores(graph: Graph, layout: str, stride: int) -> str:
    """Add scores (b, c, n) of each cell for each class, as pictures of the layout have them."""
    colours = np.array(list(CLASSES.values()), dtype=np.float32)
    if layout == "yolox":  # blue, green, red, to 255
        colours = colours[:, ::-1] / np.float32(255)
    bias = np.zeros(len(colours), dtype=np.float32)
    if layout in ("detr", "rtdetr"):
        colours = colours * np.float32(20)
        bias += np.float32(BIAS)
    if layout == "detr":  # it is shown shares less a mean, over a deviation
        mean, deviation = np.array([[0.485, 0.456, 0.406], [0.229, 0.224, 0.225]], np.float32)
        bias += colours @ mean
        colours = colours * deviation
    kernel = np.repeat(colours / stride**2, stride**2, axis=1).reshape(-1, 3, stride, stride)
    found = graph.node(
        "Conv",
        "images",
        graph.weight(np.ascontiguousarray(kernel, dtype=np.float32)),
        graph.weight(bias.astype(np.float32)),
        strides=(stride, stride),
        kernel_shape=(stride, stride),
    )
    flat = graph.node(
        "Reshape", found, graph.weight(np.array([0, len(colours), -1], dtype=np.int64))
    )
    return flat if layout in ("detr", "rtdetr") else graph.node("Relu", flat)


def _cells(size: tuple[int, int], stride: int) -> Array:
    rows, columns = np.mgrid[0 : size[0] // stride, 0 : size[1] // stride]
    centres = (np.stack([columns.ravel(), rows.ravel()], axis=1) + 0.5) * stride
    return np.concatenate([centres, np.full_like(centres, stride)], axis=1).astype(np.float32)


def _written(
    graph: Graph,
    layout: str,
    scores: str,
    cells: Array,
    rest: tuple[tuple[int, int], int, float],
) -> list[str]:
    """Add what writes boxes (n, 4) and scores down; return the outputs."""
    (height, width), batch, objectness = rest
    unit = np.array([width, height, width, height], dtype=np.float32)
    shares = np.divide(cells, unit, dtype=np.float32)

    def constant(rows: Array) -> str:
        return graph.weight(np.ascontiguousarray(np.repeat(rows.T[None], batch, axis=0)))

    def turned(name: str) -> str:
        return graph.node("Transpose", name, perm=(0, 2, 1))

    def joined(*names: str, axis: int = 1) -> str:
        return graph.node("Concat", *names, axis=axis)

    def column(value: float) -> Array:
        return np.ones((count, 1), dtype=np.float32) * np.float32(value)

    count = len(cells)
    if layout == "yolo8":
        return [joined(constant(cells), scores)]
    if layout == "yolo8-rows":
        return [turned(joined(constant(cells), scores))]
    if layout == "rtdetr-one":
        return [turned(joined(constant(shares), scores))]
    if layout == "yolo5":
        certain = constant(column(objectness))
        return [turned(joined(constant(cells), certain, scores))]
    if layout == "yolox":  # half a cell right and down, as large as its cell
        raw = np.tile(np.array([[0.5, 0.5, 0.0, 0.0]], dtype=np.float32), (count, 1))
        sure = np.where(cells[:, 2:3] == CELL, objectness, 0.0).astype(np.float32)
        return [turned(joined(constant(raw), constant(sure), scores))]
    if layout == "detr":
        nothing = constant(column(0.0))
        return [turned(joined(scores, nothing)), turned(constant(shares))]
    if layout == "rtdetr":
        return [turned(constant(shares)), turned(scores)]
    corners = np.concatenate([cells[:, :2] - CELL / 2, cells[:, :2] + CELL / 2], axis=1)
    parts = []
    for number in range(len(CLASSES)):
        index = graph.weight(np.array([number], dtype=np.int64))
        own = graph.node("Gather", scores, index, axis=1)
        kind = constant(column(number))
        parts.append(joined(constant(corners.astype(np.float32)), own, kind))
    return [turned(joined(*parts, axis=2))]


def mean_colour(path: Path, side: int = 8, *, batch: int | str = 1, scale: float = 1.0) -> Path:
    """Write an embedder: the mean red, green and blue of a crop, 3 x 1 x 1."""
    graph = Graph()
    kernel = np.eye(3, dtype=np.float32)[:, :, None, None] * np.float32(scale / side**2)
    kernel = np.ascontiguousarray(np.tile(kernel, (1, 1, side, side)))
    out = graph.node("Conv", "crop", graph.weight(kernel), kernel_shape=(side, side))
    path.write_bytes(graph.model({"crop": (batch, 3, side, side)}, {out: (batch, 3, 1, 1)}))
    return path


def scene(
    things: Mapping[tuple[int, int], str], width: int = 64, height: int = 48, cell: int = CELL
) -> NDArray[np.uint8]:
    """A grey picture with a patch for each cell (column, row): red, green or blue."""
    paints = {"cup": (220, 30, 30), "bowl": (30, 220, 30), "book": (30, 30, 220)}
    pixels = np.full((height, width, 3), 114, dtype=np.uint8)
    for (column, row), category in things.items():
        pixels[row * cell : (row + 1) * cell, column * cell : (column + 1) * cell] = paints[
            category
        ]
    return pixels


def names_file(path: Path, names: Sequence[str] = tuple(CLASSES)) -> Path:
    path.write_text("".join(f"{name}\n" for name in names), encoding="utf-8")
    return path
