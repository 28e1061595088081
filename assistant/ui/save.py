"""Write an answer to files: its record as JSON, its picture as PNG with the box drawn in."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING

from assistant.drawing import boxed_png, file_stem

if TYPE_CHECKING:
    from assistant.ui.picture import Shot
    from d3a.answer import Answer


def save_answer(answer: Answer, shot: Shot | None, folder: Path) -> list[Path]:
    """Return the files written; earlier ones are never overwritten. Raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    words = re.sub(r"[^a-z0-9]+", "-", answer.text.lower()).strip("-")[:40] or "answer"
    written = [_free(folder, words, ".json")]
    record = json.dumps(answer.to_json(), ensure_ascii=False, indent=2)
    written[0].write_text(record + "\n", encoding="utf-8")
    if shot is not None and shot.picture is not None:
        png = boxed_png(shot.picture, shot.keyframe.box, shot.keyframe.category)
        path = _free(folder, f"{words}-{file_stem(shot.keyframe)}", ".png")
        path.write_bytes(png)
        written.append(path)
    return written


def _free(folder: Path, stem: str, suffix: str) -> Path:
    """Return a path in `folder` that does not exist yet."""
    path = folder / f"{stem}{suffix}"
    number = 2
    while path.exists():
        path = folder / f"{stem}-{number}{suffix}"
        number += 1
    return path
