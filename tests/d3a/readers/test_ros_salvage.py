"""Bags with bytes that are wrong anywhere: they are read, or said to be none, and nothing else."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from d3a.model import BadInput
from d3a.readers.opening import open_source

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'd3a[ros]'")

from tests.worlds.bags import KINDS, as_bag


@pytest.mark.parametrize("kind", KINDS)
def test_no_damage_ends_in_another_error(tmp_path: Path, kind: str) -> None:
    bag = as_bag(tmp_path / "b", kind)
    file = bag if bag.is_file() else next(f for f in bag.iterdir() if f.suffix != ".yaml")
    sound, rng, read = file.read_bytes(), random.Random(11), 0
    for number in range(12):
        content = bytearray(sound)
        for _ in range(number % 4 * 5):
            content[rng.randrange(len(content))] = rng.randrange(256)
        if number % 3 == 0:
            del content[rng.randrange(len(content)) :]
        file.write_bytes(content)
        try:
            frames = list(open_source(bag))
        except BadInput:
            continue
        read += bool(frames)
        assert len(frames) <= 8
    assert read > 0
