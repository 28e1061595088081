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
    from assistant.ui.picture import Shot
    from d3a.answer import Answer

_MARKDOWN = re.compile(r"([\\`*_{}\[\]<>()#+!|~-])")
_ROWS = 10


def save_answer(answer: Answer, shot: Shot | None, folder: Path, now: datetime) -> list[Path]:
    """Return the files written; earlier ones are never overwritten. Raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    words = re.sub(r"[^a-z0-9]+", "-", answer.text.lower()).strip("-")[:40] or "answer"
    written = [_free(folder, words, ".json")]
    record = json.dumps(answer.to_json(), ensure_ascii=False, indent=2)
    written[0].write_text(record + "\n", encoding="utf-8")
    picture: Path | None = None
    if shot is not None and shot.picture is not None:
        png = boxed_png(shot.picture, shot.keyframe.box, shot.keyframe.category)
        picture = _free(folder, f"{words}-{file_stem(shot.keyframe)}", ".png")
        picture.write_bytes(png)
        written.append(picture)
    card = _free(folder, words, ".md")
    card.write_text(card_text(answer, picture, now), encoding="utf-8")
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
