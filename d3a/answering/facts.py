"""What questions need to know of the store itself, read once: words, rooms, thresholds, landmarks.

A process that asks one store many questions reads these once for as long as nobody writes.
"""

from __future__ import annotations

import weakref
from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import datetime
from functools import lru_cache
from operator import is_not
from typing import Any, cast

import numpy as np

from d3a.answering.attributes import Looks
from d3a.answering.landmarks import Landmarks, is_landmark_word, landmarks, usual_grounds
from d3a.answering.match import Candidate, Lexicon, candidates, rungs
from d3a.answering.moments import Found, in_slice, joined
from d3a.answering.revision import Revision, by_object
from d3a.answering.spots import Spots
from d3a.colours import HISTOGRAM_SIZE, Palette, histograms, learn
from d3a.parameters import Parameters, parameters_of
from d3a.plan import FindObjects
from d3a.store.base import (
    Area,
    ObjectRecord,
    Positions,
    Region,
    Sighting,
    Spans,
    StayKey,
    StayRecord,
    Store,
    TaughtName,
)
from d3a.store.newest import is_whole, newest_of
from grammar.forms import RelationKind

FEW_SIGHTINGS = 500
"""Where no more was seen of what is asked for, it is read whole, and kept for the next question."""
MOST_WHOLE = 2_000
"""Sightings that are read as records where all of them count; more are read as columns."""
PALETTE_OBJECTS = 1_000
"""What boxes hold together is told by so many of them as well as by all."""
FEW_OBJECTS = 2_000
"""In a home of so few objects, what is large is looked for under every category."""
_Worth = Mapping[str, float]


@lru_cache(maxsize=4)
def _known(
    _store: weakref.ref[Store], _revision: tuple[int, int], _until_ms: int | None
) -> Revision:
    return Revision()


@lru_cache(maxsize=2)
def _learned(looks: bytes, views: bytes) -> Palette:
    """Return what `learn` does: few of the commits beside which questions are asked change it."""
    matrix = np.frombuffer(looks, dtype=np.float32).reshape(-1, HISTOGRAM_SIZE)
    return learn(matrix, np.frombuffer(views))


def forget() -> None:
    """Forget what was read of any store: to measure a question that reads everything anew."""
    _known.cache_clear()
    _learned.cache_clear()


