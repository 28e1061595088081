"""The small things of the home: what is carried about, read and worn.

Every function returns a `Model` that stands on z = 0, in metres. What is smaller than a hand (keys,
glasses, scissors, a remote) is about half as large again as in life, so that a person recognises it
in a picture of 480 x 360.
"""

from __future__ import annotations

from assistant.home.meshes import Mesh, arc, body, box, cylinder, joined, lathe, ring, tube
from assistant.home.model import Model, Part
from assistant.home.tableware import LEAF

STEEL = "#b9bec6"
BRASS = "#d8aa3a"
BLACK = "#1c1c1f"
WHITE = "#f4f2ec"


def keys() -> Model:
    """Return a ring with a brass and a steel key fanned out, and a red leather tag."""
    loop = ring(0.03, 0.0032).moved(z=0.004)
    brass = _key().turned(z=-28).moved(z=0.003)
    steel = _key().turned(z=22).moved(z=0.007)
    tag = body(0.075, 0.042, 0.009, roundness=0.4).moved(x=-0.062, z=0.001).turned(z=-8)
    return (
        Part(joined([loop, steel]), STEEL, shiny=True),
        Part(brass, BRASS, shiny=True),
        Part(tag, "#c41f25"),
    )


def _key() -> Mesh:
    """Return a key that hangs at the ring's edge: a bow with a hole, a blade, three teeth."""
    washer = [(0.013, 0), (0.031, 0), (0.031, 0.006), (0.013, 0.006), (0.013, 0)]
    bow = lathe(washer).scaled(1, 0.9, 1).moved(x=0.048)
    blade = box(0.085, 0.015, 0.006).moved(x=0.115)
    teeth = [box(0.009, 0.011, 0.006).moved(x=x, y=-0.012) for x in (0.11, 0.128, 0.148)]
    return joined([bow, blade, *teeth])


def glasses() -> Model:
    """Return spectacles that stand open on their temples' ends, lenses towards -y."""
    height = 0.034
    rims = []
    lenses = []
    for side in (-1, 1):
        rim = ring(0.04, 0.0055).scaled(1.12, 0.9, 1).turned(x=90)
        rims.append(rim.moved(x=side * 0.055, z=height + 0.006))
        lens = cylinder(0.038, 0.001).scaled(1.12, 0.9, 1).turned(x=90)
        lenses.append(lens.moved(x=side * 0.055, y=-0.004, z=height + 0.006))
        reach = [[side * 0.099, 0, height + 0.014], [side * 0.101, 0.13, height + 0.012]]
        hook = [side * 0.097, 0.175, 0.008]
        rims.append(tube([*reach, hook], 0.0045))
    bridge = tube(arc(0.014, 10, 170), 0.005).turned(x=90).moved(z=height + 0.008)
    return (
        Part(joined([*rims, bridge]), "#15151a", shiny=True),
        Part(joined(lenses), "#c3dbe6", shiny=True),
    )


def phone() -> Model:
    """Return a telephone that lies on its back, its screen lit."""
    case = body(0.095, 0.19, 0.016, roundness=0.25)
    screen = box(0.083, 0.172, 0.002).moved(z=0.0155)
    tiles = [
        Part(box(0.015, 0.015, 0.001).moved(x, y, 0.0175), colour)
        for colour, x, y in (
            ("#e7523f", -0.024, 0.05),
            ("#4bb14f", 0.0, 0.05),
            ("#f3c33a", 0.024, 0.05),
            ("#f5f5f5", -0.024, 0.022),
            ("#e07bb5", 0.0, 0.022),
            ("#3c3c44", 0.024, 0.022),
        )
    ]
    return (Part(case, BLACK, shiny=True), Part(screen, "#3f7fd0"), *tiles)


def book(colour: str, band: str = "#f0e2b0") -> Model:
    """Return a closed book that lies flat, its spine towards -x."""
    cover = [
        box(0.17, 0.235, 0.005),
        box(0.17, 0.235, 0.005).moved(z=0.038),
        box(0.006, 0.235, 0.043).moved(x=-0.082),
    ]
    pages = box(0.158, 0.225, 0.034).moved(x=-0.002, z=0.005)
    title = [
        box(0.11, 0.03, 0.001).moved(y=0.045, z=0.043),
        box(0.07, 0.012, 0.001).moved(y=0.0, z=0.043),
    ]
    return (Part(joined(cover), colour), Part(pages, "#efe8d6"), Part(joined(title), band))


