"""What may be typed after a slash or found in the palette, and the theme of high contrast."""

from __future__ import annotations

from textual.theme import Theme

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

HIGH_CONTRAST = Theme(
    name="high-contrast",
    primary="#ffff00",
    secondary="#00ffff",
    accent="#ffff00",
    foreground="#ffffff",
    background="#000000",
    surface="#000000",
    panel="#1c1c1c",
    success="#00ff00",
    warning="#ffff00",
    error="#ff6060",
    dark=True,
)
