"""Turns of the writers of one database: a document says whose it is, until when.

A server has no lock that its clients share, so a writer puts its name into the document and takes
it out again. It is a short lease (see `lease`): a writer that died in its turn is not waited for
longer than its term. Before every command that writes it makes sure that the turn is still its own.

Transactions would be no better: what a killed client leaves of one stays locked for a minute, and a
standalone server has none.
"""

from __future__ import annotations

from time import monotonic, sleep

from pymongo.database import Database
from pymongo.errors import DuplicateKeyError

from d3a.store.errors import StoreBusy, StoreConflict
from d3a.store.lease import TERM_S, Lease
from d3a.store.mongo_documents import Document

TURN, LEASE = "d3a:turn", "d3a:lease"
WAIT_S = 2 * TERM_S
_POLL_S = 0.02


def server_ms(database: Database[Document]) -> int:
    """Return the server's time: those of its clients may differ."""
    asked = database.command("hello", codec_options=database.codec_options)
    return int(asked["localTime"])


def lease_of(database: Database[Document], key: str) -> Lease | None:
    """Return the lease that a document of `meta` holds."""
    found = database["meta"].find_one({"_id": key}, {"_id": 0})
    return None if found is None else Lease(**found)


class Turns:
    """Turns of one client; one at a time, the caller sees to that."""

    def __init__(self, database: Database[Document]) -> None:
        self._db = database
        self._mine: Lease | None = None
        self._renew_at = 0.0

    def begin(self) -> bool:
        """Wait for the turn; return whether the one before was not ended, so may have left work.

        Raises StoreBusy where another holds on to it.
        """
        given_up = monotonic() + WAIT_S
        while True:
            asked = monotonic()
            now_ms, before = server_ms(self._db), lease_of(self._db, TURN)
            is_mine = self._is_mine(before)
            if before is None or is_mine or not before.is_held(now_ms):
                lease = Lease.next(before, "a write", now_ms)
                if self._swapped(before, lease):
                    self._mine, self._renew_at = lease, asked + TERM_S / 2
                    return before is not None and before.until_ms > 0
            elif asked > given_up:
                raise StoreBusy(f"another writes to it: {before.told()}; try again")
            sleep(_POLL_S)

    def _is_mine(self, before: Lease | None) -> bool:
        """Whether it is an earlier turn of this client, whose end did not reach the server."""
        own = self._mine
        return before is not None and own is not None and before.owner == own.owner

    def _swapped(self, before: Lease | None, lease: Lease) -> bool:
        """Put a lease in the place of the one that was read; False where another was quicker."""
        meta = self._db["meta"]
        if before is None:
            try:
                meta.insert_one({"_id": TURN, **lease.to_json()})
            except DuplicateKeyError:
                return False
            return True
        read = {"_id": TURN, "fence": before.fence, "until_ms": before.until_ms}
        return meta.update_one(read, {"$set": lease.to_json()}).matched_count == 1

    def keep(self) -> None:
        """Make sure that the turn is still this client's, for some seconds more.

        Raises StoreConflict where another has taken it.
        """
        asked = monotonic()
        if asked < self._renew_at:
            return
        until_ms = server_ms(self._db) + round(TERM_S * 1000)
        if not self._set(until_ms):
            raise StoreConflict("this process was held up for so long that another took its turn")
        self._renew_at = asked + TERM_S / 2

    def end(self, *, is_unfinished: bool) -> None:
        """Let the next one begin; is_unfinished: it has to finish what the journal holds."""
        self._set(int(is_unfinished))

    def _set(self, until_ms: int) -> bool:
        assert self._mine is not None
        own = {"_id": TURN, "fence": self._mine.fence}
        change = {"$set": {"until_ms": until_ms}}
        return self._db["meta"].update_one(own, change).matched_count == 1
