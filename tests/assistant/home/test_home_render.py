"""The demo home's script: its solids, its diary, its rounds, and a tiny recording rendered."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from assistant.home.denoise import denoised
from assistant.home.inventory import inventory
from assistant.home.life import NOW
from assistant.home.meshes import Mesh, body, box, cylinder, lathe, ring, rotation, tube
from assistant.home.patrol import CAMERA, believed, glances
from assistant.home.plan import SURFACES, room_at
from d3a.geometry import project
from d3a.model import Camera

TINY = Camera(width=48, height=36, fx=40.0, fy=40.0, cx=24.0, cy=18.0)

with_renderer = pytest.mark.skipif(
    find_spec("mitsuba") is None, reason="the renderer is the extra `sim`, which is not installed"
)


def test_things_stand_on_surfaces_inside_rooms_and_none_inside_another() -> None:
    for moment in {since for thing in inventory() for since, _ in thing.stays}:
        spots: dict[tuple[float, float, float], str] = {}
        for thing in inventory():
            place = thing.place_at(moment)
            if place is None:
                continue
            assert place.surface in SURFACES
            x, y, z = place.position()
            assert room_at(x, y)
            key = (round(x, 2), round(y, 2), round(z, 2))
            assert key not in spots, f"{thing.name} and {spots.get(key)} share a place at {moment}"
            spots[key] = thing.name


def test_every_stay_begins_after_the_one_before() -> None:
    for thing in inventory():
        times = [since for since, _ in thing.stays]
        assert times == sorted(set(times)), thing.name
        assert times[-1] < NOW


def volume(mesh: Mesh) -> float:
    corners = mesh.vertices[mesh.faces]
    across = np.cross(corners[:, 1], corners[:, 2])
    return float(np.einsum("ij,ij->", corners[:, 0], across) / 6)


def test_solids_are_closed_face_outwards_and_have_their_volume() -> None:
    assert volume(box(1, 2, 3)) == pytest.approx(6)
    assert volume(cylinder(1, 1)) == pytest.approx(np.pi, rel=0.01)
    assert volume(cylinder(1, 1, top=0.5)) == pytest.approx(np.pi * 1.75 / 3, rel=0.01)
    assert volume(body(2, 2, 2)) == pytest.approx(4 * np.pi / 3, rel=0.03)
    assert volume(body(2, 2, 2, roundness=0.1)) == pytest.approx(8, rel=0.12)
    assert volume(ring(1, 0.1)) == pytest.approx(2 * np.pi**2 * 0.01, rel=0.1)
    assert volume(tube([[0, 0, 0], [3, 0, 0]], 0.5)) == pytest.approx(np.pi * 0.75, rel=0.1)
    hollow = lathe([(0, 0), (1, 0), (1, 1), (0.9, 1), (0.9, 0.1), (0, 0.1)])
    assert volume(hollow) == pytest.approx(np.pi * (1 - 0.81 * 0.9), rel=0.02)


def test_rotation_turns_x_first_then_y_then_z() -> None:
    assert rotation(z=90) @ [1, 0, 0] == pytest.approx(np.array([0, 1, 0]), abs=1e-12)
    assert rotation(x=90) @ [0, 1, 0] == pytest.approx(np.array([0, 0, 1]), abs=1e-12)
    assert rotation(x=90, z=90) @ [0, 1, 0] == pytest.approx(np.array([0, 0, 1]), abs=1e-12)


def test_patrol_is_drawn_from_its_seed_and_the_camera_looks_at_its_target() -> None:
    first, again = (glances(np.random.default_rng(5)) for _ in range(2))
    assert first == again
    assert first != glances(np.random.default_rng(6))
    for glance in first[0]:
        axes = glance.axes
        assert axes.T @ axes == pytest.approx(np.eye(3), abs=1e-9)
        assert np.linalg.det(axes) == pytest.approx(1)
        pose = believed(glance, np.random.default_rng(0)).pose()
        seen = project(np.array([glance.target]), pose, CAMERA)
        assert seen.u == pytest.approx(np.array([CAMERA.cx]), abs=25)
        assert seen.v == pytest.approx(np.array([CAMERA.cy]), abs=25)


@with_renderer
def test_script_renders_a_tiny_recording_again_alike(tmp_path: Path) -> None:
    from assistant.home.render import Settings, render_recording

    settings = Settings(samples=1, camera=TINY, frames=2)
    folders = [tmp_path / name for name in ("first", "again")]
    for folder in folders:
        assert render_recording(folder, settings) == 2
    written = [
        {
            path.relative_to(folder): path.read_bytes()
            for path in folder.rglob("*")
            if path.is_file()
        }
        for folder in folders
    ]
    assert written[0] == written[1]
    names = {str(path) for path in written[0]}
    assert names >= {"recording.json", "frames.jsonl", "detections.jsonl", "truth.jsonl"}
    assert names >= {"map.yaml", "map.png", "images/000000.jpg", "images/000001.jpg"}


@with_renderer
def test_buffers_say_which_thing_a_pixel_shows_and_where_it_is() -> None:
    from assistant.home.picture import Light, Stage
    from assistant.home.plan import building

    glance = glances(np.random.default_rng(5))[0][1]  # the hall shelf with its vase
    present = {t.name: t.model_at(glance.time) for t in inventory() if t.place_at(glance.time)}
    light = Light(even=1.0, bearing=0, height=80, spot=1.0)
    stage = Stage(building(daylight=True), present, light, variant="scalar_rgb")
    shot = stage.shoot(glance, TINY, samples=1, seed=1)
    points = (shot.points - np.array(glance.eye)) @ glance.axes
    columns = TINY.fx * points[..., 0] / points[..., 2] + TINY.cx
    rows = TINY.fy * points[..., 1] / points[..., 2] + TINY.cy
    assert np.abs(columns - (np.arange(TINY.width) + 0.5)).max() < 0.51
    assert np.abs(rows - (np.arange(TINY.height)[:, None] + 0.5)).max() < 0.51
    vase = shot.points[shot.owner == stage.names.index("vase-1")]
    assert len(vase) > 5
    corners = np.concatenate([part.mesh.vertices for part in present["vase-1"]])
    assert (vase >= corners.min(axis=0) - 1e-4).all()
    assert (vase <= corners.max(axis=0) + 1e-4).all()


def test_denoising_takes_the_grain_and_leaves_the_edges() -> None:
    rng = np.random.default_rng(2)
    paint = np.full((60, 80, 3), 0.6)
    paint[:, 40:] = 0.1
    normal = np.zeros((60, 80, 3))
    normal[..., 2] = 1.0
    grainy = paint + rng.normal(scale=0.05, size=paint.shape) * paint
    smooth = denoised(grainy, paint, normal)
    for side in (slice(0, 39), slice(41, 80)):
        before, after = (image[:, side] - paint[:, side] for image in (grainy, smooth))
        assert after.std() < before.std() / 3
        assert abs(after.mean()) < before.std() / 10
    assert smooth[:, 39:41] == pytest.approx(grainy[:, 39:41])  # the edge's pixels as they were
