"""The furniture of the home, in metres, each piece with its back to +y and its front to -y."""

from __future__ import annotations

from assistant.home.meshes import body, box, cylinder, joined, tube
from assistant.home.model import Model, Part

BEECH = "#c99a62"
OAK = "#9a6a3a"
WALNUT = "#6a4528"
GRAPHITE = "#2b2c30"


def table(width: float, depth: float, height: float, top: str = BEECH, leg: str = OAK) -> Model:
    """Return a table: a board on four legs."""
    board = box(width, depth, 0.04).moved(z=height - 0.04)
    corners = [
        (sx * (width / 2 - 0.06), sy * (depth / 2 - 0.06)) for sx in (-1, 1) for sy in (-1, 1)
    ]
    legs = [box(0.06, 0.06, height - 0.04).moved(x, y) for x, y in corners]
    apron = box(width - 0.12, depth - 0.12, 0.07).moved(z=height - 0.11)
    return (Part(board, top), Part(joined([*legs, apron]), leg))


def chair(colour: str, seat: str) -> Model:
    """Return a chair with a slatted back."""
    legs = [box(0.042, 0.042, 0.45).moved(x, y) for x in (-0.19, 0.19) for y in (-0.19, 0.19)]
    posts = [box(0.042, 0.042, 0.5).moved(x, 0.19, 0.45) for x in (-0.19, 0.19)]
    rails = [box(0.36, 0.028, 0.075).moved(y=0.19, z=z) for z in (0.6, 0.73, 0.86)]
    cushion = body(0.44, 0.44, 0.07, roundness=0.3).moved(z=0.43)
    return (Part(joined([*legs, *posts, *rails]), colour), Part(cushion, seat))


def counter(width: float) -> Model:
    """Return a kitchen counter of cupboards, 0.9 m high, with a stone top and a splashback."""
    doors = []
    count = round(width / 0.6)
    for number in range(count):
        x = (number + 0.5) * width / count - width / 2
        doors.append((box(width / count - 0.03, 0.02, 0.68).moved(x, -0.29, 0.14), x))
    grips = [box(0.14, 0.02, 0.02).moved(x, -0.31, 0.74) for _, x in doors]
    return (
        Part(box(width, 0.56, 0.1), GRAPHITE),
        Part(box(width, 0.58, 0.76).moved(z=0.1), "#b9bdb8"),
        Part(joined(door for door, _ in doors), "#dfe3dc"),
        Part(joined(grips), "#7b7f85", shiny=True),
        Part(box(width + 0.02, 0.64, 0.04).moved(y=-0.01, z=0.86), "#8c8a86", shiny=True),
        Part(box(width, 0.02, 0.5).moved(y=0.285, z=0.9), "#dbe7ea"),
    )


def sink() -> Model:
    """Return a steel sink, let into a counter whose top is z = 0, with its tap."""
    rim = [box(0.52, 0.03, 0.012).moved(y=y) for y in (-0.2, 0.2)]
    rim += [box(0.03, 0.4, 0.012).moved(x) for x in (-0.245, 0.245)]
    basin = box(0.46, 0.37, 0.004)
    tap = tube(
        [
            [0, 0.2, 0],
            [0, 0.2, 0.2],
            [0, 0.18, 0.26],
            [0, 0.12, 0.28],
            [0, 0.06, 0.26],
            [0, 0.05, 0.21],
        ],
        0.016,
    )
    return (
        Part(joined([*rim, tap]), "#c9ced4", shiny=True),
        Part(basin, "#5f646b", shiny=True),
    )


def fridge() -> Model:
    """Return a fridge with a freezer door above, two long handles, and notes on its front."""
    doors = [
        box(0.66, 0.03, 1.1).moved(y=-0.335, z=0.06),
        box(0.66, 0.03, 0.56).moved(y=-0.335, z=1.19),
    ]
    grips = [
        tube([[-0.27, -0.385, a], [-0.27, -0.385, b]], 0.014) for a, b in ((0.7, 1.12), (1.24, 1.6))
    ]
    notes = (
        Part(box(0.13, 0.004, 0.15).moved(0.08, -0.352, 1.35), "#f6e05a"),
        Part(box(0.1, 0.004, 0.12).moved(0.2, -0.352, 0.98), "#ef8fb0"),
    )
    return (
        Part(box(0.68, 0.64, 1.8), "#c4c9ce"),
        Part(joined(doors), "#e4e8ea", shiny=True),
        Part(joined(grips), "#70757c", shiny=True),
        *notes,
    )


