"""Copy text to the clipboard of the person's machine, or say how else to get it.

Here a command of the desktop does it; over ssh only the terminal can (OSC 52), and some do not:
then the text is written to a file.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Mapping
from pathlib import Path

from assistant.saving import save_text

_COMMANDS = (
    ("WAYLAND_DISPLAY", ("wl-copy",)),
    ("DISPLAY", ("xclip", "-selection", "clipboard")),
    ("DISPLAY", ("xsel", "--clipboard", "--input")),
    ("", ("pbcopy",)),
)
_PATIENCE_S = 2.0


def is_remote(environ: Mapping[str, str]) -> bool:
    """Whether the person sits at another machine than the one this runs on."""
    return bool(environ.get("SSH_CONNECTION") or environ.get("SSH_TTY"))


def takes_osc_52(environ: Mapping[str, str]) -> bool:
    """Whether the terminal may take what is copied: a few are known never to."""
    console = environ.get("TERM", "").startswith("linux")
    return not console and environ.get("TERM_PROGRAM") != "Apple_Terminal"


def copied_here(
    text: str,
    environ: Mapping[str, str] = os.environ,
    which: Callable[[str], str | None] = shutil.which,
) -> bool:
    """Copy by a command of the desktop; False where there is none, or this is not its machine."""
    if is_remote(environ):
        return False
    for variable, command in _COMMANDS:
        if (variable and not environ.get(variable)) or which(command[0]) is None:
            continue
        try:
            done = subprocess.run(
                command,
                input=text.encode(),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                timeout=_PATIENCE_S,
                check=False,
            )
        except (OSError, subprocess.TimeoutExpired):
            continue
        if done.returncode == 0:
            return True
    return False


def copied(
    text: str, folder: Path, *, by_terminal: bool, environ: Mapping[str, str] = os.environ
) -> str:
    """Copy by the desktop, else leave it to the terminal, else write a file; return what to tell.

    by_terminal: the text was sent to the terminal too (OSC 52), which may or may not take it.
    """
    if copied_here(text, environ):
        return "Copied."
    if by_terminal and takes_osc_52(environ):
        return "Copied, if the terminal allows it. F6 saves a file."
    try:
        path = save_text(text, folder)
    except OSError as error:
        return f"Nothing could be copied, and {folder} cannot be written: {error.strerror or ''}"
    return f"There is no clipboard for it here: saved {path.absolute()}"
