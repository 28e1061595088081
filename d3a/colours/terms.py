"""What colours look like: the distribution over the histogram's bins of things in light and shade.

It comes from the lists of names alone, and from how bright the pictures of a store are.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from d3a.colours.names import BASIC, LUMINANCE, Floats, colours_of, encoded, linear, rest_of

BINS = 8
_LIGHTS = (0.17, 0.40, 0.54, 0.65, 0.74, 0.82, 0.89, 0.96, 1.02, 1.07)
"""Light on ten equal parts of what is seen of a ball, the darkest first: most of what is seen faces
the light. It comes from within 30 degrees of the camera (Lambert: by the cosine), and a tenth of it
from everywhere."""
_GLOSS = (0.005, 0.03)
"""Share of the lamp's own colour in what a surface sends back: matt, glossy. Glass, plastic and
lacquer mirror 4 % at most, ((1.5 - 1) / (1.5 + 1))^2 (Fresnel)."""
_NOISE = 14.0
"""Deviation of a pixel in sRGB levels: sensor, compression, one word for near colours."""


def luminance(levels: Floats) -> Floats:
    """Return the luminance 0..1 of sRGB levels (n, 3)."""
    return np.asarray(linear(levels) @ LUMINANCE)


@lru_cache(maxsize=16)
def terms(exposure: float) -> Floats:
    """Return the looks of the eleven basic terms (11, 512)."""
    return np.stack([looks_like(term, exposure) for term in BASIC])


@lru_cache(maxsize=512)
def looks_like(colour: str, exposure: float) -> Floats:
    """Return the distribution over bins (512,) of things of a colour, in light and shade."""
    colours = colours_of(colour)
    if colours is None:
        raise ValueError(f"{colour!r} is not a colour; ask is_colour first")
    return _looks(colours, exposure)


@lru_cache(maxsize=64)
def rest_looks_like(colour: str, exposure: float) -> Floats:
    """Return the looks (512,) of the other kinds of the basic term that a colour is a kind of."""
    rest = rest_of(colour)
    assert rest is not None
    return _looks(rest[1], exposure)


def in_light(colours: Floats, gloss: float = _GLOSS[0]) -> Floats:
    """Return the light (10, n, 3) that ten equal parts of things of colours (n, 3) send back."""
    return np.asarray(np.array(_LIGHTS)[:, None, None] * (colours[None, :, :] + gloss))


def _looks(colours: Floats, exposure: float) -> Floats:
    looks = np.zeros((BINS, BINS, BINS))
    for gloss in _GLOSS:
        light = in_light(colours, gloss) * exposure
        spread = _spread(encoded(light).reshape(-1, 3).astype(np.float32))  # (m, 3, 8)
        plane = (spread[:, 0, :, None] * spread[:, 1, None, :]).reshape(len(spread), -1)
        looks += (plane.T @ spread[:, 2]).reshape(BINS, BINS, BINS) / len(spread)
    flat = looks.reshape(-1)
    return np.asarray(flat / flat.sum())


def _spread(levels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return how noise spreads levels (m, 3) over the bins of each channel (m, 3, 8)."""
    inner = np.arange(1, BINS, dtype=np.float32) * np.float32(256 / BINS)
    z = (inner[None, None, :] - levels[:, :, None]) * np.float32(1.702 / _NOISE)
    below = np.zeros((*levels.shape, BINS + 1), dtype=np.float32)
    below[..., 1:BINS] = 1 / (1 + np.exp(-z))  # the logistic, within 0.01 of the normal
    below[..., BINS] = 1
    return below[..., 1:] - below[..., :-1]
