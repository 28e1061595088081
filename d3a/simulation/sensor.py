"""What the robot's detector reports: which things in sight, as what, where, and how sure.

Misses repeat from the same viewpoint: occlusion is geometry, and a thing's own detectability is a
smooth function of where it is seen from.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.simulation import appearance
from d3a.simulation.camera import CAMERA, axes, corners, pixels, seen_from
from d3a.simulation.conditions import Condition
from d3a.simulation.patrol import Track
from d3a.simulation.solids import LATERAL, VERTICAL, Floats, Ints, centred, visible
from d3a.simulation.world import World

Floats64 = NDArray[np.float64]
REACH_M = 6.5
MIN_PIXELS = 4.5
CONFUSABLE: dict[str, tuple[str, ...]] = {
    "cup": ("bowl", "bottle", "vase"),
    "bottle": ("vase", "cup"),
    "bowl": ("cup", "sink"),
    "chair": ("couch", "dining table"),
    "tv": ("laptop", "microwave"),
    "laptop": ("tv", "book"),
    "potted plant": ("vase",),
    "book": ("laptop",),
    "vase": ("bottle", "cup"),
    "dining table": ("chair",),
    "couch": ("chair",),
    "refrigerator": ("microwave",),
    "sink": ("bowl",),
    "microwave": ("tv", "refrigerator"),
}


@dataclass(frozen=True, slots=True)
class Exposures:
    """Every (frame, thing) with the thing in sight: indices (p,), sample points in sight (p, s).

    centre (p, 3) in the optical frame; height (p,) in pixels; solid (p, 6) in the map.
    """

    frame: Ints
    thing: Ints
    shown: NDArray[np.bool_]
    centre: Floats64
    height: Floats64
    solid: Floats


@dataclass(frozen=True, slots=True)
class Reports:
    """The detections, in the order they are written: thing (-1: false positive), frame, category.

    box (d, 4); position (d, 3) in the map by the reported pose; embedding (d, dim) raw.
    """

    thing: Ints
    frame: Ints
    category: list[str]
    probability: Floats64
    box: Floats64
    position: Floats64
    embedding: NDArray[np.float32]


def loose_solids(world: World, positions: Floats64) -> Floats:
    """Return the solids of what is not furniture at each moment, (m, n, 6); far away: not there."""
    out = centred(positions, np.broadcast_to(world.sizes, positions.shape))
    out[np.isnan(out)] = 1e4
    out[:, [k for k, thing in enumerate(world.things) if thing.piece]] = 1e4
    return out


def in_view(track: Track, frame: Ints, centres: Floats64) -> tuple[NDArray[np.bool_], Floats64]:
    """Return which centres (p, 3) fall into their frame's picture and reach, and where (p, 3)."""
    local = seen_from(track, frame, centres)
    uv = pixels(local)
    inside = (uv > 2).all(axis=1) & (uv < (CAMERA.width - 2, CAMERA.height - 2)).all(axis=1)
    return inside & (local[:, 2] > 0.3) & (np.linalg.norm(local, axis=1) < REACH_M), local


def expose(world: World, track: Track, loose: Floats, positions: Floats64) -> Exposures:
    """Find every thing in sight of every frame."""
    moments, count = positions.shape[:2]
    frame = np.repeat(np.arange(moments), count)
    thing = np.tile(np.arange(count), moments)
    centres = np.nan_to_num(positions.reshape(-1, 3), nan=1e4)
    seen, local = in_view(track, frame, centres)
    height = CAMERA.fy * world.sizes[thing, 2] / np.maximum(local[:, 2], 0.3)
    keep = np.flatnonzero(seen & (height >= MIN_PIXELS))
    frame, thing = frame[keep], thing[keep]
    solid = centred(centres[keep], world.sizes[thing])
    fixed, owner = world.fixed()
    cameras = track.places[frame].astype(np.float32)
    shown = visible(cameras, solid, thing, fixed, owner, loose, frame)
    some = np.flatnonzero(shown.mean(axis=1) >= 0.25)
    return Exposures(
        frame[some], thing[some], shown[some], local[keep][some], height[keep][some], solid[some]
    )


