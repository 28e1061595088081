"""Questions that expect a yes: "isn't it in the kitchen?" asks whether it is there."""

from __future__ import annotations

import re
from dataclasses import replace

from grammar.forms import FormalQuery

_EXPECTS_YES = re.compile(
    r"\W*((and|but|so|well|hey|um+|uh+)\W+)*(is|are|was|were|do|does|did|has|have|had)n['\u2019]?t\b"
)
"""The verb itself is denied, and stands first."""
_ENDED = re.compile(r"\b(no longer|any ?more|any longer|gone from)\b")


def expecting(query: FormalQuery) -> FormalQuery | None:
    """Return the question without its denial where it merely expects a yes; else None.

    Who asks whether the cup is not in the kitchen, or no longer, asks for the contrary.
    """
    is_denied = query.ask == "whether" and query.negated
    if not is_denied or not _EXPECTS_YES.match(query.text.casefold()):
        return None
    if _ENDED.search(query.text.casefold()):  # isn't it there any more
        return None
    return replace(query, negated=False, contrary=False)


def asks_of_an_end(query: FormalQuery) -> bool:
    """Whether it is asked if something is so no longer: what still is so is a plain no."""
    return query.negated and _ENDED.search(query.text.casefold()) is not None
