"""D3A: frames and poses in, OIc and STc filled, ranked keyframes out. Needs no language.

`d3a.open(store)` gives a memory to ask: `ask`, `plan`, `explain`, `objects`. Below it start at
`d3a.readers` (recordings), `d3a.ingest` (the three tiers), `d3a.store` (both backends) and
`d3a.execute` (answers). Nothing is loaded before it is used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from assistant.api import BadQuestion, Memory, open  # noqa: A004  d3a.open is its name
    from d3a.answer import Answer, RankedKeyframe
    from d3a.model import BadInput, D3AError
    from d3a.store.base import StoreError, StoreUnreachable
    from grammar.forms import FormalQuery

__all__ = [
    "Answer",
    "BadInput",
    "BadQuestion",
    "D3AError",
    "FormalQuery",
    "Memory",
    "RankedKeyframe",
    "StoreError",
    "StoreUnreachable",
    "open",
]
_HOMES = {
    "Answer": "d3a.answer",
    "BadInput": "d3a.model",
    "BadQuestion": "assistant.api",
    "D3AError": "d3a.model",
    "FormalQuery": "grammar.forms",
    "Memory": "assistant.api",
    "RankedKeyframe": "d3a.answer",
    "StoreError": "d3a.store.base",
    "StoreUnreachable": "d3a.store.base",
    "open": "assistant.api",
}


def __getattr__(name: str) -> Any:
    """Load a public name when it is first used (PEP 562)."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    """Return the public names with the others."""
    return sorted({*globals(), *__all__})
