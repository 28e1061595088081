"""An image network as an embedder: what it says of a crop, as one vector."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from d3a.detectors.feeding import IMAGENET, STRETCH
from d3a.detectors.onnx import NETWORK_OPTIONS, Network, feeding_of
from d3a.images import Pixels
from d3a.model import BadInput
from d3a.readers.options import Options

EMBEDDER_OPTIONS: Mapping[str, str] = {
    **NETWORK_OPTIONS,
    "output": "NAME of the output to take, where there are several; else the first",
}


class OnnxEmbedder:
    """Crops through a network; its output, flattened, is the embedding.

    Usual image networks are trained on pictures less ImageNet's mean, stretched to a square; the
    options `pixels` and `fit` say otherwise.
    """

    def __init__(self, path: Path, given: Mapping[str, str] | None = None) -> None:
        """Load a model; see EMBEDDER_OPTIONS. Raises BadInput as `Network`."""
        self._given = dict(given or {})
        options = Options(
            path, given, known=EMBEDDER_OPTIONS, reader=f"the embedder {path.name}", common={}
        )
        self._network = Network(path, options)
        self._feeding = feeding_of(self._network, options, pixels=IMAGENET, fit=STRETCH)
        names = [tensor.name for tensor in self._network.file.outputs]
        output = options.text("output") or names[0]
        if output not in names:
            raise BadInput(f"{path.name} has no output {output!r}; it has {', '.join(names)}")
        self._output = names.index(output)
        self.name = f"{path.stem}-{self._network.fingerprint(self._feeding, output)}"
        (self._length,) = self._vectors([self._feeding.grey()]).shape[1:]

    def __reduce__(self) -> tuple[object, ...]:
        """Load the model anew in another process: OpenCV's networks cannot be sent there."""
        return OnnxEmbedder, (self._network.path, self._given)

    def __str__(self) -> str:
        height, width = self._feeding.size
        return (
            f"{self.name}: {self._length} numbers, input {width} x {height} "
            f"{self._feeding.pixels}, {self._feeding.fit}"
        )

    def embed(self, crops: Sequence[Pixels]) -> NDArray[np.float32]:
        """Return the network's output for each crop, (n, d)."""
        placed = [self._feeding.place(crop)[0] for crop in crops]
        size = self._network.batch
        parts = [self._vectors(placed[at : at + size]) for at in range(0, len(placed), size)]
        return np.concatenate(parts) if parts else np.zeros((0, self._length), dtype=np.float32)

    def _vectors(self, inputs: Sequence[NDArray[np.float32]]) -> NDArray[np.float32]:
        output = self._network.run(np.stack(inputs))[self._output]
        return np.asarray(output, dtype=np.float32).reshape(len(inputs), -1)