def bearing_of(exposures: Exposures, track: Track) -> Floats64:
    """Return from which direction each thing is seen, radians in the map's plane, (p,)."""
    centre = (exposures.solid[:, :2] + exposures.solid[:, 3:5]) / 2
    offset = track.places[exposures.frame, :2] - centre
    return np.arctan2(offset[:, 1], offset[:, 0])


def detect(
    world: World, track: Track, exposures: Exposures, wanted: int, rng: np.random.Generator
) -> tuple[Ints, Floats64]:
    """Choose about `wanted` of the exposures as detected; return them and each thing's ease (n,).

    Bigger, freer things are found more often; each has an ease of its own (heavy-tailed: the
    paper's busiest object has 369 of 2,558), and a wave of ease over viewpoints.
    """
    n = len(world.things)
    ease = rng.normal(0, 2.4, size=n)
    phase = rng.uniform(-np.pi, np.pi, size=(n, 4))
    bearing, thing = bearing_of(exposures, track), exposures.thing
    distance = np.linalg.norm(exposures.centre, axis=1)
    wave = sum(
        np.sin((k + 1) * bearing + (k + 1) * 1.3 * distance + phase[thing, k]) for k in range(4)
    )
    score = (
        ease[thing]
        + 1.2 * np.clip(np.log(exposures.height / 16.0), -2.0, 1.2)
        + 3.0 * (exposures.shown.mean(axis=1) - 0.7)
        + 0.9 * wave
    )
    draw = rng.random(len(score))
    low, high = -20.0, 20.0
    for _ in range(60):  # the offset that gives the wanted number of detections
        middle = (low + high) / 2
        if _sigmoid(score + middle).sum() < wanted:
            low = middle
        else:
            high = middle
    return np.flatnonzero(draw < _sigmoid(score + high)), ease


def report(
    world: World,
    track: Track,
    believed: Track,
    exposures: Exposures,
    wanted: int,
    condition: Condition,
    streams: dict[str, np.random.Generator],
) -> Reports:
    """Return what the detector says under a condition, frames in order, shuffled within a frame.

    The same seed detects the same things in the same frames under every condition.
    """
    false = 0 if condition.perfect else round(condition.false_positives * wanted)
    found, ease = detect(
        world, track, exposures, wanted - round(0.04 * wanted), streams["detections"]
    )
    thing, frame = exposures.thing[found], exposures.frame[found]
    box = _boxes(track, exposures, found, streams["boxes"])
    local = _measured(exposures, found, box, condition, streams["depth"])
    category, fooled = _categories(world, thing, condition, streams["categories"])
    probability = _probabilities(exposures, found, ease, fooled, condition, streams["probability"])
    embedding = _histograms(world, track, exposures, found, box, condition, streams["colours"])
    made = _false_positives(world, frame, false, condition, streams["false"])
    category += made.category
    frame = np.concatenate([frame, made.frame])
    local = np.concatenate([local, made.position])
    order = np.lexsort((streams["order"].random(len(frame)), frame))
    place = believed.places[frame] + np.einsum("pij,pj->pi", axes(believed.yaw)[frame], local)
    return Reports(
        thing=np.concatenate([thing, made.thing])[order],
        frame=frame[order],
        category=[category[k] for k in order],
        probability=np.concatenate([probability, made.probability])[order],
        box=np.concatenate([box, made.box])[order],
        position=place[order],
        embedding=np.concatenate([embedding, made.embedding])[order],
    )


def _sigmoid(x: Floats64) -> Floats64:
    return np.asarray(1.0 / (1.0 + np.exp(-x)))


def _boxes(track: Track, exposures: Exposures, found: Ints, rng: np.random.Generator) -> Floats64:
    """Return the boxes (d, 4) around the part in sight, edges shaken by a twentieth."""
    uv = pixels(seen_from(track, exposures.frame[found], corners(exposures.solid[found])))
    low, high = uv.min(axis=1), uv.max(axis=1)
    shown = exposures.shown[found].reshape(len(found), len(VERTICAL), len(LATERAL))
    left, right = _extent(np.asarray(shown.any(axis=1)))
    bottom, top = _extent(np.asarray(shown.any(axis=2)))
    size = high - low
    box = np.column_stack(
        [
            low[:, 0] + left * size[:, 0],
            high[:, 1] - top * size[:, 1],
            low[:, 0] + right * size[:, 0],
            high[:, 1] - bottom * size[:, 1],
        ]
    )
    box += rng.normal(0, 0.03, size=box.shape) * np.tile(size, 2)
    return _inside(box)


