"""Colour words as sets of sRGB colours, from two public lists (see the head of names.tsv).

A basic term is the region of every name in the survey that ends in it ("dark sky blue" is a blue),
so its borders are those of the people who were asked, not of a rule of ours; nor of a standard's,
whose "navajo white" is the colour of wood in the sun.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from importlib.resources import files
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
BASIC = (
    "black",
    "white",
    "grey",
    "red",
    "orange",
    "yellow",
    "green",
    "blue",
    "purple",
    "pink",
    "brown",
)
"""The eleven basic colour terms of English (Berlin and Kay, 1969)."""
_SURVEY = "xkcd"
"""The list whose names are of people who were shown colours."""
_NOT_COLOURS = frozenset(
    {"brick", "cement", "clay", "dark", "denim", "leather", "linen", "pale", "steel", "stone"}
    | {"straw", "velvet"}
)
"""Listed names that say what a thing is made of, or how a colour is, when said of a thing.

"Leather-coloured" says that it is no leather.
"""
_COLOURED = ("coloured", "colored")
_SPELLINGS = {
    "gray": "grey",
    "golden": "gold",
    "colored": "",
    "coloured": "",
    "color": "",
    "colour": "",
}
SHADES: dict[str, tuple[float, float]] = {
    # factor on linear light, then the share of white that is mixed in
    "dark": (0.3, 0.0),
    "deep": (0.4, 0.0),
    "light": (1.0, 0.45),
    "pale": (1.0, 0.6),
    "pastel": (1.0, 0.55),
    "bright": (1.2, 0.0),
    "vivid": (1.2, 0.0),
    "neon": (1.4, 0.0),
    "hot": (1.0, 0.0),
    "dusty": (0.7, 0.2),
    "dull": (0.7, 0.1),
    "soft": (1.0, 0.35),
    "very": (1.0, 0.0),
    "medium": (0.8, 0.0),
}
_METALS = frozenset({"silver", "gold", "bronze", "copper", "brass", "steel", "chrome"})
_MIRRORED = (0.1, 0.3, 1.0)
"""Shares of the light that parts of a polished thing send back: it mirrors dark and bright."""
_NEIGHBOURS = 5
"""So many names of a basic term tell how near to it a colour is."""
_DARK = frozenset({"dark", "deep"})
_LIGHT = frozenset({"light", "pale", "pastel"})
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Shares of linear red, green and blue in how bright a light looks (Rec. 709)."""
_TO_XYZ = np.array(
    [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
).T / np.array([0.9505, 1.0, 1.089])
"""Linear sRGB to XYZ, white at 1 (IEC 61966-2-1, D65)."""


def linear(rgb: Floats) -> Floats:
    """Return sRGB 0..255 as linear light 0..1."""
    c = rgb / 255.0
    return np.asarray(np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4))


def encoded(light: Floats) -> Floats:
    """Return linear light as sRGB 0..255; what is brighter than white is white."""
    x = np.clip(light, 0.0, 1.0)
    return np.asarray(255.0 * np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055))


def lab(light: Floats) -> Floats:
    """Return lightness, redness and yellowness (..., 3) of linear light (..., 3), white 1.

    CIELAB (CIE 15), for daylight: equal steps look about equally large.
    """
    xyz = light @ _TO_XYZ
    root = np.where(xyz > 216 / 24389, np.cbrt(xyz), xyz * (841 / 108) + 4 / 29)
    x, y, z = root[..., 0], root[..., 1], root[..., 2]
    return np.asarray(np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1))


def words_of(colour: str) -> tuple[str, ...]:
    """Return a colour's words in the lists' spelling: `light-Gray` is (light, grey).

    A listed name is as it stands ("pinkish brown", "blue/green"), one written as style sheets do
    is its words (lightgray); of others "reddish" is red.
    """
    said = colour.lower().replace("gray", "grey")
    for mark in "-_/":
        said = said.replace(mark, " ")
    words = tuple(word for word in said.split() if _SPELLINGS.get(word, word))
    names, glued = _names()
    if words in names:
        return words
    if words[:1] in glued and len(words) == 1:
        return glued[words]
    return tuple(_SPELLINGS.get(word, _of_reddish(word)) for word in words)


def is_metal(colour: str) -> bool:
    """Whether a colour is that of a polished metal, whose parts mirror dark and bright."""
    return not _METALS.isdisjoint(words_of(colour)[-1:])


def _of_reddish(word: str) -> str:
    """Return the basic term inside of `reddish`, `greyish`; another word as it is."""
    if not word.endswith("ish"):
        return word
    stem = word.removesuffix("ish").replace("gray", "grey")
    return next((term for term in BASIC if stem in (term, term[:-1], term + term[-1])), word)


@lru_cache(maxsize=1)
def _names() -> tuple[frozenset[tuple[str, ...]], dict[tuple[str, ...], tuple[str, ...]]]:
    """Return the listed names, and those of several words by how they look written in one."""
    names = frozenset(table().names)
    return names, {("".join(name),): name for name in names if len(name) > 1}


