"""What is said for politeness alone, and what is said back: thanks, hello, okay, goodbye.

It asks nothing, so nothing is looked up; what was asked before, and its rows, stay as they are.
"""

from __future__ import annotations

_ASK = "Ask me where a thing is, or when I saw it."
_REPLIES: dict[str, tuple[str, ...]] = {
    "You are welcome.": (
        "thanks", "thank you", "thx", "ty", "cheers", "ta", "many thanks", "thanks a lot",
        "thank you very much", "thank you so much", "thanks so much", "much appreciated",
        "thanks for that", "thank you for that", "thanks for your help", "thank you robot",
        "thanks robot", "that is all", "that's all", "found it", "i found it", "got it",
        "perfect", "great", "good", "nice", "cool", "super", "brilliant", "excellent", "awesome",
        "lovely", "wonderful", "good job", "well done", "good robot",
    ),
    f"Hello. {_ASK}": (
        "hello", "hi", "hey", "hiya", "howdy", "good morning", "good afternoon", "good evening",
        "hello robot", "hi robot", "hey robot", "hello there", "hi there",
    ),
    "Goodbye.": (
        "bye", "goodbye", "good bye", "bye bye", "see you", "see you later", "good night",
    ),
    "All right.": (
        "ok", "okay", "k", "fine", "all right", "alright", "i see", "right", "sure", "aha",
        "understood", "never mind", "nevermind", "forget it", "no matter", "sorry", "no worries",
        "no problem", "leave it",
    ),
    f"I asked nothing just now. {_ASK}": ("yes", "yeah", "yep", "yup", "yes please", "correct"),
    "If that is not the one you mean, say not this one; or ask again in other words.": (
        "no", "nope", "nah", "wrong", "that is wrong", "that's wrong", "no it is not",
    ),
}  # fmt: skip
_SAID = {said: reply for reply, sayings in _REPLIES.items() for said in sayings}
_OPENINGS = ("ok ", "okay ", "oh ", "great ", "cool ", "good ", "perfect ", "right ", "no ", "yes ")


def courteous(text: str) -> str | None:
    """Return what to say to a saying that asks nothing, None for any other."""
    said = " ".join("".join(c if c.isalnum() or c == "'" else " " for c in text.lower()).split())
    if said in _SAID:
        return _SAID[said]
    rest = next((said.removeprefix(lead) for lead in _OPENINGS if said.startswith(lead)), "")
    return _SAID.get(rest)
