"""What an embedder is, and the colour histogram, which is the one that needs no model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from d3a import figure, images
from d3a.colours.looks import CARRIED, HISTOGRAM_MODEL, HISTOGRAM_SIZE
from d3a.images import Pixels
from d3a.model import BadInput, Box
from d3a.store.limits import MAX_EMBEDDING

Floats = NDArray[np.float32]
MOST_NUMBERS = MAX_EMBEDDING - HISTOGRAM_SIZE
CARRIED_LENGTH = 0.01
"""The length of a carried histogram: it adds 0.0001 to a cosine at most, and keeps its digits."""


class Embedder(Protocol):
    """Turns crops into vectors whose cosine says how alike two things look."""

    @property
    def name(self) -> str:
        """What tells its vectors from those of any other: a store holds one kind only."""
        ...

    def embed(self, crops: Sequence[Pixels]) -> Floats:
        """Return a row (n, d) for each crop (h, w, 3) RGB; d is always the same."""
        ...


@runtime_checkable
class InPlace(Protocol):
    """An embedder that tells a thing from its surroundings where it sees them."""

    def embed_in(self, pixels: Pixels, boxes: Sequence[Box]) -> Floats:
        """Return a row (n, d) for the thing in each box of a picture (h, w, 3) RGB."""
        ...


class HistogramEmbedder:
    """The paper's colour histogram, by which colour words are judged too.

    Of a crop it is that of all its pixels; in a picture that of the thing's own.
    """

    name = HISTOGRAM_MODEL

    def __str__(self) -> str:
        return self.name

    def embed(self, crops: Sequence[Pixels]) -> Floats:
        """Return the histograms (n, 512), unit length."""
        return np.array([images.histogram(each) for each in crops], dtype=np.float32).reshape(
            len(crops), HISTOGRAM_SIZE
        )

    def embed_in(self, pixels: Pixels, boxes: Sequence[Box]) -> Floats:
        """Return the histograms (n, 512) without the surroundings, unit length."""
        own = [figure.own_histogram(pixels, box) for box in boxes]
        return np.array(own, dtype=np.float32).reshape(len(boxes), HISTOGRAM_SIZE)


@dataclass(frozen=True, slots=True)
class WithColours:
    """Another embedder's vectors, which carry the histogram along so that colours can be told.

    Looks are compared by the embedder alone: what is carried is too short to count. Means of such
    vectors carry the mean histogram.
    """

    inner: Embedder

    @property
    def name(self) -> str:
        """The embedder's name, and what its vectors carry."""
        return self.inner.name + CARRIED

    def __str__(self) -> str:
        return str(self.inner)

    def embed(self, crops: Sequence[Pixels]) -> Floats:
        """Return (n, d + 512), unit length: the embedder's, then the histogram."""
        return self._carrying(HistogramEmbedder().embed(crops), crops)

    def embed_in(self, pixels: Pixels, boxes: Sequence[Box]) -> Floats:
        """Return (n, d + 512) as `embed` does, the histogram without the surroundings."""
        colours = HistogramEmbedder().embed_in(pixels, boxes)
        return self._carrying(colours, [images.crop(pixels, box) for box in boxes])

    def _carrying(self, colours: Floats, crops: Sequence[Pixels]) -> Floats:
        vectors = images.unit(checked(self.inner, self.inner.embed(crops), len(crops)))
        if vectors.shape[1] > MOST_NUMBERS:
            raise BadInput(
                f"the embedder {self.inner.name!r} gives {vectors.shape[1]} numbers; a store keeps "
                f"{MOST_NUMBERS} at most besides the colours"
            )
        share = np.float32(CARRIED_LENGTH)
        return np.concatenate([vectors * np.sqrt(1 - share**2), colours * share], axis=1)


def looks_in(
    embedder: Embedder, pixels: Pixels, boxes: Sequence[Box], *, own_pixels: bool
) -> Floats:
    """Return what an embedder gives for the boxes of a picture (n, d); BadInput as `checked`.

    own_pixels: without the surroundings, where the embedder can tell them.
    """
    if own_pixels and isinstance(embedder, InPlace):
        return checked(embedder, embedder.embed_in(pixels, boxes), len(boxes))
    crops = [images.crop(pixels, box) for box in boxes]
    return checked(embedder, embedder.embed(crops), len(crops))


def checked(embedder: Embedder, vectors: Floats, count: int) -> Floats:
    """Return what an embedder gave, as (n, d) of float32; BadInput where it is no such thing."""
    rows = np.asarray(vectors, dtype=np.float32)
    if rows.ndim != 2 or len(rows) != count or rows.shape[1] == 0:
        raise BadInput(
            f"the embedder {embedder.name!r} gave {' x '.join(map(str, rows.shape))} numbers for "
            f"{count} pictures; a row of at least one for each would do"
        )
    if not np.isfinite(rows).all():
        raise BadInput(f"the embedder {embedder.name!r} gave numbers that are not finite")
    return rows
