"""How likely an object is of a colour, from its own histogram: a small model with two views.

A thing fills the middle of its box and shares the rest with its surroundings; its pixels are its
colour under more or less light. So the histogram of a red cup is a mixture of what red names
look like in light and shade, and of what the other objects' boxes hold: how well a colour explains
all of it is one view. The other is what stands out: of the pixels beyond what other boxes hold as
well, the share that one would call by the word. Both are weighed as a logistic regression does,
and the colours' shares of the weight are their probabilities. The four weights were fitted to the
largest likelihood on simulated worlds (development seeds, three conditions); what colours look
like comes from the lists alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from d3a.colours.looks import HISTOGRAM_SIZE
from d3a.colours.names import (
    BASIC,
    LUMINANCE,
    Floats,
    colours_of,
    encoded,
    is_metal,
    linear,
    rest_of,
)

_BINS = 8
_FILL = 0.6
"""Share of a box that its object covers: between a disc (0.79) and a thing with a handle."""
_LOOKS = 8.0
"""Independent looks in one box: neighbouring pixels agree, so a box is not 10,000 witnesses."""


@dataclass(frozen=True, slots=True)
class Weights:
    """How much each part of the evidence for a single colour counts.

    explains: per nat of log likelihood of a pixel; stands_out: per nat of the share that stands
    out; chromatic: for a term with a hue: a thing is called by it though shine, shade and handles
    are white, grey and black. views: the power of the number of views (by summed probability, at
    most MOST_VIEWS) that all of it is multiplied with.
    """

    explains: float = 0.68
    stands_out: float = 1.71
    chromatic: float = 0.22
    views: float = 0.23


WEIGHTS = Weights()
MOST_VIEWS = 30.0
_LEAST_SHARE = 0.03
"""A share below this is noise."""
_RARE = 1e-6
"""What no colour looks like is called by none."""
_HUELESS = frozenset({"black", "white", "grey"})
_LIGHTS = tuple(float(s) for s in np.exp(np.linspace(np.log(0.25), np.log(1.1), 10)))
"""Light on the parts of a thing relative to the full light: its shaded side has a quarter."""
_GLOSS = (0.0, 0.12)
"""Share of the lamp's own colour in what a surface sends back: matt, glossy."""
_NOISE = 14.0
"""Deviation of a pixel in sRGB levels: sensor, compression, one word for near colours."""
_FLOOR = 1e-4 / HISTOGRAM_SIZE
_BRIGHT = 0.95
"""The quantile of light that stands for a white thing in full light (white patch)."""
_PRIOR_OBJECTS = 8.0
"""With fewer objects than this the surroundings are known less than assumed."""
LEAST_ODDS = 0.5
"""A word is refused where its opposite is more than twice as likely; people differ on the rest."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """How likely each object is of the colours asked for (n,), and whether that is tenable (n,)."""

    probability: Floats
    tenable: NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Palette:
    """What the boxes of a store hold together: surroundings and light.

    total (512,): the sum of all objects' pixel shares; count: how many objects.
    exposure: the light of a white thing, quantised, so that one store keeps one set of terms.
    """

    total: Floats
    count: int
    exposure: float

    @classmethod
    def of(cls, embeddings: NDArray[np.float32]) -> Palette:
        """Measure the histograms (n, 512) of a store, any positive scale a row."""
        shares = as_shares(embeddings)
        total = shares.sum(axis=0) if len(shares) else np.zeros(HISTOGRAM_SIZE)
        return cls(total, len(shares), _exposure(total, len(shares)))

    def around(
        self, count: int, rows: NDArray[np.intp], bins: NDArray[np.intp], held: Floats
    ) -> Floats:
        """Return the share of the surroundings in some bins (m,): all others, a little of all.

        rows, bins, held (m,): the bins that hold something of which of `count` objects, and how
        much; every one of them is given.
        """
        own = np.minimum(self.total[bins], held)
        others = self.total.sum() - np.bincount(rows, own, minlength=count)
        uniform = 1.0 / HISTOGRAM_SIZE
        return np.asarray((self.total[bins] - own + 2.0 * uniform) / (others[rows] + 2.0))


def as_shares(embeddings: NDArray[np.float32]) -> Floats:
    """Return histograms as shares of the pixels: rows sum to 1."""
    counts = np.clip(np.asarray(embeddings, dtype=np.float64), 0.0, None)
    return np.asarray(counts / np.maximum(counts.sum(axis=1, keepdims=True), 1e-12))


def judge(
    colours: Sequence[str],
    embeddings: NDArray[np.float32],
    palette: Palette,
    views: Floats | None = None,
    weights: Weights = WEIGHTS,
) -> Verdict:
    """Return how likely each object (n, 512) is of the colours: of all of them, where several.

    colours: words for which `is_colour` holds; several make a thing of parts (red and white).
    views (n,): by how many views each was seen; one where it is left out. The alternatives are
    the eleven basic terms.
    """
    return judge_pixels(colours, Pixels.of(embeddings, palette), views, weights)


def judge_pixels(
    colours: Sequence[str],
    pixels: Pixels,
    views: Floats | None = None,
    weights: Weights = WEIGHTS,
) -> Verdict:
    """Return what `judge` does, of objects whose pixels were read already."""
    exposure = pixels.exposure
    rivals = _rivals(colours, exposure)  # (k, 512)
    blends = _blends([_looks_like(colour, exposure) for colour in colours])  # (m, 512)
    if len(colours) > 1 or is_metal(colours[0]):  # many colours at once: none is the one
        evidence = pixels.explained(np.vstack([rivals, blends])) * _LOOKS  # (n, k + m)
    else:
        explained, out = _of_one(colours[0], pixels, np.vstack([rivals, blends]))
        evidence = explained * weights.explains
        evidence += weights.stands_out * np.log(out + _LEAST_SHARE)
        evidence += weights.chromatic * _has_hue(colours[0])
        if views is not None:
            evidence *= np.clip(views, 1.0, MOST_VIEWS)[:, None] ** weights.views
    weight = np.exp(evidence - evidence.max(axis=1, keepdims=True))
    asked = weight[:, len(rivals) :].mean(axis=1)
    rest = weight[:, : len(rivals)].sum(axis=1)
    return Verdict(probability=asked / (asked + rest), tenable=asked >= LEAST_ODDS * rest)


def _of_one(colour: str, pixels: Pixels, looks: Floats) -> tuple[Floats, Floats]:
    """Return both views of a colour and its rivals (k, 512), the colour last: (n, k) each."""
    basic = colour.replace("gray", "grey")
    if basic not in BASIC:
        return pixels.explained(looks), pixels.standing_out(looks)
    own = BASIC.index(basic)  # its rivals are the other terms: told apart once for all of them
    order = [*(i for i in range(len(BASIC)) if i != own), own]
    explained, out = pixels.of_terms
    return explained[:, order], out[:, order]


def _has_hue(colour: str) -> Floats:
    """Return 1 for each rival with a hue, and last for the colour asked for; else 0."""
    rest = rest_of(colour)
    own = rest[0] if rest is not None else colour.replace("gray", "grey")
    others = [term for term in BASIC if rest is not None or term != own]
    return np.array([float(term not in _HUELESS) for term in (*others, own)])


def _rivals(colours: Sequence[str], exposure: float) -> Floats:
    """Return the looks of what the thing may be instead: the basic terms but for the asked.

    A kind of a basic colour has the other kinds of it for a rival, not itself.
    """
    terms = _terms(exposure)
    if len(colours) > 1:
        return terms
    colour = colours[0].replace("gray", "grey")
    if colour in BASIC:
        return np.delete(terms, BASIC.index(colour), axis=0)
    rest = rest_of(colour)
    if rest is None:
        return terms
    terms = terms.copy()
    terms[BASIC.index(rest[0])] = _rest_looks_like(colour, exposure)
    return terms


def _blends(looks: Sequence[Floats]) -> Floats:
    """Return a thing of parts in several proportions (m, 512); one colour is itself."""
    if len(looks) == 1:
        return looks[0][None, :]
    even = np.full(len(looks), 1 / len(looks))
    most = [
        np.where(np.arange(len(looks)) == i, 0.75, 0.25 / (len(looks) - 1))
        for i in range(len(looks))
    ]
    return np.stack([even, *most]) @ np.stack(looks)


@dataclass(frozen=True)
class Pixels:
    """The bins (m,) that hold something of n objects, with what they hold, and others there.

    Nine of ten bins of a thing are empty and say nothing: only what is in the others is read.
    exposure: of the palette that tells what is around. rows, begins (k,): the objects that have
    a filled bin, and where the bins of each begin.
    """

    count: int
    exposure: float
    rows: NDArray[np.intp] = field(repr=False)
    begins: NDArray[np.intp] = field(repr=False)
    bins: NDArray[np.int16] = field(repr=False)
    held: NDArray[np.float32] = field(repr=False)
    around: NDArray[np.float32] = field(repr=False)

    @classmethod
    def of(cls, embeddings: NDArray[np.float32], palette: Palette) -> Pixels:
        """Read the histograms (n, 512) of objects, any positive scale a row."""
        shares = as_shares(embeddings)
        rows, bins = np.nonzero(shares)
        held = shares[rows, bins]
        around = palette.around(len(shares), rows, bins, held)
        filled, begins = np.unique(rows, return_index=True)
        return cls(
            len(shares),
            palette.exposure,
            filled,
            begins,
            bins.astype(np.int16),
            held.astype(np.float32),
            around.astype(np.float32),
        )

    @cached_property
    def of_terms(self) -> tuple[Floats, Floats]:
        """Both views of the eleven basic terms, (n, 11) each: asked of the same things often."""
        terms = _terms(self.exposure)
        return self.explained(terms), self.standing_out(terms)

    def explained(self, looks: Floats) -> Floats:
        """Return the mean log likelihood of a pixel under each of k looks: (n, k)."""
        thing = (_FILL * looks + _FLOOR).astype(np.float32)
        return self._sums(np.log(thing[:, self.bins] + (1 - _FILL) * self.around) * self.held)

    def standing_out(self, looks: Floats) -> Floats:
        """Return the share of each of k looks among what the others do not hold: (n, k)."""
        called = looks / (looks.sum(axis=0) + _RARE)
        beyond = np.maximum(self.held - self.around, 0.0)
        whole = self._sums(beyond[None, :].astype(np.float64))
        shares = self._sums(called.astype(np.float32)[:, self.bins] * beyond)
        return np.asarray(shares / np.maximum(whole, 1e-9))

    def _sums(self, told: NDArray[np.float32] | Floats) -> Floats:
        """Return the sums over each object's bins of (k, m): (n, k)."""
        sums = np.zeros((self.count, len(told)))
        if len(self.rows):
            sums[self.rows] = np.add.reduceat(told, self.begins, axis=1).T
        return sums


