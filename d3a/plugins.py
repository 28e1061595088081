"""Detectors and embedders that other packages bring along, by their entry points.

A package names a function or class in its metadata (`[project.entry-points."d3a.detectors"]`); it
is called with the options as a dict of texts, and returns a detector. Nothing of it is imported
before it is asked for by name.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib.metadata import entry_points
from typing import Any

from d3a.model import BadInput
from d3a.readers.parsing import clean_text, did_you_mean

DETECTORS, EMBEDDERS = "d3a.detectors", "d3a.embedders"


def load(group: str, name: str, options: Mapping[str, str], built_in: Iterable[str]) -> Any:
    """Return what the plug-in of that name makes of the options.

    built_in: the names there are besides, for the message. Raises BadInput for a name that no
    package has, or two have, and for a plug-in that fails.
    """
    kind = group.rpartition(".")[2].removesuffix("s")
    installed = entry_points(group=group)
    found = list(dict.fromkeys(each for each in installed if each.name == name))
    if not found:
        known = sorted({*built_in, *(each.name for each in installed)})
        hint = did_you_mean(name, known)
        raise BadInput(
            f"there is no {kind} {clean_text(name)!r}; there are {', '.join(known)}, or the path "
            f"of a file that ends in .onnx.{hint}"
        )
    if len({each.value for each in found}) > 1:
        where = " and ".join(sorted(each.value for each in found))
        raise BadInput(f"two packages have a {kind} {name!r} ({where}): remove one")
    try:
        return found[0].load()(dict(options))
    except BadInput:
        raise
    except Exception as error:
        raise BadInput(failure(f"the {kind} {name!r} ({found[0].value})", error)) from error


def failure(what: str, error: Exception) -> str:
    """Return a sentence for an exception of somebody else's code."""
    said = clean_text(str(error))[:300]
    return f"{what} failed: {type(error).__name__}{': ' if said else ''}{said}"


def version_of(group: str, name: str) -> str:
    """Return "package version" of a plug-in, "" where its package does not say."""
    for each in entry_points(group=group):
        if each.name == name and each.dist is not None:
            return f"{each.dist.name} {each.dist.version}"
    return ""
