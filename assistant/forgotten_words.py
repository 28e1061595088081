"""What is said with a no where something was forgotten: the memory cannot vouch for "never"."""

from __future__ import annotations

from d3a.answer import Answer

_VOUCHES = ("gone", "not_recognisable")
"""Reasons that rest on what is remembered: nothing forgotten could make them untrue."""


def but_forgotten(said: str, answer: Answer) -> str:
    """Return the sentence of an answer from a store that was told to forget something."""
    if answer.status not in ("not_found", "unknown_object") or answer.reason in _VOUCHES:
        return said
    if answer.reason == "empty":
        return "My memory is empty: I was asked to forget what was in it."
    if said.startswith("I "):
        said = f"As far as I still remember, {said}"
    return f"{said} I was asked to forget some things, and cannot speak of those."