def _exposure(total: Floats, count: int) -> float:
    """Return the light that a white thing has in these pictures, 1 for the sensor's white.

    Rooms are dim and cameras expose for windows: what people call white is the brightest there
    is. With few objects that is little to go by, so it is taken nearer to 1.
    """
    if count == 0:
        return 1.0
    index = np.arange(HISTOGRAM_SIZE)
    bins = np.stack([index // 64, index // 8 % 8, index % 8], axis=1).astype(np.float64)
    light = luminance(bins * 32.0 + 15.5)
    order = np.argsort(light, kind="stable")
    reached = np.cumsum(total[order]) / total.sum()
    bright = light[order][min(int(np.searchsorted(reached, _BRIGHT)), HISTOGRAM_SIZE - 1)]
    stops = np.log2(np.clip(bright, 0.2, 1.0)) * count / (count + _PRIOR_OBJECTS)
    return float(2.0 ** (np.round(stops * 8) / 8))


def luminance(levels: Floats) -> Floats:
    """Return the luminance 0..1 of sRGB levels (n, 3)."""
    return np.asarray(linear(levels) @ LUMINANCE)


@lru_cache(maxsize=16)
def _terms(exposure: float) -> Floats:
    """Return the looks of the eleven basic terms (11, 512)."""
    return np.stack([_looks_like(term, exposure) for term in BASIC])


@lru_cache(maxsize=512)
def _looks_like(colour: str, exposure: float) -> Floats:
    """Return the distribution over bins (512,) of things of a colour, in light and shade."""
    colours = colours_of(colour)
    if colours is None:
        raise ValueError(f"{colour!r} is not a colour; ask is_colour first")
    return _looks(colours, exposure)


@lru_cache(maxsize=64)
def _rest_looks_like(colour: str, exposure: float) -> Floats:
    """Return the looks (512,) of the other kinds of the basic term that a colour is a kind of."""
    rest = rest_of(colour)
    assert rest is not None
    return _looks(rest[1], exposure)


def _looks(colours: Floats, exposure: float) -> Floats:
    looks = np.zeros((_BINS, _BINS, _BINS))
    for gloss in _GLOSS:
        light = np.array(_LIGHTS)[:, None, None] * (colours[None, :, :] + gloss) * exposure
        spread = _spread(encoded(light).reshape(-1, 3).astype(np.float32))  # (m, 3, 8)
        plane = (spread[:, 0, :, None] * spread[:, 1, None, :]).reshape(len(spread), -1)
        looks += (plane.T @ spread[:, 2]).reshape(_BINS, _BINS, _BINS) / len(spread)
    flat = looks.reshape(-1)
    return np.asarray(flat / flat.sum())


def _spread(levels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return how noise spreads levels (m, 3) over the bins of each channel (m, 3, 8)."""
    inner = np.arange(1, _BINS, dtype=np.float32) * np.float32(256 / _BINS)
    z = (inner[None, None, :] - levels[:, :, None]) * np.float32(1.702 / _NOISE)
    below = np.zeros((*levels.shape, _BINS + 1), dtype=np.float32)
    below[..., 1:_BINS] = 1 / (1 + np.exp(-z))  # the logistic, within 0.01 of the normal
    below[..., _BINS] = 1
    return below[..., 1:] - below[..., :-1]
