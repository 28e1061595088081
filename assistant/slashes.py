"""What may be typed after a slash or found in the palette, in the chat and line by line."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple


class Command(NamedTuple):
    """What a word after a slash does. tells: in words. action: of the full screen, by its name.

    says: the sentence that it stands for, as if it were typed; then it has no action.
    """

    tells: str
    action: str = ""
    says: str = ""


COMMANDS = {
    "help": Command("Keys and examples", "help"),
    "picture": Command("The whole picture of the chosen keyframe", "picture"),
    "map": Command("Rooms, places, the robot", "map"),
    "speak": Command("The answer aloud; again: stop", "speak"),
    "large": Command("The answer in few, spaced lines", "large"),
    "save": Command("The answer as a Markdown card and as JSON, its picture as PNG", "save"),
    "why": Command("Formal query, parts of the score, plan, native queries", "why"),
    "copy": Command("The answer, to the clipboard", "copy_answer"),
    "wrong": Command("Not this one: the next best", says="not this one"),
    "mine": Command("The chosen thing is mine", says="this is mine"),
    "other": Command("The chosen thing is another one than the rest", says="that is not the same"),
    "undo": Command("Take back what was taught last", says="undo"),
    "taught": Command("What was taught so far", says="what did I teach you?"),
    "forget": Command("Wipe the questions of this and earlier chats", "forget"),
    "theme": Command("Light, dark, high contrast", "change_theme"),
    "quit": Command("Leave the chat", "quit"),
}
"""What may be typed after a slash, by name."""
BARE = frozenset({"help", "quit", "exit", "why"})
"""Those that need no slash: no question is one of these words."""
BOX_USAGE = "Say its edges too, in pixels of the picture: /box LEFT TOP RIGHT BOTTOM"


def bare(text: str) -> str | None:
    """Return the command that a saying without a slash is, None for none."""
    word = text.lower().rstrip("?!. ")
    return {"exit": "quit"}.get(word, word) if word in BARE else None


def unknown(word: str, known: Iterable[str]) -> str:
    """Return what is told of a word that is no command."""
    return f"There is no /{word}. There are {slashed(known)}"


def slashed(names: Iterable[str]) -> str:
    """Return commands as they are typed."""
    return " ".join(f"/{name}" for name in names)
