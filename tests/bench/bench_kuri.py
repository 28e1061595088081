"""Ingest the Kuri sample, ask its questions, and let its own judge score the answers.

    D3A_SHARED=... python -m tests.bench.bench_kuri [--questions FILE]

Prints what the judge prints: each miss, then first / top3 / MRR / refused negatives; then the time
of a question. The sample and its judge are not part of the project.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from assistant.asking import store_now
from assistant.batch import run
from d3a.answer import Answer
from d3a.ingest import ingest
from d3a.parameters import DEFAULT
from d3a.readers.opening import open_source
from d3a.store import open_store


def main() -> None:
    """Print the judge's lines and the time of a question."""
    named = os.environ.get("D3A_SHARED")
    if named is None:
        raise SystemExit("D3A_SHARED does not name the folder that holds data/kuri-sample")
    shared = Path(named)
    sample = shared / "data" / "kuri-sample"
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--questions", type=Path, default=sample / "questions-dev.jsonl")
    questions: Path = options.parse_args().questions
    with tempfile.TemporaryDirectory() as folder:
        answers = answered(sample, questions, Path(folder))
        lines = "".join(f"{json.dumps(answer.to_json())}\n" for answer in answers)
        written = Path(folder) / "answers.jsonl"
        written.write_text(lines, encoding="utf-8")
        judge = [str(shared / "tools" / "score-kuri"), str(sample), str(questions), str(written)]
        result = subprocess.run(judge, capture_output=True, text=True, check=True)
    sys.stdout.write(result.stdout)
    spent = [answer.elapsed_ms["total"] for answer in answers]
    median, slowest = np.median(spent), max(spent)
    sys.stdout.write(f"a question: median {median:.2f} ms, slowest {slowest:.1f} ms\n")


def answered(sample: Path, questions: Path, folder: Path) -> list[Answer]:
    """Return the answers of a fresh store of the sample, asked at its newest frame."""
    lines = questions.read_text(encoding="utf-8").splitlines()
    texts = [json.loads(line)["text"] for line in lines if line.strip()]
    with closing(open_store(str(folder / "kuri.db"))) as store:
        ingest(open_source(sample), store, DEFAULT)
        now = store_now(store, "last", lambda: datetime(2020, 3, 1, tzinfo=UTC))
        return list(run(store, texts, now=now))


if __name__ == "__main__":
    main()