def _extent(shown: NDArray[np.bool_]) -> tuple[Floats64, Floats64]:
    """Return where the shown cells (d, k) begin and end, as shares of the whole."""
    cells = shown.shape[1]
    first = shown.argmax(axis=1)
    last = cells - shown[:, ::-1].argmax(axis=1)
    return first / cells, last / cells


def _inside(box: Floats64) -> Floats64:
    """Clip boxes to the picture and keep them at least 2 pixels wide and high."""
    width, height = CAMERA.width, CAMERA.height
    low = np.clip(box[:, :2], 0, (width - 3, height - 3))
    high = np.clip(box[:, 2:], low + 2, (width, height))
    return np.concatenate([low, high], axis=1)


def _measured(
    exposures: Exposures, found: Ints, box: Floats64, condition: Condition, rng: np.random.Generator
) -> Floats64:
    """Return where the depth camera puts each thing in the optical frame: its near side, (d, 3)."""
    centre = exposures.centre[found]
    size = exposures.solid[found, 3:] - exposures.solid[found, :3]
    depth = centre[:, 2] - 0.3 * size[:, :2].min(axis=1)
    depth = np.maximum(depth * (1 + condition.depth * rng.normal(size=len(found))), 0.1)
    return np.asarray(_sight_lines(box) * depth[:, None])


def _sight_lines(box: Floats64) -> Floats64:
    """Return the ray of unit depth through the middle of each box, (d, 3), optical frame."""
    u, v = (box[:, 0] + box[:, 2]) / 2, (box[:, 1] + box[:, 3]) / 2
    return np.stack([(u - CAMERA.cx) / CAMERA.fx, (v - CAMERA.cy) / CAMERA.fy, np.ones(len(u))], 1)


def _categories(
    world: World, thing: Ints, condition: Condition, rng: np.random.Generator
) -> tuple[list[str], NDArray[np.bool_]]:
    """Return what each is taken for, and which were taken for something else."""
    draw, pick = rng.random(len(thing)), rng.random(len(thing))
    fooled = draw < (0.0 if condition.perfect else condition.confusion)
    names = []
    for k, wrong, p in zip(thing, fooled, pick, strict=True):
        true = world.things[k].category
        others = CONFUSABLE.get(true, (true,))  # of an arranged world's own kinds none is
        names.append(others[int(p * len(others))] if wrong else true)
    return names, fooled


def _probabilities(
    exposures: Exposures,
    found: Ints,
    ease: Floats64,
    fooled: NDArray[np.bool_],
    condition: Condition,
    rng: np.random.Generator,
) -> Floats64:
    """Return how sure the detector is: 0.7 to 1, median about .93 as in the paper's sample."""
    own = 0.6 * ease + 1.0 * rng.normal(size=len(ease))
    noise = rng.normal(size=len(found))
    if condition.certain:
        return np.ones(len(found))
    clear = 2.0 * (exposures.shown[found].mean(axis=1) - 0.8)
    sure = 1.0 + clear + 0.9 * noise - 1.0 * fooled
    if condition.skewed:
        sure = sure + own[exposures.thing[found]]
    return np.round(0.7 + 0.299 * _sigmoid(sure), 3)


