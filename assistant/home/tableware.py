"""What is eaten and drunk from, and what stands about in a kitchen.

Every function returns a `Model` that stands on z = 0, in metres; cups and bowls are a fifth larger
than in life, so that a person recognises them in a picture of 480 x 360.
"""

from __future__ import annotations

import numpy as np

from assistant.home.meshes import arc, body, box, cylinder, joined, lathe, tube
from assistant.home.model import Model, Part

STEEL = "#b9bec6"
BLACK = "#1c1c1f"
LEAF = "#3d8a3a"


def cup(colour: str) -> Model:
    """Return a mug with its handle towards +x."""
    wall = lathe(
        [
            (0, 0),
            (0.044, 0),
            (0.05, 0.012),
            (0.055, 0.12),
            (0.049, 0.12),
            (0.043, 0.016),
            (0, 0.016),
        ]
    )
    bow = tube(arc(0.036, -105, 105) * [1, 1.05, 1], 0.0095).turned(x=90).moved(x=0.05, z=0.064)
    return (
        Part(joined([wall, bow]), colour, shiny=True),
        Part(cylinder(0.0475, 0.004).moved(z=0.09), "#5b3a22"),
    )


def bowl(colour: str) -> Model:
    """Return a round, empty bowl."""
    profile = [(0, 0), (0.05, 0), (0.052, 0.012), (0.09, 0.035), (0.125, 0.085), (0.132, 0.105)]
    inner = [(0.124, 0.105), (0.117, 0.085), (0.083, 0.04), (0.04, 0.018), (0, 0.016)]
    return (Part(lathe([*profile, *inner], crease=60), colour, shiny=True),)


def _spread(number: int, count: int, radius: float) -> tuple[float, float]:
    """Return the place of one of `count` things set evenly round a centre."""
    angle = 2 * np.pi * number / count + 0.5
    return radius * float(np.cos(angle)), radius * float(np.sin(angle))


def apple(colour: str) -> Model:
    """Return an apple with its stalk."""
    flesh = lathe(
        [
            (0, 0.008),
            (0.02, 0),
            (0.04, 0.015),
            (0.047, 0.045),
            (0.036, 0.075),
            (0.015, 0.08),
            (0, 0.068),
        ],
        crease=80,
    )
    stalk = tube([[0, 0, 0.066], [0.004, 0, 0.085], [0.012, 0, 0.098]], 0.003)
    return (Part(flesh, colour, shiny=True), Part(stalk, "#4b3420"))


def banana() -> Model:
    """Return two bananas that lie side by side."""
    width = 0.021 * np.sin(np.linspace(0.25, np.pi - 0.25, 16)) ** 0.6
    one = tube(arc(0.13, 35, 145), width.tolist()).moved(y=-0.11, z=0.021)
    tips = [tube(arc(0.13, a, a + 7, steps=4), 0.007).moved(y=-0.11, z=0.021) for a in (29, 144)]
    pair = [part.moved(y=shift) for shift in (0.0, 0.042) for part in (one,)]
    ends = [part.moved(y=shift) for shift in (0.0, 0.042) for part in tips]
    return (Part(joined(pair), "#f2cf2c"), Part(joined(ends), "#5e4a1c"))


def wine_bottle(colour: str) -> Model:
    """Return a wine bottle with a pale label and a red cap."""
    shape = [(0, 0), (0.042, 0), (0.046, 0.01), (0.046, 0.2), (0.036, 0.235), (0.017, 0.265)]
    neck = [(0.016, 0.335), (0, 0.335)]
    return (
        Part(lathe([*shape, *neck]), colour, shiny=True),
        Part(cylinder(0.0185, 0.035).moved(z=0.333), "#b03030", shiny=True),
        Part(cylinder(0.0475, 0.085).moved(z=0.07), "#f2ead2"),
    )


def water_bottle(colour: str) -> Model:
    """Return a drinking bottle with a white screw top."""
    shape = [(0, 0), (0.04, 0), (0.044, 0.012), (0.044, 0.205), (0.036, 0.235), (0.026, 0.245)]
    return (
        Part(lathe([*shape, (0, 0.245)]), colour, shiny=True),
        Part(cylinder(0.03, 0.035).moved(z=0.243), "#f4f4f4", shiny=True),
    )


def vase(colour: str) -> Model:
    """Return a vase with five red tulips."""
    shape = [
        (0, 0),
        (0.05, 0),
        (0.085, 0.07),
        (0.075, 0.15),
        (0.04, 0.21),
        (0.05, 0.25),
        (0.042, 0.25),
        (0.03, 0.21),
        (0, 0.2),
    ]
    stems, heads = [], []
    for number in range(5):
        x, y = _spread(number, 5, 0.085)
        stems.append(tube([[0, 0, 0.15], [x / 2, y / 2, 0.3], [x, y, 0.4]], 0.005))
        heads.append(
            lathe(
                [(0, 0), (0.025, 0.01), (0.03, 0.04), (0.018, 0.065), (0, 0.05)], crease=70
            ).moved(x, y, 0.39)
        )
    return (
        Part(lathe(shape, crease=60), colour, shiny=True),
        Part(joined(stems), LEAF),
        Part(joined(heads), "#d3202a"),
    )


def kettle(colour: str) -> Model:
    """Return a kettle with a spout towards -x and a handle."""
    pot = lathe([(0, 0), (0.095, 0), (0.1, 0.02), (0.075, 0.2), (0.05, 0.215), (0, 0.22)])
    spout = tube([[-0.07, 0, 0.13], [-0.105, 0, 0.17], [-0.12, 0, 0.2]], [0.025, 0.018, 0.015])
    grip = tube(arc(0.075, -80, 80), 0.013).turned(x=90).moved(x=0.075, z=0.115)
    knob = cylinder(0.014, 0.03).moved(z=0.215)
    return (Part(joined([pot, spout]), colour, shiny=True), Part(joined([grip, knob]), BLACK))


def toaster() -> Model:
    """Return a toaster with two slices of bread that look out."""
    case = body(0.3, 0.19, 0.2, roundness=0.35)
    slots = [box(0.22, 0.035, 0.004).moved(y=y, z=0.199) for y in (-0.035, 0.035)]
    bread = [body(0.14, 0.022, 0.12, roundness=0.4).moved(y=y, z=0.13) for y in (-0.035, 0.035)]
    lever = box(0.02, 0.05, 0.02).moved(x=0.155, z=0.12)
    return (
        Part(case, STEEL, shiny=True),
        Part(joined([*slots, lever]), BLACK),
        Part(joined(bread), "#c98d4b"),
    )
