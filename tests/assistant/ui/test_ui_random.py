"""Random keys and resizes break nothing; `python -m tests.bench.bench_random` does many more."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.worlds.random_presses import press_at_random


@pytest.mark.parametrize("seed", [1, 2])
async def test_random_presses_break_nothing(seed: int, tmp_path: Path) -> None:
    done = await press_at_random(seed, 120, tmp_path)
    assert sum(done.values()) == 120 or done["quits"]
    assert min(done["keys"], done["questions"], done["resizes"]) > 0
