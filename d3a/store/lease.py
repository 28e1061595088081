"""Who may write, and for how long: a lease with an owner, an end and a fencing number.

An ingest holds what it has seen in memory, so two of one store would overwrite each other: who
ingests takes the store's lease, and renews it as long as it runs. A lease ends by itself, so that
a machine that died blocks nobody; a process that died on the same machine is not waited for. Who
was stopped for longer than its lease finds another fencing number, and writes nothing more.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from d3a.model import Json
from d3a.store.errors import StoreBusy, StoreError

if TYPE_CHECKING:
    from d3a.store.base import Store

TERM_S = 30.0
"""For so long a lease holds that is not renewed."""
RENEWALS = 3
"""So often a lease is renewed within its term: one that fails ends nothing."""


@dataclass(frozen=True, slots=True)
class Lease:
    """One taking of the right to write.

    owner: unique to this taking. who: for people ("ingest of kuri"). fence: greater with each
    taking. until_ms: when it ends, by the store's clock; 0 for one that was given back.
    """

    owner: str
    who: str
    host: str
    process: int
    fence: int
    until_ms: int

    @classmethod
    def next(cls, before: Lease | None, who: str, now_ms: int) -> Lease:
        """Return a new lease of this process, after another."""
        fence = 1 if before is None else before.fence + 1
        until_ms = now_ms + round(TERM_S * 1000)
        return cls(os.urandom(16).hex(), who, _host(), os.getpid(), fence, until_ms)

    def is_held(self, now_ms: int) -> bool:
        """Say whether its owner may still be writing."""
        return now_ms < self.until_ms and not self._has_died()

    def _has_died(self) -> bool:
        """Say whether the owner is known to be gone: a process of this machine that ended."""
        if os.name != "posix" or self.host != _host():
            return False
        try:
            os.kill(self.process, 0)  # asks whether it is there, and sends nothing
        except ProcessLookupError:
            return True
        except PermissionError:
            return False  # it is there, and somebody else's
        return False

    def told(self) -> str:
        """Return who holds it and until when, for a message."""
        until = datetime.fromtimestamp(self.until_ms / 1000, UTC)
        return f"{self.who} (process {self.process} on {self.host}) until {until:%H:%M:%S} UTC"

    def to_json(self) -> Json:
        """Return the fields as a store keeps them."""
        return {
            "owner": self.owner,
            "who": self.who,
            "host": self.host,
            "process": self.process,
            "fence": self.fence,
            "until_ms": self.until_ms,
        }


def _host() -> str:
    import socket  # which a question does without

    return socket.gethostname()


@contextmanager
def leased(store: Store, who: str) -> Iterator[Lease]:
    """Hold the store's lease, renewed by a thread; raises StoreBusy where another holds it."""
    lease = take(store, who)
    ended = threading.Event()
    renewing = threading.Thread(
        target=_renew, args=(store, lease, ended), name="d3a-lease", daemon=True
    )
    renewing.start()
    try:
        yield lease
    except BaseException:
        ended.set()
        renewing.join()
        with suppress(StoreError):  # what failed first is told; a lease ends by itself
            give_back(store, lease)
        raise
    ended.set()
    renewing.join()
    give_back(store, lease)


def take(store: Store, who: str) -> Lease:
    """Take the store's lease for one term; raises StoreBusy where another holds it."""
    with store.turn():
        now_ms, before = store.clock_ms(), store.lease()
        if before is not None and before.is_held(now_ms):
            raise StoreBusy(
                f"{store.uri}: it is being filled: {before.told()}, renewed while it runs; "
                "two ingests of one store would overwrite each other: let that one end, or stop it"
            )
        lease = Lease.next(before, who, now_ms)
        store.put_lease(lease)
    return lease


def renew(store: Store, lease: Lease) -> bool:
    """Let a lease hold for a term from now; False where another has taken it."""
    with store.turn():
        return _put_end(store, lease, store.clock_ms() + round(TERM_S * 1000))


def give_back(store: Store, lease: Lease) -> None:
    """End a lease, unless another has taken it."""
    with store.turn():
        _put_end(store, lease, 0)


def _put_end(store: Store, lease: Lease, until_ms: int) -> bool:
    """Let a lease end at a time, in a turn; False where another has taken it."""
    now = store.lease()
    if now is None or now.fence != lease.fence:
        return False
    store.put_lease(replace(lease, until_ms=until_ms))
    return True


def _renew(store: Store, lease: Lease, ended: threading.Event) -> None:
    while not ended.wait(TERM_S / RENEWALS):
        # one that fails is tried again; where all do, the fence ends the ingest when it writes
        with suppress(StoreError):
            if not renew(store, lease):
                return