class Facts:
    """A view of the store for the length of one question; a later one sees later writes.

    What an earlier question read is used again where the store's revision says that nothing was
    written since. Every method raises StoreError.
    """

    __slots__ = ("_known", "_whole", "store")

    def __init__(self, store: Store, *, until_ms: int | None = None) -> None:
        revision = store.revision()
        self._known = _known(weakref.ref(store), revision, until_ms) if revision else Revision()
        self._whole = self.store = store
        if until_ms is not None:
            from d3a.store.past import PastStore  # most questions are asked of all that there is

            self.store = cast("Store", PastStore(store, until_ms))

    def as_of(self, now: datetime) -> Facts:
        """Return what was known at a time: these facts where nothing was seen since."""
        newest, now_ms = self.last_view_ms(), round(now.timestamp() * 1000)
        if newest is None or newest <= now_ms:
            return self
        return Facts(self.store, until_ms=now_ms)

    def begins_ms(self) -> int | None:
        """Return when anything was seen first, also where that was later than these facts go."""
        first = self._whole.sightings(limit=1)
        return first[0].start_ms if first else None

    def categories(self) -> list[str]:
        """Return the categories of the store, by name."""
        return [category for category, _ in self._counted()]

    def _counted(self) -> list[tuple[str, int]]:
        if self._known.categories is None:
            self._known.categories = self.store.categories()
        return self._known.categories

    def classes(self) -> list[str] | None:
        """Return what the detectors that filled the store can recognise, None where unknown."""
        known = self.meta("classes")
        return [str(word) for word in known] or None if isinstance(known, list) else None

    def names(self) -> list[TaughtName]:
        """Return what people call the objects."""
        if self._known.names is None:
            self._known.names = self.store.names()
        return self._known.names

    def regions(self) -> list[Region]:
        """Return the named rooms."""
        if self._known.regions is None:
            self._known.regions = self.store.regions()
        return self._known.regions

    def last_view_ms(self) -> int | None:
        """Return the time of the newest frame, None where there is none."""
        if self._known.newest_ms is None:
            self._known.newest_ms = self.store.last_view_ms()
        return self._known.newest_ms

    def meta(self, key: str) -> Any | None:
        """Return a value that the store was given: zone, now, classes, parameters."""
        if key not in self._known.meta:
            self._known.meta[key] = self.store.meta(key)
        return self._known.meta[key]

    def objects(self, categories: Sequence[str] | None, *, embeddings: bool) -> list[ObjectRecord]:
        """Return the objects of which any detection had one of the categories, by id; None: all."""
        asked = None if categories is None else tuple(categories)
        kept = self._known.seen if embeddings else self._known.objects
        found = kept.get(asked, None)
        if found is None:
            found = self.store.objects(categories=categories, votes=True, embeddings=embeddings)
            kept.put(asked, found, len(found))
        return found

    def rungs(self, step: FindObjects, lexicon: Lexicon) -> tuple[_Worth, _Worth]:
        """Return what a noun may mean of the store's categories and of its detectors' classes."""
        asked = (step.category, step.word, step.precision)
        found = self._known.rungs.get(asked, None)
        if found is None:
            classes = rungs(step, self.classes() or (), lexicon)
            found = rungs(step, self.categories(), lexicon), classes
            self._known.rungs.put(asked, found, 1)
        return found

    def candidates(
        self,
        step: FindObjects,
        records: Sequence[ObjectRecord],
        worth: Mapping[str, float],
        confusion: float,
    ) -> list[Candidate]:
        """Return what `match.candidates` does, kept where the same records are asked again."""
        asked = (replace(step, var=""), tuple(worth.items()), confusion)
        of, found = self._known.meant.get(asked, ([], []))
        if len(of) != len(records) or any(map(is_not, of, records)):
            of, found = list(records), candidates(step, records, worth, confusion=confusion)
            self._known.meant.put(asked, (of, found), len(of))
        return found

    def looks(self, records: Sequence[ObjectRecord]) -> Looks | None:
        """Return the colours of objects, None where none of them has a histogram."""
        asked = tuple([record.object_id for record in records])
        found, is_known = self._known.looks.get(asked, (None, False))
        if not is_known:
            found = Looks.of(records, self.palette)
            self._known.looks.put(asked, (found, True), len(asked))
        return found

    def stays(self, ids: Sequence[str]) -> dict[StayKey, StayRecord]:
        """Return where the objects lay, by (object_id, place)."""
        known = self._known.stays.several(ids)
        unknown = [name for name in ids if name not in known]
        if unknown:
            for name, read in by_object(unknown, self.store.stays(object_ids=unknown)).items():
                known[name] = read
                self._known.stays.put(name, read, len(read))
        return {(s.object_id, s.place): s for name in ids for s in known[name]}

    def stays_of(
        self, sightings: Sequence[Sighting], *, whole: bool = False
    ) -> dict[StayKey, StayRecord]:
        """Return the stays of sightings, by (object_id, place), and maybe others of their objects.

        whole: all stays of their objects. In a large memory these lie far apart in its file.
        """
        if whole or self._has_few_objects():
            return self.stays(sorted({sighting.object_id for sighting in sightings}))
        keys = sorted({(sighting.object_id, sighting.place) for sighting in sightings})
        known = self._known.room_for_places(keys)
        unknown = [key for key in keys if key not in known]
        for stay in self.store.stays_at(unknown) if unknown else ():
            known[stay.object_id, stay.place] = stay
        return {key: known[key] for key in keys if key in known}

    def reach(self, ids: Sequence[str], count: int, *, oldest: bool = False) -> int | None:
        """Return the start of the count-th newest (or oldest) sighting, see `Store.reach`."""
        known = self._known.sightings
        if all(name in known for name in ids) and sum(len(known[name]) for name in ids) < count:
            return None
        return self.store.reach(ids, count, oldest=oldest)

    def newest(
        self,
        ids: Sequence[str],
        limit: int,
        start_ms: int | None,
        end_ms: int | None,
        *,
        oldest: bool = False,
    ) -> list[Sighting]:
        """Return sightings that meet [start, end) as `Store.newest` chooses them; none is joined.

        They are kept where they are all that there are.
        """
        known = self._known.sightings
        if self._knows_all(ids):
            every = (s for name in ids for s in known[name] if in_slice(s, start_ms, end_ms))
            ordered = sorted(every, key=lambda s: (s.start_ms, s.object_id, s.place))
            return newest_of(ordered, limit, oldest=oldest)
        last = None if end_ms is None else end_ms - 1
        found = self.store.newest(ids, limit, start_ms=start_ms, end_ms=last, oldest=oldest)
        if start_ms is None and end_ms is None and is_whole(found, limit):
            self._keep_sightings(ids, found)
        return found

    def last_of(self, ids: Sequence[str]) -> list[Sighting]:
        """Return each object's last sighting, by object_id; kept for the next question."""
        found = self._known.last.get(tuple(ids), None)
        if found is None:
            found = self.store.edges(ids, "last")
            self._known.last.put(tuple(ids), found, len(found))
        return found.copy()

    def count_seen(self, ids: Sequence[str], start_ms: int | None, last_ms: int | None) -> int:
        """Count the objects with a sighting that touches the closed [start, last]."""
        asked = (tuple(ids), start_ms, last_ms)
        if (count := self._known.counts.get(asked, None)) is None:
            count = self.store.count_seen(ids, start_ms=start_ms, end_ms=last_ms)
            self._known.counts.put(asked, count, len(ids))
        return count

    def are_many(self, ids: Sequence[str], start_ms: int | None, last_ms: int | None) -> bool:
        """Whether the objects have more sightings that touch [start, last] than are read whole."""
        if self._knows_all(ids):
            return sum(len(self._known.sightings[name]) for name in ids) > MOST_WHOLE
        found = self.store.spans(ids, start_ms=start_ms, end_ms=last_ms, limit=MOST_WHOLE + 1)
        return len(found) > MOST_WHOLE

    def spans(
        self,
        ids: Sequence[str],
        start_ms: int | None,
        last_ms: int | None,
        area: Area | None = None,
    ) -> Spans:
        """Return when objects were seen, see `Store.spans`; kept for the next question."""
        asked = (tuple(ids), start_ms, last_ms, area)
        found = self._known.spans.get(asked, None)
        if found is None:
            found = self.store.spans(ids, area=area, start_ms=start_ms, end_ms=last_ms)
            self._known.spans.put(asked, found, len(found))
        return found

    def positions(self, ids: Sequence[str]) -> Positions:
        """Return where the stays of objects are, see `Store.positions`; kept for the next."""
        found = self._known.positions.get(tuple(ids), None)
        if found is None:
            found = self.store.positions(ids)
            self._known.positions.put(tuple(ids), found, len(found))
        return found

    def _has_few_objects(self) -> bool:
        return sum(count for _, count in self._counted()) <= FEW_OBJECTS

    def _knows_all(self, ids: Sequence[str]) -> bool:
        """Whether all sightings of the objects are known; reads them where they are few."""
        known = self._known
        if not known.crowded:
            unknown = [name for name in ids if name not in known.sightings]
            few = self._has_few_objects() and (
                not unknown or self.store.reach(unknown, FEW_SIGHTINGS) is None
            )
            if few and unknown:
                few = self._keep_sightings(unknown, self.store.sightings(object_ids=unknown))
            known.crowded = not few
        return all(name in known.sightings for name in ids)

    def _keep_sightings(self, ids: Sequence[str], found: Sequence[Sighting]) -> bool:
        """Keep the sightings of objects, all that there are; False where there is no room."""
        room = self._known.keeps(len(found))
        if room:
            self._known.sightings |= by_object(ids, found)
        return room

    def sightings(
        self, ids: Sequence[str], start_ms: int | None, end_ms: int | None
    ) -> list[Sighting]:
        """Return sightings that meet [start, end), joined where the store's limit split them.

        In the order of `joined`. A slice reads no more than itself, where the rest is not kept.
        """
        bounded = start_ms is not None or end_ms is not None
        asked, known = tuple(ids), self._known.sightings
        whole = None if bounded else self._known.joined.get(asked, None)
        if whole is not None:
            return whole.copy()
        if bounded and not self._knows_all(ids):
            last = None if end_ms is None else end_ms - 1
            read = self.store.sightings(object_ids=ids, start_ms=start_ms, end_ms=last)
            return [s for s in joined(read) if in_slice(s, start_ms, end_ms)]
        unknown = [name for name in ids if name not in known]
        fresh = by_object(unknown, self.store.sightings(object_ids=unknown) if unknown else ())
        parts = (fresh[name] if name in fresh else known[name] for name in ids)
        found = joined(s for part in parts for s in part if in_slice(s, start_ms, end_ms))
        if self._known.keeps(sum(map(len, fresh.values()))):
            known |= fresh
        if not bounded:
            self._known.joined.put(asked, found.copy(), len(found))
        return found

    def usual_grounds(self, kind: RelationKind, lexicon: Lexicon) -> frozenset[str]:
        """Return the categories of the store that things usually stand in the relation to.

        There is room below furniture and in containers; things lie on what is large and stays.
        """
        if kind not in self._known.usual:
            self._known.usual[kind] = usual_grounds(kind, self.categories(), lexicon)
        return self._known.usual[kind]

    def landmarks(self, lexicon: Lexicon) -> Landmarks:
        """Return the large static things that places are told by."""
        if self._known.landmarks is None:
            few = self._has_few_objects()
            wanted = [
                category
                for category in self.categories()
                if is_landmark_word(category, lexicon, or_large=few)
            ]
            records = self.store.objects(categories=wanted, embeddings=False) if wanted else []
            stays = self.stays([record.object_id for record in records])
            found = landmarks(records, list(stays.values()), self.regions(), lexicon)
            self._known.landmarks = found
            self._known.carriers = Found(
                {r.object_id: Candidate(r, 1.0) for r in records if r.object_id in found},
                stays={stay: stays[stay] for stay in found.stays},
            )
        return self._known.landmarks

    def spots(self, landmarks: Landmarks | None, near_m: float) -> Spots:
        """Return what tells where stays were, by these landmarks or by rooms alone."""
        asked = (landmarks is not None, near_m)
        if asked not in self._known.spots:
            self._known.spots[asked] = Spots(self.regions(), landmarks, near_m)
        return self._known.spots[asked]

    def carriers(self, lexicon: Lexicon) -> Found:
        """Return the same as things that others may lie on, each at the place where it stays."""
        self.landmarks(lexicon)
        return self._known.carriers

    def palette(self) -> Palette:
        """Return what the boxes of the whole store hold together and show, for colours."""
        if self._known.palette is None:
            ids, matrix = self.store.embeddings(PALETTE_OBJECTS)
            # It is asked for where an object has a histogram; a store holds looks of one kind.
            usable = len(ids) if matrix.shape[1] >= HISTOGRAM_SIZE else 0
            known = self.store.objects(ids=ids, embeddings=False) if usable else []
            weights = {record.object_id: record.weight for record in known}
            views = np.array([weights.get(name, 1.0) for name in ids[:usable]])
            looks = histograms(matrix) if usable else np.zeros((0, HISTOGRAM_SIZE), np.float32)
            self._known.palette = _learned(looks.tobytes(), views.tobytes())
        return self._known.palette

    def parameters(self) -> Parameters:
        """Return the parameters that filled the store; unknown fields of a later version are left.

        A store that was filled with another `together_m` is asked with the same.
        """
        if self._known.parameters is None:
            self._known.parameters = parameters_of(self.meta("parameters"))
        return self._known.parameters
