"""What may be typed after a slash or found in the palette, in the chat and line by line."""

from __future__ import annotations

import difflib
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
    "repeat": Command("The last question once more", says="again"),
    "quit": Command("Leave the chat", "quit"),
}
"""What may be typed after a slash, by name."""
_BARE = ("help", "quit", "why", "speak", "save", "copy", "large", "repeat")
"""Those that need no slash: no question is one of these words."""
_SAID = {
    "quit": ("exit", "leave", "close"),
    "help": (
        "what can you do", "what can i ask", "what can i say", "what do you know",
        "what can i ask you", "how does this work", "how do you work", "how do i quit",
        "how do i leave", "how do i get out", "what are the keys", "help me",
    ),
    "speak": (
        "read it to me", "read that to me", "read it", "read it aloud", "read it out",
        "read it out loud", "read that aloud", "read that out", "say it aloud", "say it out loud",
        "speak it", "tell me aloud", "speak the answer", "read the answer", "read me the answer",
    ),
    "large": (
        "bigger", "larger", "make it bigger", "make it larger", "make that bigger",
        "bigger letters", "larger letters", "show it bigger", "show it larger", "i cannot read it",
        "i can't read it", "i cant read it", "i cannot read that", "too small",
    ),
    "repeat": (
        "say it again", "say that again", "repeat that", "repeat it", "pardon", "come again",
        "what did you say", "tell me again", "once more", "repeat the answer",
    ),
    "save": ("save it", "save that", "save the answer", "save this"),
    "copy": ("copy it", "copy that", "copy the answer"),
}  # fmt: skip
"""Other words for a command, as people say them."""
_COMMAND_OF = {said: name for name, sayings in _SAID.items() for said in sayings}
_POLITE = ("can you ", "could you ", "would you ", "please ", "just ")
BOX_USAGE = "Say its edges too, in pixels of the picture: /box LEFT TOP RIGHT BOTTOM"


def bare(text: str) -> str | None:
    """Return the command that a saying without a slash is, None for none."""
    said = " ".join(text.lower().replace(",", " ").split()).rstrip("?!. ").removesuffix(" please")
    while lead := next((each for each in _POLITE if said.startswith(each)), ""):
        said = said.removeprefix(lead)
    return said if said in _BARE else _COMMAND_OF.get(said)


def unknown(word: str, known: Iterable[str]) -> str:
    """Return what is told of a word that is no command: the nearest that is, and all of them."""
    names = list(known)
    near = difflib.get_close_matches(word.partition(" ")[0], names, n=1)
    meant = f" Did you mean /{near[0]}?" if near else ""
    return f"There is no /{word}.{meant} There are {slashed(names)}"


def slashed(names: Iterable[str]) -> str:
    """Return commands as they are typed."""
    return " ".join(f"/{name}" for name in names)
