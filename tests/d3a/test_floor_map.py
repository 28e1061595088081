"""Maps of map_server: what its documentation says of cells, origin and picture."""

from __future__ import annotations

import math
from pathlib import Path

import cv2
import numpy as np
import pytest

from d3a import teaching
from d3a.floor_map import FREE, OCCUPIED, UNKNOWN, FloorMap, read_map, stored_map
from d3a.model import BadInput
from tests.worlds.oracle import OracleStore

# two rows of three: the upper row has a wall, floor and nothing known; the lower is all floor
PIXELS = np.array([[0, 254, 205], [254, 254, 254]], dtype=np.uint8)
YAML = """image: home.pgm
mode: trinary
resolution: 0.5
origin: [-1.0, 2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def written(folder: Path, text: str = YAML, picture: bytes | None = None) -> Path:
    header = b"P5\n# CREATOR: map_saver 0.500 m/pix\n3 2\n255\n"
    (folder / "home.pgm").write_bytes(picture or header + PIXELS.tobytes())
    path = folder / "home.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_lowest_row_of_the_picture_is_row_0_and_the_origin_its_corner(tmp_path: Path) -> None:
    floor = read_map(written(tmp_path))
    wanted = [[FREE, FREE, FREE], [OCCUPIED, FREE, UNKNOWN]]
    assert floor.cells.tolist() == wanted
    assert floor.at(-0.9, 2.1) == FREE
    assert floor.at(-0.9, 2.6) == OCCUPIED
    assert floor.at(0.4, 2.9) == UNKNOWN
    assert floor.at(0.6, 2.1) == UNKNOWN  # outside
    assert floor.of_pixel(0, 2) == (-1.0, 2.0)  # the picture's lower left corner
    assert floor.of_pixel(3, 0) == (0.5, 3.0)


def test_yaw_turns_counterclockwise(tmp_path: Path) -> None:
    text = YAML.replace("0.0]", f"{math.pi / 2}]")
    floor = read_map(written(tmp_path, text))
    assert floor.point(2, 0) == pytest.approx((-1.0, 3.0))
    assert floor.at(-1.1, 3.2) == FREE  # two cells along the turned x axis
    assert floor.at(-1.6, 2.1) == OCCUPIED


@pytest.mark.parametrize(
    ("change", "corner"),
    [
        (("negate: 0", "negate: 1"), FREE),
        (("occupied_thresh: 0.65", "occupied_thresh: 1.0"), OCCUPIED),
        (("mode: trinary", "mode: raw"), FREE),
        (("[-1.0, 2.0, 0.0]", "\n  - -1.0\n  - 2.0\n  - 0.0"), OCCUPIED),
        (("negate: 0", "negate: false  # as some write it"), OCCUPIED),
    ],
)
def test_what_a_file_may_say(tmp_path: Path, change: tuple[str, str], corner: int) -> None:
    floor = read_map(written(tmp_path, YAML.replace(*change)))
    assert int(floor.cells[1, 0]) == corner


@pytest.mark.parametrize(
    "picture",
    [
        b"P2\n3 2\n# grey\n255\n0 254 205\n254 254 254\n",
        b"P5 3 2 65535\n" + (PIXELS.astype(">u2") * 257).tobytes(),
        bytes(cv2.imencode(".png", PIXELS)[1]),
        bytes(cv2.imencode(".png", np.dstack([PIXELS] * 3))[1]),
    ],
    ids=["plain pgm", "16-bit pgm", "grey png", "colour png"],
)
def test_pictures_of_other_kinds_say_the_same(tmp_path: Path, picture: bytes) -> None:
    expected = read_map(written(tmp_path)).cells.tolist()
    assert read_map(written(tmp_path, picture=picture)).cells.tolist() == expected


def test_what_is_transparent_is_unknown(tmp_path: Path) -> None:
    alpha = np.where(PIXELS == 0, 0, 255).astype(np.uint8)
    picture = bytes(cv2.imencode(".png", np.dstack([PIXELS] * 3 + [alpha]))[1])
    assert read_map(written(tmp_path, picture=picture)).cells[1, 0] == UNKNOWN


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("resolution: 0.5\n", ""), "has no resolution"),
        (("0.5\n", "nought\n"), "is no number"),
        (("resolution: 0.5", "resolution: -1"), "not above 0"),
        (("occupied_thresh: 0.65", "occupied_thresh: 0.1"), "in order"),
        (("[-1.0, 2.0, 0.0]", "[1]"), "is not \\[x, y, yaw\\]"),
        (("mode: trinary", "mode: fuzzy"), "not trinary, scale or raw"),
        (("image: home.pgm", "image: none.pgm"), "cannot be read"),
        (("image: home.pgm", "%% binary"), "no map_server map"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, change: tuple[str, str], said: str) -> None:
    with pytest.raises(BadInput, match=said):
        read_map(written(tmp_path, YAML.replace(*change)))


@pytest.mark.parametrize(
    "picture",
    [b"P5 3 2 255\n\0\0", b"P5 3", b"P5 x 2 255\n", b"P5 9 999999999 255\n", b"no picture"],
)
def test_broken_pictures_are_refused(tmp_path: Path, picture: bytes) -> None:
    with pytest.raises(BadInput, match="picture"):
        read_map(written(tmp_path, picture=picture))


def test_a_store_keeps_the_map_and_undo_brings_the_one_before_back(tmp_path: Path) -> None:
    store = OracleStore()
    first = read_map(written(tmp_path))
    other = FloorMap(np.zeros((4, 4), np.int8), 0.1, (0.0, 0.0, 0.0))
    assert stored_map(store) is None
    teaching.put_map(store, first.to_json(), "the first")
    teaching.put_map(store, other.to_json(), "the other")
    kept = stored_map(store)
    assert kept is not None
    assert kept.cells.shape == (4, 4)
    teaching.undo(store)
    kept = stored_map(store)
    assert kept is not None
    assert kept.cells.tolist() == first.cells.tolist()
    assert (kept.resolution, kept.origin) == (first.resolution, first.origin)
    teaching.undo(store)
    assert stored_map(store) is None


def test_a_map_too_large_for_a_store_is_refused_with_what_would_do() -> None:
    noise = np.random.default_rng(0).choice(np.array([0, 100, -1], np.int8), (3000, 3000))
    with pytest.raises(BadInput, match="coarser"):
        FloorMap(noise, 0.05, (0.0, 0.0, 0.0)).to_json()
