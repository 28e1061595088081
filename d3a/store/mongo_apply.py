"""How a batch gets into a database whole: by the journal, in a turn of its writer."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress

from pymongo.database import Database
from pymongo.errors import PyMongoError

from d3a.store.base import Batch, StoreConflict, StoreError
from d3a.store.mongo_documents import Document
from d3a.store.mongo_journal import Entry, Journal
from d3a.store.mongo_turn import Turns
from d3a.store.mongo_write import Writer


class Applier:
    """Applies batches; for one thread at a time. Errors are those of pymongo."""

    def __init__(self, database: Database[Document]) -> None:
        self._turns = Turns(database)
        self._writer = Writer(database, self._turns.keep)
        self._journal = Journal(database)
        self._has_turn = False
        self._is_unfinished = False

    @contextmanager
    def turn(self) -> Iterator[None]:
        """Be the one writer; what a killed one has written down and not finished is finished."""
        if self._has_turn:
            yield
            return
        is_left = self._turns.begin()
        self._has_turn = True
        try:
            if is_left or self._is_unfinished:
                self.finish()
            yield
        except BaseException:
            with suppress(PyMongoError):  # what failed first is told; a turn ends by itself
                self._turns.end(is_unfinished=self._is_unfinished)
            raise
        else:
            self._turns.end(is_unfinished=False)
        finally:
            self._has_turn = False

    def keep(self) -> None:
        """Before a command that writes: make sure that the turn is still this client's."""
        self._turns.keep()

    def apply(self, batch: Batch) -> None:
        """Apply a batch, in a turn; returns when a majority of the servers has it."""
        self._writer.check(batch)
        entry = Entry(batch, self._writer.put_bytes(batch))
        self._turns.keep()
        self._is_unfinished = True
        self._journal.write(entry)
        try:
            self._write(entry)
        except StoreConflict as error:
            said = f"{error}, and finished what this one had written down"
            raise StoreError(said) from error

    def finish(self) -> None:
        """Apply again, in a turn, what was written down and not finished."""
        self._write(self._journal.pending())

    def _write(self, entry: Entry | None) -> None:
        if entry is not None:
            self._writer.write(entry)
        self._turns.keep()
        self._journal.done()
        self._is_unfinished = False
