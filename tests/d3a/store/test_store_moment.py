"""What is read in one moment of a store does not change with what another writes."""

from __future__ import annotations

import threading
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from d3a import teaching
from d3a.constraints import Correction, with_records
from d3a.correcting.forgetting import forget, plan_forgetting
from d3a.correcting.forgotten import Selection
from d3a.store import open_store
from d3a.store.base import Batch, Keyframe
from d3a.store.copy import copy_store
from tests.worlds import small_home


def test_a_file_is_copied_as_it_was_when_the_copy_began(tmp_path: Path) -> None:
    path = str(tmp_path / "home.db")
    with (
        closing(open_store(path)) as writer,
        closing(open_store(path, read_only=True)) as source,
        closing(open_store(str(tmp_path / "copy.db"))) as target,
    ):
        small_home.fill(writer)
        before = list(source.dump())
        written: list[int] = []

        def meddle(copied: int) -> None:
            written.append(copied)
            gone = [key for key in writer.keyframe_keys() if key != "late"][:1]
            late = Keyframe("late", b"\xff\xd8 late", 4, 3, copied)
            writer.apply(
                Batch(
                    keyframes=[late],
                    removed_keyframes=gone,
                    meta={"late": copied},
                    state=f"state {copied}".encode(),
                )
            )

        copy_store(source, target, progress=meddle)
        assert len(written) > 3
        assert list(target.dump()) == before
        assert list(source.dump()) == list(writer.dump()) != before, "the moment is over"


def test_reads_in_a_moment_agree(tmp_path: Path) -> None:
    path = str(tmp_path / "home.db")
    with closing(open_store(path)) as writer, closing(open_store(path)) as reader:
        writer.apply(Batch(meta={"a": 1}))
        with reader.moment():
            assert reader.meta("a") == 1
            writer.apply(Batch(meta={"a": 2}))
            assert reader.meta("a") == 1
            assert [record["value"] for record in reader.dump()] == [1]
        assert reader.meta("a") == 2
        reader.apply(Batch(meta={"a": 3}))
        assert writer.meta("a") == 3


def test_a_moment_of_a_server_keeps_others_from_writing(mongo_uri: str) -> None:
    with closing(open_store(mongo_uri)) as one, closing(open_store(mongo_uri)) as two:
        other = threading.Thread(target=lambda: two.apply(Batch(meta={"a": 2})))
        with one.moment():
            other.start()
            other.join(0.3)
            assert one.meta("a") is None
        other.join()
        assert one.meta("a") == 2


def test_a_forgetting_is_planned_in_one_moment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Who takes a correction back while it is read does not make the plan fail."""
    path = str(tmp_path / "home.db")
    with closing(open_store(path)) as store, closing(open_store(path)) as another:
        small_home.fill(store)
        teaching.merge(store, "cup-1", "couch-1", force=True)

        def undone_meanwhile(*args: Any) -> Correction:
            if teaching.history(another):
                teaching.undo(another)
            return with_records(*args)

        monkeypatch.setattr("d3a.correcting.forgotten_history.with_records", undone_meanwhile)
        plan = plan_forgetting(store, Selection(object_ids=frozenset({"keys-1"})))
        assert teaching.history(another) == ()
        done = forget(store, plan)
        assert done.is_anew
        assert store.objects(ids=["keys-1"]) == []
        assert store.check() == []
