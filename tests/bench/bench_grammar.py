"""Measure the language: right readings, time a question, a fresh process, fuzzing, and neighbours.

    python -m tests.bench.bench_grammar [--fuzz 1000000] [--sentences 10000] [--seed 1]

Prints a line for each figure. The given question sets are judged where D3A_SHARED names them.
hassil, dateparser and parsedatetime run on the same sentences where they are installed (extra
`bench`). Wall clock and processor time are both printed: other work on the machine moves the first.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import random
import statistics
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import click

from grammar import QuestionError, parse
from tests.bench import processes
from tests.worlds.vocabulary import vocabulary_words

NOW = datetime.fromisoformat("2020-01-01T18:00:00-05:00")
NOUNS = [
    "cup",
    "red mug",
    "keys",
    "wallet",
    "blue plastic bottle",
    "glasses",
    "coffee machine",
    "remote control",
    "zorbulator",
    "striped towel",
    "phone",
    "walking stick",
    "pill box",
    "hearing aid",
    "charger",
    "black bag",
]
GROUNDS = ("table", "wooden chair", "sofa", "kitchen counter", "desk by the window", "bed")
RELATIONS = ("on", "next to", "under", "behind", "to the left of", "in front of")
PLACES = ("", "", " in the kitchen", " in the living room", " in the hall")
SLICES = [
    "yesterday",
    "last night",
    "on tuesday evening",
    "this morning",
    "at half past three",
    "two hours ago",
    "between 1 and 4 pm",
    "since monday",
    "in the last three weeks",
    "before noon",
    "in august 2019",
    "on the first of december twenty nineteen at quarter to four",
    "from nine a m to noon",
    "over the weekend",
    "three quarters of an hour ago",
]
OPENINGS = ("", "", "", "hey robot ", "um ", "can you tell me ", "do you know ", "okay so ")
ASKED = (
    "where is the {noun}", "where did you see my {noun}", "did you see the {noun}",
    "is the {noun} {relation} the {ground}", "what is {relation} the {ground}",
    "how many {noun} are there {relation} the {ground}", "when did you last see the {noun}",
    "where is the {noun} that is not red", "is there a {noun} {relation} the {ground}",
    "where is the {noun} no the {ground}", "how long was the {noun} {relation} the {ground}",
    "what moved", "show me all {noun}",
)  # fmt: skip
INDIRECT = ("where the {noun} is", "when you last saw the {noun}", "if the {noun} is here")
FRESH = (
    "import sys, time\nbegan = time.perf_counter()\nimport grammar\n"
    "from datetime import datetime\n"
    "grammar.parse('where did you see the pink cup between 1:00pm and 4:00pm on 1st Jan, 2020?',"
    " now=datetime.fromisoformat('2020-01-01T18:00:00-05:00'))\n"
    "print((time.perf_counter() - began) * 1e3)\n"
)


@dataclass(frozen=True)
class Timing:
    """Milliseconds of each call, by the wall clock and of the processor."""

    wall_ms: list[float]
    cpu_ms: list[float]

    def line(self, name: str) -> str:
        """Return median, 99th percentile and the slowest, wall clock and processor."""
        parts = [_quantiles(self.wall_ms, "wall"), _quantiles(self.cpu_ms, "cpu")]
        return f"{name:34s} {'  '.join(parts)}"


def _quantiles(values_ms: list[float], kind: str) -> str:
    ordered = sorted(values_ms)
    p99 = ordered[int(len(ordered) * 0.99)]
    return f"{kind} median {statistics.median(ordered):.2f} p99 {p99:.2f} max {ordered[-1]:.2f} ms"


def sentences(count: int, draw: random.Random) -> Iterator[str]:
    """Draw questions of all the forms, with a time and a place in half of them."""
    for _ in range(count):
        opening = draw.choice(OPENINGS)
        asked = draw.choice(INDIRECT if opening.endswith(("me ", "know ")) else ASKED)
        question = asked.format(
            noun=draw.choice(NOUNS), relation=draw.choice(RELATIONS), ground=draw.choice(GROUNDS)
        )
        said = draw.choice(SLICES) if draw.random() < 0.5 else ""
        yield f"{opening}{question}{draw.choice(PLACES)} {said}".strip()


def timed(run: Callable[[str], object], texts: list[str]) -> Timing:
    """Time `run` on each text; the first call, which builds what is kept, is left out."""
    run(texts[0])
    wall_ms, cpu_ms = [], []
    for text in texts:
        began, worked = time.perf_counter(), time.process_time()
        run(text)
        wall_ms.append((time.perf_counter() - began) * 1e3)
        cpu_ms.append((time.process_time() - worked) * 1e3)
    return Timing(wall_ms, cpu_ms)


def outcome(text: str, now: datetime = NOW) -> dict[str, Any]:
    """Return the record of a question, or of its error."""
    try:
        return parse(text, now=now).to_json()
    except QuestionError as error:
        return error.to_json()


def fresh(runs: int) -> Iterator[str]:
    """Yield the time of import and first parse in fresh processes, beside one that does nothing."""
    first, empty = [sys.executable, "-c", FRESH], [sys.executable, "-c", "pass"]
    with processes.with_bytecode() as kept:
        for name, environment in (
            ("import and first parse, fresh", kept),
            ("  where no bytecode is kept", processes.without_bytecode()),
        ):
            processes.run(first, environment)
            pairs = [
                (processes.run(first, environment), processes.run(empty, environment))
                for _ in range(runs)
            ]
            inside = [float(done.stdout) for done, _ in pairs]
            wall = [done.wall_ms for done, _ in pairs]
            beyond = [done.processor_ms - nothing.processor_ms for done, nothing in pairs]
            yield (
                f"{name:34s} inside {processes.summary(inside)}  process "
                f"{processes.summary(wall)}  cpu beyond an empty one {processes.summary(beyond)}"
            )


def salad(draw: random.Random, words: list[str]) -> str:
    """Return a text that may mean anything: words, cut questions, or plain characters."""
    kind = draw.random()
    if kind < 0.1:
        return "".join(chr(draw.choice((draw.randint(32, 126), draw.randint(0, 0x2FFF)))) for _ in
                       range(draw.randint(0, 60)))  # fmt: skip
    if kind < 0.3:
        return " ".join(draw.choice(words) for _ in range(draw.randint(1, 4)))
    return " ".join(draw.choice(words) for _ in range(draw.randint(1, 14)))


def fuzz(count: int, draw: random.Random) -> str:
    """Parse `count` texts; any exception but QuestionError ends the program."""
    pool = [word for text in sentences(400, draw) for word in text.split()]
    pool += [word for word in vocabulary_words() if len(word) <= 6]
    pool += [
        "?",
        ",",
        "'",
        '"',
        "|",
        "(",
        ")",
        "31",
        "2020",
        "13/13/2020",
        "24:00",
        "tomorrow",
        "nothing",
        "than",
        "belongs",
        "-5",
        "0",
        "it",
    ]
    kinds: Counter[str] = Counter()
    slowest, text_of_slowest, began = 0.0, "", time.perf_counter()
    for i in range(count):
        text = salad(draw, pool)
        worked = time.process_time()
        kinds[outcome(text).get("error", "query")] += 1
        spent = (time.process_time() - worked) * 1e3
        if i and spent > slowest:
            slowest, text_of_slowest = spent, text
    seconds = time.perf_counter() - began
    return (
        f"{'fuzzed texts':34s} {count} in {seconds:.0f} s, no other exception; {dict(kinds)}; "
        f"slowest {slowest:.1f} ms cpu: {text_of_slowest[:60]!r}"
    )


# -- the neighbours -------------------------------------------------------------------------------


def hassil_reader() -> Callable[[str], object] | None:
    """Return hassil with templates of the same questions, None where it is not installed."""
    try:
        hassil = importlib.import_module("hassil")
    except ImportError:
        return None
    object_ = "[the|my|a] {noun}"
    templates = [
        f"[hey robot|um|okay so] where (is|are) {object_} [in the {{place}}] [{{time}}]",
        f"[hey robot|um|okay so] where did you see {object_} [in the {{place}}] [{{time}}]",
        f"[hey robot|um|okay so] did you see {object_} [in the {{place}}] [{{time}}]",
        f"is {object_} {{relation}} the {{ground}} [in the {{place}}] [{{time}}]",
        "what is {relation} the {ground} [in the {place}] [{time}]",
        "how many {noun} are there {relation} the {ground} [in the {place}] [{time}]",
        f"when did you last see {object_} [in the {{place}}] [{{time}}]",
        "show me all {noun} [in the {place}] [{time}]",
    ]
    values = {
        "noun": NOUNS, "ground": GROUNDS, "relation": RELATIONS, "time": SLICES,
        "place": ("kitchen", "living room", "hall"),
    }  # fmt: skip
    intents = hassil.Intents.from_dict(
        {
            "language": "en",
            "intents": {"Ask": {"data": [{"sentences": templates}]}},
            "lists": {name: {"values": list(said)} for name, said in values.items()},
        }
    )
    return lambda text: hassil.recognize(text, intents)


def dateparser_reader() -> Callable[[str], object] | None:
    """Return dateparser's search with the past preferred, None where it is not installed."""
    try:
        search = importlib.import_module("dateparser.search")
    except ImportError:
        return None
    settings = {"PREFER_DATES_FROM": "past", "RELATIVE_BASE": NOW.replace(tzinfo=None)}
    return lambda text: search.search_dates(text, languages=["en"], settings=settings)


