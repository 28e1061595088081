"""Why an answer is what it is, as text: its formal query, the parts of a score, the plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

from assistant.wording import how_sure

if TYPE_CHECKING:
    from d3a.answer import Answer, RankedKeyframe

_SAID_ABOVE = ("query ", "times ")
"""How the lines of an explanation begin that say what the answer says itself."""


def why_text(
    answer: Answer, keyframe: RankedKeyframe | None, explanation: str, *, aloud: bool = False
) -> str:
    """Return why this answer: the formal query, the score's parts, the plan and its queries.

    aloud: without the store's own queries and the answer, for who hears it read.
    """
    lines = [f"Question   {answer.text}"]
    if answer.query is not None:
        lines += [f"Formal     {answer.query.formal}", f"Form       {answer.query.form}"]
    lines.append(f"Status     {answer.status}" + (f", {answer.reason}" if answer.reason else ""))
    if keyframe is not None:
        lines += ["", f"Keyframe {keyframe.rank}   {keyframe.category}, frame {keyframe.frame}"]
        lines.append(f"  score      {keyframe.score:.2f} ({how_sure(keyframe)})")
        lines += [f"  {name:<10} {_part(value)}" for name, value in keyframe.why.items()]
        lines.append(f"  object     {keyframe.object_id}")
    if answer.elapsed_ms:
        spent = ", ".join(f"{name} {ms:.1f} ms" for name, ms in answer.elapsed_ms.items())
        lines += ["", f"Time       {spent}"]
    if explanation:
        lines += ["", _plan(explanation) if aloud else _beside(explanation)]
    return "\n".join(lines)


def _beside(explanation: str) -> str:
    """Return an explanation without its query and times: the answer's own stand above it."""
    kept = (line for line in explanation.splitlines() if not line.startswith(_SAID_ABOVE))
    return "\n".join(kept).strip("\n")


def _plan(explanation: str) -> str:
    """Return the steps of an explanation; all of it where it has none, as a reason has."""
    lines = explanation.splitlines()
    if "plan" not in lines:
        return explanation
    steps = lines[lines.index("plan") :]
    ends = (i for i, line in enumerate(steps[1:], 1) if not line.startswith(" "))
    return "\n".join(steps[: next(ends, None)])


def _part(value: object) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {_part(part)}" for name, part in value.items()) or "-"
    if isinstance(value, list | tuple):
        return ", ".join(map(_part, value)) or "-"
    return f"{value:.2f}" if isinstance(value, float) else str(value)
