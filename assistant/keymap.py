"""The chat's keys by the name of what they do, and what may be put in their place.

In a settings file:

    [keys]
    why = "ctrl+y"
    help = "f9,ctrl+g"
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping

ACTIONS = {
    "help": "f1",
    "picture": "f2",
    "map": "f3",
    "speak": "f4",
    "large": "f5",
    "save": "f6",
    "why": "f7",
    "copy": "f8",
    "palette": "ctrl+p",
    "quit": "ctrl+q",
    "stop": "escape",
    "earlier": "pageup",
    "later": "pagedown",
}
"""What a key does, and the key that does it where nothing else is said."""

_KEY = re.compile(
    r"f([1-9]|1\d|2[0-4])"
    r"|(ctrl\+|alt\+|ctrl\+shift\+|alt\+shift\+)([a-z0-9]|up|down|left|right|home|end)"
    r"|(shift\+|ctrl\+)?(f([1-9]|1\d|2[0-4])|pageup|pagedown|insert|delete)"
    r"|escape"
)
_SAME = {"ctrl+i": "Tab", "ctrl+m": "Enter", "ctrl+h": "Backspace", "ctrl+j": "Enter"}
"""What a terminal sends for these is what it sends for another key."""
_TAKEN = {"ctrl+c": "copies a selection", "delete": "deletes a letter"}


class KeysError(ValueError):
    """Keys that cannot be: says which, why, and what would do."""


def checked(given: Mapping[str, object]) -> dict[str, str]:
    """Return the keys of a settings file by action. Raises KeysError."""
    keys: dict[str, str] = {}
    for action, said in given.items():
        if action not in ACTIONS:
            near = difflib.get_close_matches(action, ACTIONS, n=1, cutoff=0.0)
            raise KeysError(f"keys.{action} is nothing that a key does; nearest: {near[0]}")
        if not isinstance(said, str):
            raise KeysError(f'keys.{action} is {said!r}; write it as text, like "ctrl+g"')
        keys[action] = ",".join(_key(action, part.strip()) for part in said.lower().split(","))
    owner: dict[str, str] = {}
    for action, said in (ACTIONS | keys).items():
        for key in said.split(","):
            if key in owner:
                words = f"{key} is to do both {owner[key]} and {action}; give one of them another"
                raise KeysError(words)
            owner[key] = action
    return keys


def _key(action: str, key: str) -> str:
    if key in _SAME:
        raise KeysError(f"keys.{action} is {key}, which a terminal cannot tell from {_SAME[key]}")
    if key in _TAKEN:
        raise KeysError(f"keys.{action} is {key}, which {_TAKEN[key]}")
    if _KEY.fullmatch(key) is None:
        would = "f1 to f24, ctrl+ or alt+ and a letter, pageup, insert"
        raise KeysError(f"keys.{action} is {key!r}, which is no key for it; such would do: {would}")
    return key
