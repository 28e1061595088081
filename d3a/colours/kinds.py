"""Kinds of a basic colour that are told by how light and how strong it is: dark blue, silver.

"Dark blue" is not another colour than blue, but where in it a thing is. So it is judged in two
steps: how likely the thing is blue, and whether its blue is nearer to what people call dark blue
than to what they call blue and no more. "Silver" is said of grey things
that are light, and of white ones that are not.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from d3a.colours.names import (
    BASIC,
    SHADES,
    Floats,
    is_metal,
    lab,
    linear,
    listed_as,
    table,
    words_of,
)
from d3a.colours.naming import named
from d3a.colours.terms import in_light

SPREAD = np.array([10.0, 20.0])
"""Deviation of a thing's lightness and chroma from those of its name: names are used loosely, bins
are 12 wide, and of the light only its strength in the whole store is known."""
BORDER = 0.4
"""Share of the way from a plain name to that of a kind from which on most say the kind's: its names
are of the best examples that there are."""
SLOPE = 2.0
"""Log odds a deviation beyond the border."""
_LEAST_CALLED = 0.1
"""What fewer people call a metal is no colour of it."""
_NO_SHADES = frozenset({"very", "medium"})
"""They say how much, or that it is no shade at all."""


class Kind(NamedTuple):
    """A kind of a basic term: its lightness and chroma (2,), and those of the term's plain names.

    Means over a thing in light and shade.
    """

    term: str
    own: Floats
    plain: Floats

    def chance(self, seen: Floats) -> Floats:
        """Return how likely things of the term are of the kind, by lightness and chroma (n, 2)."""
        way = (self.own - self.plain) / SPREAD
        length = max(float(np.linalg.norm(way)), 1e-9)
        gone = ((seen - self.plain) / SPREAD) @ way / length
        return np.asarray(1.0 / (1.0 + np.exp(-SLOPE * (gone - BORDER * length))))


@lru_cache(maxsize=256)
def kinds_of(colour: str) -> tuple[Kind, ...]:
    """Return the kinds of basic terms that a colour is; none where it is told by its hue too."""
    words = words_of(colour)
    if len(words) == 2 and words[1] in BASIC and words[0] in SHADES.keys() - _NO_SHADES:
        plain = _plain(words[1])
        return (Kind(words[1], plain + _shift(*words), plain),)
    listed = listed_as(words)
    if not is_metal(colour) or len(listed) == 0:
        return ()
    called = named(lab(listed)).mean(axis=1)
    terms = [term for term, share in zip(BASIC, called, strict=True) if share >= _LEAST_CALLED]
    return tuple(Kind(term, _strength(listed), _plain(term)) for term in terms)


def strength(seen: Floats) -> Floats:
    """Return lightness and chroma (..., 2) of colours (..., 3) in CIELAB."""
    return np.stack([seen[..., 0], np.hypot(seen[..., 1], seen[..., 2])], axis=-1)


def _strength(colours: Floats) -> Floats:
    """Return the mean lightness and chroma (2,) of things of colours (n, 3), linear light."""
    return np.asarray(strength(lab(np.clip(in_light(colours), 0.0, 1.0))).mean(axis=(0, 1)))


@lru_cache(maxsize=16)
def _plain(term: str) -> Floats:
    return _strength(_listed(term, ()))


@lru_cache(maxsize=256)
def _shift(shade: str, term: str) -> Floats:
    """Return how far the listed names of a shade are from the plain ones of a term (2,).

    Where the term has none: as far as those of the other terms are from theirs.
    """
    own = _listed(term, (shade,))
    if len(own):
        return _strength(own) - _plain(term)
    others = [_strength(kin) - _plain(t) for t in BASIC if len(kin := _listed(t, (shade,)))]
    return np.asarray(np.mean(others, axis=0))


def _listed(term: str, shades: Sequence[str]) -> Floats:
    """Return the colours (n, 3), linear light, of a term's names with just these shades."""
    names, colours, common = table()
    kept = [
        i
        for i, name in enumerate(names)
        if common[i]
        and name[-1] == term
        and SHADES.keys() & set(name) == set(shades)
        and not set(name[:-1]) & set(BASIC)
    ]
    return linear(colours[kept])
