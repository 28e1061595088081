"""Say an answer aloud, by a command of this machine: spd-say, say, espeak-ng, or a configured one.

The words reach the command as one argument and never a shell, so that what a recording or a
person named cannot become a command.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from assistant.terminal import clean

TRIED = (("spd-say", "--"), ("say", "--"), ("espeak-ng", "--"))
"""Commands that speak their argument; `--` ends their options."""
NONE_FOUND = (
    "This machine has no spd-say, say or espeak-ng to speak with. Install one, or name a command "
    'in the settings: speak = "..."'
)


def speaker(
    configured: str | None, which: Callable[[str], str | None] = shutil.which
) -> tuple[str, ...] | None:
    """Return the command that speaks its last argument, None where there is none.

    configured: a command line of the settings, split as a shell would, without one being run.
    """
    if configured:
        try:
            words = tuple(shlex.split(configured))
        except ValueError:  # a quotation mark without its other
            return None
        return words if words and which(words[0]) else None
    return next((command for command in TRIED if which(command[0])), None)


def where_it_sounds(environ: Mapping[str, str] = os.environ) -> str:
    """Return a warning where the sound does not come out here: over ssh it is the robot's."""
    if environ.get("SSH_CONNECTION") or environ.get("SSH_TTY"):
        return "The sound comes out at the robot: this is a connection over ssh."
    return ""


@dataclass(slots=True)
class Voice:
    """Speaks one text at a time; a second call stops the first.

    configured: the command of the settings, None for the first that the machine has.
    """

    configured: str | None = None
    _running: subprocess.Popen[bytes] | None = None

    def say(self, text: str) -> str:
        """Begin to speak and return what the person should know, or why nothing is heard."""
        if self.stop():
            return "Stopped speaking."
        command = speaker(self.configured)
        if command is None and self.configured:
            return f"The command to speak with cannot be run: {self.configured}"
        if command is None:
            return NONE_FOUND
        words = clean(text).strip() or "There is no answer yet."
        try:
            self._running = subprocess.Popen(
                [*command, words],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,
            )
        except OSError as error:
            return f"{command[0]} cannot be run: {error.strerror}"
        return f"Speaking. {where_it_sounds()}".strip()

    def stop(self) -> bool:
        """Stop what is being spoken; False where nothing is."""
        running, self._running = self._running, None
        if running is None or running.poll() is not None:
            return False
        running.terminate()
        running.wait()
        return True
