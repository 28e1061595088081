"""What a person may tell a reader: `--reader KEY=VALUE`, checked against what the reader knows."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from d3a.model import BadInput
from d3a.readers import parsing
from d3a.readers.base import RecordingFacts
from d3a.readers.clock import Clock

COMMON: Mapping[str, str] = {
    "name": "the recording's name in the store",
    "site": "the home or floor it was made in; things of two sites are never one",
}
"""Options of every reader."""
TIMES = {
    "times": "FILE with a time for each picture or frame",
    "start": "ISO time that seconds from the recording's start count from",
}
POSES = {
    "poses": "FILE of camera poses: time or frame, x y z qx qy qz qw",
    "pose-gap": "SECONDS to the nearest pose that still counts",
}
CAMERA = {"camera": "fx,fy,cx,cy in pixels, or a FILE (JSON, or a 3 x 3 matrix)"}
DETECTIONS = {
    "detections": "FILE of boxes that a detector found (.jsonl or .csv)",
    "box": "xyxy, xywh or cxcywh: what the four numbers of a box are",
}


def key_values(
    pairs: Iterable[str], whose: str = "reader", example: str = "name=lab"
) -> dict[str, str]:
    """Return the options of KEY=VALUE texts; BadInput for another text, or a key given twice."""
    options: dict[str, str] = {}
    for pair in pairs:
        key, equals, value = pair.partition("=")
        key = key.strip().lower().replace("_", "-")
        if not equals or not key or not value.strip():
            raise BadInput(f"{pair!r} is no {whose} option: KEY=VALUE would do, as in {example}")
        if key in options:
            raise BadInput(f"the {whose} option {key!r} is given twice")
        options[key] = value.strip()
    return options


class Options:
    """The options of one run, for one reader.

    Raises BadInput for a name that the reader does not know, with the nearest that it does.
    """

    def __init__(
        self,
        source: Path,
        given: Mapping[str, str] | None = None,
        *,
        known: Mapping[str, str] | None = None,
        zone: str | None = None,
        reader: str = "this reader",
        common: Mapping[str, str] = COMMON,
    ) -> None:
        self.folder = source if source.is_dir() else source.parent
        self._source = source
        self.zone = parsing.zone_of(zone)
        self._given = dict(given or {})
        self._known = {**common, **(known or {})}
        for name in self._given:
            if name not in self._known and name.split(".")[0] + "." not in self._known:
                raise BadInput(self._unknown(name, reader))

    def _unknown(self, name: str, reader: str) -> str:
        hint = parsing.did_you_mean(name, self._known)
        return f"{reader} has no option {name!r}.{hint} It takes: {', '.join(sorted(self._known))}"

    @property
    def usual_name(self) -> str:
        """What the recording is called by its place: the folder, or the file without its ending."""
        whole = self._source.resolve()
        return whole.stem if self._source.is_file() else whole.name

    def named(self, facts: RecordingFacts) -> RecordingFacts:
        """Return the facts with the name and the site that the person told, where there are any."""
        name, site = self.text("name"), self.text("site")
        if name is not None:
            facts = replace(facts, name=parsing.clean_text(name))
        if site is not None:
            facts = replace(facts, site=parsing.clean_text(site))
        return facts

    def text(self, name: str) -> str | None:
        """Return the value as it was given, None where it was not."""
        return self._given.get(name)

    def below(self, prefix: str) -> dict[str, str]:
        """Return options of the form `prefix.key`, by key: a reader knows them as `prefix.`."""
        start = prefix + "."
        return {
            key.removeprefix(start): v for key, v in self._given.items() if key.startswith(start)
        }

    def positive(self, name: str, usual: float) -> float:
        """Return a number above zero; BadInput for any other value."""
        if name not in self._given:
            return usual
        value = parsing.number(self._given[name], f"the option {name}")
        if value <= 0:
            raise BadInput(f"the option {name} must be above 0, not {value:g}")
        return value

    def choice(self, name: str, allowed: Iterable[str]) -> str | None:
        """Return one of the allowed words, None where nothing was given; BadInput otherwise."""
        value, words = self._given.get(name), tuple(allowed)
        if value is not None and value not in words:
            raise BadInput(f"the option {name} is {value!r}; it takes {', '.join(words)}")
        return value

    def file(self, name: str, *usual: str) -> Path | None:
        """Return the file that was given, else the first of the usual names in the folder.

        A given name is looked for as it stands, then in the recording's folder; BadInput where it
        is in neither.
        """
        given = self._given.get(name)
        if given is not None:
            for path in (Path(given), self.folder / given):
                if "\0" not in given and path.is_file():
                    return path
            raise BadInput(f"the option {name} names {given!r}, and there is no such file")
        return next((self.folder / each for each in usual if (self.folder / each).is_file()), None)

    def clock(self) -> Clock:
        """Return what reads the recording's times, by `start` and the zone."""
        start = self._given.get("start")
        start_ms = None if start is None else Clock(self.zone).absolute_ms(start)
        return Clock(self.zone, start_ms)