def parsedatetime_reader() -> Callable[[str], object] | None:
    """Return parsedatetime's reader, None where it is not installed."""
    try:
        parsedatetime = importlib.import_module("parsedatetime")
    except ImportError:
        return None
    calendar = parsedatetime.Calendar()
    return lambda text: calendar.nlp(text, NOW)


def start_of(found: object) -> datetime | None:
    """Return the first moment that a date library found, without its zone."""
    if isinstance(found, list | tuple) and found:
        first = found[0]
        moments = [part for part in first if isinstance(part, datetime)]
        return moments[0].replace(tzinfo=None) if moments else None
    return None


def neighbours(texts: list[str]) -> Iterator[str]:
    """Time each neighbour, and count what it makes of the sentences."""
    some = texts[: min(len(texts), 1000)]
    wanted = [outcome(text) for text in some]
    readers = {
        "hassil": hassil_reader(),
        "dateparser": dateparser_reader(),
        "parsedatetime": parsedatetime_reader(),
    }
    for name, reader in readers.items():
        if reader is None:
            yield f"{name:34s} not installed"
            continue
        yield timed(reader, some).line(f"{name}, {len(some)} sentences")
        if name == "hassil":
            matched = sum(reader(text) is not None for text in some)
            yield f"{'':34s} matches {matched} of {len(some)}"
            continue
        found = [(w.get("time"), start_of(reader(t))) for t, w in zip(some, wanted, strict=True)]
        pairs = [(time["start"], got) for time, got in found if time and time["start"]]
        right = sum(datetime.fromisoformat(w).replace(tzinfo=None) == got for w, got in pairs)
        stray = sum(got is not None for time, got in found if not time)
        yield (
            f"{'':34s} the same start in {right} of {len(pairs)} sentences with one; "
            f"a time in {stray} sentences without"
        )


