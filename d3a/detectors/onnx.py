"""Networks in ONNX files, run by OpenCV: the network itself, and the detector made of one."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from d3a.detectors.classes import class_names
from d3a.detectors.feeding import FITS, PIXELS, RGB_1, Feeding, Placement
from d3a.detectors.layouts import LAYOUTS, Candidates, recognise
from d3a.detectors.onnx_file import OnnxFile, read_onnx, shape_text
from d3a.detectors.suppression import suppressed
from d3a.images import Pixels
from d3a.model import BadInput, Detection, Frame
from d3a.readers.options import Options

Floats = NDArray[np.float32]
USUAL_THRESHOLD = 0.25
USUAL_OVERLAP = 0.5
MOST_CANDIDATES = 3000
"""Of so many candidates the best are looked at; no picture shows that many things."""
NETWORK_OPTIONS: Mapping[str, str] = {
    "size": "WIDTHxHEIGHT of the input in pixels, where the file leaves it open",
    "pixels": ", ".join(PIXELS) + ": what the network is shown",
    "fit": ", ".join(FITS) + ": how a picture of another shape is put into the input",
    "batch": "how many pictures at once, where the file leaves it open",
    "threads": "how many processor threads OpenCV uses",
}
DETECTOR_OPTIONS: Mapping[str, str] = {
    **NETWORK_OPTIONS,
    "classes": "FILE with the name of each class, a line each, in the network's order",
    "threshold": f"least score of a detection ({USUAL_THRESHOLD})",
    "overlap": f"boxes of a class that share more are one thing ({USUAL_OVERLAP})",
    "layout": ", ".join(LAYOUTS) + ": how the network writes boxes down; else found by looking",
}


class Network:
    """A network in a file: pictures of one size in, arrays out.

    Raises BadInput for a file that is not there or no model, one whose input is no colour picture,
    and one that OpenCV cannot run.
    """

    def __init__(self, path: Path, options: Options) -> None:
        self.path = path
        self.file: OnnxFile = read_onnx(path)
        self.size, self.batch = _input_of(path, self.file, options)
        threads = options.text("threads")
        if threads is not None:
            cv2.setNumThreads(_count(threads, "threads"))
        try:
            self._net = cv2.dnn.readNetFromONNX(str(path))
        except cv2.error as error:
            raise BadInput(f"OpenCV cannot load {path}: {_reason(error)}") from error
        # OpenCV's own names are the file's, which are in the file's order only there
        self._names = [tensor.name for tensor in self.file.outputs]

    def fingerprint(self, *details: object) -> str:
        """Return eight characters that tell this file, used in this way, from any other."""
        digest = hashlib.sha256(self.path.read_bytes())
        digest.update(repr(details).encode())
        return digest.hexdigest()[:8]

    def run(self, inputs: Floats) -> list[NDArray[Any]]:
        """Return the outputs for inputs (n, 3, h, w), n at most `batch`, in the file's order.

        Each output has a row per input first. Raises BadInput where the network fails.
        """
        count = len(inputs)
        if count < self.batch:  # a network of a fixed batch wants all of it
            inputs = np.concatenate([inputs, np.repeat(inputs[-1:], self.batch - count, axis=0)])
        try:
            self._net.setInput(np.ascontiguousarray(inputs))
            outputs = [np.asarray(each) for each in self._net.forward(self._names)]
        except cv2.error as error:
            raise BadInput(
                f"OpenCV cannot run {self.path.name} on {shape_text(inputs.shape)}: "
                f"{_reason(error)}"
            ) from error
        for each in outputs:
            if each.ndim > 1 and each.shape[0] != self.batch:
                raise BadInput(
                    f"{self.path.name} gives {shape_text(each.shape)} for {self.batch} pictures: "
                    "it takes one at a time (batch=1)"
                )
        return [each[:count] if each.ndim > 1 else each for each in outputs]


def _input_of(path: Path, file: OnnxFile, options: Options) -> tuple[tuple[int, int], int]:
    """Return (height, width) of a network's input, and how many pictures it takes at once."""
    shapes = " and ".join(str(tensor) for tensor in file.inputs) or "nothing"
    if len(file.inputs) != 1 or len(file.inputs[0].shape) != 4 or file.inputs[0].shape[1] != 3:
        raise BadInput(
            f"{path.name} takes {shapes}; a colour picture would be 1 x 3 x height x width"
        )
    number, _, height, width = file.inputs[0].shape
    size = options.text("size")
    if size is not None:
        wide, by, high = size.partition("x")
        given = (_count(high if by else "", "size"), _count(wide, "size"))
        if (height or given[0], width or given[1]) != given:
            raise BadInput(f"{path.name} takes pictures of {width} x {height} only, not {size}")
        height, width = given
    if height is None or width is None:
        raise BadInput(
            f"{path.name} leaves the size of its input open ({shapes}): say it, as in size=640x640"
        )
    batch = _count(options.text("batch") or str(number or 1), "batch")
    if number is not None and batch != number:
        raise BadInput(f"{path.name} takes {number} picture(s) at a time, not {batch}")
    return (height, width), batch