def remote() -> Model:
    """Return a remote control with its keys on top."""
    pad = [
        Part(cylinder(0.0065, 0.003).moved(x, y, 0.021), "#d9d9de")
        for x in (-0.018, 0.0, 0.018)
        for y in (-0.07, -0.048, -0.026, -0.004)
    ]
    power = Part(cylinder(0.0085, 0.003).moved(x=-0.016, y=0.092, z=0.021), "#d8261f")
    wheel = Part(ring(0.017, 0.004).moved(y=0.045, z=0.019), "#d9d9de")
    return (Part(body(0.068, 0.235, 0.024, roundness=0.3), BLACK), power, wheel, *pad)


def wallet() -> Model:
    """Return a folded leather wallet with a note and a card that look out."""
    leather = body(0.15, 0.115, 0.03, roundness=0.25)
    stitch = [box(0.136, 0.003, 0.001).moved(y=y, z=0.0295) for y in (-0.045, 0.045)]
    note = box(0.13, 0.05, 0.003).moved(y=0.045, z=0.014)
    card = box(0.09, 0.05, 0.003).moved(x=0.012, y=0.042, z=0.018)
    return (
        Part(leather, "#6b3f1f"),
        Part(joined(stitch), "#c79a5c"),
        Part(note, "#7fb27a"),
        Part(card, "#e9e9ee"),
    )


def handbag(colour: str) -> Model:
    """Return a handbag with a flap, a clasp and a high strap."""
    sack = body(0.36, 0.15, 0.27, roundness=0.35)
    flap = body(0.35, 0.16, 0.13, roundness=0.3).moved(z=0.145)
    strap = tube(arc(0.12, 0, 180) * [1, 1.35, 1], 0.011).turned(x=90).moved(z=0.25)
    clasp = body(0.05, 0.03, 0.04, roundness=0.4).moved(y=-0.075, z=0.135)
    return (
        Part(sack, colour),
        Part(joined([flap, strap]), "#6d2f16"),
        Part(clasp, BRASS, shiny=True),
    )


def backpack(colour: str) -> Model:
    """Return a rucksack that stands upright, its pocket towards -y."""
    sack = body(0.34, 0.22, 0.47, roundness=0.45)
    pocket = body(0.27, 0.1, 0.2, roundness=0.4).moved(y=-0.11, z=0.03)
    lid = body(0.32, 0.23, 0.12, roundness=0.5).moved(y=-0.01, z=0.38)
    grip = tube(arc(0.045, 0, 180), 0.011).turned(x=90).moved(y=0.03, z=0.48)
    zips = [
        box(0.22, 0.006, 0.01).moved(y=-0.162, z=0.17),
        box(0.28, 0.006, 0.012).moved(y=-0.112, z=0.385),
    ]
    straps = [
        tube(arc(0.2, -60, 60) * [0.5, 1, 1], 0.018).turned(y=-90).moved(x=x, y=0.1, z=0.22)
        for x in (-0.1, 0.1)
    ]
    return (
        Part(joined([sack, pocket]), colour),
        Part(joined([lid, grip, *straps]), "#1d2f63"),
        Part(joined(zips), "#f0c63c"),
    )


def laptop() -> Model:
    """Return an open laptop that faces -y."""
    base = body(0.36, 0.25, 0.022, roundness=0.2)
    pad = [
        box(0.32, 0.11, 0.002).moved(y=0.035, z=0.0205),
        box(0.1, 0.06, 0.002).moved(y=-0.075, z=0.0205),
    ]
    lid = body(0.36, 0.014, 0.25, roundness=0.2).turned(x=-14).moved(y=0.12, z=0.015)
    screen = box(0.33, 0.004, 0.215).moved(y=-0.008, z=0.018).turned(x=-14).moved(y=0.12, z=0.015)
    window = (
        box(0.17, 0.004, 0.11).moved(x=0.03, y=-0.011, z=0.075).turned(x=-14).moved(y=0.12, z=0.015)
    )
    return (
        Part(joined([base, lid]), "#c3c6cb"),
        Part(joined(pad), "#4a4b52"),
        Part(screen, "#2f6fb5"),
        Part(window, "#f3f3f3"),
    )


