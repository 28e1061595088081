"""`d3a ingest --detector --embedder` as a person runs it."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from assistant.cli import main
from d3a import images
from d3a.store import open_store
from tests.worlds.onnx_models import CLASSES, finder, mean_colour, names_file, scene

Run = Callable[..., Result]


@pytest.fixture
def run(own_settings: Path) -> Run:
    """Beside a folder of pictures, a detector without names, their file, and an embedder."""
    Path("shots").mkdir()
    rows = ["file,time"]
    for n in range(6):
        picture = scene({(1, 1): "cup", (3, n % 3): "book"})
        Path(f"shots/{n}.jpg").write_bytes(images.encode(picture, 64, 95))
        rows.append(f"{n}.jpg,2024-05-01T10:00:{n:02d}Z")
    Path("shots/times.csv").write_text("\n".join(rows) + "\n")
    finder(Path("m.onnx"))
    names_file(Path("names.txt"))
    mean_colour(Path("look.onnx"))
    return lambda *args: CliRunner().invoke(main, ["ingest", *args, "--store", "s.db"])


def test_pictures_with_a_model(run: Run) -> None:
    result = run("shots", "--detector", "m.onnx", "--classes", "names.txt")
    assert result.exit_code == 0, result.output
    assert "detector: m.onnx " in result.stderr
    assert "layout yolo8, 3 classes, input 64 x 48 rgb-1, centre, threshold 0.25" in result.stderr
    assert "detections  12" in result.stdout
    assert ", detect 0." in result.stdout
    with closing(open_store("s.db")) as store:
        assert store.meta("classes") == sorted(CLASSES)
        assert {record.category for record in store.objects()} == {"book", "cup"}


def test_thresholds_options_and_an_embedder(run: Run) -> None:
    detector = ("--detector", "m.onnx", "--classes", "names.txt")
    strict = run("shots", *detector, "--detector-threshold", "0.9", "--json")
    assert json.loads(strict.stdout)["recordings"][0]["detections"] == 0
    Path("s.db").unlink()
    tuned = ("--detector-option", "threshold=0.1", "--detector-option", "layout=yolo8")
    looks = ("--embedder", "look.onnx", "--embedder-option", "pixels=rgb-1")
    result = run("shots", *detector, *tuned, *looks)
    assert "threshold 0.1" in result.stderr
    assert "embedder: look-" in result.stderr
    with closing(open_store("s.db")) as store:
        assert str(store.meta("embedding_model")).endswith("+rgb-8x8x8")
    asked = CliRunner().invoke(main, ["ask", "Where is the red cup?", "--store", "s.db"])
    assert asked.exit_code == 0, asked.output


@pytest.mark.parametrize(
    ("args", "said"),
    [
        ((), "it needs a detector (--detector model.onnx)"),
        (("--detector", "none.onnx"), "the model none.onnx cannot be read: No such file"),
        (("--detector", "names.txt"), "there is no detector 'names.txt'; there are recorded"),
        (("--detector", "m.onnx"), "give --classes FILE with a name a line"),
        (("--detector", "m.onnx", "--classes", "x.txt"), "there is no such file"),
        (("--classes", "names.txt"), "'classes' is of a detector: give --detector model.onnx too"),
        (("--detector-option", "layout"), "as in layout=yolox"),
        (("--embedder-option", "fit=corner"), "'fit' is of an embedder: give --embedder"),
        (("--embedder", "clip"), "there is no embedder 'clip'; there are rgb-8x8x8"),
        (
            (
                *("--detector", "m.onnx", "--detector-option", "threshold=1"),
                *("--detector-threshold", "0.5"),
            ),
            "the detector option 'threshold' is given twice",
        ),
    ],
)
def test_what_cannot_be_is_said_and_no_store_is_left(
    run: Run, args: tuple[str, ...], said: str
) -> None:
    result = run("shots", *args)
    assert result.exit_code == 2
    assert said in " ".join(result.stderr.split())
    assert "Traceback" not in result.output
