"""The options of a command that looks at pictures itself: which detector, which embedder."""

from __future__ import annotations

from collections.abc import Callable, MutableMapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from d3a.detectors.base import Detector
    from d3a.embedders.base import Embedder

_Function = TypeVar("_Function", bound=Callable[..., Any])
_OPTIONS = (
    click.option(
        "--detector",
        metavar="MODEL",
        help="What looks at the pictures: a file model.onnx, a plug-in's name, or recorded. "
        "It replaces recorded boxes.",
    ),
    click.option(
        "--classes",
        metavar="FILE",
        help="Names of the detector's classes, one a line; else the model's own.",
    ),
    click.option(
        "--detector-threshold",
        type=click.FloatRange(0, 1, min_open=True),
        help="The detector says nothing below this probability (0.25).",
    ),
    click.option(
        "--detector-option",
        "detector_options",
        multiple=True,
        metavar="KEY=VALUE",
        help="Tell the detector something, such as layout=yolox, overlap=0.5, threads=2, batch=4.",
    ),
    click.option(
        "--embedder",
        metavar="MODEL",
        help="What compares looks: a file model.onnx, a plug-in's name, or rgb-8x8x8.",
    ),
    click.option(
        "--embedder-option",
        "embedder_options",
        multiple=True,
        metavar="KEY=VALUE",
        help="Tell the embedder something, such as pixels=rgb-1, fit=centre, threads=2.",
    ),
)


def detector_options(function: _Function) -> _Function:
    """Give a command the options of a detector and an embedder; see `Looking.taken_from`."""
    for option in reversed(_OPTIONS):
        function = option(function)
    return function


@dataclass(frozen=True, slots=True)
class Looking:
    """What is to look at the pictures, as it stands on the command line."""

    detector: str | None = None
    classes: str | None = None
    detector_threshold: float | None = None
    detector_options: tuple[str, ...] = ()
    embedder: str | None = None
    embedder_options: tuple[str, ...] = ()

    @classmethod
    def taken_from(cls, wished: MutableMapping[str, Any]) -> Looking:
        """Take these options out of a command's others."""
        return cls(**{each.name: wished.pop(each.name) for each in fields(cls)})

    def open_detector(self) -> Detector | None:
        """Return the detector, None for recorded boxes; BadInput where it cannot be used."""
        from d3a.detectors.opening import open_detector
        from d3a.model import BadInput
        from d3a.readers.options import key_values

        given = key_values(self.detector_options, "detector", "layout=yolox")
        said = {"classes": self.classes, "threshold": self.detector_threshold}
        for name, value in said.items():
            if value is not None:
                if name in given:
                    raise BadInput(f"the detector option {name!r} is given twice")
                given[name] = str(value)
        if self.detector is None:
            if given:
                raise BadInput(
                    f"{sorted(given)[0]!r} is of a detector: give --detector model.onnx too"
                )
            return None
        return open_detector(self.detector, given)

    def open_embedder(self) -> Embedder | None:
        """Return the embedder, None for what is usual; BadInput where it cannot be used."""
        from d3a.embedders.opening import open_embedder
        from d3a.model import BadInput
        from d3a.readers.options import key_values

        given = key_values(self.embedder_options, "embedder", "pixels=rgb-1")
        if self.embedder is None:
            if given:
                raise BadInput(
                    f"{sorted(given)[0]!r} is of an embedder: give --embedder model.onnx too"
                )
            return None
        return open_embedder(self.embedder, given)
