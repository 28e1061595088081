"""Many questions, an answer a line: in the order of the input, a bad line is a record too."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

from assistant.asking import ask
from d3a.answer import Answer
from d3a.store.base import Store


class LineError(ValueError):
    """A line that is neither a question nor a record with one."""


def run(store: Store, lines: Iterable[str], *, now: datetime, limit: int = 50) -> Iterator[Answer]:
    """Yield the answer of each line, of an empty one too: the records are as many as the lines.

    A line is a question, or a JSON object {"id", "text", "now"} of which `text` alone is needed;
    its `now` is ISO with an offset, else that of the home. A line that is neither gives an answer
    with the status "not_understood", and the next line is read.
    """
    for line in lines:
        said = line.strip()
        try:
            text, name, moment = _question(said, now)
        except LineError as error:
            yield Answer(
                text=said,
                status="not_understood",
                position=0,
                answer=str(error),
                message=str(error),
            )
            continue
        yield replace(ask(store, text, now=moment, limit=limit), id=name)


def failed(line: str, said: str) -> Answer:
    """Return the record of a question that no store could be asked: `said` tells why."""
    text, name = line.strip(), None
    with suppress(LineError):
        text, name, _ = _question(text, datetime.min.replace(tzinfo=UTC))
    return Answer(text=text, id=name, status="error", answer=said, message=said)


def _question(line: str, now: datetime) -> tuple[str, str | None, datetime]:
    if not line:
        raise LineError("This line is empty.")
    if not line.startswith("{"):
        return line, None, now
    try:
        record: Any = json.loads(line)
    except ValueError as error:
        raise LineError(f"This line is not JSON: {error}.") from error
    except RecursionError as error:
        raise LineError("This line is not JSON: it is nested too deeply.") from error
    text = record.get("text")
    if not isinstance(text, str) or not text.strip():
        raise LineError('This record has no question: it needs a "text".')
    name = record.get("id")
    return text, None if name is None else str(name), _moment(record.get("now"), now)


def _moment(given: object, now: datetime) -> datetime:
    if given is None:
        return now
    try:
        moment = datetime.fromisoformat(str(given))
    except ValueError as error:
        raise LineError(f'The "now" of this record, {given!r}, is not an ISO time.') from error
    if moment.tzinfo is None:
        return moment.replace(tzinfo=now.tzinfo)
    return moment.astimezone(now.tzinfo)
