"""`d3a demo`: a home that ships with d3a, ingested once, then asked."""

from __future__ import annotations

import sys
from dataclasses import replace

import click

from assistant.commands.chat import hold, session_of
from assistant.options import failures, opened, settings_of, settings_options
from assistant.serving import serve as serve_chat
from assistant.serving import serving_options
from assistant.terminal import clean_lines, emit, is_terminal


@click.command("demo")
@click.option("--tour", is_flag=True, help="Ask five questions, print the answers, and leave.")
@click.option("--json", "as_json", is_flag=True, help="With --tour: an answer a line, as JSON.")
@click.option("--plain", is_flag=True, help="Chat a line at a time.")
@serving_options
@settings_options
@click.pass_context
def command(
    context: click.Context,
    tour: bool,
    as_json: bool,
    plain: bool,
    serve: bool,
    port: int,
    served: bool,
) -> None:
    """Open the chat on a small home: the first minute with d3a.

    The home is ingested into a store of its own, once. Without a terminal five questions are
    asked and answered on standard output.
    """
    from assistant.demo import QUESTIONS, demo_store, tour_lines, tour_records

    settings = settings_of(context)
    with failures():
        uri = demo_store(settings, lambda line: click.echo(line, err=True))
        if serve:
            serve_chat("demo", settings, port)
            return
        settings = replace(settings, store=uri, store_from="the demo")
        with opened(settings) as store:
            session = session_of(settings, store, title="the demo home", suggestions=QUESTIONS)
            nobody = not (is_terminal(sys.stdin) and is_terminal(sys.stdout))
            if tour or (nobody and not plain and not served):
                if as_json:
                    for record in tour_records(session):
                        emit(record)
                    return
                if not tour:
                    hint = "no terminal: the tour. With --plain it takes questions, a line each."
                    click.echo(hint, err=True)
                for line in tour_lines(session):
                    click.echo(clean_lines(line))
                return
            hold(session, settings, plain=plain, served=served)
