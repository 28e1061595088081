"""Which topics of a bag are read: told, chosen, or asked about."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from d3a.model import BadInput
from d3a.readers.opening import open_source

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'd3a[ros]'")

from tests.worlds.bags import BOXES, COLOUR, IMAGE, Said, World, without
from tests.worlds.folders import moments

WORLD = World("mcap")


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"topic.picture": COLOUR}, "no topic 'picture' to choose; there are image, depth"),
        ({"topic.image": "/camera/color/image"}, rf"Did you mean {COLOUR}\?|Did you mean /camera"),
        ({"topic.image": BOXES}, "is vision_msgs/msg/Detection2DArray; for image it takes"),
        ({"topik.image": COLOUR}, "no option 'topik.image'"),
        ({"stamps": "now"}, "header, receive"),
        ({"map-frame": "world"}, "the frame 'world' is not above the camera's"),
        ({"classes": "none.txt"}, "no such file"),
        ({"mount": "1,2"}, "mount"),
    ],
)
def test_an_option_that_cannot_be_is_refused(
    tmp_path: Path, given: dict[str, str], said: str
) -> None:
    with pytest.raises(BadInput, match=said):
        open_source(WORLD.write_changed(tmp_path / "b"), options=given)


def second(name: str) -> tuple[Said, ...]:
    return tuple(WORLD.jpeg(each, topic=name) for each in moments())


def test_two_cameras_are_asked_about_and_one_of_them_can_be_told(tmp_path: Path) -> None:
    names = ("/front/color/image_raw/compressed", "/rear/color/image_raw/compressed")
    more = (*second(names[0]), *second(names[1]))
    bag = WORLD.write_changed(tmp_path / "b", without(COLOUR), more=more)
    with pytest.raises(BadInput) as asked:
        open_source(bag)
    assert str(asked.value).startswith(
        "the bag has 2 topics that may be the image: "
        f"{names[0]} (sensor_msgs/msg/CompressedImage, 8), {names[1]}"
    )
    assert "--topic image=" in str(asked.value)
    reader = open_source(bag, options={"topic.image": names[1]})
    assert len(list(reader)) == 8


def test_of_one_cameras_forms_the_plain_one_is_read_and_the_others_named(tmp_path: Path) -> None:
    raw = []
    for each in moments():
        pixels = WORLD.raw("bgr8", np.zeros((48, 64, 3), np.uint8))
        raw.append(
            Said(IMAGE, "sensor_msgs/Image", each.time_ms, pixels, "camera_color_optical_frame")
        )
    infra = second("/camera/infra1/image_rect_raw/compressed")
    reader = open_source(WORLD.write_changed(tmp_path / "b", more=(*raw, *infra)))
    assert all(isinstance(f.image, np.ndarray) for f in reader)
    assert f"image: {IMAGE} is read, not " in reader.facts.notes[0]
    assert reader.skipped.counts == {}
