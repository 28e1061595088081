"""Choose an embedder by its name: the histogram, a model's file, or a plug-in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from d3a import plugins
from d3a.colours.looks import CARRIED, HISTOGRAM_MODEL
from d3a.embedders.base import Embedder, HistogramEmbedder, WithColours
from d3a.images import Pixels
from d3a.model import BadInput
from d3a.readers.parsing import clean_text

BUILT_IN = (HISTOGRAM_MODEL,)
MOST_NAME = 100


def open_embedder(name: str, options: Mapping[str, str] | None = None) -> Embedder:
    """Return the embedder of that name: `rgb-8x8x8`, the path of an ONNX model, or a plug-in's.

    All but the histogram carry the histogram along, so that colours can be asked for. Raises
    BadInput for a name that is none of them, and for a model or plug-in that does not work.
    """
    given = dict(options or {})
    if name == HISTOGRAM_MODEL:
        if given:
            raise BadInput(f"the embedder {name!r} has no options, and {sorted(given)[0]!r} is one")
        return HistogramEmbedder()
    if name.casefold().endswith(".onnx"):
        from d3a.embedders.onnx import OnnxEmbedder

        return WithColours(OnnxEmbedder(Path(name), given))
    return WithColours(_plugin(name, given))


def _plugin(entry: str, options: Mapping[str, str]) -> _Plugin:
    return _Plugin(entry, plugins.load(plugins.EMBEDDERS, entry, options, BUILT_IN), options)


class _Plugin:
    """An embedder of another package: its mistakes become sentences."""

    def __init__(self, entry: str, made: Any, options: Mapping[str, str]) -> None:
        self._entry, self._options = entry, dict(options)
        self._made = made
        self.name = clean_text(str(getattr(made, "name", "")))
        if not callable(getattr(made, "embed", None)):
            raise BadInput(f"the embedder {entry!r} has no method embed(crops)")
        if not self.name or len(self.name) > MOST_NAME:
            raise BadInput(f"the embedder {entry!r} has no name of 1 to {MOST_NAME} characters")
        if self.name.startswith("rgb-") or CARRIED in self.name:
            raise BadInput(
                f"the embedder {entry!r} calls itself {self.name!r}, which is a histogram's name"
            )

    def __reduce__(self) -> tuple[object, ...]:
        """Make the plug-in anew in another process, where its parts may not be sent."""
        return _plugin, (self._entry, self._options)

    def __str__(self) -> str:
        return self.name

    def embed(self, crops: Sequence[Pixels]) -> NDArray[np.float32]:
        """Return what the plug-in gives; BadInput where it fails."""
        try:
            return np.asarray(self._made.embed(crops), dtype=np.float32)
        except Exception as error:
            what = f"the embedder {self._entry!r}"
            raise BadInput(plugins.failure(what, error)) from error
