"""Render the demo home's recording: `python -m assistant.home.render OUT` (extra `sim`).

Writes a folder of the form `recording`: pictures of the robot's rounds, what a noisy synthetic
detector makes of them, a map, and the truth. The same arguments give the same folder. The one that
ships with the product is rendered with the defaults and `--variant llvm_ad_rgb`; another variant
gives the same scenes and truth, but other grain and so slightly other bytes.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from assistant.home.inventory import inventory
from assistant.home.life import NOW, ZONE, Thing
from assistant.home.meshes import Floats
from assistant.home.model import Model, middle
from assistant.home.patrol import CAMERA, Belief, Glance, believed, glances
from assistant.home.picture import Light, Shot, Stage
from assistant.home.plan import CELL_M, MAP_MARGIN_M, ROOMS, building, occupancy, room_at
from d3a.detectors.synthetic import DetectorNoise, Sighted, SyntheticDetector, VisibleObject
from d3a.geometry import quaternion
from d3a.model import Box, Camera, Position

Json = dict[str, Any]

NEVER_SEEN = (
    "bicycle",
    "umbrella",
    "pizza",
    "dog",
    "cat",
    "toothbrush",
    "suitcase",
    "tie",
    "fork",
    "knife",
)
"""Categories that the detector knows and the home does not have, for honest answers."""

MIN_PIXELS = 24
LIGHTS = (
    Light(even=1.15, bearing=200, height=66, spot=5.0),
    Light(even=1.2, bearing=100, height=75, spot=5.0),
    Light(even=1.05, bearing=20, height=82, spot=4.0),
)
EVENING_HOUR = 18


@dataclass(frozen=True, slots=True)
class Settings:
    """How to render: `samples` light paths a pixel, JPEG quality, seed, the renderer's variant."""

    samples: int = 32
    quality: int = 70
    seed: int = 7
    variant: str = "scalar_rgb"
    camera: Camera = CAMERA
    frames: int | None = None


def render_recording(folder: Path, settings: Settings) -> int:
    """Write the whole recording to `folder`, which may exist; return its number of frames."""
    (folder / "images").mkdir(parents=True, exist_ok=True)
    things = inventory()
    frames: list[Json] = []
    rows: list[Json] = []
    sources: list[str | None] = []
    poses: list[Json] = []
    for glance, shot, models in _shots(things, settings):
        rng = np.random.default_rng([settings.seed, int(glance.name)])
        belief = believed(glance, rng)
        image = f"images/{glance.name}.jpg"
        _write_jpeg(folder / image, shot.colour, settings.quality)
        frames.append(_frame_record(glance, belief, image))
        poses.append({"frame": glance.name, "pose": _pose_numbers(glance.eye, glance.axes)})
        for sighted in _detect(things, models, glance, shot, belief, settings.camera, rng):
            rows.append(_detection_record(glance.name, sighted))
            sources.append(sighted.source)
    _write_lines(folder / "frames.jsonl", frames)
    _write_lines(folder / "detections.jsonl", rows)
    _write_lines(folder / "truth.jsonl", _truth(things, sources))
    _write_lines(folder / "truth-poses.jsonl", poses)
    _write_map(folder, things)
    _write_json(folder / "recording.json", _header(things, settings.camera))
    return len(frames)


def _shots(
    things: Sequence[Thing], settings: Settings
) -> Iterator[tuple[Glance, Shot, dict[str, Model]]]:
    """Yield each frame with its picture and the models of what was in the home then."""
    remaining = settings.frames
    for number, taken in enumerate(glances(np.random.default_rng(settings.seed))):
        moment = taken[0].time
        models = {thing.name: thing.model_at(moment) for thing in things}
        present = {name: model for name, model in models.items() if model}
        house = building(daylight=moment.hour < EVENING_HOUR)
        stage = Stage(house, present, LIGHTS[number % 3], variant=settings.variant)
        for glance in taken if remaining is None else taken[:remaining]:
            seed = settings.seed + int(glance.name)
            shot = stage.shoot(glance, settings.camera, samples=settings.samples, seed=seed)
            yield glance, shot, present
        if remaining is not None:
            remaining -= min(remaining, len(taken))
            if not remaining:
                return