def _light(track: Track, frame: Ints, strength: float, rng: np.random.Generator) -> Floats64:
    """Return the light's factor on R, G, B of each detection, (d, 3): by place, frame and crop."""
    cell = (track.places[:, :2] // 2.0).astype(int)
    lamp = rng.normal(size=(8, 8))
    by_frame = 0.10 * lamp[cell[:, 0] % 8, cell[:, 1] % 8] + 0.08 * rng.normal(size=len(cell))
    own = 0.06 * rng.normal(size=len(frame))
    tint = 0.03 * rng.normal(size=(len(frame), 3))
    return np.asarray(np.exp(strength * ((by_frame[frame] + own)[:, None] + tint)))


def _behind(
    exposures: Exposures, found: Ints, bearing: Floats64, strength: float, rng: np.random.Generator
) -> Floats64:
    """Return the background's colour of each crop, (d, 3): the same from the same side."""
    materials = np.array(
        [[150, 112, 74], [205, 200, 190], [96, 98, 104], [176, 150, 112], [222, 218, 208]]
    )
    cell = ((exposures.solid[found, :2] + exposures.solid[found, 3:5]) / 2 // 1.5).astype(int)
    sector = ((bearing + np.pi) / (np.pi / 3)).astype(int) % 6
    usual = rng.dirichlet((0.3,) * len(materials))  # a home has a style
    under = rng.choice(len(materials), p=usual, size=(8, 10))[cell[:, 0] % 8, cell[:, 1] % 10]
    wall = rng.choice(len(materials), p=usual, size=(8, 10, 6))
    wall = wall[cell[:, 0] % 8, cell[:, 1] % 10, sector]
    mixed = 0.6 * materials[under] + 0.4 * materials[wall]
    return np.asarray(mixed + strength * rng.normal(0, 12, size=mixed.shape))


def _histograms(
    world: World,
    track: Track,
    exposures: Exposures,
    found: Ints,
    box: Floats64,
    condition: Condition,
    rng: np.random.Generator,
) -> NDArray[np.float32]:
    thing, frame = exposures.thing[found], exposures.frame[found]
    bearing = bearing_of(exposures, track)[found]
    free = exposures.shown[found].mean(axis=1)
    behind = _behind(exposures, found, bearing, condition.colour, rng)
    spread = 0.08 * condition.colour * rng.normal(size=len(found))
    cover = np.clip(0.34 + 0.40 * free + spread, 0.15, 0.9)
    colours, shares = appearance.mixtures(world.looks, thing, bearing, cover, behind)
    gain = _light(track, frame, condition.colour, rng)
    return appearance.histograms(colours, shares, gain, _areas(box), rng)


def _areas(box: Floats64) -> Ints:
    sides = np.maximum(box[:, 2:] - box[:, :2], 1)
    return np.asarray(np.round(sides.prod(axis=1)), dtype=np.intp)


def _false_positives(
    world: World, frames: Ints, count: int, condition: Condition, rng: np.random.Generator
) -> Reports:
    """Return detections of nothing, in frames that have others; positions in the optical frame.

    A category as common as its things, somewhere in the picture at 1 to 4.5 m, looking like
    paint and background by chance.
    """
    frame = rng.choice(frames, size=count)
    like = rng.integers(len(world.things), size=count)
    depth = rng.uniform(1.0, 4.5, size=count)
    u, v = rng.uniform(20, CAMERA.width - 20, count), rng.uniform(30, CAMERA.height - 20, count)
    half = 0.5 * CAMERA.fx * world.sizes[like][:, 1:] / depth[:, None]
    box = _inside(np.column_stack([u - half[:, 0], v - half[:, 1], u + half[:, 0], v + half[:, 1]]))
    sight = _sight_lines(box)
    cover = rng.uniform(0.2, 0.6, size=count)
    colours, shares = appearance.mixtures(
        world.looks,
        rng.integers(len(world.things), size=count),
        rng.uniform(-np.pi, np.pi, size=count),
        cover,
        rng.uniform(60, 220, size=(count, 3)),
    )
    gain = np.exp(0.15 * rng.normal(size=(count, 1))) * np.ones((1, 3))
    sure = _sigmoid(rng.normal(0.0, 1.0, size=count) + (0.0 if condition.skewed else 0.5))
    return Reports(
        thing=np.full(count, -1),
        frame=frame,
        category=[world.things[k].category for k in like],
        probability=np.round(0.7 + 0.299 * sure, 3),
        box=box,
        position=sight * depth[:, None],
        embedding=appearance.histograms(colours, shares, gain, _areas(box), rng),
    )
