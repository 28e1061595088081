"""Files that were damaged anywhere: a reader counts what is broken, or says why it cannot read."""

from __future__ import annotations

import importlib.util
import random
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from d3a.ingest import ingest
from d3a.ingesting.survey import lacks, survey
from d3a.model import BadInput
from d3a.parameters import DEFAULT
from d3a.readers.opening import open_source
from tests.worlds.folders import as_recording, as_tum
from tests.worlds.oracle import OracleStore

ROUNDS = 25


def module(name: str) -> ModuleType:
    """The tests of a reader, which hold the writer of its folders."""
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    assert spec is not None
    assert spec.loader is not None
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


WRITERS: dict[str, Callable[[Path], Path]] = {
    "recording": as_recording,
    "tum": as_tum,
    "pictures": lambda folder: module("test_reader_pictures").as_pictures(folder),
    "csv": lambda folder: module("test_reader_csv").as_csv(folder),
    "coco": lambda folder: module("test_reader_coco").as_coco(folder),
    "posed": lambda folder: module("test_reader_equal").as_posed(folder),
    "kuri": lambda folder: module("test_reader_equal").as_kuri(folder),
}
ODD = (
    "9" * 30,
    "-1",
    "1e400",
    "NaN",
    "null",
    '"',
    "{",
    "[",
    ",",
    "\n",
    "\0",
    "\x1b[2J",
    "é",
    "\u2028",
)


def damaged(content: bytes, rng: random.Random) -> bytes:
    """The bytes with a few cuts, swaps and odd pieces put in."""
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(content) + 1)
        until = min(len(content), at + rng.choice((0, 1, 3, 40)))
        piece = rng.choice(
            (b"", rng.choice(ODD).encode(), rng.randbytes(4), content[:20], b"\xff\xfe")
        )
        content = content[:at] + piece + content[until:]
    return content


@pytest.mark.parametrize("name", WRITERS)
def test_damage_is_counted_or_refused(name: str, tmp_path: Path) -> None:
    folder = WRITERS[name](tmp_path / "sound")
    suffixes = {".json", ".jsonl", ".csv", ".txt"}
    texts = sorted(p for p in folder.rglob("*") if p.suffix in suffixes)
    rng = random.Random(name)
    read = 0
    for _ in range(ROUNDS):
        with tempfile.TemporaryDirectory(dir=tmp_path) as place:
            copy = Path(place) / "copy"
            shutil.copytree(folder, copy)
            file = copy / rng.choice(texts).relative_to(folder)
            file.write_bytes(damaged(file.read_bytes(), rng))
            store = OracleStore()
            try:
                reader = open_source(copy, format=name, zone="UTC")
                list(lacks(survey(reader)))
                ingest(reader, store, DEFAULT)
            except BadInput:
                continue
            read += 1
            assert store.check() == []
    assert read > ROUNDS // 4
