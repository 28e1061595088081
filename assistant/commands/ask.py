"""`d3a ask`: a question, a sentence, ranked keyframes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from assistant.exits import OF_STATUS, ExitCode
from assistant.options import (
    Failure,
    now_of,
    opened,
    settings_of,
    settings_options,
    store_name,
)
from assistant.terminal import clean_lines, emit, well_formed

if TYPE_CHECKING:
    from d3a.answer import Answer
    from d3a.store.base import Store


@click.command("ask")
@click.argument("question", nargs=-1, required=True)
@click.option("--json", "as_json", is_flag=True, help="The answer as one JSON object.")
@click.option("--limit", type=click.IntRange(1, 10_000), default=50, show_default=True)
@click.option(
    "--precision",
    type=click.Choice(("perfect", "category", "attribute", "any")),
    help="How strictly things must match; by default as strictly as finds something.",
)
@click.option(
    "--save",
    type=click.Path(file_okay=False, path_type=Path),
    metavar="DIR",
    help="Write the keyframes' pictures there, the box drawn in.",
)
@settings_options
@click.pass_context
def command(
    context: click.Context,
    question: tuple[str, ...],
    as_json: bool,
    limit: int,
    precision: str | None,
    save: Path | None,
) -> None:
    """Answer QUESTION with a sentence and ranked keyframes, the best first.

    Status: 0 found, 1 nothing found, 3 the store cannot be reached, 5 not understood.
    """
    settings = settings_of(context)
    from assistant.asking import ask

    text = well_formed(" ".join(question))
    try:
        with opened(settings) as store:
            now = now_of(settings, store)
            answer = ask(store, text, now=now, limit=limit, precision=precision)
            if as_json:
                emit(answer.to_json())
            else:
                from assistant.wording import answer_lines

                sentence, *rest = answer_lines(answer, now)
                click.echo(click.style(clean_lines(sentence), bold=True))
                for line in rest:
                    click.echo(line)
            if save is not None:
                _save(store, answer, save, quiet=settings.quiet)
    except Failure as failure:
        if as_json and failure.exit_code == ExitCode.STORE:
            from assistant.batch import failed

            emit(failed(text, failure.format_message()).to_json())
        raise
    status = OF_STATUS[answer.status]
    if status in (ExitCode.NOTHING, ExitCode.STORE) and not settings.quiet:
        click.echo(f"store: {store_name(settings)}", err=True)
    context.exit(status)


def _save(store: Store, answer: Answer, folder: Path, *, quiet: bool) -> None:
    """Write the picture of each keyframe that has one, and say what was written."""
    from assistant.drawing import write_pictures

    try:
        written = write_pictures(store, answer.keyframes, folder)
    except OSError as error:
        raise Failure(f"{folder} cannot be written: {error.strerror}", ExitCode.USAGE) from error
    if not quiet:
        without = len(answer.keyframes) - len(written)
        note = f", {without} without a picture" if without else ""
        click.echo(f"{len(written)} pictures in {folder}{note}", err=True)
