"""What a model's file says of itself, read without a library; broken files are refused."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from d3a.detectors.onnx_file import Tensor, read_onnx
from d3a.model import BadInput
from tests.worlds.onnx_models import Graph, finder


def test_inputs_outputs_and_metadata(tmp_path: Path) -> None:
    file = read_onnx(finder(tmp_path / "m.onnx", names="{0: 'cup'}"))
    assert file.inputs == (Tensor("images", (1, 3, 48, 64)),)
    (output,) = file.outputs
    assert output.shape == (1, None, None)
    assert str(output) == "1 x ? x ?"
    assert file.metadata == {"names": "{0: 'cup'}"}


def test_weights_are_no_inputs(tmp_path: Path) -> None:
    graph = Graph()
    weight = graph.weight(np.zeros((2, 2), dtype=np.float32))
    path = tmp_path / "old.onnx"
    path.write_bytes(graph.model({"images": (1, 3, "h", "w"), weight: (2, 2)}, {weight: (2, 2)}))
    assert read_onnx(path).inputs == (Tensor("images", (1, 3, None, None)),)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "it holds no network"),
        (b"hello world, this is no model", "not an ONNX model"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:12\n", "not an ONNX model"),
        (b"\x89PNG\r\n\x1a\n", "not an ONNX model"),
        (b"\x38" + b"\xff" * 30, "a number without an end"),
        (b"\x38\x07", "it holds no network"),
    ],
)
def test_what_is_no_model_is_refused(tmp_path: Path, content: bytes, said: str) -> None:
    path = tmp_path / "m.onnx"
    path.write_bytes(content)
    with pytest.raises(BadInput, match=said):
        read_onnx(path)


def test_what_is_not_there_or_cut_off_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"m\.onnx cannot be read: No such file"):
        read_onnx(tmp_path / "m.onnx")
    with pytest.raises(BadInput, match="cannot be read: Is a directory"):
        read_onnx(tmp_path)
    whole = finder(tmp_path / "m.onnx").read_bytes()
    (tmp_path / "m.onnx").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(BadInput, match="it ends too early"):
        read_onnx(tmp_path / "m.onnx")


@settings(max_examples=200)
@given(at=st.integers(0, 3000), with_=st.binary(max_size=6), cut=st.integers(0, 3000))
def test_no_bytes_raise_anything_else(
    tmp_path_factory: pytest.TempPathFactory, at: int, with_: bytes, cut: int
) -> None:
    path = tmp_path_factory.mktemp("fuzz") / "m.onnx"
    whole = finder(path, names="['cup']").read_bytes()
    at %= len(whole)
    path.write_bytes((whole[:at] + with_ + whole[at + len(with_) :])[: cut or None])
    with suppress(BadInput):
        assert read_onnx(path).inputs is not None
