"""Compare the answers of every store with the oracle's, on many drawn homes.

    python -m tests.bench.bench_equal [--number 500]

Runs `tests/assistant/test_equal_answers.py` with so many homes for SQLite, SQLite without R*Trees,
MongoDB over the wire (the double, and D3A_TEST_MONGO_URI where it is set), eight formal queries a
home, each asked whole and with a small limit. Prints how many were compared.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

TEST = Path(__file__).parents[1] / "assistant" / "test_equal_answers.py"
QUERIES = 6


def main() -> None:
    """Run the test with the number of homes that is asked for; its status is this one's."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--number", type=int, default=500, help="homes a store")
    number = options.parse_args().number
    begun = time.perf_counter()
    command = [sys.executable, "-m", "pytest", "-v", "-p", "no:cacheprovider", str(TEST)]
    ended = subprocess.run(
        command, env=os.environ | {"D3A_DRAWN": str(number)}, cwd=TEST.parents[2], check=False
    )
    sys.stdout.write(
        f"N = {number} homes and {number * QUERIES} formal queries a store, each asked twice; "
        f"{time.perf_counter() - begun:.0f} s\n"
    )
    raise SystemExit(ended.returncode)


if __name__ == "__main__":
    main()
