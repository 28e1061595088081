"""The exit status of each command, as the contract `answer` has it."""

from __future__ import annotations

from enum import IntEnum


class ExitCode(IntEnum):
    """What the shell is told."""

    OK = 0
    NOTHING = 1  # understood, but nothing was found; or a batch with a failed record
    USAGE = 2
    STORE = 3  # the store cannot be reached, opened or read
    QUESTION = 5  # not understood, out of scope, ambiguous
    INTERRUPTED = 130
    TERMINATED = 143  # SIGTERM


OF_STATUS = {
    "found": ExitCode.OK,
    "not_found": ExitCode.NOTHING,
    "unknown_object": ExitCode.NOTHING,
    "error": ExitCode.STORE,
    "not_understood": ExitCode.QUESTION,
    "out_of_scope": ExitCode.QUESTION,
    "ambiguous": ExitCode.QUESTION,
}
"""Exit status of `ask` by the answer's status."""
