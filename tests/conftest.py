"""Fixtures of every test: the shared data, the oracle store and a MongoDB server."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

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
