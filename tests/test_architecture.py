"""The one direction of imports, and who may use which heavy library (STYLE, "Layout")."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("grammar", "d3a", "assistant")
MAY_IMPORT = {
    "grammar": {"grammar"},
    "d3a": {"d3a", "grammar.forms"},
    "assistant": {"assistant", "d3a", "grammar"},
}
ONLY_USERS = {
    "cv2": ("d3a/images.py", "d3a/videos.py", "d3a/detectors/onnx.py"),
    "sklearn": ("d3a/tier1.py",),
    "pymongo": ("d3a/store/mongo",),
    "bson": ("d3a/store/mongo",),
    "textual": ("assistant/ui/",),
    "mitsuba": ("assistant/home/",),
    "matplotlib": ("assistant/evaluation/",),
    "rosbags": ("d3a/readers/ros_bag.py",),
}
GRAMMAR_MAY_USE = {"lark", "rapidfuzz"}


WITHIN_D3A = {
    "answering": {"answering"},
    "correcting": {"answering", "correcting"},
    "ingesting": {"ingesting"},
    "tracking": {"correcting", "tracking"},
}
"""Of which of these packages each may use modules."""

FACADE = ("d3a/__init__.py", "assistant.api")
"""The one arrow that points back: `d3a.open` loads the API when it is used, and not before."""


def modules() -> list[Path]:
    return sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))


def imported(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            assert node.module is not None
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def within(name: str, allowed: set[str]) -> bool:
    return any(name == prefix or name.startswith(prefix + ".") for prefix in allowed)


def is_facade(path: Path, name: str) -> bool:
    return path == ROOT / FACADE[0] and within(name, {FACADE[1]})


@pytest.mark.parametrize("path", modules(), ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_run_one_way(path: Path) -> None:
    package = path.relative_to(ROOT).parts[0]
    for name in imported(path):
        if name.split(".")[0] in PACKAGES and not is_facade(path, name):
            assert within(name, MAY_IMPORT[package]), f"{package} may not import {name}"
        for library, users in ONLY_USERS.items():
            if name.split(".")[0] == library:
                where = path.relative_to(ROOT).as_posix()
                assert where.startswith(users), f"only {users} may import {library}"


@pytest.mark.parametrize("package", WITHIN_D3A)
def test_questions_corrections_and_tracking_do_not_mix(package: str) -> None:
    for path in sorted((ROOT / "d3a" / package).rglob("*.py")):
        for name in imported(path):
            parts = name.split(".")
            if parts[0] == "d3a" and parts[1] in WITHIN_D3A:
                assert parts[1] in WITHIN_D3A[package], f"{path.name}: d3a.{package} uses {name}"


@pytest.mark.parametrize(
    "path", sorted((ROOT / "grammar").rglob("*.py")), ids=lambda path: path.stem
)
def test_grammar_needs_little(path: Path) -> None:
    for name in imported(path):
        top = name.split(".")[0]
        assert top in sys.stdlib_module_names | GRAMMAR_MAY_USE | {"grammar"}, name


@pytest.mark.parametrize(
    ("module", "unwanted"),
    [
        ("grammar.parser", {"numpy", "textual", "cv2", "pymongo", "sklearn", "scipy", "PIL"}),
        ("d3a", {"assistant", "click", "numpy", "lark", "textual", "cv2", "pymongo", "sklearn"}),
        ("d3a.plan", {"textual", "cv2", "pymongo", "sklearn", "scipy", "PIL"}),
        ("d3a.store", {"textual", "cv2", "pymongo", "sklearn", "scipy", "PIL"}),
        ("assistant.asking", {"textual", "cv2", "pymongo", "sklearn", "scipy", "PIL"}),
        ("assistant.cli", {"textual", "cv2", "pymongo", "sklearn", "scipy", "PIL", "numpy"}),
    ],
)
def test_fresh_interpreter_loads_little(module: str, unwanted: set[str]) -> None:
    code = f"import sys, {module}; print(*sorted({{m.split('.')[0] for m in sys.modules}}))"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert not unwanted & set(done.stdout.split())


def test_a_question_loads_nothing_that_teaches_or_writes_or_joins() -> None:
    unwanted = {
        "assistant.protocols",
        "assistant.taught",
        "d3a.answering.changes",
        "d3a.answering.joins",
        "d3a.answering.relating",
        "d3a.constraints",
        "d3a.correcting.forgotten",
        "d3a.store.expected",
        "d3a.store.limits",
        "d3a.store.sqlite_check",
        "d3a.store.sqlite_dump",
        "d3a.store.sqlite_repair",
        "d3a.store.sqlite_write",
        "hashlib",
        "numpy.polynomial",
        "tomllib",
    }
    code = "import sys, assistant.cli, assistant.commands.ask, assistant.asking, d3a.store"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}; print(*sys.modules)"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert not unwanted & set(done.stdout.split())


@pytest.mark.parametrize("path", modules(), ids=lambda path: str(path.relative_to(ROOT)))
def test_modules_stay_short(path: Path) -> None:
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 400
