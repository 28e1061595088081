"""The keys of the chat as textual has them; `assistant.keymap` names them for settings."""

from __future__ import annotations

from collections.abc import Mapping

from textual.binding import Binding, BindingType

from assistant.keymap import ACTIONS

_SHOWN = ("help", "picture", "map", "speak", "large", "save", "why", "copy", "quit")
_DONE_BY = {"copy": "copy_answer", "palette": "command_palette"}
_OF_THE_SCREEN = {"earlier": "earlier(-1)", "later": "earlier(1)"}

APP_KEYS: list[BindingType] = [
    *(
        Binding(
            key,
            _DONE_BY.get(action, action),
            action.capitalize(),
            show=action in _SHOWN,
            priority=action == "palette",
            id=action,
        )
        for action, key in ACTIONS.items()
        if action not in _OF_THE_SCREEN
    ),
    Binding("ctrl+c", "help_quit", show=False, system=True),
]
SCREEN_KEYS: list[BindingType] = [
    Binding(ACTIONS[action], done_by, action.capitalize(), show=False, id=action)
    for action, done_by in _OF_THE_SCREEN.items()
]


def closing(*actions: str) -> list[BindingType]:
    """Return the keys that take away what they have opened."""
    return [
        Binding(ACTIONS[action], "dismiss_sheet", "Back", show=False, id=action)
        for action in actions
    ]


def keys_said(keys: Mapping[str, str]) -> str:
    """Return a line for the help about keys that the settings have changed."""
    if not keys:
        return ""
    said = "   ".join(
        f"{action}: {' or '.join(part.capitalize() for part in key.split(','))}"
        for action, key in keys.items()
    )
    return f"\n\nYour own keys   {said}"
