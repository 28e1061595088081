"""The stores of OIc and STc: `open_store` gives SQLite for a file, MongoDB for a server."""

from d3a.store.opening import mask, open_store

__all__ = ["mask", "open_store"]
