"""Choose a detector by its name: the recorded boxes, a model's file, or a plug-in."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from d3a import plugins
from d3a.detectors.base import Detector
from d3a.images import Pixels
from d3a.model import BadInput, Detection, Frame
from d3a.readers.base import Skipped
from d3a.readers.parsing import category_of

RECORDED = "recorded"
BUILT_IN = (RECORDED,)


def open_detector(name: str, options: Mapping[str, str] | None = None) -> Detector | None:
    """Return the detector of that name: the path of an ONNX model, or a plug-in's.

    None for `recorded`: the boxes that come with the recording. Raises BadInput for a name that is
    none of them, and for a model or plug-in that does not work.
    """
    given = dict(options or {})
    if name == RECORDED:
        if given:
            raise BadInput(f"recorded boxes take no option, and {sorted(given)[0]!r} is one")
        return None
    if name.casefold().endswith(".onnx"):
        from d3a.detectors.onnx import OnnxDetector

        return OnnxDetector(Path(name), given)
    made = plugins.load(plugins.DETECTORS, name, given, BUILT_IN)
    kind = _BatchPlugin if callable(getattr(made, "detect_all", None)) else _Plugin
    return kind(name, made, given)


class _Plugin:
    """A detector of another package: its mistakes become sentences."""

    def __init__(self, entry: str, made: Any, options: Mapping[str, str]) -> None:
        self._opened = (entry, dict(options))
        self._what = f"the detector {entry!r}"
        self._made = made
        if not callable(getattr(made, "detect", None)):
            raise BadInput(f"{self._what} has no method detect(frame, pixels)")
        classes = getattr(made, "classes", ())
        if isinstance(classes, str) or not isinstance(classes, Iterable):
            raise BadInput(f"{self._what} has classes that are no list of names")
        self.classes = tuple(category_of(each, Skipped(), self._what) for each in classes)
        said = json.dumps(options, sort_keys=True, ensure_ascii=False)
        version = plugins.version_of(plugins.DETECTORS, entry)
        self.identity = " ".join(filter(None, (entry, version, said if options else "")))

    def __reduce__(self) -> tuple[object, ...]:
        """Make the plug-in anew in another process, where its parts may not be sent."""
        return open_detector, self._opened

    def __str__(self) -> str:
        return f"{self.identity}: {len(self.classes) or 'unknown'} classes"

    def detect(self, frame: Frame, pixels: Pixels | None) -> tuple[Detection, ...]:
        """Return what the plug-in finds; BadInput where it fails or gives something else."""
        with self._told(frame):
            found = tuple(self._made.detect(frame, pixels))
        return tuple(self._clean(each) for each in found)

    @contextmanager
    def _told(self, frame: Frame) -> Iterator[None]:
        try:
            yield
        except Exception as error:
            what = f"{self._what} on frame {frame.name}"
            raise BadInput(plugins.failure(what, error)) from error

    def _clean(self, found: Any) -> Detection:
        if not isinstance(found, Detection):
            raise BadInput(f"{self._what} gave {type(found).__name__}, not d3a.model.Detection")
        category = category_of(found.category, Skipped(), self._what)
        return replace(found, category=category, embedding=None, row=None)


class _BatchPlugin(_Plugin):
    """A detector of another package that takes several frames at once."""

    def __init__(self, entry: str, made: Any, options: Mapping[str, str]) -> None:
        super().__init__(entry, made, options)
        self.batch: int = getattr(made, "batch", 0)
        if not isinstance(self.batch, int) or self.batch < 1:
            raise BadInput(f"{self._what} has detect_all, and no batch of 1 or more")

    def detect_all(
        self, frames: Sequence[Frame], pictures: Sequence[Pixels | None]
    ) -> list[tuple[Detection, ...]]:
        """Return what the plug-in finds in each frame; BadInput as `detect`."""
        if not frames:
            return []
        with self._told(frames[0]):
            found = [tuple(each) for each in self._made.detect_all(frames, pictures)]
        if len(found) != len(frames):
            raise BadInput(f"{self._what} gave {len(found)} answers for {len(frames)} frames")
        return [tuple(self._clean(one) for one in each) for each in found]