def oven() -> Model:
    """Return a cooker: a glass door, four knobs and four rings on top."""
    rings = [cylinder(0.085, 0.006).moved(x, y, 0.9) for x in (-0.14, 0.14) for y in (-0.13, 0.14)]
    knobs = [
        cylinder(0.02, 0.03).turned(x=90).moved(x, -0.3, 0.82) for x in (-0.2, -0.07, 0.07, 0.2)
    ]
    grip = tube([[-0.22, -0.345, 0.72], [0.22, -0.345, 0.72]], 0.013)
    return (
        Part(box(0.6, 0.6, 0.9), "#eceeee"),
        Part(box(0.48, 0.02, 0.4).moved(y=-0.3, z=0.24), "#26282c", shiny=True),
        Part(box(0.58, 0.56, 0.005).moved(z=0.9), "#303236", shiny=True),
        Part(joined(rings), "#0f0f10"),
        Part(joined([*knobs, grip]), "#5c6066", shiny=True),
    )


def microwave() -> Model:
    """Return a microwave with a dark window and a panel of keys."""
    panel = [
        Part(box(0.025, 0.004, 0.018).moved(x, -0.187, z), "#d7dade")
        for x in (0.165, 0.2)
        for z in (0.07, 0.1, 0.13, 0.16)
    ]
    return (
        Part(box(0.5, 0.36, 0.3), "#e7e7e7"),
        Part(box(0.34, 0.01, 0.23).moved(-0.06, -0.182, 0.035), "#1e2024", shiny=True),
        Part(box(0.1, 0.01, 0.25).moved(0.18, -0.182, 0.025), "#4a4d53"),
        Part(box(0.08, 0.004, 0.035).moved(0.18, -0.188, 0.215), "#54e08a"),
        Part(tube([[0.1, -0.205, 0.05], [0.1, -0.205, 0.25]], 0.01), "#9aa0a6", shiny=True),
        *panel,
    )


def couch(colour: str, width: float = 1.9) -> Model:
    """Return a sofa with two seat cushions, a back and two arms."""
    half = width / 2
    base = box(width, 0.85, 0.22).moved(z=0.1)
    arms = [body(0.22, 0.9, 0.5, roundness=0.35).moved(x=s * (half - 0.1), z=0.12) for s in (-1, 1)]
    back = body(width, 0.28, 0.72, roundness=0.3).moved(y=0.33, z=0.14)
    seat = (width - 0.42) / 2
    cushions = [
        body(seat, 0.68, 0.2, roundness=0.3).moved(s * seat / 2, -0.1, 0.3) for s in (-1, 1)
    ]
    feet = [
        cylinder(0.03, 0.1).moved(x, y) for x in (-half + 0.1, half - 0.1) for y in (-0.35, 0.35)
    ]
    darker = "#" + "".join(f"{int(int(colour[i : i + 2], 16) * 0.82):02x}" for i in (1, 3, 5))
    return (
        Part(joined([base, *arms, back]), darker),
        Part(joined(cushions), colour),
        Part(joined(feet), WALNUT),
    )


def television() -> Model:
    """Return a flat television on its foot."""
    return (
        Part(body(1.15, 0.05, 0.67, roundness=0.12).moved(z=0.08), GRAPHITE),
        Part(box(1.09, 0.01, 0.6).moved(y=-0.022, z=0.115), "#0c0d10", shiny=True),
        Part(joined([box(0.08, 0.06, 0.1), box(0.5, 0.22, 0.015)]), "#3f4147"),
    )


def sideboard(width: float, height: float, colour: str = WALNUT) -> Model:
    """Return a low cupboard with two doors on short legs."""
    doors = [
        box(width / 2 - 0.03, 0.015, height - 0.2).moved(s * width / 4, -0.205, 0.14)
        for s in (-1, 1)
    ]
    knobs = [
        cylinder(0.015, 0.025).turned(x=90).moved(s * 0.06, -0.21, height / 2) for s in (-1, 1)
    ]
    legs = [
        box(0.05, 0.05, 0.1).moved(x, y)
        for x in (-width / 2 + 0.06, width / 2 - 0.06)
        for y in (-0.15, 0.15)
    ]
    return (
        Part(box(width, 0.4, height - 0.1).moved(z=0.1), colour),
        Part(joined(doors), OAK),
        Part(joined([*knobs, *legs]), GRAPHITE),
    )