def _detect(
    things: Sequence[Thing],
    models: dict[str, Model],
    glance: Glance,
    shot: Shot,
    belief: Belief,
    camera: Camera,
    rng: np.random.Generator,
) -> tuple[Sighted, ...]:
    """Return what the noisy detector finds in a picture, with positions from its depth."""
    seen_from_eye = (shot.points - np.array(glance.eye)) @ glance.axes  # the optical frame
    categories = {thing.name: thing.category for thing in things}
    visible = []
    for owner, name in enumerate(models):
        pixels = shot.owner == owner
        if int(pixels.sum()) < MIN_PIXELS:
            continue
        box = _around(pixels)
        middle_of = seen_from_eye[pixels].mean(axis=0)
        visible.append(
            VisibleObject(
                name,
                categories[name],
                box,
                visible=_visible_share(models[name], box, glance, camera),
                distance_m=float(np.linalg.norm(middle_of)),
                position=_triple(belief.to_map(middle_of)),
            )
        )

    def surface(box: Box) -> Position | None:
        x, y = int((box[0] + box[2]) / 2), int((box[1] + box[3]) / 2)
        return _triple(belief.to_map(seen_from_eye[y, x]))

    detector = SyntheticDetector(DetectorNoise(), tuple(sorted(set(categories.values()))))
    return detector.detect(visible, camera, rng, surface)


def _triple(point: Floats) -> Position:
    x, y, z = (float(value) for value in point)
    return x, y, z


def _around(pixels: NDArray[np.bool_]) -> Box:
    """Return the box around the pixels that are set."""
    ys, xs = np.nonzero(pixels)
    return float(xs.min()), float(ys.min()), float(xs.max() + 1), float(ys.max() + 1)


def _visible_share(model: Model, box: Box, glance: Glance, camera: Camera) -> float:
    """Return the area of the visible box against that of the whole thing's, without occluders."""
    corners = np.concatenate([part.mesh.vertices for part in model])
    x, y, z = ((corners - np.array(glance.eye)) @ glance.axes).T
    z = np.maximum(z, 0.05)  # what is beside the camera counts as far out of the picture
    columns, rows = camera.fx * x / z, camera.fy * y / z
    whole = (columns.max() - columns.min()) * (rows.max() - rows.min())
    return float(min((box[2] - box[0]) * (box[3] - box[1]) / whole, 1.0))


def _pose_numbers(eye: Sequence[float] | Floats, axes: Floats) -> list[float]:
    return [round(float(value), 4) for value in (*eye, *quaternion(axes))]


def _frame_record(glance: Glance, belief: Belief, image: str) -> Json:
    covariance = belief.pose().covariance or ()
    return {
        "frame": glance.name,
        "time": glance.time.isoformat(timespec="milliseconds"),
        "pose": _pose_numbers(belief.eye, belief.axes),
        "pose_covariance": [float(f"{value:.3g}") or 0 for value in covariance],
        "image": image,
        "depth": None,
    }


def _detection_record(frame: str, sighted: Sighted) -> Json:
    found = sighted.detection
    return {
        "frame": frame,
        "category": found.category,
        "probability": round(found.probability, 3),
        "box": [round(edge, 1) for edge in found.box],
        "position": found.position and [round(value, 3) for value in found.position],
        "embedding": None,
    }


