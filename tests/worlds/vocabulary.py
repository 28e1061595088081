"""Every word that the language's own files know, to draw texts from."""

from __future__ import annotations

import re
from pathlib import Path

import grammar


def vocabulary_words() -> list[str]:
    """Return the words of grammar/vocabulary/*.txt, sorted, each once."""
    folder = Path(grammar.__file__).parent / "vocabulary"
    texts = (path.read_text(encoding="utf-8") for path in sorted(folder.glob("*.txt")))
    return sorted({word for text in texts for word in re.findall(r"[\w']+", text.lower())})