def bookcase(colour: str = OAK) -> Model:
    """Return a bookcase, 1.6 m high, with rows of books on its upper three boards."""
    sides = [box(0.035, 0.32, 1.6).moved(x) for x in (-0.5, 0.5)]
    boards = [box(1.0, 0.32, 0.035).moved(z=z) for z in (0.06, 0.42, 0.82, 1.22, 1.57)]
    spines = [
        "#b5382e",
        "#2f5d8c",
        "#e0b23c",
        "#4d7d4a",
        "#774a86",
        "#d9d2c0",
        "#31708e",
        "#a35d2a",
    ]
    rows: list[Part] = []
    for shelf, (left, count) in {1.255: (-0.46, 15), 0.855: (-0.46, 7), 0.455: (-0.1, 9)}.items():
        for number in range(count):
            width, height = 0.04 + 0.013 * (number % 3), 0.2 + 0.027 * (number * 5 % 4)
            book = box(width, 0.2, height).moved(left + 0.062 * number, 0.02, shelf)
            rows.append(Part(book, spines[(number * 3 + count) % len(spines)]))
    back = Part(box(1.0, 0.015, 1.6).moved(y=0.155), "#7d5430")
    return (Part(joined([*sides, *boards]), colour), back, *rows)


def bed(cover: str) -> Model:
    """Return a bed, 1.4 m wide, its head at +y, with a mattress, a blanket and two pillows."""
    head = body(1.5, 0.08, 1.0, roundness=0.2).moved(y=1.02)
    frame = box(1.46, 2.0, 0.22).moved(z=0.08)
    mattress = body(1.4, 1.98, 0.26, roundness=0.15).moved(z=0.28)
    blanket = body(1.48, 1.4, 0.22, roundness=0.15).moved(y=-0.32, z=0.36)
    fold = body(1.48, 0.3, 0.235, roundness=0.2).moved(y=0.3, z=0.36)
    pillows = [body(0.6, 0.42, 0.17, roundness=0.5).moved(s * 0.35, 0.72, 0.51) for s in (-1, 1)]
    return (
        Part(joined([head, frame]), OAK),
        Part(joined([mattress, *pillows]), "#f3f1ea"),
        Part(blanket, cover),
        Part(fold, "#e3e6ef"),
    )


def nightstand() -> Model:
    """Return a bedside table with two drawers, 0.55 m high."""
    drawers = [box(0.4, 0.015, 0.18).moved(y=-0.2, z=z) for z in (0.09, 0.3)]
    knobs = [cylinder(0.015, 0.025).turned(x=90).moved(y=-0.205, z=z) for z in (0.18, 0.39)]
    return (
        Part(box(0.48, 0.4, 0.55), OAK),
        Part(joined(drawers), BEECH),
        Part(joined(knobs), GRAPHITE),
    )


def wardrobe() -> Model:
    """Return a wardrobe with two doors, 2 m high."""
    doors = [box(0.56, 0.02, 1.84).moved(s * 0.29, -0.3, 0.1) for s in (-1, 1)]
    grips = [box(0.02, 0.03, 0.2).moved(s * 0.04, -0.32, 0.95) for s in (-1, 1)]
    return (
        Part(box(1.2, 0.58, 2.0), "#b98b57"),
        Part(joined(doors), BEECH),
        Part(joined(grips), GRAPHITE),
    )


def bench() -> Model:
    """Return a hall bench, 0.45 m high, with a padded seat and shoes' space below."""
    legs = [box(0.05, 0.36, 0.4).moved(x) for x in (-0.52, 0.52)]
    return (
        Part(joined([*legs, box(1.0, 0.34, 0.03).moved(z=0.12)]), OAK),
        Part(body(1.12, 0.4, 0.08, roundness=0.3).moved(z=0.38), "#7c8f7a"),
    )