def teddy() -> Model:
    """Return a teddy bear that sits, its face towards -y."""
    fur = [
        body(0.19, 0.17, 0.22),
        body(0.17, 0.16, 0.16).moved(z=0.19),
        *(body(0.065, 0.04, 0.065).moved(x=x, z=0.315) for x in (-0.065, 0.065)),
        *(
            body(0.07, 0.075, 0.14).turned(y=t).moved(x=x, y=-0.04, z=0.09)
            for x, t in ((-0.1, 35), (0.1, -35))
        ),
        *(body(0.085, 0.17, 0.085).moved(x=x, y=-0.11) for x in (-0.07, 0.07)),
    ]
    pale = [
        body(0.085, 0.06, 0.065).moved(y=-0.065, z=0.215),
        body(0.11, 0.04, 0.13).moved(y=-0.075, z=0.05),
    ]
    soles = [body(0.06, 0.02, 0.06).moved(x=x, y=-0.19, z=0.012) for x in (-0.07, 0.07)]
    dark = [body(0.02, 0.02, 0.02).moved(x=x, y=-0.073, z=0.275) for x in (-0.035, 0.035)]
    nose = body(0.028, 0.02, 0.02).moved(y=-0.096, z=0.25)
    return (
        Part(joined(fur), "#9c6433"),
        Part(joined([*pale, *soles]), "#e2c396"),
        Part(joined([*dark, nose]), BLACK, shiny=True),
    )


def scissors() -> Model:
    """Return half-open scissors that lie flat, the points towards +y."""
    blades = []
    handles = []
    for side, lift in ((-1, 0.0), (1, 0.005)):
        blade = box(0.017, 0.15, 0.004).moved(x=side * 0.004, y=0.075)
        shank = tube([[0.0, 0.0, 0.0], [0.0, -0.05, 0.0]], 0.007).moved(z=0.004)
        loop = ring(0.026, 0.0085).scaled(1, 1.35, 1).moved(x=-side * 0.014, y=-0.082)
        blades.append(blade.turned(z=side * 13).moved(z=lift + 0.003))
        handles += [bar.turned(z=side * 20).moved(z=lift) for bar in (shank, loop)]
    return (Part(joined(blades), STEEL, shiny=True), Part(joined(handles), "#e06a1b", shiny=True))


def plant(height: float = 0.9) -> Model:
    """Return a pot plant of broad leaves, `height` metres in all."""
    pot = lathe(
        [
            (0, 0),
            (0.11, 0),
            (0.15, 0.24),
            (0.165, 0.24),
            (0.165, 0.28),
            (0.145, 0.28),
            (0.14, 0.25),
            (0, 0.25),
        ]
    )
    leaves = []
    for number in range(22):
        turn, tilt = 137.5 * number, 62 - 2.3 * number
        blade = body(0.34, 0.11, 0.014).moved(x=0.2).turned(y=-30 + tilt / 3).turned(z=turn)
        leaves.append(blade.moved(z=0.36 + 0.017 * number))
    stem = tube([[0, 0, 0.2], [0.01, 0, 0.75]], 0.018)
    soil = cylinder(0.14, 0.004).moved(z=0.25)
    factor = height / 0.9
    return tuple(
        Part(part.mesh.scaled(factor), part.colour, shiny=part.shiny)
        for part in (
            Part(pot, "#c65f36"),
            Part(soil, "#3b2a1e"),
            Part(joined(leaves[::2]), LEAF),
            Part(joined(leaves[1::2]), "#57a84c"),
            Part(stem, "#5c7a39"),
        )
    )


def pillow(colour: str) -> Model:
    """Return a cushion that lies flat."""
    return (Part(body(0.42, 0.42, 0.15, roundness=0.55), colour),)


def clock(colour: str) -> Model:
    """Return a wall clock in the x, z plane that faces -y, centred on the origin."""
    rim = lathe([(0, 0), (0.17, 0), (0.17, 0.045), (0.15, 0.045), (0.15, 0.03), (0, 0.03)])
    face = cylinder(0.15, 0.002).moved(z=0.03)
    marks = [
        box(0.012, 0.03, 0.003).moved(y=0.125, z=0.032).turned(z=30 * hour) for hour in range(12)
    ]
    hands = [
        box(0.014, 0.085, 0.004).moved(y=0.035, z=0.034).turned(z=60),
        box(0.009, 0.125, 0.004).moved(y=0.055, z=0.036).turned(z=-60),
    ]
    standing = [
        Part(rim, colour, shiny=True),
        Part(face, WHITE),
        Part(joined([*marks, *hands]), BLACK),
    ]
    return tuple(part.turned(x=90) for part in standing)


def lamp(shade: str, height: float = 0.5, foot: str = "#8a6a44") -> Model:
    """Return a lamp with a cloth shade: for a table, or for the floor where it is high."""
    base = cylinder(0.09 + height * 0.05, 0.025)
    pole = cylinder(0.014, height - 0.1)
    width = 0.12 + height * 0.06
    cloth = lathe(
        [(width, 0), (width * 0.65, 0.22), (width * 0.63, 0.22), (width * 0.97, 0)], crease=30
    )
    return (Part(joined([base, pole]), foot), Part(cloth.moved(z=height - 0.22), shade))
