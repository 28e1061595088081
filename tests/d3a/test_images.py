from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from d3a import images
from d3a.model import BadInput
from tests.worlds.rounds import depth_png, jpeg


def test_channels_come_out_as_red_green_blue() -> None:
    red = np.zeros((16, 16, 3), np.uint8)
    red[..., 0] = 255
    pixels = images.decode(images.encode(red, 100, 95))
    assert pixels[8, 8, 0] > 240
    assert pixels[8, 8, 2] < 20


@pytest.mark.parametrize("share", [0.3, 0.5, 0.9, 0.999])
def test_a_cut_jpeg_is_refused_wherever_it_is_cut(share: float) -> None:
    whole = jpeg(90, 320, 240)
    images.decode(whole)
    cut = whole[: int(len(whole) * share)]
    with pytest.raises(BadInput, match="cut off"):
        images.decode(cut)
    with pytest.raises(BadInput):
        images.check(cut)


def test_the_end_marker_of_a_thumbnail_is_not_the_end() -> None:
    whole = jpeg(90, 320, 240)
    inner = jpeg(10)
    segment = b"\xff\xe1" + (len(inner) + 2).to_bytes(2, "big") + inner
    with_thumbnail = whole[:2] + segment + whole[2:]
    assert not images.is_cut(with_thumbnail)
    assert images.is_cut(with_thumbnail[: len(segment) + 200])


def test_bytes_after_the_end_do_no_harm() -> None:
    assert not images.is_cut(jpeg(90) + b"\0\0trailer")


def test_what_is_no_picture_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="not a picture"):
        images.decode(b"GIF89a nonsense")
    with pytest.raises(BadInput, match="cannot be read"):
        images.decode(tmp_path / "none.jpg")


def test_depth_is_metres_and_only_16_bit() -> None:
    assert images.decode_depth(depth_png(1.5))[0, 0] == pytest.approx(1.5)
    with pytest.raises(BadInput, match="16-bit"):
        images.decode_depth(jpeg(9))
    with pytest.raises(BadInput, match="cut off"):
        images.decode_depth(depth_png(1.5)[:-20])
    measured = np.array([[np.nan, np.inf, 2.0]], np.float32)
    assert images.decode_depth(measured).tolist() == [[0.0, 0.0, 2.0]]


def test_the_histogram_has_the_order_of_the_recording_format() -> None:
    pixels = np.zeros((10, 10, 3), np.uint8)
    pixels[..., 0], pixels[..., 1], pixels[..., 2] = 70, 40, 250  # bins 2, 1, 7
    embedding = images.histogram(pixels)
    assert embedding.argmax() == 64 * 2 + 8 * 1 + 7
    assert embedding.dtype == np.float32
    assert np.linalg.norm(embedding) == pytest.approx(1.0)


def test_the_mass_comes_back_from_the_unit_length() -> None:
    pixels = np.zeros((10, 10, 3), np.uint8)
    pixels[:3] = 200
    embedding = images.histogram(pixels)
    mass = embedding / embedding.sum()
    assert mass[64 * 6 + 8 * 6 + 6] == pytest.approx(0.3)
    assert mass[0] == pytest.approx(0.7)


def test_the_histogram_counts_as_a_loop_does() -> None:
    rng = np.random.default_rng(3)
    pixels = rng.integers(0, 256, (20, 30, 3), dtype=np.uint8)
    bins = pixels.reshape(-1, 3).astype(int) // 32
    counts = np.bincount(bins @ np.array([64, 8, 1]), minlength=512)
    assert np.allclose(images.histogram(pixels), counts / np.linalg.norm(counts), atol=1e-6)


def test_a_crop_is_never_empty() -> None:
    pixels = np.zeros((10, 10, 3), np.uint8)
    assert images.crop(pixels, (9.7, 9.7, 30, 30)).shape == (1, 1, 3)
    assert images.crop(pixels, (2, 3, 6, 9)).shape == (6, 4, 3)


def test_a_keyframe_is_made_smaller_only() -> None:
    pixels = np.zeros((100, 200, 3), np.uint8)
    small = cv2.imdecode(np.frombuffer(images.encode(pixels, 50, 80), np.uint8), 1)
    assert small is not None
    assert small.shape == (25, 50, 3)
    assert images.decode(images.encode(pixels, 500, 80)).shape == (100, 200, 3)


@pytest.mark.parametrize("encoded", [jpeg(9, 80, 20), depth_png(1.0, 80, 20)])
def test_a_size_is_read_from_the_header(encoded: bytes) -> None:
    assert images.size(encoded) == (80, 20)
    with pytest.raises(BadInput, match="cut off"):
        images.size(encoded[:-20])


def test_a_depth_picture_has_its_own_scale() -> None:
    assert images.decode_depth(depth_png(1.5), 5000.0)[0, 0] == pytest.approx(0.3)


def test_a_picture_that_would_fill_the_memory_is_not_decoded() -> None:
    wide = bytearray(depth_png(1.0))
    wide[16:20] = (1_000_000).to_bytes(4, "big")
    for read in (images.decode, images.decode_depth, images.size):
        with pytest.raises(BadInput, match="too large to decode: 1000000 x 48"):
            read(bytes(wide))
