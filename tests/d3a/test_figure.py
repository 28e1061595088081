"""What a thing's own colours are before grounds that are drawn around it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from d3a import images
from d3a.figure import own_histogram
from d3a.images import Pixels
from d3a.ingest import ingest
from d3a.model import Detection, Frame
from d3a.parameters import DEFAULT, PAPER, Parameters
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import ListReader

RED, BLUE, WOOD = (200, 30, 30), (40, 60, 190), (150, 110, 70)
Colour = tuple[int, int, int]


def drawn(thing: Colour, ground: Colour, *, size: int = 60) -> Pixels:
    """Return a disc of a size that fills three quarters of its box, before a ground with grain."""
    rng = np.random.default_rng(7)
    pixels = np.empty((240, 320, 3), np.float64)
    pixels[:] = ground
    rows, columns = np.mgrid[:240, :320]
    pixels[(rows - 120) ** 2 + (columns - 160) ** 2 < (size / 2) ** 2] = thing
    return np.clip(pixels + rng.normal(0, 6, pixels.shape), 0, 255).astype(np.uint8)


def box(size: int = 60) -> tuple[float, float, float, float]:
    return (160 - size / 2, 120 - size / 2, 160 + size / 2, 120 + size / 2)


def share(histogram: NDArray[np.float32], colour: Colour) -> float:
    """Return the share of what is near a colour, by one bin in each channel."""
    near = np.indices((8, 8, 8)) - np.array(colour)[:, None, None, None] // 32
    held = histogram.reshape(8, 8, 8)[(np.abs(near) <= 1).all(axis=0)]
    return float(held.sum() / histogram.sum())


@pytest.mark.parametrize("size", [8, 60, 220])
def test_the_ground_is_taken_off(size: int) -> None:
    pixels = drawn(RED, BLUE, size=size)
    whole = images.histogram(images.crop(pixels, box(size)))
    own = own_histogram(pixels, box(size))
    assert share(whole, BLUE) > 0.15
    assert share(own, BLUE) < 0.05
    assert share(own, RED) > 0.95
    assert np.linalg.norm(own) == pytest.approx(1.0, abs=1e-5)


def test_a_moved_thing_looks_as_before() -> None:
    one, other = drawn(RED, BLUE), drawn(RED, WOOD)
    whole = [images.histogram(images.crop(pixels, box())) for pixels in (one, other)]
    own = [own_histogram(pixels, box()) for pixels in (one, other)]
    assert own[0] @ own[1] > 0.99 > whole[0] @ whole[1]


def test_what_has_the_colour_of_its_ground_keeps_it() -> None:
    pixels = drawn(WOOD, WOOD)
    assert share(own_histogram(pixels, box()), WOOD) > 0.95


def test_a_box_that_fills_the_picture_is_read_whole() -> None:
    pixels = drawn(RED, BLUE)
    everything = (0.0, 0.0, 320.0, 240.0)
    assert np.array_equal(own_histogram(pixels, everything), images.histogram(pixels))


def test_a_box_at_the_border_has_surroundings_within_the_picture() -> None:
    pixels = np.roll(drawn(RED, BLUE), -130, axis=1)  # its box begins at the left border
    own = own_histogram(pixels, (-3.0, 90.0, 60.0, 150.0))
    assert share(own, RED) > 0.97


@pytest.mark.parametrize(("parameters", "is_own"), [(DEFAULT, True), (PAPER, False)])
def test_the_paper_takes_the_whole_box(parameters: Parameters, is_own: bool) -> None:
    pixels, store = drawn(RED, BLUE), OracleStore()
    there = (Detection("cup", 0.9, box()),)
    frames = [Frame(f"{n}", 1000 * n, image=pixels, detections=there) for n in range(1, 4)]
    ingest(ListReader(frames), store, parameters)
    (record,) = store.objects(embeddings=True)
    whole, own = images.histogram(images.crop(pixels, box())), own_histogram(pixels, box())
    assert record.embedding is not None
    assert np.allclose(record.embedding, own if is_own else whole, atol=1e-3)
    assert not np.allclose(own, whole, atol=1e-2)
