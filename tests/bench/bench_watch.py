"""How far `d3a watch` is behind a robot: from a frame's last byte to where others can ask for it.

`python -m tests.bench.bench_watch [--frames 300] [--rate 10] [--fresh 2] [--source FOLDER]`

One process writes, one watches, this one asks the store which frame is the newest. Without
--source a patrol with small pictures is made; any recording folder will do.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import closing
from pathlib import Path

import numpy as np

from d3a.store import open_store
from d3a.store.base import StoreError

ROOT = Path(__file__).resolve().parents[2]
POLL_S = 0.02


def made(folder: Path, count: int) -> Path:
    """A patrol with pictures and depth."""
    from tests.assistant.commands.test_watch_command import patrol

    return patrol(folder, count)


def part_of(source: Path, folder: Path, count: int) -> Path:
    """The first frames of a recording, its pictures by link."""
    folder.mkdir()
    lines = (source / "frames.jsonl").read_text().splitlines(keepends=True)[:count]
    names = {json.loads(line)["frame"] for line in lines}
    rows = (source / "detections.jsonl").read_text().splitlines(keepends=True)
    (folder / "frames.jsonl").write_text("".join(lines))
    kept = [row for row in rows if json.loads(row)["frame"] in names]
    (folder / "detections.jsonl").write_text("".join(kept))
    (folder / "recording.json").write_text((source / "recording.json").read_text())
    for each in source.iterdir():
        if each.is_dir() or each.suffix == ".npy":
            (folder / each.name).symlink_to(each)
    return folder


class Written:
    """When each frame was written, as the writer says."""

    def __init__(self, writer: subprocess.Popen[str]) -> None:
        self.times: list[float] = []
        self._writer = writer
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self) -> None:
        assert self._writer.stdout is not None
        for line in self._writer.stdout:
            self.times.append(json.loads(line)[1])


def measure(whole: Path, folder: Path, rate_hz: float, fresh_s: float) -> dict[str, float]:
    """Write, watch and ask; return the lags in seconds and what the watching cost."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    growing = [sys.executable, str(ROOT / "tests/worlds/growing.py")]
    watch = [sys.executable, "-m", "assistant.cli", "watch", "grows", "--store", "s.db", "-q"]
    watch += ["--until-idle", "3", "--fresh", str(fresh_s)]
    watcher = subprocess.Popen(watch, cwd=folder, env=environment, stdout=subprocess.DEVNULL)
    time.sleep(3)  # it waits for the folder
    command = [*growing, str(whole), str(folder / "grows"), str(rate_hz)]
    writer = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=folder)
    written, seen = Written(writer), 0
    lags: list[float] = []
    while watcher.poll() is None:
        time.sleep(POLL_S)
        try:
            with closing(open_store(str(folder / "s.db"), create=False, read_only=True)) as store:
                frames = sum(record.frames for record in store.recordings())
        except StoreError:  # it is being made
            continue
        now = time.time()
        lags += [now - written.times[n] for n in range(seen, frames)]
        seen = max(seen, frames)
    assert watcher.returncode == 0
    assert writer.wait() == 0
    usage = os.times()
    p50, p95, most = np.percentile(lags, [50, 95, 100])
    span_s = written.times[-1] - written.times[0]
    return {
        "frames": len(lags),
        "rate_hz": round((len(lags) - 1) / span_s, 2),
        "lag_p50_s": round(float(p50), 3),
        "lag_p95_s": round(float(p95), 3),
        "lag_max_s": round(float(most), 3),
        "last_quarter_p50_s": round(float(np.median(lags[-len(lags) // 4 :])), 3),
        "children_cpu_s": round(usage.children_user + usage.children_system, 2),
    }


def main() -> None:
    """Measure, and print one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--rate", type=float, default=10.0)
    parser.add_argument("--fresh", type=float, default=2.0)
    parser.add_argument("--source", type=Path)
    said = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if said.source is None:
            whole = made(folder / "whole", said.frames)
        else:
            whole = part_of(said.source.resolve(), folder / "whole", said.frames)
        sys.stdout.write(json.dumps(measure(whole, folder, said.rate, said.fresh)) + "\n")


if __name__ == "__main__":
    main()
