"""Frozen records by the thousand: made as quickly as if they were not frozen.

The constructor of a frozen dataclass sets each field through `object.__setattr__`, which takes ten
times as long as an assignment: most of the time of decoding a row of SQLite went there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import Any, TypeVar

T = TypeVar("T")


def maker(record: type[T]) -> Callable[..., T]:
    """Return a quick constructor of a frozen dataclass with slots; it takes every field.

    An open twin with the same slots is filled, and then made one of the record: the class of an
    object may be changed to one that has the same `__slots__` (Python's data model). What the
    record checks in `__post_init__` is not checked again: it was when the row was written.
    """
    names = [each.name for each in fields(record)]  # type: ignore[arg-type]  # a dataclass
    filled = "; ".join(f"self.{name} = {name}" for name in names)
    scope: dict[str, Any] = {"__frozen": record}  # a name that no field has
    # as dataclasses write their own constructors, without the rest that they make: 60 us a class
    exec(f"def init(self, {', '.join(names)}): {filled}; self.__class__ = __frozen", scope)
    return type(record.__name__, (), {"__slots__": names, "__init__": scope["init"]})
