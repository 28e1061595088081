"""Opening a store on a MongoDB server: strict Stable API, its version, its indexes, its journal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any
from urllib.parse import parse_qs

from pymongo import MongoClient
from pymongo.database import Database
from pymongo.errors import (
    BulkWriteError,
    ConfigurationError,
    ConnectionFailure,
    InvalidURI,
    OperationFailure,
    PyMongoError,
)
from pymongo.monitoring import CommandListener
from pymongo.server_api import ServerApi

from d3a.store.base import SCHEMA, StoreError, StoreMissing, StoreRefused, StoreUnreachable
from d3a.store.mongo import MongoStore
from d3a.store.mongo_documents import Document

MIN_WIRE_VERSION = 13  # 5.0, the first with the Stable API
SELECTION_TIMEOUT_MS = 5_000
DEFAULT_DATABASE = "d3a"
BOUND_M = 10_000
COLLECTIONS = ("oic", "stc", "keyframes", "encounters", "views", "regions", "recordings", "meta")
Keys = list[tuple[str, Any]]
INDEXES: dict[str, list[Keys]] = {
    "oic": [[("category", 1), ("_id", 1)], [("names", 1)], [("votes", 1)]],
    "stc": [[("object_id", 1), ("last", -1)], [("loc", "2d"), ("last", 1)], [("last", 1)]],
    "encounters": [[("a", 1), ("start", 1)], [("b", 1), ("start", 1)], [("start", 1)]],
    "views": [[("end", 1)]],
}
_AUTHENTICATION = {13, 18}  # Unauthorized, AuthenticationFailed


def open_mongo(
    uri: str,
    masked: str,
    *,
    create: bool = True,
    read_only: bool = False,
    listeners: Sequence[CommandListener] = (),
) -> MongoStore:
    """Open the store in the database that the address names, `d3a` where it names none.

    masked: the address as it may be shown. listeners: are told of every command sent. A batch
    that a killed writer left in the journal is applied again, unless read_only. Raises
    StoreUnreachable, or StoreError for a server too old and for a database of another program.
    """
    create = create and not read_only
    with translated(masked):
        client = _client(uri, listeners)
        try:
            check_version(client.admin.command("hello"))
            database = client.get_default_database(DEFAULT_DATABASE)
            _claim(database, create=create)
            if not read_only:
                _index(database)
            store = MongoStore(masked, client, database, translated, read_only=read_only)
            if not read_only:
                store.recover()
        except BaseException:
            client.close()
            raise
    return store


@contextmanager
def translated(uri: str) -> Iterator[None]:
    """Let no error of pymongo out; the message names the masked address."""
    try:
        yield
    except StoreRefused:
        raise  # it is about a record, not about the server
    except StoreError as error:
        if str(error).startswith(uri):
            raise
        raise type(error)(f"{uri}: {error}") from error
    except ConnectionFailure as error:
        said = str(error).split(", Timeout:")[0].split(" (configured timeouts:")[0]
        raise StoreUnreachable(f"{uri}: no MongoDB server answers ({said})") from error
    except OperationFailure as error:
        if error.code in _AUTHENTICATION:
            raise StoreUnreachable(
                f"{uri}: the server refuses this user ({_said(error)})"
            ) from error
        raise StoreError(f"{uri}: {_said(error)}") from error
    except (InvalidURI, ValueError) as error:  # their messages may quote a password
        said = "mongodb://host:27017/database would do"
        raise StoreUnreachable(f"{uri}: the address cannot be used; {said}") from error
    except ConfigurationError as error:  # an unknown host of mongodb+srv, an unknown option
        raise StoreUnreachable(f"{uri}: the address cannot be used ({error})") from error
    except PyMongoError as error:
        raise StoreError(f"{uri}: {error}") from error


def _said(error: OperationFailure) -> str:
    if isinstance(error, BulkWriteError) and error.details:
        failed = [entry["errmsg"] for entry in error.details.get("writeErrors", [])]
        return failed[0] if failed else str(error)
    details: Mapping[str, Any] = error.details or {}
    return str(details.get("errmsg", error))


def _client(uri: str, listeners: Sequence[CommandListener]) -> MongoClient[Document]:
    asked = {name.lower() for name in parse_qs(uri.partition("?")[2], keep_blank_values=True)}
    waits: dict[str, Any] = {}
    if "serverselectiontimeoutms" not in asked:
        waits["serverSelectionTimeoutMS"] = SELECTION_TIMEOUT_MS
    return MongoClient(
        uri,
        server_api=ServerApi("1", strict=True, deprecation_errors=True),
        tz_aware=True,
        datetime_conversion="DATETIME_MS",
        w="majority",
        journal=True,
        appname="d3a",
        event_listeners=list(listeners),
        **waits,
    )


def check_version(hello: Mapping[str, Any]) -> None:
    """Raise StoreError for a server older than the Stable API."""
    version = hello.get("maxWireVersion", 0)
    if version < MIN_WIRE_VERSION:
        raise StoreError(
            f"the server speaks wire version {version}, which is older than MongoDB 5.0 "
            f"({MIN_WIRE_VERSION}); update the server"
        )


def _claim(database: Database[Document], *, create: bool) -> None:
    """Find the store in the database, or make it in one that holds nothing of its names."""
    about = database["meta"].find_one({"_id": "d3a:schema"})
    if about is not None:
        schema = about["value"]
        if schema > SCHEMA:
            raise StoreError(
                f"it has schema {schema}, this version reads up to {SCHEMA}: update d3a to open it"
            )
        return
    foreign = sorted(set(database.list_collection_names()) & set(COLLECTIONS))
    if any(database[name].find_one({}, {"_id": 1}) is not None for name in foreign):
        raise StoreError(
            f"database {database.name!r} has collections {', '.join(foreign)} of another program; "
            "name another database"
        )
    if not create:
        raise StoreMissing(
            f"database {database.name!r} holds no store; ingest a recording to make one"
        )
    database["meta"].update_one(
        {"_id": "d3a:schema"}, {"$setOnInsert": {"value": SCHEMA}}, upsert=True
    )


def _index(database: Database[Document]) -> None:
    """Make the indexes and compare them with what the server says it has."""
    for name, wanted in INDEXES.items():
        for keys in wanted:
            bounds: dict[str, Any] = (
                {"min": -BOUND_M, "max": BOUND_M} if ("loc", "2d") in keys else {}
            )
            database[name].create_index(keys, **bounds)
        made = {
            tuple((field, _direction(order)) for field, order in index["key"].items()): index
            for index in database[name].list_indexes()
        }
        for keys in wanted:
            index = made.get(tuple(keys))
            if index is None or (("loc", "2d") in keys and index.get("max") != BOUND_M):
                raise StoreError(f"the server did not make the index {keys} of {name!r}")


def _direction(order: Any) -> Any:
    return order if isinstance(order, str) else int(order)  # some servers list 1.0 for 1
