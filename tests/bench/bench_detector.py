"""Take recordings in from their pictures alone, through real detectors, and judge the result.

    python -m tests.bench.bench_detector [--shared FOLDER] [--threads N]

FOLDER holds data/red-kitchen, data/kuri-sample and models; D3A_SHARED names it too. The kitchen:
where its cups and chairs are against the truth, and what the time goes into. Kuri: its questions,
answered from the JPEGs and their times, judged by the frames that show what is asked.
"""

from __future__ import annotations

import csv
import json
import subprocess
import tempfile
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path

import click

from assistant.asking import store_now
from assistant.batch import run
from d3a.answer import Answer
from d3a.detectors.opening import open_detector
from d3a.ingest import IngestSummary, ingest
from d3a.parameters import DEFAULT
from d3a.readers.base import Reader
from d3a.readers.opening import open_source
from tests.bench.bench_real import NEAR_M, Found, distance
from tests.worlds.oracle import OracleStore

FAMILIES = ("yolo11n-640.onnx", "yolox-nano-416.onnx")
WIDE = "yolo11n-608x1088.onnx"
ORANGE_BOWL = "Did you ever see an orange bowl?"
SAME_QUESTION = "Did you ever see an orange bowl on the desk?"
"""The judge's question about the same bowl: the one that there is lies on the desk."""


def looked_at(
    reader: Reader, shared: Path, model: str, options: Mapping[str, str]
) -> tuple[IngestSummary, OracleStore]:
    """Ingest a recording with a model in place of whatever boxes it has."""
    given = {"classes": str(shared / "models/coco80.txt"), **options}
    detector = open_detector(str(shared / "models" / model), given)
    assert detector is not None
    store = OracleStore()
    return ingest(reader, store, DEFAULT, detector=detector), store


def detector_share(summary: IngestSummary) -> float:
    """The part of the time that the detector took."""
    return summary.seconds["detect"] / sum(summary.seconds.values())


def kitchen(
    shared: Path, model: str, options: Mapping[str, str]
) -> tuple[IngestSummary, OracleStore, list[Found]]:
    """Ingest the kitchen; look for the true cups and chairs among the stays of their category."""
    folder = shared / "data/red-kitchen"
    summary, store = looked_at(open_source(folder), shared, model, options)
    categories = {record.object_id: record.category for record in store.objects()}
    found = []
    for true in json.loads((folder / "truth.json").read_text(encoding="utf-8"))["objects"]:
        away = [
            distance(stay, true["position"])
            for stay in store.stays()
            if categories[stay.object_id] == true["category"] and stay.position is not None
        ]
        near = sum(metres <= NEAR_M for metres in away)
        found.append(Found(true["id"], min(away, default=float("inf")), near))
    return summary, store, found


def kuri(shared: Path, model: str, options: Mapping[str, str]) -> tuple[IngestSummary, OracleStore]:
    """Ingest the JPEGs by a table of their times; of the authors' table nothing else is read."""
    sample = shared / "data/kuri-sample"
    with (sample / "detections.csv").open(encoding="utf-8") as lines:
        times = {row["frame"]: row["timestamp"] for row in csv.DictReader(lines)}
    with tempfile.TemporaryDirectory() as scratch:
        table = Path(scratch) / "times.csv"
        rows = "".join(f"{frame}.jpg,{time}\n" for frame, time in times.items())
        table.write_text(f"file,time\n{rows}", encoding="utf-8")
        reader = open_source(
            sample / "images",
            format="pictures",
            zone="America/New_York",
            options={"times": str(table)},
        )
        return looked_at(reader, shared, model, options)


def asked(store: OracleStore, texts: list[str]) -> list[Answer]:
    """Ask at the newest frame."""
    now = store_now(store, "last", lambda: datetime(2020, 3, 1, tzinfo=UTC))
    return list(run(store, texts, now=now))


def right_frames(sample: Path, question: str) -> set[str]:
    """The frames that show what a question asks for."""
    lines = (sample / "questions-dev.jsonl").read_text(encoding="utf-8").splitlines()
    records = {record["text"]: record["answer"] for record in map(json.loads, lines)}
    return {str(frame) for frame in records[question]["frames_ok"]}


def first_frame(answer: Answer) -> str | None:
    """The frame of the first keyframe; None for an answer without one."""
    images = [keyframe.image for keyframe in answer.keyframes if keyframe.image]
    return images[0].rpartition("/")[2] if images else None


def judged(shared: Path, store: OracleStore) -> str:
    """What the sample's judge says of all its questions."""
    sample = shared / "data/kuri-sample"
    questions = sample / "questions-dev.jsonl"
    texts = [json.loads(line)["text"] for line in questions.read_text("utf-8").splitlines()]
    with tempfile.TemporaryDirectory() as scratch:
        written = Path(scratch) / "answers.jsonl"
        lines = (json.dumps(answer.to_json()) + "\n" for answer in asked(store, texts))
        written.write_text("".join(lines), encoding="utf-8")
        judge = [str(shared / "tools/score-kuri"), str(sample), str(questions), str(written)]
        return subprocess.run(judge, capture_output=True, text=True, check=True).stdout


def told(summary: IngestSummary) -> str:
    """The time by stage, and the detector's share."""
    stages = ", ".join(f"{stage} {value:.2f} s" for stage, value in summary.seconds.items())
    return f"{summary.frames} frames, {stages}: detector {detector_share(summary):.0%}"


@click.command()
@click.option("--shared", envvar="D3A_SHARED", required=True, type=click.Path(path_type=Path))
@click.option("--threads", default=1, show_default=True, help="Processor threads of OpenCV.")
def main(shared: Path, threads: int) -> None:
    """Print places, time and answers."""
    options = {"threads": str(threads)}
    for model in FAMILIES:
        summary, store, found = kitchen(shared, model, options)
        click.echo(f"red-kitchen, {model}: {told(summary)}")
        for each in found:
            click.echo(f"  {each.name:<18} {each.distance_m:5.2f} m off, {each.stays} stay(s)")
        sure = [record.category for record in store.objects() if not record.tentative]
        click.echo(f"  confirmed: {sure.count('cup')} cups of 2, {sure.count('chair')} chairs of 6")
    for threshold in ("0.25", "0.1"):
        summary, store = kuri(shared, WIDE, options | {"threshold": threshold})
        click.echo(f"kuri, {WIDE}, threshold {threshold}: {told(summary)}")
        (answer,) = asked(store, [ORANGE_BOWL])
        frame = first_frame(answer)
        is_right = frame in right_frames(shared / "data/kuri-sample", SAME_QUESTION)
        click.echo(f"  {ORANGE_BOWL} {answer.status}, first keyframe {frame}: right {is_right}")
        click.echo("  all questions:\n    " + judged(shared, store).strip().replace("\n", "\n    "))


if __name__ == "__main__":
    main()
