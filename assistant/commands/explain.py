"""`d3a explain`: what a question becomes, down to the store's own queries."""

from __future__ import annotations

import click

from assistant.exits import ExitCode
from assistant.options import Failure, now_of, opened, settings_of, settings_options
from assistant.terminal import clean_lines, emit, well_formed

SCHEMA = 1


@click.command("explain")
@click.argument("question", nargs=-1, required=True)
@click.option("--json", "as_json", is_flag=True, help="One JSON object.")
@click.option(
    "--precision",
    type=click.Choice(("perfect", "category", "attribute", "any")),
    help="How strictly things must match; by default as strictly as finds something.",
)
@settings_options
@click.pass_context
def command(
    context: click.Context, question: tuple[str, ...], as_json: bool, precision: str | None
) -> None:
    """Print the formal query, plan, native queries and answer of QUESTION."""
    settings = settings_of(context)
    from assistant.asking import explain
    from grammar.errors import QuestionError

    with opened(settings) as store:
        now = now_of(settings, store)
        try:
            text = well_formed(" ".join(question))
            explanation = explain(store, text, now=now, precision=precision)
        except QuestionError as error:
            if as_json:
                record = {"schema": SCHEMA, **error.to_json()}
                emit(record)
                context.exit(ExitCode.QUESTION)
            raise Failure(str(error), ExitCode.QUESTION) from error
    if as_json:
        record = {"schema": SCHEMA, **explanation.to_json()}
        emit(record)
    else:
        click.echo(clean_lines(explanation.to_text()))
