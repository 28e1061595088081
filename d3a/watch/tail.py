"""The end of a file that somebody writes to: whole lines, and rows of a matrix."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from d3a.model import BadInput

AT_ONCE = 1 << 22
"""Bytes read at one look: a backlog comes in parts, and the frames in it are taken meanwhile."""


class Tail:
    """Gives a growing file's lines, each once it is whole; there may be no file yet."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._offset = 0
        self._rest = b""
        self._number = 0

    def lines(self, at_once: int | None = AT_ONCE) -> list[tuple[int, str]]:
        """Return (number from 0, line) of what is new; at_once: bytes to read, None for all.

        Raises BadInput for a file that has got shorter: its numbers no longer mean the same.
        """
        try:
            with self._path.open("rb") as file:
                size = file.seek(0, 2)
                if size < self._offset:
                    raise BadInput(f"{self._path.name} got shorter while it was followed")
                file.seek(self._offset)
                content = file.read() if at_once is None else file.read(at_once)
        except FileNotFoundError:
            return []
        except OSError as error:
            raise BadInput(f"{self._path.name} cannot be read: {error.strerror}") from error
        self._offset += len(content)
        *whole, self._rest = (self._rest + content).split(b"\n")
        return self._numbered(whole)

    def last(self) -> list[tuple[int, str]]:
        """Return what stands after the last line's end, as a line, where no more will come."""
        rest, self._rest = self._rest, b""
        return self._numbered([rest]) if rest else []

    def _numbered(self, lines: list[bytes]) -> list[tuple[int, str]]:
        start, self._number = self._number, self._number + len(lines)
        decoded = (line.decode("utf-8", errors="replace") for line in lines)
        return [(start + n, line) for n, line in enumerate(decoded)]


class GrowingRows:
    """The rows of an `.npy` file that is there in part; its header may promise less or more.

    It is read with every row and never mapped: a file that is written anew under a map would end
    the process.
    """

    def __init__(self, path: Path, check: Callable[[int], None]) -> None:
        """check: raises BadInput for a number of numbers in a row that cannot be."""
        self._path = path
        self._check = check

    def __len__(self) -> int:
        """Return how many rows lie there now; 0 for a file that is not there, or just begun."""
        layout = self._layout()
        return 0 if layout is None else layout[2]

    def __getitem__(self, row: int) -> NDArray[np.float32]:
        """Return a row (dim,)."""
        layout = self._layout()
        if layout is None or not 0 <= row < layout[2]:
            raise IndexError(row)
        start, dim, _ = layout
        with self._path.open("rb") as file:
            file.seek(start + row * dim * 4)
            return np.frombuffer(file.read(dim * 4), np.float32)

    def _layout(self) -> tuple[int, int, int] | None:
        """Return where the rows start, numbers in a row, and the rows that lie there."""
        try:
            with self._path.open("rb") as file:
                version = np.lib.format.read_magic(file)
                read = (
                    np.lib.format.read_array_header_1_0
                    if version == (1, 0)
                    else np.lib.format.read_array_header_2_0
                )
                shape, is_fortran, kind = read(file)
                start, size = file.tell(), file.seek(0, 2)
        except (OSError, ValueError):  # not there, or not written to the end of its header
            return None
        if len(shape) != 2 or kind != np.float32 or is_fortran or shape[1] == 0:
            raise BadInput(f"{self._path.name} must be float32 (n, dim), not {kind} {shape}")
        self._check(int(shape[1]))
        return start, int(shape[1]), (size - start) // (int(shape[1]) * 4)
