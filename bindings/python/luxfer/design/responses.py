"""Linear responses: the illuminance of every point, and the glare of every observer, by each luminaire at full power.

Light is linear in the flux of the luminaires, so one set of paths for each point measures its light from all of them
at once (the library's Lamps), and every choice of dimmers is then a product of a matrix and a vector. The unified
glare rating of CIE 117 is not linear, but its parts are: the sum over luminaires is quadratic in the dimmers without
mixed terms, and the luminance of the background is linear. The emissive meshes of the scene are a constant part.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..lamps import Lamps
from ..scene import Scene
from .areas import PLANES
from .luminaires import dimmed, lit_scene
from .measure import UGR_FACTOR

if TYPE_CHECKING:
    from .areas import Area
    from .luminaires import Luminaire
    from .observers import Observers

#: Luminance of linear Rec.709 channels. [convention: BT.709]
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
#: Goals that one Lamps object takes.
MAX_GOALS = 64
#: Side in metres of the square that stands for a point. [convention]
POINT = 0.01
#: Paths that measure the background of glare, per luminaire and observer. [convention]
GLARE_SAMPLES = 1024
#: The factor of the sum in the unified glare rating. [convention: CIE 117]
UGR_SCALE = 0.25


@dataclass(frozen=True)
class Response:
    """Illuminance of an area's points: matrix @ dimmers + other."""

    area: Area
    matrix: NDArray[np.float64]
    """Lux (points, luminaires) of each luminaire at full power."""
    other: NDArray[np.float64]
    """Lux (points) of all other light of the scene."""

    def values(self, dimmers: NDArray[np.float64]) -> NDArray[np.float64]:
        """Initial illuminance of the points for dimmers."""
        return self.matrix @ dimmers + self.other

    @property
    def mean_other(self) -> float:
        """Mean illuminance by all other light."""
        return float(self.area.weights @ self.other)


@dataclass(frozen=True)
class GlareResponse:
    """Parts of the glare of observers."""

    observers: Observers
    sources: NDArray[np.float64]
    """L² ω / p² (observers, luminaires) of each luminaire at full power."""
    background: NDArray[np.float64]
    """Luminance of the background in cd/m² (observers, luminaires) by each luminaire at full power."""
    other_sources: NDArray[np.float64]
    """L² ω / p² (observers) of the emissive meshes of the scene."""
    other_background: NDArray[np.float64]
    """Luminance of the background in cd/m² (observers) by all other light of the scene."""

    def ugr(self, dimmers: NDArray[np.float64]) -> NDArray[np.float64]:
        """The unified glare rating of each observer for dimmers."""
        total = self.sources @ dimmers**2 + self.other_sources
        veil = self.background @ dimmers + self.other_background
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(total > 0, UGR_FACTOR * np.log10(UGR_SCALE * total / veil), -np.inf)


def respond(scene: Scene, luminaires: Sequence[Luminaire], area: Area, paths: int = 1024, seed: int = 1) -> Response:
    """The response of an area to each luminaire. The scene must not contain these luminaires yet, nor other punctual
    lights."""
    return respond_all(scene, luminaires, [area], paths, seed)[0]


def respond_all(
    scene: Scene,
    luminaires: Sequence[Luminaire],
    areas: Sequence[Area],
    paths: int = 1024,
    seed: int = 1,
) -> list[Response]:
    """The responses of several areas."""
    lit = all_on(scene, luminaires)
    return [respond_lit(lit, len(luminaires), area, paths, seed + index) for index, area in enumerate(areas)]


def all_on(scene: Scene, luminaires: Sequence[Luminaire], shape: str = "faces") -> Scene:
    """A copy of a scene with luminaires at full power, which are its only punctual lights. For shape, see lit_scene."""
    if scene.counts.lights:
        raise ValueError(f"the scene has {scene.counts.lights} punctual lights of its own: give them as luminaires")
    return lit_scene(scene, dimmed(luminaires, [1.0] * len(luminaires)), shape)


def respond_lit(lit: Scene, count: int, area: Area, paths: int, seed: int) -> Response:
    """The response of an area to all luminaires of a scene."""
    grids = []
    for patch in area.patches:
        across = POINT * patch.across / np.linalg.norm(patch.across)
        down = POINT * patch.down / np.linalg.norm(patch.down)
        for point in patch.points[patch.keep]:
            corner = point - 0.5 * (across + down)
            grids.append({"origin": corner, "across": across, "down": down, "normal": patch.normal})
    parts = [
        _goals(lit, count, grids[i : i + MAX_GOALS], paths, seed * 1000 + i) for i in range(0, len(grids), MAX_GOALS)
    ]
    matrix, other = np.concatenate([m for m, _ in parts]), np.concatenate([o for _, o in parts])
    if area.kind == "cylindrical":
        matrix = matrix.reshape(PLANES, -1, count).mean(axis=0)
        other = other.reshape(PLANES, -1).mean(axis=0)
    return Response(area, matrix, other)


def _goals(lit: Scene, count: int, grids: list[dict], paths: int, seed: int) -> tuple[NDArray, NDArray]:
    """Lux of a few points by each luminaire, and by all other light."""
    lamps = Lamps(lit.context)
    lamps.set_scene(lit, None)
    for grid in grids:
        lamps.add_grid(grid, 1.0)
    lamps.run(group="all", paths=paths, target_error=0.0, seed=seed)
    matrix = math.pi * (lamps.responses(len(grids), count) @ LUMINANCE)
    return matrix, np.array([lamps.goal(g).background_lux for g in range(len(grids))])


def respond_glare(
    scene: Scene, luminaires: Sequence[Luminaire], observers: Sequence[Observers], seed: int = 1
) -> list[GlareResponse]:
    """The parts of glare: of each luminaire, without the light of emissive meshes and of the environment, and of all
    other light."""
    eyes = np.concatenate([o.positions for o in observers])
    views = np.concatenate([o.directions for o in observers])
    other = glare_parts(scene, eyes, views, seed + len(luminaires))
    unlit = _unlit(scene)
    without = glare_parts(unlit, eyes, views, seed + len(luminaires))
    parts = np.zeros((2, len(eyes), len(luminaires)))
    for index, lamp in enumerate(dimmed(luminaires, [1.0] * len(luminaires))):
        parts[:, :, index] = np.maximum(glare_parts(lit_scene(unlit, [lamp]), eyes, views, seed + index) - without, 0)
    ends = np.cumsum([len(o.positions) for o in observers])[:-1]
    split = [np.split(part, ends) for part in (*parts, *other)]
    return [GlareResponse(o, *found) for o, *found in zip(observers, *split)]


def _unlit(scene: Scene) -> Scene:
    """A copy of a scene whose materials and environment emit nothing. Otherwise the noise of their light would enter
    the part of each luminaire."""
    copy = lit_scene(scene, [])
    for index in range(copy.counts.materials):
        copy.set_material(index, emission=(0, 0, 0))
    copy.set_environment((0, 0, 0))
    return copy


def glare_parts(
    scene: Scene, eyes: NDArray[np.float64], views: NDArray[np.float64], seed: int
) -> NDArray[np.float64]:
    """L² ω / p² of all sources in view of each eye, and the luminance of its background: (2, eyes)."""
    ratings = scene.glare(eyes, views, GLARE_SAMPLES, seed)
    sources, seen = np.zeros(len(eyes)), np.isfinite(ratings["ugr"])
    sources[seen] = 10 ** (ratings["ugr"][seen] / UGR_FACTOR) * ratings["background"][seen] / UGR_SCALE
    return np.stack([sources, ratings["background"]])
