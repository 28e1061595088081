"""Embeddings that a recording brings along: what kind they are, and a row of them.

A whole file of another kind than `recording.json` says is refused before anything is stored; one
broken row costs its detection the look.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from d3a.colours.looks import HISTOGRAM_MODEL, HISTOGRAM_SIZE
from d3a.images import unit
from d3a.model import BadInput
from d3a.readers.parsing import clean_text
from d3a.store.limits import MAX_EMBEDDING, MIN_EMBEDDING

EMBEDDINGS = "embeddings.npy"


class Vectors(Protocol):
    """Embeddings by row: an array (n, dim), or a file of them that grows."""

    def __len__(self) -> int:
        """Return how many rows there are."""
        ...

    def __getitem__(self, row: int, /) -> NDArray[np.float32]:
        """Return a row (dim,)."""
        ...


@dataclass(frozen=True, slots=True)
class EmbeddingFacts:
    """What a recording says of its embeddings; where it says nothing they are histograms.

    name: of the model, None where it is not said. dim: numbers in a row, None where any will do.
    file: where it is said.
    """

    name: str | None
    dim: int | None
    file: str

    @classmethod
    def of(cls, record: Any, file: str) -> EmbeddingFacts:
        """Return the facts of `{"name": ..., "dim": ...}` or null; BadInput for anything else."""
        if record is None:
            return cls(None, HISTOGRAM_SIZE, file)
        if not isinstance(record, dict):
            raise BadInput(f"{file}: embedding must be an object with name and dim, or null")
        name, dim = record.get("name"), record.get("dim")
        if not isinstance(name, str) or not clean_text(name):
            raise BadInput(f"{file}: embedding.name must be text, not {name!r}")
        name = clean_text(name)
        if dim is not None and (isinstance(dim, bool) or not isinstance(dim, int)):
            raise BadInput(f"{file}: embedding.dim must be a whole number, not {dim!r}")
        if name == HISTOGRAM_MODEL and dim not in (None, HISTOGRAM_SIZE):
            raise BadInput(
                f"{file}: embedding.dim is {dim}, and {name} has {HISTOGRAM_SIZE} numbers"
            )
        return cls(name, HISTOGRAM_SIZE if name == HISTOGRAM_MODEL else dim, file)

    @property
    def is_histogram(self) -> bool:
        """Whether the rows are counts of colours."""
        return self.name in (None, HISTOGRAM_MODEL)

    def check(self, width: int) -> None:
        """Raise BadInput for rows of another width than was said, or than a store keeps."""
        has = f"{EMBEDDINGS} has {width} numbers a row"
        if self.name is None and width != self.dim:
            would = '"embedding": {"name": "my-model", "dim": %d}' % width  # noqa: UP031  braces
            raise BadInput(f"{has}, and {self.file} does not say of what: {would} would do")
        if self.dim is not None and width != self.dim:
            raise BadInput(
                f"{has}, and {self.file} says {self.dim} ({self.name}): mend the one that is "
                f"wrong, or take {EMBEDDINGS} away to have looks made from the pictures"
            )
        if not MIN_EMBEDDING <= width <= MAX_EMBEDDING:
            raise BadInput(f"{has}; a store keeps {MIN_EMBEDDING} to {MAX_EMBEDDING}")

    def read(self, folder: Path) -> NDArray[np.float32] | None:
        """Return the file's rows (n, dim), mapped; None where there is none."""
        path = folder / EMBEDDINGS
        if not path.is_file():
            return None
        try:
            matrix = np.load(path, mmap_mode="r", allow_pickle=False)
        except (OSError, ValueError, EOFError) as error:
            raise BadInput(f"{EMBEDDINGS} is not an array of numbers: {error}") from error
        if matrix.ndim != 2 or matrix.dtype != np.float32:
            raise BadInput(
                f"{EMBEDDINGS} must be float32 (n, dim), not {matrix.dtype} {matrix.shape}"
            )
        if len(matrix) > 0:
            self.check(matrix.shape[1])
        return np.asarray(matrix)

    def vector(self, row: Any, vectors: Vectors | None) -> NDArray[np.float32] | None:
        """Return the row that a detection names at unit length, None for null.

        BadInput where there is no such row, or it is no look.
        """
        if row is None:
            return None
        if vectors is None:
            raise BadInput(f"it names an embedding, and there is no {EMBEDDINGS}")
        if isinstance(row, bool) or not isinstance(row, int) or not 0 <= row < len(vectors):
            raise BadInput(f"embedding {row!r} is no row of {EMBEDDINGS}")
        vector = np.array(vectors[row])
        if not np.isfinite(vector).all() or not vector.any():
            raise BadInput(f"embedding {row} is zero or not finite")
        if self.is_histogram and (vector < 0).any():
            raise BadInput(f"embedding {row} counts fewer than no pixels of a colour")
        return unit(vector)
