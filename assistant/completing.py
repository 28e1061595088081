"""What the shell completes from the store: ids, categories, taught names, places.

Only an embedded store is looked into: a key press must not wait for a server. Whatever fails
completes nothing, and says nothing: a message would land in the middle of the person's line.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import click
from click.shell_completion import CompletionItem

from assistant import config
from assistant.options import said_so_far

if TYPE_CHECKING:
    from d3a.store.base import Store

Completer = Callable[[click.Context, click.Parameter, str], list[CompletionItem]]
Candidates = Iterable[tuple[str, str]]
"""Words with what they are."""


@contextmanager
def _looked_into(context: click.Context) -> Iterator[Store | None]:
    """Give the store that the line so far is about, None where it is not at hand."""
    from d3a.model import D3AError
    from d3a.store import open_store

    try:
        settings = replace(config.load(lambda: datetime.now(UTC)), **said_so_far(context))
        uri = settings.store_uri
        if "://" in uri and not uri.startswith("sqlite:"):
            yield None
            return
        store = open_store(uri, create=False, read_only=True)
    except (D3AError, config.SettingsError):
        yield None
        return
    try:
        yield store
    finally:
        store.close()


def _completer(candidates: Callable[[Store], Candidates]) -> Completer:
    def complete(
        context: click.Context, parameter: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        from d3a.model import D3AError

        with _looked_into(context) as store:
            if store is None:
                return []
            try:
                found = dict(candidates(store))
            except D3AError:
                return []
        start = incomplete.casefold()
        # A control character would act on the terminal, a line break end the answer.
        fit = {word for word in found if word.isprintable() and word.casefold().startswith(start)}
        return [CompletionItem(word, help=found[word]) for word in sorted(fit)]

    return complete


def _ids(store: Store) -> Iterator[tuple[str, str]]:
    for thing in store.objects():
        named = ", ".join(name.word for name in thing.names)
        yield thing.object_id, f"{thing.category} ({named})" if named else thing.category


def _categories(store: Store) -> Iterator[tuple[str, str]]:
    for category, count in store.categories():
        yield category, f"{count} of them"


def _things(store: Store) -> Iterator[tuple[str, str]]:
    yield from _ids(store)
    for thing in store.objects():
        for name in thing.names:
            yield name.word, thing.category
    yield from _categories(store)


def _places(store: Store) -> Iterator[tuple[str, str]]:
    for region in store.regions():
        yield region.name, "place"


object_ids = _completer(_ids)
categories = _completer(_categories)
things = _completer(_things)
places = _completer(_places)
