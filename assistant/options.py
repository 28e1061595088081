"""What commands share: the options each takes, their settings, an opened store, failures."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from datetime import datetime, tzinfo
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import click

from assistant.config import CHOICES, Settings, machine_zone, moment_of
from assistant.exits import ExitCode

if TYPE_CHECKING:
    from d3a.store.base import Store

_GIVEN = "assistant.given"
_Function = TypeVar("_Function", bound=Callable[..., Any])


BEGIN = "Look around in a small home with `d3a demo`, or fill your own with `d3a ingest SOURCE`."
"""What a person does first."""


class Failure(click.ClickException):
    """A run that ends with a message and a status, and without a usage line."""

    def __init__(self, message: str, status: ExitCode) -> None:
        super().__init__(message)
        self.exit_code = int(status)  # type: ignore[misc]  # click reads it from the instance

    def show(self, file: Any = None) -> None:
        """Print the message to `file`, or to standard error."""
        click.echo(f"d3a: {self.format_message()}", file=file, err=file is None)


def settings_options(function: _Function) -> _Function:
    """Add --store, --zone, --now, --color and --quiet, before or after the command's name."""
    options = (
        click.option(
            "--store",
            metavar="URI",
            help="The store: memory.db, sqlite:///..., mongodb://... [env: D3A_STORE]",
        ),
        click.option("--zone", metavar="NAME", help="Time zone, such as Europe/Berlin."),
        click.option("--now", metavar="TIME", help="ISO time, or last: that of the newest frame."),
        click.option("--color", type=click.Choice(CHOICES["color"]), help="Colours in the output."),
        click.option("-q", "--quiet", is_flag=True, default=None, help="No talk on stderr."),
    )
    for option in reversed(options):
        function = option(function)
    return _remembering(function)


def _remembering(function: _Function) -> _Function:
    """Keep the shared options in the context, so that the function does not take them."""
    for parameter in getattr(function, "__click_params__", []):
        if parameter.name in ("store", "zone", "now", "color", "quiet"):
            parameter.expose_value = False
            parameter.callback = _remember
    return function


def _remember(context: click.Context, parameter: click.Parameter, value: Any) -> Any:
    if value is not None and parameter.name is not None:
        context.meta.setdefault(_GIVEN, {})[parameter.name] = value
    return value


def store_was_named(context: click.Context) -> bool:
    """Whether --store stands on the command line."""
    return "store" in context.meta.get(_GIVEN, {})


def said_so_far(context: click.Context) -> dict[str, Any]:
    """Return the shared options that stand on the command line, as a shell completes it too."""
    return dict(context.meta.get(_GIVEN, {}))


def settings_of(context: click.Context) -> Settings:
    """Return the settings of this run, flags laid over environment and files.

    Raises SettingsError for an unknown zone or a `now` that is no time.
    """
    settings: Settings = context.find_root().obj
    given = dict(context.meta.get(_GIVEN, {}))
    if "store" in given:
        given["store_from"] = "--store"
    settings = replace(settings, **given)
    if settings.now not in (None, "last"):
        settings.moment()
    _ = settings.zone_info
    context.color = use_color(settings.color, os.environ)
    return settings


def use_color(said: str, environ: Mapping[str, str]) -> bool | None:
    """Return whether to colour; None leaves it to whether the output is a terminal."""
    if said == "auto":
        return False if environ.get("NO_COLOR") else None
    return said == "always"


@contextmanager
def failures() -> Iterator[None]:
    """Turn what d3a raises for bad input or a failing store into a message and a status."""
    from d3a.model import BadInput, D3AError

    try:
        yield
    except BadInput as error:
        raise Failure(str(error), ExitCode.USAGE) from error
    except D3AError as error:
        raise Failure(str(error), ExitCode.STORE) from error


@contextmanager
def opened(settings: Settings, *, create: bool = False) -> Iterator[Store]:
    """Open the store of the settings, and close it; d3a's errors become messages.

    create: whether a store that does not exist is made; else it is a Failure that says how to
    fill one.
    """
    from d3a.store import open_store
    from d3a.store.base import StoreMissing
    from d3a.store.opening import mask

    with failures():
        try:
            store = open_store(settings.store_uri, create=create)
        except StoreMissing as error:
            address = mask(settings.store_uri)
            raise Failure(
                f"there is no memory at {address} yet. {BEGIN}", ExitCode.STORE
            ) from error
        try:
            yield store
        finally:
            store.close()


def store_name(settings: Settings) -> str:
    """Return the store's address as it may be printed: the password masked, and who said it."""
    from d3a.store.opening import mask

    return f"{mask(settings.store_uri)} (from {settings.store_from})"


def now_of(settings: Settings, store: Store) -> datetime:
    """Return the moment that a question to `store` is asked at, in --zone or the home's zone.

    --now, else the store's own fixed now, else the clock; `last` is its newest frame's time.
    """
    from assistant.asking import store_now

    zone = zone_if_said(settings, store)
    given: datetime | Literal["last"] | None = None
    if settings.now == "last":
        given = "last"
    elif settings.now is not None:
        given = moment_of(settings.now, zone)
    moment = store_now(store, given, settings.clock)
    return moment.astimezone(zone) if zone else moment


def zone_if_said(settings: Settings, store: Store) -> tzinfo | None:
    """Return --zone, else the zone the store was told, else None."""
    from assistant.asking import home_zone

    return settings.zone_info or home_zone(store)


def zone_for(settings: Settings, store: Store) -> tzinfo:
    """Return the zone that times are said in: --zone, the home's, else the machine's."""
    return zone_if_said(settings, store) or machine_zone()
