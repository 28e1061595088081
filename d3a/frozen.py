"""Frozen records by the thousand: made as quickly as if they were not frozen.

The constructor of a frozen dataclass sets each field through `object.__setattr__`, which takes six
times as long as an assignment: most of the time of decoding a row of SQLite went there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, make_dataclass
from typing import Any, TypeVar

T = TypeVar("T")


def maker(record: type[T]) -> Callable[..., T]:
    """Return a quick constructor of a frozen dataclass with slots; it takes every field.

    An open twin with the same slots is filled, and then made one of the record: the class of an
    object may be changed to one that has the same `__slots__` (Python's data model). What the
    record checks in `__post_init__` is not checked again: it was when the row was written.
    """
    names = [each.name for each in fields(record)]  # type: ignore[arg-type]  # a dataclass

    def freeze(one: Any) -> None:
        one.__class__ = record

    own = {"__slots__": names, "__post_init__": freeze}
    return make_dataclass(
        record.__name__, names, namespace=own, eq=False, repr=False, match_args=False
    )
