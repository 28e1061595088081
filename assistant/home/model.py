"""What is drawn: a `Part` is one mesh in one colour, a `Model` a thing made of parts."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from assistant.home.meshes import Floats, Mesh


@dataclass(frozen=True, eq=False)
class Part:
    """One solid in one colour (#rrggbb, as seen in even white light), dull or shiny."""

    mesh: Mesh
    colour: str
    shiny: bool = False

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Part:
        """Return the part shifted by metres."""
        return replace(self, mesh=self.mesh.moved(x, y, z))

    def turned(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Part:
        """Return the part turned about x, then y, then z, by degrees."""
        return replace(self, mesh=self.mesh.turned(x, y, z))

    def reflectance(self) -> Floats:
        """Return the colour as linear red, green, blue reflectances (3,)."""
        encoded = np.array([int(self.colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
        return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


Model = tuple[Part, ...]


def placed(model: Model, position: tuple[float, float, float], yaw: float = 0.0) -> Model:
    """Return the model turned about z by `yaw` degrees, its origin set down at `position`."""
    return tuple(part.turned(z=yaw).moved(*position) for part in model)


def middle(model: Model) -> tuple[float, float, float]:
    """Return the centre of the box around a placed model, x, y, z in metres."""
    corners = np.concatenate([part.mesh.vertices for part in model])
    x, y, z = (corners.min(axis=0) + corners.max(axis=0)) / 2
    return float(x), float(y), float(z)
