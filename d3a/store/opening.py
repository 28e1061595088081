"""From a store's address to the store: a file for SQLite, a server for MongoDB."""

from __future__ import annotations

import re
from pathlib import Path

from d3a.store.base import Store, StoreError
from d3a.store.sqlite_file import open_sqlite

_SECRET_OPTIONS = re.compile(
    r"([?&](?:authMechanismProperties|tlsCertificateKeyFilePassword)=)[^&]*", re.IGNORECASE
)
_NO_PORT = re.compile(r"(?<=[^:,]):(?!\d{1,5}(?:,|$))[^,]+$")
"""What follows a host's colon and is no port."""


def open_store(uri: str, *, create: bool = True, read_only: bool = False) -> Store:
    """Open the store at an address.

    uri: a path, `sqlite:///relative.db`, `sqlite:////absolute.db`, `mongodb://...` or
    `mongodb+srv://...`. create: make it where there is none. read_only: never write to it.
    Raises StoreUnreachable or StoreError; passwords in the address are never shown.
    """
    scheme, separator, rest = uri.partition("://")
    if not separator:
        return open_sqlite(_path(uri), create=create, read_only=read_only)
    if scheme == "sqlite":
        if not rest.startswith("/"):
            raise StoreError(
                f"{mask(uri)}: a file is sqlite:///relative.db or sqlite:////absolute.db"
            )
        return open_sqlite(_path(rest[1:]), create=create, read_only=read_only)
    if scheme in {"mongodb", "mongodb+srv"}:
        from d3a.store.mongo_server import (
            open_mongo,
        )  # pymongo costs 0.2 s, which a file need not pay

        return open_mongo(uri, mask(uri), create=create, read_only=read_only)
    raise StoreError(
        f"{mask(uri)}: no store is known by {scheme}://; "
        "sqlite:///file.db or mongodb://host would do"
    )


def mask(uri: str) -> str:
    """Return the address without the passwords in it; it is safe to print."""
    scheme, separator, rest = uri.partition("://")
    if not separator:
        return uri
    authority = re.split(r"[/?]", rest, maxsplit=1)[0]
    if "@" in rest and "@" not in authority:  # a password with an unescaped / or ?
        authority = rest[: rest.rindex("@") + 1]
    tail = rest[len(authority) :]
    credentials, at, hosts = authority.rpartition("@")
    if at:
        user, colon, _ = credentials.partition(":")
        authority = f"{user}{colon}{'***' if colon else ''}@{hosts}"
    elif (
        scheme != "sqlite" and "[" not in authority
    ):  # the host was forgotten: what stands for a port is a password
        authority = _NO_PORT.sub(r":***", authority)
    return _SECRET_OPTIONS.sub(r"\1***", f"{scheme}://{authority}{tail}")


def _path(text: str) -> Path:
    if not text.strip() or text == ":memory:":
        raise StoreError(f"{text!r} names no file; sqlite:///file.db would do")
    if "\0" in text:
        raise StoreError("a file's name cannot hold a NUL character")
    return Path(text).expanduser()
