"""Take the grain of few light paths out of a picture, without a blur over edges.

An edge-avoiding à-trous filter (Dammertz et al. 2010): a small kernel, spread wider at each pass,
that averages only over neighbours which show the same paint on the same plane.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from assistant.home.meshes import Floats

PASSES = 4
RANGE = 0.5  # relative difference of brightness that is still taken for grain, in the first pass
DARK = 0.02  # difference of brightness that is grain however dark the paint
NEIGHBOURS = tuple((y, x) for y in (-1, 0, 1) for x in (-1, 0, 1) if (y, x) != (0, 0))


def denoised(radiance: Floats, paint: Floats, normal: Floats) -> Floats:
    """Return the picture (h, w, 3) without its grain.

    paint: (h, w, 3), what colour each pixel's surface has in even light. normal: (h, w, 3), unit.
    Both from one sample a pixel. A pixel on an edge is a mixture, which that sample does not tell;
    it is left as it is and not spread.
    """
    guide = np.concatenate([paint * 4.0, normal * 0.55], axis=-1)
    inner = ~_edges(guide)
    smooth = radiance
    for number in range(PASSES):
        smooth = _pass(smooth, guide, inner, 2**number, RANGE / 1.6**number)
    return smooth


def _shifted(array: NDArray[np.generic], y: int, x: int) -> tuple[slice, slice, slice, slice]:
    height, width = array.shape[:2]
    return (
        slice(max(0, -y), min(height, height - y)),
        slice(max(0, -x), min(width, width - x)),
        slice(max(0, y), min(height, height + y)),
        slice(max(0, x), min(width, width + x)),
    )


def _pairs(array: NDArray[np.generic], step: int) -> Iterator[tuple[int, tuple[slice, ...]]]:
    """Yield, for each neighbour at `step` pixels, its distance rank and the two windows' slices."""
    for y, x in NEIGHBOURS:
        yield abs(y) + abs(x), _shifted(array, y * step, x * step)


def _edges(guide: Floats) -> NDArray[np.bool_]:
    """Return where a pixel's neighbour shows other paint, or a plane turned by 45 degrees or so."""
    edge = np.zeros(guide.shape[:2], dtype=bool)
    for _, (a, b, c, d) in _pairs(guide, 1):
        edge[a, b] |= ((guide[a, b] - guide[c, d]) ** 2).sum(axis=-1) > 0.18
    return edge


def _pass(
    image: Floats, guide: Floats, inner: NDArray[np.bool_], step: int, tolerance: float
) -> Floats:
    """Return the image averaged over the eight neighbours at `step` pixels that are alike."""
    grey = image.mean(axis=-1)
    total = image.copy()
    weight = np.ones(image.shape[:2])
    for rank, (a, b, c, d) in _pairs(image, step):
        apart = ((guide[a, b] - guide[c, d]) ** 2).sum(axis=-1) / 0.03
        scale = tolerance * 0.5 * (grey[a, b] + grey[c, d]) + DARK
        unlike = ((grey[a, b] - grey[c, d]) / scale) ** 2
        share = np.exp(-apart - unlike) * (0.5 if rank == 1 else 0.25)
        share *= inner[a, b] & inner[c, d]
        total[a, b] += share[..., None] * image[c, d]
        weight[a, b] += share
    return np.asarray(total / weight[..., None])
