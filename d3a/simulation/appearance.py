"""What a thing looks like: colours, light and background, as 8 x 8 x 8 histograms of its crop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

BINS = 8
DIM = BINS**3
MODEL = "rgb-8x8x8"
PIXELS = 480  # colours drawn per crop; counts are scaled to the crop's size
PAINTS: dict[str, tuple[int, int, int]] = {
    "white": (222, 219, 212),
    "black": (34, 33, 36),
    "gray": (128, 129, 131),
    "red": (181, 38, 42),
    "orange": (226, 122, 38),
    "yellow": (225, 196, 62),
    "green": (52, 128, 66),
    "blue": (44, 84, 168),
    "purple": (110, 58, 138),
    "pink": (226, 138, 166),
    "brown": (118, 78, 48),
}
COMMON: dict[str, tuple[tuple[str, float], ...]] = {
    "cup": (
        ("white", 5),
        ("red", 2),
        ("blue", 1.5),
        ("black", 2),
        ("pink", 1),
        ("green", 1),
        ("yellow", 1),
        ("orange", 1),
    ),
    "bottle": (("green", 3), ("blue", 1.5), ("white", 3.5), ("brown", 2), ("red", 1), ("black", 1)),
    "bowl": (("white", 3), ("orange", 1.5), ("blue", 1.5), ("gray", 1), ("green", 1)),
    "chair": (("black", 5), ("gray", 2.5), ("blue", 1.5), ("brown", 1)),
    "tv": (("black", 1),),
    "laptop": (("gray", 2), ("black", 1)),
    "potted plant": (("green", 1),),
    "book": (("red", 1), ("blue", 1), ("yellow", 1), ("purple", 1)),
    "vase": (("blue", 1), ("white", 1), ("pink", 1)),
    "dining table": (("brown", 1),),
    "couch": (("gray", 1), ("blue", 1), ("brown", 1)),
    "refrigerator": (("white", 1), ("gray", 1)),
    "sink": (("gray", 1),),
    "microwave": (("white", 1), ("black", 1)),
}
SHARED: dict[str, str] = {  # what all of a kind have: lids, handles, screens, legs
    "cup": "white",
    "bottle": "white",
    "bowl": "white",
    "chair": "gray",
    "tv": "blue",
    "laptop": "black",
    "potted plant": "brown",
    "book": "white",
    "vase": "white",
    "dining table": "gray",
    "couch": "black",
    "refrigerator": "black",
    "sink": "white",
    "microwave": "black",
}
SHADE = np.array([24.0, 22.0, 22.0])
Colours = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Looks:
    """Colours of n things, 0..255: main, accent and kind's own (n, 3), with their shares (n, 3).

    turn (n,): the bearing, radians, from which most of the accent is seen.
    """

    main: Colours
    accent: Colours
    common: Colours
    shares: Colours
    turn: Colours


def dress(categories: list[str], rng: np.random.Generator) -> tuple[list[str], Looks]:
    """Draw a colour word and its looks for each thing; things of a kind share many colours."""
    words = []
    for category in categories:
        names, weights = zip(*COMMON[category], strict=True)
        p = np.array(weights) / sum(weights)
        words.append(str(rng.choice(names, p=p)))
    n = len(categories)
    jitter = rng.normal(0, 9, size=(n, 3))
    paints = list(PAINTS)
    accents = [paints[i] for i in rng.integers(len(paints), size=n)]
    shares = rng.dirichlet((9.0, 1.3, 3.0), size=n)
    return words, Looks(
        main=np.clip(np.array([PAINTS[w] for w in words]) + jitter, 8, 247),
        accent=np.array([PAINTS[a] for a in accents], dtype=float),
        common=np.array([PAINTS[SHARED[c]] for c in categories], dtype=float),
        shares=shares,
        turn=rng.uniform(-np.pi, np.pi, size=n),
    )


def mixtures(
    looks: Looks, thing: NDArray[np.intp], bearing: Colours, cover: Colours, behind: Colours
) -> tuple[Colours, Colours]:
    """Return colours (n, 5, 3) and shares (n, 5) of each crop: the thing, shade, background.

    thing, bearing (n,): which thing from where; cover (n,): how much of the box it fills;
    behind (n, 3): the background's colour.
    """
    shares = looks.shares[thing].copy()
    facing = np.cos(bearing - looks.turn[thing])
    shares[:, 1] *= np.exp(1.2 * facing)  # a logo is on one side
    shares /= shares.sum(axis=1, keepdims=True)
    shade = np.broadcast_to(SHADE, (len(thing), 3))
    colours = np.stack(
        [looks.main[thing], looks.accent[thing], looks.common[thing], shade, behind], axis=1
    )
    dark = np.full((len(thing), 1), 0.28)  # hollows, undersides and cast shadows
    front = np.concatenate([shares * (1 - dark), dark], axis=1) * cover[:, None]
    return colours, np.concatenate([front, 1 - cover[:, None]], axis=1)


def histograms(
    colours: Colours,
    shares: Colours,
    gain: Colours,
    pixels: NDArray[np.intp],
    rng: np.random.Generator,
) -> NDArray[np.float32]:
    """Return raw pixel counts (n, 512), index 64 R + 8 G + B of bins of 32.

    gain (n, 3): the light's factor on R, G, B. pixels (n,): the size of the crop.
    """
    n, parts = shares.shape
    edges = np.cumsum(shares, axis=1)
    pick = (rng.random((n, PIXELS))[..., None] > edges[:, None, : parts - 1]).sum(axis=2)
    drawn = np.take_along_axis(colours, pick[..., None], axis=1)
    shade = rng.normal(1.0, 0.10, size=(n, PIXELS, 1))  # rounded and folded surfaces
    drawn = drawn * shade * gain[:, None, :] + rng.normal(0, 5, size=drawn.shape)
    bins = np.clip(drawn, 0, 255).astype(np.intp) // (256 // BINS)
    index = (bins[..., 0] * BINS + bins[..., 1]) * BINS + bins[..., 2]
    flat = (np.arange(n)[:, None] * DIM + index).ravel()
    counts = np.bincount(flat, minlength=n * DIM).reshape(n, DIM)
    return np.round(counts * (pixels[:, None] / PIXELS)).astype(np.float32)
