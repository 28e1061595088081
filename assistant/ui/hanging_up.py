"""The end of the chat where its terminal goes: a login that breaks off, a closed window."""

from __future__ import annotations

import os
import select
import signal
import threading
from typing import TextIO


def end_when_closed(stream: TextIO) -> None:
    """Watch a terminal from a thread; once its other end is closed, the process gets SIGHUP.

    The system sends that itself to whom the terminal controls. To others it only ends the input:
    Textual reads that end over and over, and waits for ever to draw. The signal ends the chat also
    where it was told to ignore it (nohup): nobody can go on with it elsewhere.
    """
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    hang_up = select.poll()
    hang_up.register(stream, 0)  # that much is told unasked

    def wait() -> None:
        hang_up.poll()
        os.kill(os.getpid(), signal.SIGHUP)

    threading.Thread(target=wait, name="terminal", daemon=True).start()
