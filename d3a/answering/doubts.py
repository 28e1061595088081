"""What may no longer be so, as one like a thing of it was seen elsewhere since, under another id.

Each thing of a moment is judged: what a couch is under is doubted as much as the couch.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import islice

from d3a.answering.alike import Alike
from d3a.answering.moments import Entry, Moment, single
from d3a.answering.run import Run
from d3a.store.base import Sighting
from grammar.forms import ANYTHING

Doubt = tuple[str, Sighting]
"""What may be a thing of a moment, seen elsewhere since, and the variable of that thing."""


class Doubts:
    """The moments that are so still by what was seen of their own things, and what doubts them."""

    def __init__(
        self,
        run: Run,
        var: str,
        kept: Sequence[Moment],
        before: Sequence[Sighting],
        newest: Mapping[str, Sighting],
    ) -> None:
        """Take moments of a variable's things, all that was seen of these, each thing's newest."""
        self._run, self._var, self._kept = run, var, kept
        self._before, self._newest = before, newest
        self._here: dict[str, set[str]] = {}
        for entry in (entry for moment in kept for entry in moment.entries):
            self._here.setdefault(run.var_of(entry), set()).add(entry.sighting.object_id)
        self._alike: dict[str, Alike] = {}

    def judged(self) -> list[Moment]:
        """Return what is told as so still: of each figure its surest moment, of these the newest.

        What is doubted for what it stands beside is left out where anything is not; a list leaves
        out what may be elsewhere by now, and has it told apart (`doubted`). Of a thing asked for,
        but of a number, no more is told than is sure, and where nothing is, here and in a list, the
        newest that may be it (`otherwise`).
        """
        run = self._run
        kept, is_what = list(self._kept), run.query.ask == "what"
        is_list = run.term(self._var).category == ANYTHING
        if is_list:
            kept = [moment for moment in kept if not _any(self._turned_up(moment.figure))]
        beside = {id(moment) for moment in kept if _any(self._of(moment.entries[1:]))}
        kept = [moment for moment in kept if id(moment) not in beside] or kept
        doubtful = {id(m) for m in kept if id(m) in beside or self._is_doubtful(m, is_list)}
        kept = _one_a_figure(kept, doubtful)
        unsure = [moment for moment in kept if id(moment) in doubtful]
        sure = [moment for moment in kept if id(moment) not in doubtful]
        if is_list or is_what:
            if sure:
                run.doubted = unsure
            elif unsure and is_what:
                self._tell([max(unsure, key=lambda moment: moment.end_ms)])
            return sure or kept
        if run.query.ask == "count":
            away = [m.figure.sighting.object_id for m in unsure if _any(self._away(m.figure))]
            run.elsewhere = frozenset(away)
        elif unsure and not sure:
            self._tell(unsure)
        elif run.term(self._var).quantity is None:
            kept = sure
        return kept

    def _tell(self, unsure: Sequence[Moment]) -> None:
        """Note the newest of what may be a thing of these moments, seen elsewhere since."""
        doubts = [each for moment in unsure for each in self._of(moment.entries)]
        var, best = max(doubts, key=lambda each: (each[1].end_ms, each[1].object_id))
        self._run.otherwise = single(self._run.found[var], best)

    def _is_doubtful(self, moment: Moment, is_list: bool) -> bool:
        if is_list:
            return _any(self._since(moment.figure))
        if self._run.query.ask != "what":
            return _any(self._of(moment.entries[:1]))
        return _any(self._away(moment.figure))

    def _away(self, entry: Entry) -> Iterator[Sighting]:
        """Yield what may be the thing of an entry and was seen since, but not here as well.

        What may be another of a list, or of what is counted, is one of it.
        """
        here = self._here[self._run.var_of(entry)]
        yield from self._turned_up(entry)
        yield from (s for s in self._since(entry) if s.object_id not in here)

    def _of(self, entries: Sequence[Entry]) -> Iterator[Doubt]:
        """Yield what may be one of these and was seen elsewhere since: with it its newest."""
        for entry in entries:
            var = self._run.var_of(entry)
            yield from ((var, sighting) for sighting in self._turned_up(entry))
            yield from ((var, sighting) for sighting in islice(self._since(entry), 1))

    def _turned_up(self, entry: Entry) -> Iterator[Sighting]:
        name, var = entry.sighting.object_id, self._run.var_of(entry)
        if name in self._stay:
            return iter(())
        return self._among(var).turned_up(name, self._newest[name].end_ms, self._here[var])

    def _since(self, entry: Entry) -> Iterator[Sighting]:
        """Yield what may be the thing of an entry by its looks since, the newest first."""
        name, var = entry.sighting.object_id, self._run.var_of(entry)
        if name in self._stay:
            return iter(())
        return self._among(var).seen_since(name, self._newest[name].end_ms)

    @cached_property
    def _stay(self) -> Collection[str]:
        """The large things that stay: none of them is another that was carried."""
        return {name for name, _ in self._run.facts.landmarks(self._run.lexicon).stays}

    def _among(self, var: str) -> Alike:
        if var not in self._alike:
            before = self._before if var == self._var else self._run.found[var].sightings
            self._alike[var] = Alike(self._run, var, self._here[var], before)
        return self._alike[var]


def _any(some: Iterator[object]) -> bool:
    """Whether there is any, without looking for more."""
    return next(some, None) is not None


def _one_a_figure(moments: Sequence[Moment], doubtful: Collection[int]) -> list[Moment]:
    """Return of each figure the moment that is not doubtful, and of these the newest."""
    best: dict[str, Moment] = {}
    for moment in sorted(moments, key=lambda m: (id(m) not in doubtful, m.end_ms)):
        best[moment.figure.sighting.object_id] = moment
    return [moment for moment in moments if best[moment.figure.sighting.object_id] is moment]
