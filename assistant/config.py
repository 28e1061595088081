"""Settings: flag, then environment, then ./d3a.toml, then the user's file, then the default."""

from __future__ import annotations

import difflib
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from datetime import UTC, datetime, tzinfo
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo, available_timezones

from assistant import keymap

APP = "d3a"
FILE = "d3a.toml"
CHOICES = {
    "color": ("auto", "always", "never"),
    "images": ("auto", "kitty", "sixel", "cells", "ascii", "off"),
}
_KINDS = {str: (str, "text"), bool: (bool, "true or false"), dict: (Mapping, "a table")}
HIDDEN = {"clock", "store_from"}
"""Fields of Settings that no file may hold."""
STORE_SCHEME = "sqlite:///"


class SettingsError(Exception):
    """A setting that cannot be used: says what was found, where, and what would do."""


@dataclass(frozen=True, slots=True)
class Settings:
    """What holds for one run of `d3a`.

    store: a path or URI, None for the default file. store_from: where that was said.
    zone: an IANA name, None for the store's own. now: ISO, "last", or None for the clock.
    images: how the chat shows pictures, one of CHOICES; see `assistant.protocols`.
    history: whether questions are kept for the next chat. speak: the command that says an answer
    aloud, its words being the last argument; empty for the first that the machine has.
    theme: of the chat's colours, by its name; empty for the usual one.
    keys: the chat's keys by action where they are not the usual ones; see `keymap`.
    """

    clock: Callable[[], datetime]
    store: str | None = None
    store_from: str = "the default"
    zone: str | None = None
    now: str | None = None
    color: str = "auto"
    images: str = "auto"
    quiet: bool = False
    history: bool = True
    speak: str = ""
    theme: str = ""
    keys: Mapping[str, str] = field(default_factory=dict)

    @property
    def store_uri(self) -> str:
        """The store's address, the default file where nothing else was said."""
        return self.store or STORE_SCHEME + str(user_data() / "memory.db")

    @property
    def zone_info(self) -> ZoneInfo | None:
        """The zone that was asked for; SettingsError for a name that no zone has."""
        return None if self.zone is None else zone_of(self.zone)

    def moment(self) -> datetime:
        """Return `now` without a store: --now, else the clock, in the zone that was asked for.

        Without --zone the offset of --now holds, else the machine's zone. SettingsError for
        a `now` that is no ISO time, or "last", which only a store can tell.
        """
        if self.now == "last":
            raise SettingsError(
                "--now last is the time of a store's newest frame; give an ISO time"
            )
        if self.now is None:
            return self.clock().astimezone(self.zone_info or machine_zone())
        return moment_of(self.now, self.zone_info)


def moment_of(text: str, zone: tzinfo | None) -> datetime:
    """Return the time written in `text`, in `zone` where one is given."""
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise SettingsError(
            f"--now {text!r} is not a time; write it like 2020-02-25T19:00:00-05:00"
        ) from None
    if moment.tzinfo is None:
        return moment.replace(tzinfo=zone or machine_zone())
    try:
        return moment.astimezone(zone) if zone else moment
    except OverflowError:
        raise SettingsError(f"--now {text!r} is out of the calendar") from None


def zone_of(name: str) -> ZoneInfo:
    """Return the zone of an IANA name; SettingsError with the nearest names otherwise."""
    try:
        return ZoneInfo(name)
    except (ValueError, OSError, KeyError):
        zones = {known.lower(): known for known in available_timezones()}
        near = difflib.get_close_matches(name.lower(), zones, n=3, cutoff=0.6)
        hint = f"; did you mean {', '.join(zones[n] for n in near)}?" if near else ""
        raise SettingsError(
            f"there is no time zone {name!r}; give an IANA name such as Europe/Berlin{hint}"
        ) from None


def machine_zone() -> tzinfo:
    """Return the zone this machine is set to, UTC where it does not say."""
    from zoneinfo import ZoneInfoNotFoundError

    import tzlocal

    try:
        return tzlocal.get_localzone()
    except (ZoneInfoNotFoundError, ValueError, OSError):
        return UTC


def user_data() -> Path:
    """Return the folder of the default store, made for its owner alone."""
    import platformdirs

    return _private(Path(platformdirs.user_data_dir(APP, appauthor=False)))


def user_cache() -> Path:
    """Return the folder of the demo's store."""
    import platformdirs

    return _private(Path(platformdirs.user_cache_dir(APP, appauthor=False)))


def user_state() -> Path:
    """Return the folder of the chat's history."""
    import platformdirs

    return _private(Path(platformdirs.user_state_dir(APP, appauthor=False)))


def user_file() -> Path:
    """Return the user's settings file, which need not exist."""
    import platformdirs

    return Path(platformdirs.user_config_dir(APP, appauthor=False)) / FILE


def _private(folder: Path) -> Path:
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise SettingsError(f"the folder {folder} cannot be made: {error.strerror}") from error
    return folder


def load(
    clock: Callable[[], datetime],
    environ: Mapping[str, str] = os.environ,
    files: tuple[Path, ...] | None = None,
) -> Settings:
    """Return the settings of the files and the environment; flags are laid over them later.

    files: weakest first; by default the user's file, then ./d3a.toml.
    """
    settings = Settings(clock)
    for path in (user_file(), Path(FILE)) if files is None else files:
        settings = _laid_over(settings, _read(path), f"{path}")
    given: dict[str, Any] = {
        name: environ[f"D3A_{name.upper()}"]
        for name in ("store", "zone", "now", "color", "images", "speak", "theme")
        if environ.get(f"D3A_{name.upper()}")
    }
    return _laid_over(settings, given, "the environment (D3A_*)")


def _read(path: Path) -> Mapping[str, Any]:
    try:
        text = path.read_text(encoding="utf-8")
        import tomllib  # most have no file

        return tomllib.loads(text)
    except FileNotFoundError:
        return {}
    except (OSError, ValueError) as error:  # also: not UTF-8, not TOML
        raise SettingsError(f"the settings file {path} cannot be read: {error}") from error


def _laid_over(settings: Settings, given: Mapping[str, Any], where: str) -> Settings:
    known = {f.name: type(getattr(settings, f.name)) for f in fields(settings)}
    allowed = sorted(known.keys() - HIDDEN)
    for name, value in given.items():
        if name not in allowed:
            near = difflib.get_close_matches(name, allowed, n=1, cutoff=0.0)
            raise SettingsError(f"{where} sets {name!r}, which is no setting; nearest: {near[0]}")
        kind, expected = _KINDS.get(known[name], _KINDS[str])
        if not isinstance(value, kind):
            raise SettingsError(f"{where} sets {name} to {value!r}; it must be {expected}")
        if name in CHOICES and value not in CHOICES[name]:
            choices = ", ".join(CHOICES[name])
            raise SettingsError(f"{where} sets {name} to {value!r}; it must be one of {choices}")
    if "keys" in given:
        try:
            given = {**given, "keys": keymap.checked(given["keys"])}
        except keymap.KeysError as error:
            raise SettingsError(f"{where}: {error}") from None
    if "store" in given:
        settings = replace(settings, store_from=where)
    return replace(settings, **given)