def _count(text: str, name: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = 0
    if not 0 < value <= 1 << 14:
        example = "640x480" if name == "size" else "a whole number above 0"
        raise BadInput(f"the option {name} has {text!r}; {example} would do")
    return value


def _reason(error: cv2.error) -> str:
    """Return OpenCV's own reason as one line."""
    return " ".join(str(error.err or error).split())[:200]


def feeding_of(network: Network, options: Options, *, pixels: str = RGB_1, fit: str) -> Feeding:
    """Return what the network is shown, as the person says, else as is usual for its kind."""
    said = options.choice("pixels", PIXELS)
    return Feeding(network.size, said or pixels, options.choice("fit", FITS) or fit)


class OnnxDetector:
    """Looks at pictures with a network; boxes, class names and least score as the options say."""

    def __init__(self, path: Path, given: Mapping[str, str] | None = None) -> None:
        """Load a model; see DETECTOR_OPTIONS. Raises BadInput as `Network` and `recognise`."""
        self._given = dict(given or {})
        options = Options(
            path, given, known=DETECTOR_OPTIONS, reader=f"the detector {path.name}", common={}
        )
        self._threshold = _share(options, "threshold", USUAL_THRESHOLD)
        self._overlap = _share(options, "overlap", USUAL_OVERLAP)
        said = options.choice("layout", LAYOUTS)
        self._network = Network(path, options)
        self._names = class_names(path, self._network.file, options.file("classes"))
        grey = Feeding(self._network.size).grey()
        outputs = self._network.run(grey[None])
        try:
            self._reading = recognise(outputs, self._network.size, len(self._names), said)
        except BadInput as error:
            raise BadInput(f"{path.name}: {error}") from error
        layout = self._reading.layout
        self._feeding = feeding_of(self._network, options, pixels=layout.pixels, fit=layout.fit)
        self.classes = tuple(dict.fromkeys(name for name in self._names if name))
        self.batch = self._network.batch
        details = (self._feeding, layout.name, self._threshold, self._overlap, self._names)
        self.identity = f"{path.name} {self._network.fingerprint(*details)}"
        """The file and its settings, so that a recording is not looked at in two ways."""

    def __reduce__(self) -> tuple[object, ...]:
        """Load the model anew in another process: OpenCV's networks cannot be sent there."""
        return OnnxDetector, (self._network.path, self._given)

    def __str__(self) -> str:
        height, width = self._feeding.size
        return (
            f"{self.identity}: layout {self._reading.layout.name}, {len(self.classes)} classes, "
            f"input {width} x {height} {self._feeding.pixels}, {self._feeding.fit}, "
            f"threshold {self._threshold:g}"
        )

    def detect(self, frame: Frame, pixels: Pixels | None) -> tuple[Detection, ...]:
        """Return what is seen, the likeliest first; () without a picture."""
        return self.detect_all([frame], [pixels])[0]

    def detect_all(
        self, frames: Sequence[Frame], pictures: Sequence[Pixels | None]
    ) -> list[tuple[Detection, ...]]:
        """Return what is seen in each frame; `batch` pictures go through the network at once."""
        found: list[tuple[Detection, ...]] = [()] * len(frames)
        placed = [
            (n, self._feeding.place(each)) for n, each in enumerate(pictures) if each is not None
        ]
        for start in range(0, len(placed), self.batch):
            part = placed[start : start + self.batch]
            outputs = self._network.run(np.stack([inputs for _, (inputs, _) in part]))
            for which, (number, (_, placement)) in enumerate(part):
                candidates = self._reading.candidates(outputs, which)
                found[number] = self._detections(candidates, placement)
        return found

    def _detections(self, candidates: Candidates, placement: Placement) -> tuple[Detection, ...]:
        scores = np.where(np.isfinite(candidates.scores), candidates.scores, 0.0)
        kinds = scores.argmax(axis=1)
        best = scores[np.arange(len(scores)), kinds]
        rows = np.flatnonzero((best >= self._threshold) & np.isfinite(candidates.boxes).all(axis=1))
        rows = rows[np.argsort(-best[rows], kind="stable")][:MOST_CANDIDATES]
        boxes = placement.back(candidates.boxes[rows])
        large = ((boxes[:, 2:] - boxes[:, :2]) >= 1).all(axis=1)
        rows, boxes = rows[large], boxes[large]
        if self._reading.layout.overlaps:
            kept = suppressed(boxes, kinds[rows], self._overlap)
            rows, boxes = rows[kept], boxes[kept]
        return tuple(
            Detection(name, float(min(best[row], 1.0)), (x1, y1, x2, y2))
            for row, (x1, y1, x2, y2) in zip(rows.tolist(), boxes.tolist(), strict=True)
            if (name := self._names[kinds[row]])
        )


def _share(options: Options, name: str, usual: float) -> float:
    value = options.positive(name, usual)
    if value > 1:
        raise BadInput(f"the option {name} must be at most 1, not {value:g}")
    return value
