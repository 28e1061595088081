"""What may be typed after a slash or found in the palette, in the chat and line by line."""

from __future__ import annotations

from collections.abc import Iterable

COMMANDS = {
    "help": ("help", "Keys and examples"),
    "picture": ("picture", "The whole picture of the chosen keyframe"),
    "map": ("map", "Rooms, places, the robot"),
    "speak": ("speak", "The answer aloud; again: stop"),
    "large": ("large", "The answer in few, spaced lines"),
    "save": ("save", "The answer as a Markdown card and as JSON, its picture as PNG"),
    "why": ("why", "Formal query, parts of the score, plan, native queries"),
    "copy": ("copy_answer", "The answer, to the clipboard"),
    "wrong": ("say('not this one')", "Not this one: the next best"),
    "mine": ("say('this is mine')", "The chosen thing is mine"),
    "other": ("say('that is not the same')", "The chosen thing is another one than the rest"),
    "undo": ("say('undo')", "Take back what was taught last"),
    "taught": ("say('what did I teach you?')", "What was taught so far"),
    "forget": ("forget", "Wipe the questions of this and earlier chats"),
    "theme": ("change_theme", "Light, dark, high contrast"),
    "quit": ("quit", "Leave the chat"),
}
"""By name: the action, and what it does. `say` stands for typing the sentence."""
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
