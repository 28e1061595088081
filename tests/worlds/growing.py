"""A robot's program as a process of its own: it writes a recording folder line by line.

`python growing.py WHOLE FOLDER FRAMES_A_SECOND` copies a recording into a folder that grows, and
prints each frame's name with the time at which all of it was written.
"""

from __future__ import annotations

import json
import shutil
import sys
import time
from pathlib import Path


def write(whole: Path, folder: Path, rate_hz: float) -> None:
    """Write the frames at their rate, each with its pictures and boxes; half a line at first."""
    folder.mkdir(parents=True, exist_ok=True)
    rows: dict[str, list[str]] = {}
    for line in (whole / "detections.jsonl").read_text().splitlines(keepends=True):
        rows.setdefault(json.loads(line)["frame"], []).append(line)
    shutil.copy(whole / "recording.json", folder)
    start = time.monotonic()
    with (
        (folder / "frames.jsonl").open("a") as frames,
        (folder / "detections.jsonl").open("a") as boxes,
    ):
        for n, line in enumerate((whole / "frames.jsonl").read_text().splitlines(keepends=True)):
            time.sleep(max(0.0, start + n / rate_hz - time.monotonic()))
            record = json.loads(line)
            for name in (record["image"], record["depth"]):
                if name is not None:
                    (folder / name).parent.mkdir(exist_ok=True)
                    shutil.copy(whole / name, folder / name)
            for part in (line[:20], line[20:]):
                frames.write(part)
                frames.flush()
            boxes.writelines(rows.get(record["frame"], []))
            boxes.flush()
            sys.stdout.write(json.dumps([record["frame"], time.time()]) + "\n")
            sys.stdout.flush()


if __name__ == "__main__":
    write(Path(sys.argv[1]), Path(sys.argv[2]), float(sys.argv[3]))
