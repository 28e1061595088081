"""Follow a folder that grows and has tables: it is read anew as it changes, by its own reader.

A frame is given once it was the same for long enough, or, where pictures alone are told, when a
later one is there. It serves every reader whose frames stay what they are when others are added.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path

from d3a.model import BadInput, Frame
from d3a.readers.base import Reader, RecordingFacts, Skipped
from d3a.readers.beside import is_picture
from d3a.watch.patience import Patience
from d3a.watch.pictures import is_whole

SHARE = 4
"""Reading anew takes at most one part in so many of the time, however large the folder is."""
Mark = tuple[tuple[str, int, int], ...]


class FolderFollower:
    """Frames of a growing folder; None while there is nothing new.

    Gives the frames that the reader gives of the folder in the end, in the same order, as long as
    what is added comes later in time than what was given.
    """

    def __init__(self, source: Path, opened: Callable[[], Reader], patience: Patience) -> None:
        """Open what is there; `opened` does it, and raises BadInput where nothing can be read."""
        self._source = source
        self._opened = opened
        self._patience = patience
        self.facts: RecordingFacts = opened().facts
        self.skipped = Skipped()
        self._begin()

    def _begin(self) -> None:
        self._given: set[str] = set()
        self._waiting: list[Frame] = []
        self._since: dict[str, float] = {}
        self._mark: Mark | None = None
        self._next_look = self._patience.clock()

    def __iter__(self) -> Iterator[Frame | None]:
        """Yield frames as they come, and None at each look that found none."""
        self._begin()
        while not self._patience.should_stop():
            self._look()
            is_over = self._patience.is_over() and not self._has_changed()
            ready = self._waiting if is_over else self._ready()
            for frame in ready:
                self._given.add(frame.name)
                self._since.pop(frame.name, None)
                yield frame
                if self._patience.should_stop():
                    return
            if is_over:
                return
            self._waiting = self._waiting[len(ready) :]
            if not ready:
                yield None
                self._patience.pause()

    def _has_changed(self) -> bool:
        return mark_of(self._source) != self._mark

    def _look(self) -> None:
        """Read the folder anew where it has changed; a table half written is tried again."""
        now = self._patience.clock()
        if now < self._next_look:
            return
        mark = mark_of(self._source)
        if mark != self._mark:
            if self._mark is not None:
                self._patience.grew()
            try:
                reader = self._opened()
                self._waiting = [frame for frame in reader if frame.name not in self._given]
            except BadInput:
                if self._patience.is_over():
                    raise
            else:
                self._mark, self.skipped = mark, reader.skipped
            self._since |= {f.name: now for f in self._waiting if f.name not in self._since}
        self._next_look = now + SHARE * (self._patience.clock() - now)

    def _ready(self) -> list[Frame]:
        """Return the frames, from the first on, to which nothing more belongs."""
        for n, frame in enumerate(self._waiting):
            if self._patience.has_settled(self._since[frame.name]):
                continue
            is_bare = frame.pose is None and frame.detections is None and frame.depth is None
            if not is_bare or n + 1 == len(self._waiting) or not is_whole(frame.image):
                return self._waiting[:n]
        return self._waiting


def mark_of(source: Path) -> Mark:
    """Return what changes when something is added: of folders and tables the time and the size.

    Pictures are not asked one by one: a new one changes its folder.
    """
    places = [str(source)]
    for folder, _, files in os.walk(source):
        places.append(folder)
        places += [str(Path(folder, name)) for name in files if not is_picture(Path(name))]
    found = set()
    for place in places:
        try:
            status = Path(place).stat()
        except FileNotFoundError:  # it was there a moment ago
            continue
        found.add((place, status.st_mtime_ns, status.st_size))
    return tuple(sorted(found))