def _truth(things: Sequence[Thing], sources: Sequence[str | None]) -> list[Json]:
    """Return each thing's places, with the detections that it caused."""
    rows_of: dict[str, list[int]] = {thing.name: [] for thing in things}
    for row, source in enumerate(sources):
        if source is not None:
            rows_of[source].append(row)
    records = []
    for thing in things:
        ends = [*(since for since, _ in thing.stays[1:]), NOW]
        places = []
        for (start, place), end in zip(thing.stays, ends, strict=True):
            if place is None:
                continue
            x, y, z = middle(thing.model_at(start))
            places.append(
                {
                    "position": [round(x, 3), round(y, 3), round(z, 3)],
                    "start": start.isoformat(),
                    "end": end.isoformat(),
                    "region": room_at(x, y),
                    "on": place.surface,
                }
            )
        records.append(
            {
                "object": thing.name,
                "category": thing.category,
                "colour": thing.colour,
                "places": places,
                "detections": rows_of[thing.name],
            }
        )
    return records


def _header(things: Sequence[Thing], camera: Camera) -> Json:
    return {
        "schema": 1,
        "recording": "demo-home",
        "site": "home",
        "zone": ZONE,
        "camera": {
            **{"width": camera.width, "height": camera.height, "fx": camera.fx, "fy": camera.fy},
            **{"cx": camera.cx, "cy": camera.cy},
        },
        "embedding": None,
        "map": "map.yaml",
        "now": NOW.isoformat(),
        "regions": [{"name": room.name, "polygon": room.polygon()} for room in ROOMS],
        "classes": sorted({thing.category for thing in things} | set(NEVER_SEEN)),
    }


def _write_map(folder: Path, things: Sequence[Thing]) -> None:
    """Write map.yaml and map.png as ROS's map_server reads them; standing furniture is occupied."""
    from PIL import Image

    footprints = []
    for thing in things:
        if not thing.moves and thing.stays[0][1] is not None and thing.stays[0][1].z == 0:
            corners = np.concatenate(
                [part.mesh.vertices for part in thing.model_at(thing.stays[0][0])]
            )
            if corners[:, 2].min() < 0.3:
                (x1, y1, _), (x2, y2, _) = corners.min(axis=0), corners.max(axis=0)
                footprints.append((float(x1), float(y1), float(x2), float(y2)))
    Image.fromarray(occupancy(footprints)).save(folder / "map.png", optimize=True)
    text = (
        f"image: map.png\nresolution: {CELL_M}\norigin: [{-MAP_MARGIN_M}, {-MAP_MARGIN_M}, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    (folder / "map.yaml").write_text(text, encoding="utf-8")


def _write_jpeg(path: Path, colour: NDArray[np.uint8], quality: int) -> None:
    from PIL import Image

    Image.fromarray(colour).save(path, quality=quality, optimize=True, subsampling="4:2:0")


def _write_lines(path: Path, records: Sequence[Json]) -> None:
    lines = (json.dumps(record, separators=(",", ":")) for record in records)
    path.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")


def _write_json(path: Path, record: Json) -> None:
    path.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


def main(arguments: Sequence[str] | None = None) -> int:
    """Render the recording into the folder named on the command line."""
    default = Settings()
    parser = argparse.ArgumentParser(prog="python -m assistant.home.render", description=__doc__)
    parser.add_argument("folder", type=Path, help="where the recording goes")
    parser.add_argument("--samples", type=int, default=default.samples, help="light paths a pixel")
    parser.add_argument("--quality", type=int, default=default.quality, help="of the JPEGs, to 95")
    parser.add_argument("--seed", type=int, default=default.seed)
    parser.add_argument("--frames", type=int, help="stop after so many frames")
    parser.add_argument(
        "--variant",
        default=default.variant,
        help="Mitsuba's; llvm_ad_rgb is fast where DRJIT_LIBLLVM_PATH names LLVM 16 or newer",
    )
    given = parser.parse_args(arguments)
    settings = Settings(
        samples=given.samples,
        quality=given.quality,
        seed=given.seed,
        frames=given.frames,
        variant=given.variant,
    )
    render_recording(given.folder, settings)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
