"""What an ONNX file says of its network: inputs, outputs and metadata, read without a library.

The file is a Protocol Buffers message, of which only a few fields are wanted. The weights are
skipped over.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from d3a.model import BadInput

_GRAPH, _METADATA = 7, 14  # of ModelProto
_INITIALIZER, _INPUT, _OUTPUT = 5, 11, 12  # of GraphProto
_TENSOR_NAME = 8  # of TensorProto
_NAME, _TYPE = 1, 2  # of ValueInfoProto
_TENSOR_TYPE, _SHAPE, _DIMENSION, _SIZE = 1, 2, 1, 1  # of TypeProto and what is in it
_KEY, _VALUE = 1, 2  # of StringStringEntryProto
_VARINT, _FIXED64, _BYTES, _FIXED32 = 0, 1, 2, 5
_MOST_SIZE = 1 << 20
"""A larger size of an input is a broken file's."""


@dataclass(frozen=True, slots=True)
class Tensor:
    """An input or an output: its name, and its sizes, None where the file leaves them open."""

    name: str
    shape: tuple[int | None, ...]

    def __str__(self) -> str:
        return shape_text(self.shape)


@dataclass(frozen=True, slots=True)
class OnnxFile:
    """The part of a model's file that says how to use it."""

    inputs: tuple[Tensor, ...]
    outputs: tuple[Tensor, ...]
    metadata: Mapping[str, str]


def shape_text(shape: tuple[int | None, ...]) -> str:
    """Return sizes as a person writes them: 1 x 3 x 640 x 640; an open one is a question mark."""
    return " x ".join("?" if size is None else str(size) for size in shape) or "a number"


def read_onnx(path: Path) -> OnnxFile:
    """Return what the file says; BadInput where there is none, or it is no ONNX model."""
    try:
        content = path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise BadInput(f"the model {path} cannot be read: {reason}") from error
    try:
        return _model(memoryview(content))
    except _WireError as error:
        raise BadInput(f"{path} is not an ONNX model, or not all of one ({error})") from error


class _WireError(ValueError):
    """The bytes are no such message."""


def _model(content: memoryview) -> OnnxFile:
    graph, metadata = None, {}
    for field, value in _fields(content):
        if field == _GRAPH and isinstance(value, memoryview):
            graph = value
        elif field == _METADATA and isinstance(value, memoryview):
            entry = dict(_fields(value))
            metadata[_text(entry.get(_KEY))] = _text(entry.get(_VALUE))
    if graph is None:
        raise _WireError("it holds no network")
    inputs, outputs, weights = [], [], set()
    for field, value in _fields(graph):
        if field == _INPUT:
            inputs.append(_tensor(_message(value)))
        elif field == _OUTPUT:
            outputs.append(_tensor(_message(value)))
        elif field == _INITIALIZER:
            weights.add(_text(dict(_fields(_message(value))).get(_TENSOR_NAME)))
    # Older files list the weights among the inputs.
    return OnnxFile(tuple(t for t in inputs if t.name not in weights), tuple(outputs), metadata)


def _tensor(content: memoryview) -> Tensor:
    fields = dict(_fields(content))
    kind = dict(_fields(_message(fields.get(_TYPE, memoryview(b"")))))
    tensor = dict(_fields(_message(kind.get(_TENSOR_TYPE, memoryview(b"")))))
    shape = _message(tensor.get(_SHAPE, memoryview(b"")))
    sizes = [
        dict(_fields(_message(value))).get(_SIZE)
        for field, value in _fields(shape)
        if field == _DIMENSION
    ]
    named = tuple(s if isinstance(s, int) and 0 < s <= _MOST_SIZE else None for s in sizes)
    return Tensor(_text(fields.get(_NAME)), named)


def _fields(content: memoryview) -> Iterator[tuple[int, int | memoryview]]:
    """Yield (field's number, value) of a message, in its order."""
    at = 0
    while at < len(content):
        key, at = _varint(content, at)
        kind, size = key & 7, 0
        if kind == _VARINT:
            value, at = _varint(content, at)
            yield key >> 3, value
            continue
        if kind == _BYTES:
            size, at = _varint(content, at)
        elif kind in (_FIXED64, _FIXED32):
            size = 8 if kind == _FIXED64 else 4
        else:
            raise _WireError(f"an unknown kind of field at byte {at}")
        if at + size > len(content):
            raise _WireError("it ends too early")
        yield key >> 3, content[at : at + size]
        at += size


def _varint(content: memoryview, at: int) -> tuple[int, int]:
    """Return a number of seven bits a byte, and where the next thing begins."""
    value = 0
    for shift in range(0, 70, 7):
        if at >= len(content):
            raise _WireError("it ends too early")
        byte = content[at]
        at += 1
        value |= (byte & 0x7F) << shift
        if byte < 0x80:
            return value, at
    raise _WireError("a number without an end")


def _message(value: int | memoryview) -> memoryview:
    if isinstance(value, int):
        raise _WireError("a number where a message should be")
    return value


def _text(value: int | memoryview | None) -> str:
    return bytes(value).decode("utf-8", "replace") if isinstance(value, memoryview) else ""