def judged() -> Iterator[str]:
    """Judge the given sets with the script that comes with them."""
    folder = os.environ.get("D3A_SHARED")
    if not folder:
        yield f"{'given sets':34s} D3A_SHARED is not set"
        return
    for name in ("questions-dev.jsonl", "times-dev.jsonl"):
        command = [sys.executable, str(Path(folder) / "tools" / "score-questions")]
        done = subprocess.run(
            [*command, str(Path(folder) / name), sys.executable, "-m", __spec__.name, "--lines"],
            capture_output=True,
            text=True,
            check=False,
        )
        yield f"{name:34s} {done.stdout.strip() or done.stderr.strip()[-200:]}"


def answer_lines(now: datetime) -> None:
    """Answer questions from standard input, a JSON object a line: what the judge runs."""
    for line in sys.stdin:
        click.echo(json.dumps(outcome(line.rstrip("\n"), now)))


def main() -> None:
    """Print every figure."""
    options = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    options.add_argument("--sentences", type=int, default=10_000)
    options.add_argument("--fuzz", type=int, default=20_000)
    options.add_argument("--runs", type=int, default=20)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--lines", action="store_true", help="answer standard input instead")
    options.add_argument("--now", type=datetime.fromisoformat, default=NOW)
    chosen = options.parse_args()
    if chosen.lines:
        answer_lines(chosen.now)
        return
    draw = random.Random(chosen.seed)
    texts = list(sentences(chosen.sentences, draw))
    for line in judged():
        click.echo(line)
    understood = sum("error" not in outcome(text) for text in texts)
    click.echo(f"{'drawn sentences understood':34s} {understood} of {len(texts)}")
    click.echo(timed(outcome, texts).line(f"parse, {len(texts)} sentences"))
    for line in fresh(chosen.runs):
        click.echo(line)
    for line in neighbours(texts):
        click.echo(line)
    click.echo(fuzz(chosen.fuzz, draw))


if __name__ == "__main__":
    main()
