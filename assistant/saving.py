"""Write an answer to files: a card to read, its record as JSON, its picture with the box."""

from __future__ import annotations

import json
import re
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from assistant.drawing import boxed_png, file_stem
from assistant.terminal import clean
from assistant.wording import keyframe_row

if TYPE_CHECKING:
    from d3a.answer import Answer, RankedKeyframe
    from d3a.store.base import Keyframe

_MARKDOWN = re.compile(r"([\\`*_{}\[\]<>()#+!|~-])")
_ROWS = 10


def answer_text(answer: Answer, now: datetime) -> str:
    """Return an answer and its rows, a line each."""
    lines = [clean(answer.answer or answer.message or "")]
    for keyframe in answer.keyframes:
        lines.append(f"{keyframe.rank}  " + ", ".join(keyframe_row(keyframe, now)))
    return "\n".join(lines)


def saved(
    answer: Answer,
    keyframe: RankedKeyframe | None,
    picture: Keyframe | None,
    folder: Path,
    now: datetime,
) -> tuple[str, bool]:
    """Save an answer; return what to tell of it, and whether it failed."""
    try:
        written = save_answer(answer, keyframe, picture, folder, now)
    except OSError as error:
        return f"{folder} cannot be written: {error.strerror or error}", True
    return f"Saved {len(written)} files in {folder.absolute()}", False


def save_answer(
    answer: Answer,
    keyframe: RankedKeyframe | None,
    picture: Keyframe | None,
    folder: Path,
    now: datetime,
) -> list[Path]:
    """Return the files written; earlier ones are never overwritten. Raises OSError.

    picture: that of the keyframe, None where none is stored.
    """
    folder.mkdir(parents=True, exist_ok=True)
    words = re.sub(r"[^a-z0-9]+", "-", answer.text.lower()).strip("-")[:40] or "answer"
    written = [_free(folder, words, ".json")]
    record = json.dumps(answer.to_json(), ensure_ascii=False, indent=2)
    written[0].write_text(record + "\n", encoding="utf-8")
    drawn: Path | None = None
    if keyframe is not None and picture is not None:
        png = boxed_png(picture, keyframe.box, keyframe.category)
        drawn = _free(folder, f"{words}-{file_stem(keyframe)}", ".png")
        drawn.write_bytes(png)
        written.append(drawn)
    card = _free(folder, words, ".md")
    card.write_text(card_text(answer, drawn, now), encoding="utf-8")
    return [card, *written]


def save_text(text: str, folder: Path) -> Path:
    """Write what could not be copied; return where. Raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    path = _free(folder, "copied", ".txt")
    path.write_text(text + "\n", encoding="utf-8")
    return path


def card_text(answer: Answer, picture: Path | None, now: datetime) -> str:
    """Return an answer as Markdown: the sentence large, the picture, the list, the question.

    Words of people and recordings stand there as they are: nothing of them is Markdown or HTML.
    """
    lines = [f"# {plain(answer.answer or answer.message or '')}", ""]
    if picture is not None:
        lines += [f"![{plain(answer.text)}]({picture.name})", ""]
    lines += [f"Asked: {plain(answer.text)}", ""]
    if answer.keyframes:
        lines += ["| # | thing | seen | where | how sure | how often |", "|" + " --- |" * 6]
        for keyframe in answer.keyframes[:_ROWS]:
            cells = (str(keyframe.rank), *keyframe_row(keyframe, now))
            lines.append("| " + " | ".join(plain(cell) for cell in cells) + " |")
        below = len(answer.keyframes) - _ROWS
        lines += ["", f"{below} more are in the JSON file."] if below > 0 else []
        lines.append("")
    lines.append(f"Told on {now:%Y-%m-%d} at {now.hour}:{now.minute:02d} ({now.tzinfo}).")
    return "\n".join(lines) + "\n"


def plain(text: str) -> str:
    """Return text that Markdown shows as it is."""
    return _MARKDOWN.sub(r"\\\1", clean(text).replace("&", "&amp;"))


def _free(folder: Path, stem: str, suffix: str) -> Path:
    """Return a path in `folder` that does not exist yet."""
    path = folder / f"{stem}{suffix}"
    number = 2
    while path.exists():
        path = folder / f"{stem}-{number}{suffix}"
        number += 1
    return path
