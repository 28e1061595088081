"""The pixels of boxes: what a store's hold together, and what single things hold beyond that."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from d3a.colours.kinds import strength
from d3a.colours.looks import HISTOGRAM_SIZE
from d3a.colours.names import BASIC, Floats
from d3a.colours.naming import bin_levels, bins_lab, naming
from d3a.colours.terms import luminance, terms

FILL = 0.6
"""Share of a box that its object covers: between a disc (0.79) and a thing with a handle."""
MOST_VIEWS = 30.0
_RARE = 1e-6
"""What no colour looks like is called by none."""
_FLOOR = 1e-4 / HISTOGRAM_SIZE
_BRIGHT = 0.95
"""The quantile of light that stands for a white thing in full light (white patch)."""
_PRIOR_OBJECTS = 8.0
"""With fewer objects than this the surroundings are known less than assumed."""
_ASSUMED = 3.0
"""What a colour looks like by the lists counts as much as so many well seen things of a store."""
_STRANGE = 1e-4
"""The least share of a bin: no thing shows what others of its colour never do for certain."""
AMONG_MANY = 300
"""So many things tell what colours look like; among more no one of them sways that."""


@dataclass(frozen=True, slots=True)
class Learned:
    """How things of the eleven basic terms look in a store.

    shown (11, 512): the sum of the pixel shares of the things that are called by each term, and
    called (11,) their number: both by how likely they are, and the better seen the more.
    """

    shown: Floats
    called: Floats

    @classmethod
    def nothing(cls) -> Learned:
        """Return what is known before any thing is looked at."""
        return cls(np.zeros((len(BASIC), HISTOGRAM_SIZE)), np.zeros(len(BASIC)))


@dataclass(frozen=True, slots=True)
class Palette:
    """What the boxes of a store hold together: surroundings, light, and how its colours look.

    total (512,): the sum of all objects' pixel shares; count: how many objects.
    exposure: the light of a white thing, quantised, so that one store keeps one set of terms.
    """

    total: Floats
    count: int
    exposure: float
    learned: Learned = field(default_factory=Learned.nothing)

    @property
    def is_of_many(self) -> bool:
        """Whether no single thing sways what all of them tell."""
        return self.count > AMONG_MANY

    @classmethod
    def of(cls, embeddings: NDArray[np.float32]) -> Palette:
        """Measure the histograms (n, 512) of a store, any positive scale a row; nothing learned."""
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


def times_seen(views: Floats) -> Floats:
    """Return how often things were seen (n,), at least once and at most as often as it tells."""
    return np.clip(views, 1.0, MOST_VIEWS)


@dataclass(frozen=True)
class Pixels:
    """The bins (m,) that hold something of n objects, with what they hold, and others there.

    Nine of ten bins of a thing are empty and say nothing: only what is in the others is read.
    palette: tells what is around. rows, begins (k,): the objects that have a filled bin, and
    where the bins of each begin.
    """

    count: int
    palette: Palette
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
            palette,
            filled,
            begins,
            bins.astype(np.int16),
            held.astype(np.float32),
            around.astype(np.float32),
        )

    def explained(self, looks: Floats) -> Floats:
        """Return the mean log likelihood of a pixel under each of k looks: (n, k)."""
        return self._sums(np.log(self._expected(looks)) * self.held)

    def _expected(self, looks: Floats) -> NDArray[np.float32]:
        """Return the share of the bins in a box with a thing of each of k looks: (k, m)."""
        thing = (FILL * looks + _FLOOR).astype(np.float32)
        return np.asarray(thing[:, self.bins] + (1 - FILL) * self.around)

    def standing_out(self, called: Floats) -> Floats:
        """Return the share of each of k names among what the others do not hold: (n, k).

        called (k, 512): the share of each name in each bin.
        """
        shares = self._sums(called.astype(np.float32)[:, self.bins] * self._beyond)
        return np.asarray(shares / self._whole[:, None])

    @cached_property
    def _beyond(self) -> NDArray[np.float32]:
        """What each bin holds more than those of the others (m,)."""
        return np.asarray(np.maximum(self.held - self.around, 0.0), np.float32)

    @cached_property
    def _whole(self) -> Floats:
        """How much of each object the others do not hold (n,)."""
        return np.maximum(self._sums(self._beyond[None, :])[:, 0], 1e-9)

    @cached_property
    def terms_standing_out(self) -> Floats:
        """The share of the eleven basic terms among what the others do not hold (n, 11).

        What is seen is called by what things in light and shade would be, and as it is: people
        do both, and each errs where the other does not.
        """
        exposure = self.palette.exposure
        return self.standing_out((called_by(terms(exposure)) + naming(exposure)) / 2)

    def strength(self, term: str) -> Floats:
        """Return the lightness and chroma (n, 2) of what is of a term and the others do not hold.

        NaN where there is nothing of it.
        """
        exposure = self.palette.exposure
        called = called_by(terms(exposure))[BASIC.index(term)]
        parts = np.vstack([np.ones(HISTOGRAM_SIZE), strength(bins_lab(exposure)).T]) * called
        sums = self._sums(parts.astype(np.float32)[:, self.bins] * self._beyond)
        with np.errstate(invalid="ignore"):
            return np.asarray(sums[:, 1:] / sums[:, :1])

    def alike(self, learned: Learned, of_each: Floats) -> Floats:
        """Return the mean log likelihood of a pixel among things of each basic term: (n, 11).

        A box with a thing of a term looks as the lists say, the more so the fewer things of the
        store are called by it; else as those do.
        of_each (n, 11): how much of what was learned each thing is itself; it is left out.
        """
        expected = self._expected(terms(self.palette.exposure)) * np.float32(_ASSUMED)
        shown = learned.shown.astype(np.float32)[:, self.bins]  # (11, m)
        called = learned.called[:, None]
        if self.palette.is_of_many or not learned.called.any():
            among = (called + _ASSUMED).astype(np.float32)
            return self._logs((shown + expected) / among)
        shown -= of_each.T.astype(np.float32)[:, self._row] * self.held
        among = (np.maximum(called - of_each.T, 0.0) + _ASSUMED).astype(np.float32)
        return self._logs((np.maximum(shown, 0.0) + expected) / among[:, self._row])

    def _logs(self, shares: NDArray[Any]) -> Floats:
        return self._sums(np.log(shares + np.float32(_STRANGE)) * self.held)

    def told(self, of_each: Floats) -> Learned:
        """Return how the terms look, if each thing is so much (n, 11) of what tells of each."""
        parts = of_each.T[:, self._row] * self.held
        shown = [np.bincount(self.bins, part, HISTOGRAM_SIZE) for part in parts]
        return Learned(np.stack(shown), of_each.sum(axis=0))

    @cached_property
    def _row(self) -> NDArray[np.intp]:
        """The object of each bin (m,)."""
        return np.repeat(self.rows, np.diff(np.append(self.begins, len(self.bins))))

    def _sums(self, told: NDArray[np.float32] | Floats) -> Floats:
        """Return the sums over each object's bins of (k, m): (n, k)."""
        sums = np.zeros((self.count, len(told)))
        if len(self.rows):
            sums[self.rows] = np.add.reduceat(told, self.begins, axis=1).T
        return sums


def called_by(looks: Floats) -> Floats:
    """Return of which of k looks (k, 512) what is in each bin is, as shares (k, 512)."""
    return np.asarray(looks / (looks.sum(axis=0) + _RARE))


def _exposure(total: Floats, count: int) -> float:
    """Return the light that a white thing has in these pictures, 1 for the sensor's white.

    Rooms are dim and cameras expose for windows: what people call white is the brightest there
    is. With few objects that is little to go by, so it is taken nearer to 1.
    """
    if count == 0:
        return 1.0
    light = luminance(bin_levels())
    order = np.argsort(light, kind="stable")
    reached = np.cumsum(total[order]) / total.sum()
    bright = light[order][min(int(np.searchsorted(reached, _BRIGHT)), HISTOGRAM_SIZE - 1)]
    stops = np.log2(np.clip(bright, 0.2, 1.0)) * count / (count + _PRIOR_OBJECTS)
    return float(2.0 ** (np.round(stops * 8) / 8))
