"""Pictures of solids, by Mitsuba 3 (extra `sim`): the colours, and what each pixel shows and where.

The light is one bright spot in an even, neutral white sky over rooms without ceilings, so that
colours come out as they are named and shadows are soft. Mitsuba's variant `scalar_rgb` runs
everywhere; `llvm_ad_rgb` needs a shared library of LLVM 16 or newer and is some 30 times as fast.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from assistant.home.denoise import denoised
from assistant.home.meshes import Floats, joined
from assistant.home.model import Model
from assistant.home.patrol import Glance
from d3a.model import Camera

SAMPLES_PER_PASS = 32  # bounds the memory of the vectorised variants
EXPOSURE = 1.45
SHOULDER = 0.6


@dataclass(frozen=True, slots=True)
class Light:
    """The sky: an even radiance, and a soft spot by its bearing, height (degrees) and strength."""

    even: float
    bearing: float
    height: float
    spot: float

    def panorama(self) -> NDArray[np.float32]:
        """Return the sky as (32, 64, 3), rows from the zenith to the nadir."""
        height = np.radians(90 - (np.arange(32)[:, None] + 0.5) * 180 / 32)
        bearing = np.radians((np.arange(64)[None, :] + 0.5) * 360 / 64)
        cosine = np.sin(height) * np.sin(np.radians(self.height)) + np.cos(height) * np.cos(
            np.radians(self.height)
        ) * np.cos(bearing - np.radians(self.bearing))
        # No light comes in below the walls' upper edge; a dark rim saves the paths sent there.
        above = np.clip((np.degrees(height) - 12.0) / 20.0, 0.0, 1.0)
        grey = above * (self.even + self.spot * np.exp(18.0 * (cosine - 1.0)))
        return np.repeat(grey[..., None], 3, axis=-1).astype(np.float32)


@dataclass(frozen=True, eq=False)
class Shot:
    """A picture and its buffers, all (height, width).

    colour: (h, w, 3), sRGB. owner: the name's row in the stage's names, -1 for the building.
    points: (h, w, 3), where the pixel's surface lies in the map frame.
    """

    colour: NDArray[np.uint8]
    owner: NDArray[np.int64]
    points: Floats


class Stage:
    """The home at one moment, ready to be photographed.

    building: what is drawn but belongs to no name. models: the named things' solids, in map frame.
    """

    def __init__(
        self, building: Model, models: Mapping[str, Model], light: Light, *, variant: str
    ) -> None:
        # The extra `sim`: who only reads the shipped recording does not have it.
        import drjit
        import mitsuba

        mitsuba.set_variant(variant)
        self._drjit: Any = drjit
        self._mitsuba: Any = mitsuba
        self.names = tuple(models)
        scene: dict[str, Any] = {"type": "scene", "sky": self._sky(light)}
        surfaces = {shiny: self._surface(shiny=shiny) for shiny in (False, True)}
        owners: dict[str, int] = {}
        for owner, model in enumerate((building, *models.values()), start=-1):
            for shiny in (False, True):
                parts = tuple(part for part in model if part.shiny is shiny)
                if parts:
                    key = f"solid{len(owners):04d}"
                    scene[key] = self._solid(key, parts, surfaces[shiny])
                    owners[key] = owner
        self._scene: Any = mitsuba.load_dict(scene)
        self._owner_of = self._owner_table(owners, scalar=variant.startswith("scalar"))
        buffers = {
            "type": "aov",
            "aovs": "paint:albedo,normal:sh_normal,point:position,shape:shape_index",
        }
        self._buffers: Any = mitsuba.load_dict(buffers)
        self._path: Any = mitsuba.load_dict({"type": "path", "max_depth": 5})

    def shoot(self, glance: Glance, camera: Camera, *, samples: int, seed: int) -> Shot:
        """Return the picture from a glance: `samples` light paths a pixel, seeded."""
        sensor = self._sensor(glance, camera)
        buffers = np.array(
            self._mitsuba.render(
                self._scene, sensor=sensor, integrator=self._buffers, spp=1, seed=seed
            )
        )
        radiance = self._radiance(sensor, samples, seed)
        paint, normal, points = (buffers[..., i : i + 3] for i in (-10, -7, -4))
        owner = self._owner_of[np.rint(buffers[..., -1]).astype(np.int64)]
        colour = _encoded(denoised(radiance, paint, normal) * EXPOSURE)
        return Shot(colour, owner, np.asarray(points, dtype=np.float64))

    def _radiance(self, sensor: Any, samples: int, seed: int) -> Floats:
        """Return linear light (h, w, 3), the mean of passes of at most SAMPLES_PER_PASS."""
        passes = max(1, round(samples / SAMPLES_PER_PASS))
        images = []
        for number in range(passes):
            image = self._mitsuba.render(
                self._scene,
                sensor=sensor,
                integrator=self._path,
                spp=max(1, samples // passes),
                seed=seed * 1000 + number + 1,
            )
            images.append(np.array(image, dtype=np.float64)[..., :3])
        return np.asarray(np.mean(images, axis=0))

    def _sky(self, light: Light) -> dict[str, Any]:
        upright = self._mitsuba.ScalarTransform4f().rotate([1, 0, 0], 90)
        bitmap = self._mitsuba.Bitmap(light.panorama())
        return {"type": "envmap", "bitmap": bitmap, "to_world": upright}

    def _surface(self, *, shiny: bool) -> Any:
        painted = {"type": "mesh_attribute", "name": "vertex_color"}
        inner: dict[str, Any] = {"type": "diffuse", "reflectance": painted}
        if shiny:  # a thin gloss; the plug-ins with Fresnel's law take no colours from a mesh
            gloss = {"type": "roughconductor", "material": "none", "alpha": 0.16}
            inner = {"type": "blendbsdf", "weight": 0.07, "paint": inner, "gloss": gloss}
        return self._mitsuba.load_dict({"type": "twosided", "inner": inner})

    def _solid(self, name: str, parts: Model, surface: Any) -> Any:
        mesh = joined(part.mesh for part in parts)
        normals = np.concatenate([part.mesh.normals() for part in parts])
        colours = np.concatenate(
            [np.tile(part.reflectance(), (len(part.mesh.vertices), 1)) for part in parts]
        )
        properties = self._mitsuba.Properties()
        properties["bsdf"] = surface
        properties.set_id(name)
        solid = self._mitsuba.Mesh(
            name, len(mesh.vertices), len(mesh.faces), has_vertex_normals=True, props=properties
        )
        solid.add_attribute("vertex_color", 3, colours.astype(np.float32).ravel())
        buffers = self._mitsuba.traverse(solid)
        buffers["vertex_positions"] = mesh.vertices.astype(np.float32).ravel()
        buffers["vertex_normals"] = normals.astype(np.float32).ravel()
        buffers["faces"] = mesh.faces.astype(np.uint32).ravel()
        buffers.update()
        return solid

    def _owner_table(self, owners: Mapping[str, int], *, scalar: bool) -> NDArray[np.int64]:
        """Return the owner by the number that the renderer gives a shape; -1 for no shape."""
        numbers = {}
        for row, shape in enumerate(self._scene.shapes()):
            number = row + 1
            if not scalar:  # vectorised variants number shapes by their registry
                pointer = self._mitsuba.ShapePtr(shape)
                number = int(self._drjit.reinterpret_array(self._mitsuba.UInt32, pointer)[0])
            numbers[number] = owners[shape.id()]
        table = np.full(max(numbers) + 1, -1, dtype=np.int64)
        table[list(numbers)] = list(numbers.values())
        return table

    def _sensor(self, glance: Glance, camera: Camera) -> Any:
        view = self._mitsuba.ScalarTransform4f().look_at(
            origin=list(glance.eye), target=list(glance.target), up=[0, 0, 1]
        )
        across = float(2 * np.degrees(np.arctan(camera.width / 2 / camera.fx)))
        film = {
            "type": "hdrfilm",
            "width": camera.width,
            "height": camera.height,
            "rfilter": {"type": "box"},
        }
        return self._mitsuba.load_dict(
            {
                "type": "perspective",
                "fov": across,
                "fov_axis": "x",
                "to_world": view,
                "near_clip": 0.05,
                "film": film,
                "sampler": {"type": "independent"},
            }
        )


def _encoded(radiance: Floats) -> NDArray[np.uint8]:
    """Return linear light as sRGB bytes."""
    # Above SHOULDER the light is compressed, so that white things keep their shading.
    room = 1.0 - SHOULDER
    over = np.maximum(radiance - SHOULDER, 0.0)
    light = np.minimum(radiance, SHOULDER) + room * (1.0 - np.exp(-over / room))
    encoded = np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.asarray(np.rint(encoded * 255).astype(np.uint8))
