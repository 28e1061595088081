"""What a store raises: one base, and kinds that a caller may tell apart."""

from __future__ import annotations

from d3a.model import D3AError

DAMAGED_PAGES = "the file is damaged: "
"""How `Store.check` tells of what `repair` cannot mend: then it mends nothing at all."""


class StoreError(D3AError):
    """The store failed or refused; the message says which store, why, and what would do."""


class StoreUnreachable(StoreError):  # noqa: N818
    """The store cannot be opened or reached; passwords in its URI are masked."""


class StoreMissing(StoreUnreachable):
    """There is no store at that address yet; one is made where something is put in."""


class StoreDamaged(StoreError):  # noqa: N818
    """The bytes of the store are damaged: what they held cannot be read, or not all of it."""


class StoreRefused(StoreError):  # noqa: N818
    """A record is outside of the limits of the store (see `limits.py`)."""


class StoreConflict(StoreError):  # noqa: N818
    """Another wrote what a batch was made from: read again, and make it anew."""


class StoreBusy(StoreError):  # noqa: N818
    """Another writes to the store, and was not waited for; the message says who and until when."""
