"""`d3a batch`: many questions, an answer a line."""

from __future__ import annotations

import sys
from typing import IO

import click

from assistant.exits import ExitCode
from assistant.options import now_of, opened, settings_of, settings_options
from assistant.terminal import json_line, speaks_unicode


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
    a JSON object a line. A bad line gives a record with its error and does not stop the rest; the
    status is 1 when the store failed on one.
    """
    settings = settings_of(context)
    from assistant.batch import run

    failed = False
    with opened(settings) as store:
        now = now_of(settings, store)
        ascii_only = not speaks_unicode(sys.stdout)
        for answer in run(store, questions, now=now, limit=limit):
            failed = failed or answer.status == "error"
            click.echo(json_line(answer.to_json(), ascii_only=ascii_only))
    context.exit(ExitCode.NOTHING if failed else ExitCode.OK)
