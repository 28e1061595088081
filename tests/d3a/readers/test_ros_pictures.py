"""Pictures, depth and camera parameters of ROS messages: encodings, padding, byte order, units."""

from __future__ import annotations

import struct
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from d3a import images
from d3a.model import BadInput, Camera
from d3a.readers.ros_pictures import calibration_of, depth_of, distortion_of, is_depth, picture_of

RED = (200, 100, 50)


def raw(
    encoding: str, rows: NDArray[Any], width: int, *, pad: int = 0, big: bool = False, cut: int = 0
) -> SimpleNamespace:
    """An Image message; rows (h, ...) of anything that has bytes."""
    height = rows.shape[0]
    content = np.frombuffer(rows.tobytes(), np.uint8).reshape(height, -1)
    content = np.pad(content, ((0, 0), (0, pad)), constant_values=255)
    data = content.ravel()[: content.size - cut]
    return SimpleNamespace(
        height=height,
        width=width,
        encoding=encoding,
        is_bigendian=int(big),
        step=content.shape[1],
        data=data,
    )


def filled(*values: int) -> NDArray[np.uint8]:
    return np.broadcast_to(np.array(values, np.uint8), (4, 6, len(values)))


@pytest.mark.parametrize("pad", [0, 2])
@pytest.mark.parametrize(
    ("encoding", "rows", "want"),
    [
        ("rgb8", filled(200, 100, 50), RED),
        ("bgr8", filled(50, 100, 200), RED),
        ("rgba8", filled(200, 100, 50, 7), RED),
        ("bgra8", filled(50, 100, 200, 7), RED),
        ("8UC3", filled(50, 100, 200), RED),
        ("mono8", filled(90), (90, 90, 90)),
    ],
)
def test_colours_come_out_in_their_order(
    encoding: str, rows: NDArray[np.uint8], want: tuple[int, int, int], pad: int
) -> None:
    pixels = picture_of(raw(encoding, rows, 6, pad=pad))
    assert isinstance(pixels, np.ndarray)
    assert (pixels.shape, pixels.flags.c_contiguous) == ((4, 6, 3), True)
    assert pixels.dtype == np.uint8
    assert {tuple(p) for p in pixels.reshape(-1, 3).tolist()} == {want}


@pytest.mark.parametrize("pattern", ["rggb", "bggr", "gbrg", "grbg"])
def test_bayer_patterns_give_the_colour_back(pattern: str) -> None:
    four = [dict(zip("rgb", RED, strict=True))[sign] for sign in pattern]
    rows = np.tile(np.array(four, np.uint8).reshape(2, 2), (4, 4))
    pixels = picture_of(raw(f"bayer_{pattern}8", rows, 8, pad=4))
    assert isinstance(pixels, np.ndarray)
    assert {tuple(p) for p in pixels[2:-2, 2:-2].reshape(-1, 3).tolist()} == {RED}


