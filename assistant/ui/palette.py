"""The palette of all commands: textual's, made safe against a key that comes too early."""

from __future__ import annotations

from textual.command import CommandList, CommandPalette


class Palette(CommandPalette):
    """Every command by its name.

    textual 8.2 fails on Page Up and Page Down while the list has no room yet: as it opens, or in
    a tiny window. Such a key does nothing here.
    """

    def _action_command_list(self, action: str) -> None:
        if self.query_one(CommandList).size.area:
            super()._action_command_list(action)