class Listed(NamedTuple):
    """The listed names as words, their colours (n, 3) in sRGB 0..255, and who uses them.

    common: the names of people who were asked; and of the others those of one word.
    """

    names: tuple[tuple[str, ...], ...]
    colours: Floats
    common: tuple[bool, ...]


@lru_cache(maxsize=1)
def table() -> Listed:
    """Return the lists."""
    names: list[tuple[str, ...]] = []
    colours: list[list[int]] = []
    common: list[bool] = []
    text = files("d3a.colours").joinpath("names.tsv").read_text(encoding="utf-8")
    for line in text.splitlines():
        if line.startswith("#"):
            continue
        name, code, source = line.split("\t")
        names.append(tuple(name.split()))
        colours.append([int(code[i : i + 2], 16) for i in (1, 3, 5)])
        common.append(source == _SURVEY or len(names[-1]) == 1)
    return Listed(tuple(names), np.array(colours, dtype=np.float64), tuple(common))


def is_colour(word: str) -> bool:
    """Whether a word of a question names a colour: listed, or a shade of one that is."""
    return colours_of(word) is not None


@lru_cache(maxsize=256)
def colours_of(colour: str) -> Floats | None:
    """Return the colours (n, 3), linear light, that a colour word stands for; None for no colour.

    A basic term: every name that ends in it. Else the name itself and the names that hold all of
    its words ("dark blue": "dark royal blue" too); a dark or light basic colour also takes in the
    names of that term that are darker or lighter than most. Else a shade of what is left of it.
    """
    words = words_of(colour)
    if not words or all(word in SHADES for word in words):
        return None
    is_named = len(words) > 1 and words in _names()[0]  # fire brick
    if words[-1] in _NOT_COLOURS and not is_named and not colour.lower().endswith(_COLOURED):
        return None
    named = listed_as(words)
    if len(named):
        if words[-1] in _METALS:  # its parts send back what is around it, dark and bright
            return np.concatenate([named * share for share in _MIRRORED])
        return named
    if words[0] in SHADES and len(words) > 1:
        base = colours_of(" ".join(words[1:]))
        if base is not None:
            factor, white = SHADES[words[0]]
            return np.asarray(np.clip(base * factor, 0, 1) * (1 - white) + white)
    return None


def listed_as(words: tuple[str, ...]) -> Floats:
    """Return the listed colours (n, 3), linear light, that words stand for, see `colours_of`."""
    return linear(table().colours[list(_rows_of(words))])


@lru_cache(maxsize=64)
def rest_of(colour: str) -> tuple[str, Floats] | None:
    """Return the basic term that a colour is a kind of, and what else that term stands for.

    "dark blue" is a kind of blue; the rest are the other blues. "crimson" says of no basic term
    that it is a kind of it, but is among the reds; the rest are the reds that are least like it.
    None for a basic term.
    """
    words = words_of(colour)
    if words[-1] not in BASIC:
        return _among_which(colour)
    if len(words) < 2:
        return None
    others = sorted(set(_rows_of((words[-1],))) - set(_rows_of(words)))
    return (words[-1], linear(table().colours[others])) if others else None


def _among_which(colour: str) -> tuple[str, Floats] | None:
    """Return the basic term with the names nearest to a colour, and its farther half."""
    asked = colours_of(colour)
    if asked is None:
        return None
    listed = linear(table().colours)
    apart = np.linalg.norm(lab(listed) - lab(asked).mean(axis=0), axis=1)

    def nearness(term: str) -> float:
        return float(np.sort(apart[list(_rows_of((term,)))])[:_NEIGHBOURS].mean())

    base = min(BASIC, key=nearness)
    kin = np.array(_rows_of((base,)))
    farther = kin[apart[kin] > np.median(apart[kin])]
    return (base, listed[farther]) if len(farther) else None


@lru_cache(maxsize=256)
def _rows_of(words: tuple[str, ...]) -> tuple[int, ...]:
    """Return the rows of the table that the words stand for, in order."""
    names, colours, common = table()
    if len(words) == 1 and words[0] in BASIC:
        return tuple(i for i, name in enumerate(names) if common[i] and _head(name) == words[0])
    asked = set(words)
    rows = {i for i, name in enumerate(names) if _is_shade_of(name, words, asked)}
    if len(words) == 2 and words[1] in BASIC and words[0] in _DARK | _LIGHT:
        kin = np.array(_rows_of(words[1:]))
        light = linear(colours[kin]) @ LUMINANCE
        middle = np.median(light)
        rows |= set(kin[light < middle if words[0] in _DARK else light > middle].tolist())
    return tuple(sorted(rows))


def _head(name: Sequence[str]) -> str:
    """Return the basic term a name belongs to, "" for none and for two (blue green)."""
    last = name[-1]
    if last not in BASIC or (len(name) > 1 and name[-2] in BASIC and name[-2] != last):
        return ""
    return last


def _is_shade_of(name: tuple[str, ...], words: tuple[str, ...], asked: set[str]) -> bool:
    """Whether a listed name is the asked one, or a kind of it with the same head alone."""
    if name == words:
        return True
    others = set(name) - asked
    kind = len(words) > 1 and name[-1] == words[-1] and asked <= set(name)
    return kind and not others & set(BASIC)
