"""The lines that a person types without a full screen, with the keys of a shell."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator, Sequence

from assistant.history import History
from assistant.suggesting import completion

PROMPT = "You: "
LEAVING = "Press Ctrl+C once more to leave, or type quit. Go on typing to stay."


def typed_lines(
    history: History, words: Sequence[str], say: Callable[[str], None]
) -> Iterator[str]:
    """Yield what is typed at the terminal until its end: the arrows edit and recall, Tab completes.

    words: those that the store knows. Ctrl+C drops the line that was begun; said twice in a row it
    is a KeyboardInterrupt.
    """
    _prepare(history, words)
    dropped = False
    while True:
        try:
            line = input(PROMPT)
        except EOFError:
            say("")
            return
        except KeyboardInterrupt:
            say("")
            if dropped:
                raise
            say(LEAVING)
            dropped = True
            continue
        dropped = False
        yield line


def _prepare(history: History, words: Sequence[str]) -> None:
    """Give `input` its keys, where this Python has the library for them."""
    try:
        readline = importlib.import_module("readline")
    except ImportError:  # Windows: its own line editor serves
        return

    def complete(line: str, state: int) -> str | None:
        return completion(line, history.questions, words) if state == 0 else None

    readline.set_completer_delims("")  # a question is completed, not a word of it
    readline.set_completer(complete)
    is_libedit = "libedit" in (readline.__doc__ or "")
    readline.parse_and_bind("bind ^I rl_complete" if is_libedit else "tab: complete")
    readline.parse_and_bind("set enable-bracketed-paste off")  # it would write escapes
    for question in history.questions:
        readline.add_history(question)
