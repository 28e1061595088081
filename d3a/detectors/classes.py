"""The names of a network's classes: from a file of the person's, or from the model's own."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from d3a.detectors.onnx_file import OnnxFile
from d3a.model import BadInput
from d3a.readers.base import Skipped
from d3a.readers.parsing import category_of

UNUSED = frozenset({"-", "N/A"})
"""What stands for a number that the network never means; lists of COCO's 91 have some."""
MOST_CHARACTERS = 1 << 20


def class_names(model: Path, file: OnnxFile, names: Path | None) -> tuple[str, ...]:
    """Return the name of each class, "" for one that is not used.

    names: a file with a name a line, which wins; else the model's metadata (`names`, as YOLO's
    exporters write it). Raises BadInput where neither has them, or a name is none.
    """
    if names is not None:
        return tuple(_name(line, f"{names.name}:{n + 1}") for n, line in enumerate(_lines(names)))
    written = file.metadata.get("names")
    if written is None:
        raise BadInput(
            f"{model.name} does not say what its classes are called: give --classes FILE with a "
            "name a line, in the order of its numbers"
        )
    return tuple(_name(each, f"{model.name}: names") for each in _listed(model, written))


def _lines(path: Path) -> list[str]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"{path.name} cannot be read as text: {error}") from error
    lines = text.rstrip().splitlines()
    if not lines:
        raise BadInput(f"{path.name} names no class: a name a line would do")
    return lines


def _listed(model: Path, written: str) -> list[Any]:
    """Return the names of a list, or of a dictionary by their numbers: {0: 'person', 1: ...}."""
    try:
        value = ast.literal_eval(written) if len(written) <= MOST_CHARACTERS else None
    except (ValueError, SyntaxError, MemoryError, RecursionError):
        value = None
    if isinstance(value, Mapping):
        value = [value.get(number) for number in range(len(value))]
    if not isinstance(value, list | tuple) or not value:
        raise BadInput(
            f"the names in {model.name} cannot be read: give --classes FILE with a name a line"
        )
    return list(value)


def _name(value: Any, where: str) -> str:
    if isinstance(value, str) and value.strip() in UNUSED:
        return ""
    try:
        return category_of(value, Skipped(), where)
    except BadInput as error:
        raise BadInput(f"{where}: {error}") from error
