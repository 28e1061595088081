"""How the stores ask: the index of each query, and the commands that MongoDB is sent."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from pymongo.monitoring import (
    CommandFailedEvent,
    CommandListener,
    CommandStartedEvent,
    CommandSucceededEvent,
)

from d3a.store import open_store
from d3a.store.base import Area, NativeQuery, Store
from d3a.store.mongo_server import open_mongo
from tests.worlds import histories
from tests.worlds.victims import after_batch, before_batch

V1 = {
    "abortTransaction", "aggregate", "authenticate", "collMod", "commitTransaction", "count",
    "create", "createIndexes", "delete", "drop", "dropDatabase", "dropIndexes", "endSessions",
    "explain", "find", "findAndModify", "getMore", "hello", "insert", "killCursors",
    "listCollections", "listDatabases", "listIndexes", "ping", "refreshSessions", "update",
}  # fmt: skip
HERE = Area(0.0, 0.0, 2.0, 2.0)
Ask = Callable[[Store], object]
ASKED: dict[str, Ask] = {
    "category": lambda s: s.objects(categories=["cup"]),
    "ids": lambda s: s.objects(ids=["a"]),
    "votes": lambda s: s.objects(categories=["cup"], votes=True, embeddings=False),
    "names": lambda s: s.objects(names=["keys"]),
    "sightings of one": lambda s: s.sightings(object_ids=["a"], start_ms=5),
    "sightings in time": lambda s: s.sightings(start_ms=5),
    "sightings of many": lambda s: s.sightings(object_ids=["a"] * 1001, start_ms=5),
    "box in time": lambda s: s.sightings(area=HERE, start_ms=5),
    "box": lambda s: s.sightings(area=HERE),
    "stays in a box": lambda s: s.stays(area=HERE),
    "stays of one": lambda s: s.stays(object_ids=["a"]),
    "stays in time": lambda s: s.stays(start_ms=5),
    "last": lambda s: s.edges(["a"], "last", before_ms=9),
    "first": lambda s: s.edges(["a"], "first", after_ms=9),
    "encounters": lambda s: s.encounters(object_ids=["a"], with_ids=["b"], start_ms=5),
    "encounters in time": lambda s: s.encounters(start_ms=5),
    "views": lambda s: s.views(start_ms=5),
    "picture": lambda s: s.keyframe("p"),
}
SQLITE_INDEX = {
    "category": "oic_category",
    "ids": "sqlite_autoindex_oic_1",
    "votes": "oic_category, sqlite_autoindex_oic_1",  # and the key of oic_vote
    "names": "sqlite_autoindex_oic_1, oic_name_word",
    "sightings of one": "sighting_object_start",
    "sightings in time": "sighting_start",
    "sightings of many": "sighting_start",
    "box in time": "sighting_tree",
    "box": "stc_tree, sqlite_autoindex_sighting_1",
    "stays in a box": "stc_tree",
    "stays of one": "sqlite_autoindex_stc_1",
    "stays in time": "stc_last",
    "last": "sighting_object_end",
    "first": "sighting_object_start",
    "encounters": "encounter_a, encounter_b",
    "encounters in time": "encounter_start",
    "views": "PRIMARY KEY",
    "picture": "sqlite_autoindex_keyframe_1",
}
MONGO_INDEX = {
    "category": ["category_1__id_1"],
    "ids": ["_id_"],
    "votes": ["category_1__id_1", "votes_1"],
    "names": ["names_1"],
    "sightings of one": ["object_id_1_last_-1"],
    "sightings in time": ["last_1"],
    "box in time": ["loc_2d_last_1"],
    "box": ["loc_2d_last_1"],
    "stays in a box": ["loc_2d_last_1"],
    "stays of one": ["object_id_1_last_-1"],
    "stays in time": ["last_1"],
    "last": ["object_id_1_last_-1"],
    "first": ["object_id_1_last_-1"],
    "encounters": ["a_1_start_1", "b_1_start_1"],
    "encounters in time": ["start_1"],
    "views": ["end_1"],
    "picture": ["_id_"],
}

DOUBLE_SCANS = {
    "stays of one", "stays in time", "last", "first", "encounters", "encounters in time",
}  # fmt: skip


def traced(store: Store, ask: Ask) -> list[NativeQuery]:
    told: list[NativeQuery] = []
    store.tracing(told.append)
    ask(store)
    store.tracing(None)
    ask(store)
    return told


@pytest.mark.parametrize("asked", ASKED)
def test_every_question_to_sqlite_has_its_index(tmp_path: Path, asked: str) -> None:
    with closing(open_store(str(tmp_path / "home.db"))) as store:
        store.apply(before_batch())
        [query] = traced(store, ASKED[asked])
    assert query.index == SQLITE_INDEX[asked]
    assert query.text.startswith("SELECT ")
    assert query.elapsed_ms > 0


@pytest.mark.parametrize("asked", MONGO_INDEX)
def test_every_question_to_mongodb_has_its_index(
    mongo_uri: str, asked: str, request: pytest.FixtureRequest
) -> None:
    with closing(open_store(mongo_uri)) as store:
        store.apply(before_batch())
        queries = traced(store, ASKED[asked])
    indexes = [query.index for query in queries][: len(MONGO_INDEX[asked])]
    assert all(query.text.startswith("db.") for query in queries)
    if "double" in request.node.name and asked in DOUBLE_SCANS:
        pytest.skip("the double scans where a filter has a field that is not in the index")
    assert indexes == MONGO_INDEX[asked]


class Commands(CommandListener):
    def __init__(self) -> None:
        self.sent: list[CommandStartedEvent] = []
        self.failed_names: list[str] = []

    def started(self, event: CommandStartedEvent) -> None:
        self.sent.append(event)

    def succeeded(self, event: CommandSucceededEvent) -> None:
        pass

    def failed(self, event: CommandFailedEvent) -> None:
        self.failed_names.append(event.command_name)


def test_only_commands_of_the_stable_api_are_sent(mongo_uri: str) -> None:
    commands = Commands()
    with closing(open_mongo(mongo_uri, "shown", listeners=[commands])) as store:
        store.apply(before_batch())
        store.apply(after_batch())
        for ask in ASKED.values():
            traced(store, ask)
        histories.whole_store(store)
        store.collect_keyframes()
        store.recover()
    names = {event.command_name for event in commands.sent}
    assert names <= V1
    assert {"find", "update", "delete", "aggregate", "explain", "createIndexes"} <= names
    assert commands.failed_names == []
    for event in commands.sent:
        assert event.command["apiVersion"] == "1", event.command_name
        assert event.command["apiStrict"] is True
        if event.command_name in {"insert", "update", "delete"}:
            assert event.command["writeConcern"] == {"w": "majority", "j": True}
