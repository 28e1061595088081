"""`d3a parse`: the formal query of each question, without a store."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterator
from typing import Any

import click

from assistant.exits import ExitCode
from assistant.options import now_of, opened, settings_of, settings_options, store_was_named
from assistant.terminal import clean, emit, well_formed


@click.command("parse")
@click.argument("questions", nargs=-1)
@click.option("--json", "as_json", is_flag=True, help="A JSON object a line.")
@settings_options
@click.pass_context
def command(context: click.Context, questions: tuple[str, ...], as_json: bool) -> None:
    """Print the formal query of each question, in words or in the formal notation.

    With no question given they are read from standard input, a line each, and answered with a
    line each. The status is 5 when any of them was not understood. Needs no store; with --store
    the names and places of that store are known words, and its zone holds.
    """
    from grammar import parse
    from grammar.errors import QuestionError
    from grammar.notation import looks_formal, read

    settings = settings_of(context)
    status = ExitCode.OK
    known: dict[str, Any] = {}
    if store_was_named(context):
        from assistant.asking import store_words

        with opened(settings) as store:
            known["words"] = store_words(store)
            moment = now_of(settings, store)
    else:
        moment = settings.moment()
    for text in map(well_formed, questions) if questions else stdin_lines():
        try:
            formal = looks_formal(text)
            query = read(text, now=moment) if formal else parse(text, now=moment, **known)
            record = query.to_json()
        except QuestionError as error:  # one bad question must not stop the rest
            record, status = error.to_json(), ExitCode.QUESTION
        if as_json:
            emit(record)
        else:
            click.echo(readable(record))
    context.exit(status)


def stdin_lines() -> Iterator[str]:
    """Yield the lines of standard input without their ends; bytes that are not UTF-8 replaced."""
    if isinstance(sys.stdin, io.TextIOWrapper):
        sys.stdin.reconfigure(encoding="utf-8-sig", errors="replace")
    for line in sys.stdin:
        yield line.rstrip("\r\n")


def readable(record: dict[str, Any]) -> str:
    """Return a formal query, or an error object, in the words of a person's report."""
    lines = [clean(record["text"])]
    if "error" in record:
        lines += [f"  {record['error']} at character {record['position']}: {record['message']}"]
        return "\n".join(map(clean, lines))
    lines += [
        f"  I read “{said['said']}” as {said['taken']}." for said in record.get("corrections", ())
    ]
    lines += [f"  {record['form']}  {record['ask']}, {record['select']}  {record['formal']}"]
    lines += [f"  {term['var']}: {_term(term)}" for term in record["objects"]]
    if record["relation"]:
        lines += [
            "  relation: " + ("not " * record["relation"]["negated"]) + record["relation"]["kind"]
        ]
    if record["place"]:
        outside = "not " * record.get("outside", False)
        places = " or ".join([record["place"], *record.get("or_places", ())])
        lines += [f"  place: {outside}{places}"]
    if record["time"]:
        lines += [f"  time: {record['time']['start'] or '...'} to {record['time']['end'] or '...'}"]
    if record["negated"]:
        lines += ["  negated" + ": is there one to the contrary" * ("contrary" in record)]
    if "now" in record:
        lines += ["  now: what is so, not what was ever seen"]
    return "\n".join(map(clean, lines))


def _term(term: dict[str, Any]) -> str:
    words = [*term["attributes"], term["category"]]
    if term["word"] != term["category"]:
        words.append(f"(said: {term['word']})")
    words += [f"not {word}" for word in term["without"]]
    if term["owner"]:
        words.append(f"of {term['owner']}")
    if term.get("not_owner"):
        words.append(f"not of {term['not_owner']}")
    words += [f"other than {_term(other)}" for other in term.get("other_than", ())]
    words += [f"or {_term(other)}" for other in term.get("or_else", ())]
    if term["quantity"] is not None:
        how = {"most": "at most ", "exactly": "exactly "}.get(term.get("bound", "least"), "")
        words.append(f"x {how}{term['quantity']}")
    if term["where"]:
        kind = ("not " * term["where"]["negated"]) + term["where"]["kind"]
        words.append(f"{kind} {_term(term['where']['object'])}")
    return " ".join(words)
