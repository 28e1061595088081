"""Fixtures of every test: the shared data, the oracle store and a MongoDB server."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from d3a.store import open_store, schema
from d3a.store.base import Store
from tests.worlds.oracle import OracleStore


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of recordings and question sets that D3A_SHARED names."""
    named = os.environ.get("D3A_SHARED")
    if not named:
        pytest.skip("D3A_SHARED does not name the folder of shared recordings and questions")
    folder = Path(named)
    if not folder.is_dir():
        pytest.fail(f"D3A_SHARED names {folder}, which is not a folder")
    return folder


@pytest.fixture
def oracle_store() -> OracleStore:
    """An empty store that answers by brute force."""
    return OracleStore()


@pytest.fixture(params=["oracle", "sqlite", "sqlite without R*Tree"])
def make_store(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[[], Store]:
    """Make empty stores of each kind: call it, use the store, close it."""
    kind: str = request.param
    numbers = itertools.count()
    if kind == "oracle":
        return OracleStore
    if kind == "sqlite without R*Tree":
        monkeypatch.setattr(schema, "has_rtree", lambda _: False)
    return lambda: open_store(str(tmp_path / f"{next(numbers)}.db"))