@pytest.mark.parametrize(("encoding", "grey_at"), [("yuv422", 1), ("yuv422_yuy2", 0)])
def test_brightness_that_shares_colour_is_read(encoding: str, grey_at: int) -> None:
    rows = np.full((4, 6, 2), 128, np.uint8)
    rows[:, :, grey_at] = 235
    pixels = picture_of(raw(encoding, rows, 6))
    assert isinstance(pixels, np.ndarray)
    assert pixels.min() >= 250


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (raw("rgb8", filled(1, 2, 3), 6, cut=20), "cut off: 52 bytes of 72"),
        (raw("rgb8", filled(1, 2, 3), 7), "does not fit into 18 bytes"),
        (raw("rgb8", np.zeros((1, 3), np.uint8), 1_000_000), "too large to decode: 1000000 x 1"),
        (raw("rgb8", filled(1, 2, 3), 0), "the picture is empty: 0 x 4"),
        (raw("rgb10", filled(1, 2, 3), 6), "encoding 'rgb10' cannot be read"),
        (raw("bayer_xyzw8", filled(1), 6), "cannot be 'xyzw'"),
        (raw("yuv422", np.zeros((4, 5, 2), np.uint8), 5), "cannot share colours"),
    ],
)
def test_a_picture_that_cannot_be_is_refused(message: SimpleNamespace, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        picture_of(message)


def test_the_last_row_may_come_without_its_padding() -> None:
    pixels = picture_of(raw("rgb8", filled(1, 2, 3), 6, pad=10, cut=10))
    assert isinstance(pixels, np.ndarray)
    assert {tuple(p) for p in pixels.reshape(-1, 3).tolist()} == {(1, 2, 3)}


@pytest.mark.parametrize("pad", [0, 6])
@pytest.mark.parametrize(
    ("kind", "encoding", "big"),
    [("<u2", "16UC1", False), (">u2", "16UC1", True), ("<u2", "mono16", False)],
)
def test_depth_of_16_bits_is_millimetres(kind: str, encoding: str, big: bool, pad: int) -> None:
    rows = np.array([[0, 500], [1234, 65535]], kind)
    metres = images.decode_depth(depth_of(raw(encoding, rows, 2, pad=pad, big=big)))
    assert metres.ravel().tolist() == pytest.approx([0, 0.5, 1.234, 65.535])


@pytest.mark.parametrize(("kind", "big"), [("<f4", False), (">f4", True)])
def test_depth_of_32_bits_is_metres_and_nothing_where_nothing_is(kind: str, big: bool) -> None:
    rows = np.array([[np.nan, np.inf, -np.inf, 2.5]], kind)
    metres = images.decode_depth(depth_of(raw("32FC1", rows, 4, pad=3, big=big)))
    assert metres.tolist() == [[0.0, 0.0, 0.0, 2.5]]


def packed(counts: NDArray[np.uint16], form: str, a: float = 0.0, b: float = 0.0) -> Any:
    fine, buffer = cv2.imencode(".png", counts)
    assert fine
    return SimpleNamespace(format=form, data=struct.pack("<iff", 0, a, b) + bytes(buffer))


def test_packed_depth_is_unpacked_past_its_twelve_bytes() -> None:
    counts = np.array([[0, 500, 1234]], np.uint16)
    message = packed(counts, "16UC1; compressedDepth png")
    assert is_depth(message)
    assert images.decode_depth(depth_of(message)).tolist()[0] == pytest.approx([0, 0.5, 1.234])
    old = packed(counts, "16UC1; compressedDepth")  # older publishers do not say png
    assert images.decode_depth(depth_of(old)).tolist()[0] == pytest.approx([0, 0.5, 1.234])


def test_packed_metres_are_inverses() -> None:
    a, b = 1000.0, -20.0
    metres = np.array([0.5, 2.0, 8.0])
    counts = np.array([[0, *np.rint(a / metres + b)]], np.uint16)
    message = packed(counts, "32FC1; compressedDepth png", a, b)
    got = images.decode_depth(depth_of(message))
    assert got.tolist()[0] == pytest.approx([0, 0.5, 2.0, 8.0], rel=0.01)


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (SimpleNamespace(format="16UC1; compressedDepth png", data=b""), "empty"),
        (SimpleNamespace(format="16UC1; compressedDepth rvl", data=b"x" * 40), "RVL"),
        (raw("rgb8", filled(1, 2, 3), 6), "depth of encoding 'rgb8'"),
        (raw("16UC1", np.zeros((4, 6), "<u2"), 6, cut=1), "cut off"),
    ],
)
def test_depth_that_cannot_be_is_refused(message: SimpleNamespace, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        depth_of(message)


@pytest.mark.parametrize("is_ros1", [False, True])
def test_the_camera_is_that_of_the_picture_as_it_is_sent(is_ros1: bool) -> None:
    plain = info(is_ros1=is_ros1)
    camera = calibration_of(plain, (64, 48), is_rectified=False).camera
    assert camera == Camera(640, 480, 500, 510, 320, 240)
    rectified = calibration_of(plain, None, is_rectified=True).camera
    assert rectified == Camera(640, 480, 450, 460, 300, 220)
    assert distortion_of(plain) == 0.3
    binned = calibration_of(info(binning_x=2, binning_y=2), None, is_rectified=False).camera
    assert binned == Camera(320, 240, 250, 255, 160, 120)
    roi = SimpleNamespace(x_offset=100, y_offset=40, width=200, height=100)
    cropped = calibration_of(info(roi=roi), None, is_rectified=False).camera
    assert cropped == Camera(200, 100, 500, 510, 220, 200)
    sizeless = calibration_of(info(width=0, height=0), (640, 480), is_rectified=False).camera
    assert sizeless == camera


def test_a_resized_picture_has_a_resized_camera_and_a_cropped_one_has_not() -> None:
    found = calibration_of(info(), None, is_rectified=False)
    assert found.of_size((640, 480)) == found.of_size(None) == found.camera
    assert found.of_size((320, 240)) == Camera(320, 240, 250, 255, 159.75, 119.75)
    assert found.of_size((640, 360)) == found.camera


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"k": [0.0] * 9}, "not calibrated"),
        ({"k": [np.nan] * 9}, "not finite"),
        ({"width": 0, "height": 0}, "neither the camera nor a picture says a size"),
    ],
)
def test_a_camera_that_is_none_is_refused(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(BadInput, match=said):
        calibration_of(info(**changes), None, is_rectified=False)


def info(*, is_ros1: bool = False, **changes: Any) -> SimpleNamespace:
    matrices = {
        "k": [500.0, 0, 320, 0, 510, 240, 0, 0, 1],
        "p": [450.0, 0, 300, 0, 0, 460, 220, 0, 0, 0, 1, 0],
        "d": [0.1, -0.3, float("nan")],
    }
    matrices = {(n.upper() if is_ros1 else n): changes.pop(n, v) for n, v in matrices.items()}
    none = SimpleNamespace(x_offset=0, y_offset=0, width=0, height=0)
    usual = {"width": 640, "height": 480, "binning_x": 0, "binning_y": 0, "roi": none}
    header = SimpleNamespace(frame_id="/camera")
    return SimpleNamespace(header=header, **(usual | matrices | changes))
