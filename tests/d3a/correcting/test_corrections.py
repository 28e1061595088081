"""What people said later, and taking it back: on drawn homes, over all stores."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from functools import partial
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from d3a import teaching
from d3a.constraints import HISTORY, SAID
from d3a.correcting.corrections import UnknownThing
from d3a.ingest import ingest
from d3a.model import BadInput, Frame, Json
from d3a.parameters import PROFILES, Parameters
from d3a.store.base import (
    Batch,
    Keyframe,
    ObjectRecord,
    Sighting,
    StayRecord,
    Store,
    StoreRefused,
)
from tests.worlds.histories import PICTURES, batches
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import ListReader, Thing, circle, rounds

drawn_things = st.lists(
    st.tuples(st.sampled_from(["cup", "bowl"]), st.integers(0, 7), st.integers(0, 3)),
    min_size=2,
    max_size=6,
)


def frames_of(drawn: Sequence[tuple[str, int, int]], seed: int, count: int = 40) -> list[Frame]:
    spots = circle(1.5, 8)
    things = [
        Thing(category, spots[at], look, since=7 * n, until=10**9 if n % 2 else 25)
        for n, (category, at, look) in enumerate(drawn)
    ]
    return rounds(things, count, seed, noise_m=0.1, missed=0.3)


def parameters(profile: str = "default", **changes: Any) -> Parameters:
    given_ = {"stm_capacity": 4, "checkpoint_frames": 10, "interval_gap_s": 30.0}
    return PROFILES[profile].with_changes(**(given_ | changes))


def filled(frames: Sequence[Frame], numbers: Parameters, **how: Any) -> OracleStore:
    store = OracleStore()
    ingest(ListReader(frames), store, numbers, **how)
    return store


def content(store: Store) -> list[Json]:
    """Everything but the history, which keeps the last number that was given."""
    return [r for r in store.dump() if r.get("key") not in (HISTORY, SAID)]


def correct(store: Store, kind: int, a: int, b: int) -> bool:
    """Say one thing, of those that can be said; return whether it was taken."""
    ids = [r.object_id for r in store.objects()]
    stays = store.stays()
    try:
        if kind == 0 and ids:
            teaching.merge(store, ids[a % len(ids)], ids[b % len(ids)], force=True)
        elif kind == 1 and stays:
            teaching.split(store, *stays[a % len(stays)].key)
        elif kind == 2 and ids:
            return teaching.teach_name(store, ids[a % len(ids)], f"name {b}", "anna").number > 0
        elif kind == 3:
            teaching.name_place(store, f"room {a % 3}", around=(a, b), replace=bool(b % 2))
        elif kind == 4 and store.regions():
            teaching.rename_place(store, store.regions()[0].name, f"hall {a}")
        elif kind == 5 and store.regions():
            teaching.remove_place(store, store.regions()[0].name)
        elif kind == 6:
            teaching.put_map(store, {"drawn": a}, "a map")
        elif kind == 7 and stays:
            stay = stays[a % len(stays)]
            at_ms = stay.first_ms + (stay.last_ms - stay.first_ms) * b // 9
            since = datetime.fromtimestamp(at_ms / 1000, UTC)
            teaching.split(store, *stay.key, since=since)
        else:
            return False
    except BadInput:
        return False
    return True


drawn_words = st.lists(
    st.tuples(st.integers(0, 7), st.integers(0, 9), st.integers(0, 9)), min_size=1, max_size=8
)


@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(drawn=drawn_things, seed=st.integers(0, 99), said=drawn_words)
def test_undoing_everything_restores_the_very_store(
    drawn: list[tuple[str, int, int]], seed: int, said: list[tuple[int, int, int]]
) -> None:
    store = filled(frames_of(drawn, seed), parameters(new_thing_odds=1.0))
    states = [content(store)]
    for each in said:
        if correct(store, *each):
            states.append(content(store))
        assert store.check() == []
    while len(states) > 1:
        assert content(store) == states.pop()
        teaching.undo(store)
    assert content(store) == states.pop()
    with pytest.raises(UnknownThing, match="nothing to undo"):
        teaching.undo(store)


@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(history=st.lists(batches(), max_size=5), said=drawn_words)
def test_undo_restores_any_store(history: list[Batch], said: list[tuple[int, int, int]]) -> None:
    store = OracleStore()
    for batch in history:
        with contextlib.suppress(StoreRefused):  # some are drawn to dangle
            store.apply(batch)
    # undo gives no reference to a picture back that is not there (any more)
    store.apply(Batch(keyframes=[Keyframe(key, b"jpeg", 8, 8, 0) for key in PICTURES]))
    states = [content(store)]
    for each in said:
        if correct(store, *each):
            states.append(content(store))
    while len(states) > 1:
        assert content(store) == states.pop()
        teaching.undo(store)
    assert content(store) == states.pop()


class Speaking(ListReader):
    """A reader during which somebody speaks: after some frames, by number."""

    def __init__(self, frames: Sequence[Frame], says: Mapping[int, Callable[[], object]]) -> None:
        super().__init__(frames)
        self.says = says

    def __iter__(self) -> Iterator[Frame]:
        for number, frame in enumerate(self.frames):
            if number in self.says:
                self.says[number]()
            yield frame


drawn_times = st.lists(
    st.tuples(st.integers(0, 59), st.sampled_from([0, 0, 1, 1, 2, 7, 7, 9]), st.integers(0, 9),
              st.integers(0, 9)),
    min_size=1, max_size=5, unique_by=lambda each: each[0],
)  # fmt: skip


@pytest.mark.parametrize("profile", ["default", "paper"])
@settings(
    deadline=None,
    max_examples=40,
    suppress_health_check=[HealthCheck.too_slow],
    phases=[Phase.generate],
)
@given(drawn=drawn_things, seed=st.integers(0, 99), said=drawn_times)
def test_who_speaks_while_an_ingest_runs_loses_nothing_and_breaks_nothing(
    profile: str,
    drawn: list[tuple[str, int, int]],
    seed: int,
    said: list[tuple[int, int, int, int]],
) -> None:
    frames, numbers = frames_of(drawn, seed, 60), parameters(profile)
    store = filled(frames[:20], numbers)

    def speak(kind: int, a: int, b: int) -> None:
        if kind != 9:
            correct(store, kind, a, b)
        elif teaching.history(store):
            teaching.undo(store)
        assert store.check() == []

    says = {at: partial(speak, *words) for at, *words in said}
    summary = ingest(Speaking(frames, says), store, numbers)
    assert store.check() == []
    assert_constraints_hold(store)
    assert sum(stay.seen for stay in store.stays()) == sum(s.seen for s in store.sightings())
    assert not [reason for reason in summary.skipped.counts if "backwards" in reason]
    while teaching.history(store):
        teaching.undo(store)
        assert store.check() == []
    seen = sum(stay.seen for stay in store.stays())
    assert seen == sum(s.seen for s in store.sightings())
    assert seen <= sum(len(frame.detections or ()) for frame in frames)


def assert_constraints_hold(store: Store) -> None:
    """What was made one is one, and what was split is two: by their ids."""
    ids = {record.object_id for record in store.objects()}
    for each in teaching.history(store):
        later = [o for o in teaching.history(store) if o.number > each.number]
        swallowed = {o.arguments["gone"] for o in later if o.kind == "merge"}
        if each.kind == "merge":
            assert each.arguments["gone"] not in ids
            assert each.arguments["kept"] in ids - swallowed or each.arguments["kept"] in swallowed
        if each.kind == "split":
            for name in ("object", "new"):
                assert each.arguments[name] in ids | swallowed


class Overheard(OracleStore):
    """Somebody speaks whenever the ingest has looked whether anybody did, but not in its turn."""

    def __init__(self) -> None:
        super().__init__()
        self.spoken = 0
        self.turns = 0

    @contextlib.contextmanager
    def turn(self) -> Iterator[None]:
        self.turns += 1
        yield
        self.turns -= 1

    def meta(self, key: str) -> Any | None:
        value = super().meta(key)
        settled = [r.object_id for r in self.objects() if not r.volatile]
        if key == SAID and self.turns == 0 and settled:
            self.spoken += 1
            teaching.teach_name(self, settled[0], f"name {self.spoken}")
        return value


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_an_ingest_gets_on_however_often_people_speak(profile: str) -> None:
    frames, numbers = frames_of([("cup", 0, 1), ("bowl", 3, 2)], 5), parameters(profile)
    store = Overheard()
    ingest(ListReader(frames[:10]), store, numbers)
    summary = ingest(ListReader(frames), store, numbers)
    assert summary.frames == len(frames) - 10
    assert store.recordings()[0].done
    assert store.spoken > 10, "it looks before each frame"
    assert len(teaching.history(store)) == store.spoken
    words = {name.word for record in store.objects() for name in record.names}
    assert words == {f"name {n + 1}" for n in range(store.spoken)}
    assert store.check() == []


def test_a_thing_may_be_called_what_none_of_its_votes_says() -> None:
    """As a store allows; the votes of both then say what the one thing is."""
    store = OracleStore()
    for name, at, weight in (("a", 0, 1.0), ("b", 9, 2.0)):
        voted = (("mug", weight),)
        thing = ObjectRecord(name, "cup", weight, at, at, categories=voted)
        stays = [StayRecord(name, 0, (float(at), 0.0, 0.0), at, at, weight, seen=1)]
        sightings = [Sighting(name, 0, at, at, "f", 0.9, (0.0, 0.0, 1.0, 1.0), None)]
        store.apply(Batch(objects=[thing], stays=stays, sightings=sightings))
    before = store.objects()
    teaching.merge(store, "a", "b")
    (one,) = store.objects()
    assert (one.category, one.categories) == ("mug", (("mug", 3.0),))
    teaching.undo(store)
    assert store.objects() == before
