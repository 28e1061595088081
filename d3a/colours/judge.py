"""How likely an object is of a colour, from its own histogram: a small model with two views.

A thing fills the middle of its box and shares the rest with its surroundings; its pixels are its
colour under more or less light. So the histogram of a red cup is a mixture of what red names
look like in light and shade, and of what the other objects' boxes hold: how well a colour explains
all of it is one view. The other is what stands out: of the pixels beyond what other boxes hold as
well, the share that one would call by the word. Both are weighed as a logistic regression does,
and the colours' shares of the weight are their probabilities.

What the colours look like comes from the lists, and for the eleven basic terms from the store as
well: of things that are called red for certain, the others learn what red things look like in
this light, with these shadows, handles and backgrounds (`learn`; expectation-maximisation, as
Nigam et al. classify texts of which few are labelled, 2000). Nobody told the store a colour.
The weights were fitted to the largest likelihood on simulated worlds (development seeds, nominal
and with twice the noise of colour) and as many of another generator, with other paints, light,
shading and backgrounds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from d3a.answering.kept import Kept
from d3a.colours.kinds import kinds_of
from d3a.colours.names import BASIC, Floats, is_metal, rest_of
from d3a.colours.pixels import (
    AMONG_MANY,
    MOST_VIEWS,
    Learned,
    Palette,
    Pixels,
    called_by,
    times_seen,
)
from d3a.colours.terms import looks_like, rest_looks_like, terms

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

    explains: float
    stands_out: float
    chromatic: float
    views: float


BY_THE_LISTS = Weights(0.7, 0.9, 0.3, 0.4)
BY_THE_STORE = Weights(1.0, 0.75, 0.22, 0.4)
"""For the basic terms, whose looks are learned: they explain a box better."""
_ROUNDS = 2
"""Of learning: later ones change the second digit of few."""
MOST_TOLD = 16
"""So many colours are judged at most before the first is judged anew: 9 bytes an object each."""
_LEAST_SHARE = 0.03
"""A share below this is noise."""
_HUELESS = frozenset({"black", "white", "grey"})
_HUED = np.array([float(term not in _HUELESS) for term in BASIC])
UNSEEN = 0.5
"""Whether a thing of which nothing stands out in a colour is dark or light of it, nobody knows."""
LEAST_ODDS = 0.4
"""A word is refused where its opposite is this much likelier; people differ on the rest."""
PARTLY = 0.25
"""What is of a colour in part is called by it so much more seldom than the part is large."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """How likely each object is of the colours asked for (n,), and whether that is tenable (n,)."""

    probability: Floats
    tenable: NDArray[np.bool_]


@dataclass(frozen=True)
class Appearances:
    """How n objects look, read once for every colour word that is asked of them.

    views (n,): by how many views each was seen.
    """

    pixels: Pixels
    views: Floats

    @classmethod
    def of(
        cls, embeddings: NDArray[np.float32], palette: Palette, views: Floats | None = None
    ) -> Appearances:
        """Read the histograms (n, 512) of objects, any positive scale a row.

        views: one each where they are left out.
        """
        known = np.ones(len(embeddings)) if views is None else views
        return cls(Pixels.of(embeddings, palette), known)

    @cached_property
    def _told(self) -> Kept[tuple[str, ...], Verdict]:
        return Kept(MOST_TOLD)

    @cached_property
    def chances(self) -> Floats:
        """How likely each object is of each of the eleven basic terms: (n, 11), rows sum to 1."""
        palette, alone = self.pixels.palette, np.zeros((self.pixels.count, len(BASIC)))
        learned = palette.learned
        if palette.is_of_many and learned.called.any():
            return self.among(learned, alone)  # whatever it told itself: no rounds are needed
        chances = self.among(Learned.nothing(), alone)
        if learned.called.any():
            for _ in range(_ROUNDS):  # a thing is judged by the others: what it told is taken out
                chances = self.among(learned, self.telling(chances))
        return chances

    def among(self, learned: Learned, of_each: Floats) -> Floats:
        """Return the chances, if the terms look so; of_each: see `Pixels.alike`."""
        alike = self.pixels.alike(learned, of_each)
        out = self.pixels.terms_standing_out
        return _proportions(_weighed(alike, out, _HUED, self.views, BY_THE_STORE))

    def telling(self, chances: Floats) -> Floats:
        """Return how much each object tells of how each term looks (n, 11), by its chances."""
        return np.asarray(chances * np.sqrt(times_seen(self.views) / MOST_VIEWS)[:, None])

    def judge(self, colours: Sequence[str]) -> Verdict:
        """Return how likely each object is of the colours: of all of them, where several.

        colours: words for which `is_colour` holds; several make a thing of parts (red and white).
        The alternatives are the eleven basic terms; a thing that is another of them may still be
        called by the one that a part of it shows, such as scissors by that of their handles.
        """
        word = colours[0].replace("gray", "grey")
        if len(colours) == 1 and word in BASIC:
            column = BASIC.index(word)
            partly = PARTLY * self.pixels.terms_standing_out[:, column]
            return _verdict(np.maximum(self.chances[:, column], partly))
        told = self._told.get(tuple(colours), None)
        if told is None:
            is_kind = len(colours) == 1 and bool(kinds_of(word))
            told = _verdict(self._of_kind(word) if is_kind else self._listed(colours))
            self._told.put(tuple(colours), told, 1)
        return told

    def _of_kind(self, colour: str) -> Floats:
        """Return how likely each object is of a basic term, and a kind of it.

        It is of the term by what it looks like among all; or, as a shade may be a border case of
        it, because it is that shade or another of the term by the lists.
        """
        asked = np.zeros(self.pixels.count)
        for kind in kinds_of(colour):
            of_kind = kind.chance(self.pixels.strength(kind.term))
            likely = self.chances[:, BASIC.index(kind.term)]
            if not is_metal(colour):
                shades = self._among_listed([colour])[:, [BASIC.index(kind.term), -1]]
                likely = np.maximum(likely, shades.sum(axis=1))
            asked += likely * np.where(np.isnan(of_kind), UNSEEN, of_kind)
        return asked

    def _listed(self, colours: Sequence[str]) -> Floats:
        """Return how likely each object is of colours by how the lists have them."""
        share = self._among_listed(colours)
        asked = share[:, len(BASIC) :].mean(axis=1)
        return np.asarray(asked / (asked + share[:, : len(BASIC)].sum(axis=1)))

    def _among_listed(self, colours: Sequence[str]) -> Floats:
        """Return what the evidence makes of the basic terms and of the colours (n, 11 + m).

        A row sums to 1; of what is of one colour m is 1.
        """
        exposure = self.pixels.palette.exposure
        blends = _blends([looks_like(colour, exposure) for colour in colours])  # (m, 512)
        looks = np.vstack([_rivals(colours, exposure), blends])
        evidence = self.pixels.explained(looks)  # (n, 11 + m)
        if len(colours) > 1:  # many colours at once: none is the one
            evidence *= _LOOKS
        else:
            out = self.pixels.standing_out(called_by(looks))
            hued = _has_hue(colours[0])
            evidence = _weighed(evidence, out, hued, self.views, BY_THE_LISTS)
        return _proportions(evidence)


def _verdict(probability: Floats) -> Verdict:
    return Verdict(probability, probability >= LEAST_ODDS * (1 - probability))


def learn(embeddings: NDArray[np.float32], views: Floats | None = None) -> Palette:
    """Measure the histograms (n, 512) of a store, and learn how its colours look.

    views (n,): by how many views each was seen; one where it is left out.
    """
    palette = Palette.of(embeddings)
    known = np.ones(len(embeddings)) if views is None else views
    best = np.sort(np.argsort(-known, kind="stable")[:AMONG_MANY])  # the best seen tell the most
    seen = Appearances.of(embeddings[best], palette, known[best])
    telling = seen.telling(seen.chances)
    learned = seen.pixels.told(telling)
    for _ in range(_ROUNDS):
        telling = seen.telling(seen.among(learned, telling))
        learned = seen.pixels.told(telling)
    return replace(palette, learned=learned)


def _weighed(
    explained: Floats, out: Floats, hued: Floats, views: Floats, weights: Weights
) -> Floats:
    """Return the evidence (n, k) for each of k looks; hued (k,): 1 for those with a hue."""
    evidence = explained * weights.explains
    evidence += weights.stands_out * np.log(out + _LEAST_SHARE)
    evidence += weights.chromatic * hued
    return np.asarray(evidence * times_seen(views)[:, None] ** weights.views)


def _proportions(evidence: Floats) -> Floats:
    """Return what the evidence (n, k) makes of each of k looks; rows sum to 1."""
    weight = np.exp(evidence - evidence.max(axis=1, keepdims=True))
    return np.asarray(weight / weight.sum(axis=1, keepdims=True))


def _has_hue(colour: str) -> Floats:
    """Return 1 for each rival with a hue, and last for the colour asked for; else 0."""
    rest = rest_of(colour)
    return np.append(_HUED, float((rest[0] if rest is not None else colour) not in _HUELESS))


def _rivals(colours: Sequence[str], exposure: float) -> Floats:
    """Return the looks of what the thing may be instead: the basic terms.

    A kind of a basic colour has the other kinds of it for a rival, not itself.
    """
    looks = terms(exposure)
    rest = rest_of(colours[0]) if len(colours) == 1 else None
    if rest is None:
        return looks
    looks = looks.copy()
    looks[BASIC.index(rest[0])] = rest_looks_like(colours[0], exposure)
    return looks


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
