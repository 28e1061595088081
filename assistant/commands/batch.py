"""`d3a batch`: many questions, an answer a line."""

from __future__ import annotations

from typing import IO, TYPE_CHECKING

import click

from assistant.exits import ExitCode
from assistant.options import (
    Failure,
    now_of,
    opened,
    settings_of,
    settings_options,
)
from assistant.terminal import emit

if TYPE_CHECKING:
    from d3a.answer import Answer


@click.command("batch")
@click.argument(
    "questions", type=click.File("r", encoding="utf-8-sig", errors="replace"), default="-"
)
@click.option("--limit", type=click.IntRange(1, 10_000), default=50, show_default=True)
@settings_options
@click.pass_context
def command(context: click.Context, questions: IO[str], limit: int) -> None:
    """Answer the questions in the file QUESTIONS, or - for standard input.

    A line is a question, or a JSON object {"id", "text", "now"}; the answers come in that order,
    a JSON object a line. A bad or empty line gives a record with its error and does not stop the
    rest; the status is 1 when the store failed on one.
    """
    settings = settings_of(context)
    from assistant.batch import failed, run

    failed_any = False

    def write(answer: Answer) -> None:
        nonlocal failed_any
        failed_any = failed_any or answer.status == "error"
        emit(answer.to_json())

    try:
        with opened(settings) as store:
            for answer in run(store, questions, now=now_of(settings, store), limit=limit):
                write(answer)
    except Failure as failure:
        if failure.exit_code != ExitCode.STORE:
            raise
        failure.show()
        for line in questions:
            write(failed(line, failure.format_message()))
        failed_any = True
    context.exit(ExitCode.NOTHING if failed_any else ExitCode.OK)
