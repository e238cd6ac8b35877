"""Reflectance of a scene's materials as one number per channel, for programs that know matte surfaces only."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .. import _abi

if TYPE_CHECKING:
    from ..scene import Scene

#: Directions of the quadrature, and samples of the facets along both axes for each. [convention]
DIRECTIONS, FACETS = 24, 32
#: A metal or a coat smoother than this shows mirror images, which a matte surface does not. [convention]
GLOSSY = 0.3


def reflectance(scene: Scene, index: int) -> NDArray[np.float64]:
    """Hemispherical reflectance of a material under diffuse light, per linear Rec.709 channel; of textures the mean."""
    material = scene.material(index)
    base = np.asarray(material["base_color"], float) * _texture_mean(scene, index)
    metallic, transmission = float(material["metallic"]), float(material["transmission"])
    ior = float(material["ior"])
    f0 = ((ior - 1) / (ior + 1)) ** 2
    scale, bias = _top_layer(round(float(material["roughness"]), 4))
    coat = (f0 * scale + bias) if f0 > 0 else 0.0
    matte = coat + (1 - coat) * (1 - transmission) * base
    return np.clip((1 - metallic) * matte + metallic * (base * scale + bias), 0, 1)


def is_glossy(scene: Scene, index: int) -> bool:
    """Whether a material mirrors so sharply that a matte surface is no good substitute."""
    material = scene.material(index)
    return float(material["metallic"]) > 0.1 and float(material["roughness"]) < GLOSSY


def _texture_mean(scene: Scene, index: int) -> NDArray[np.float64]:
    """Mean colour of the base colour texture; 1 without one."""
    use = scene.material_texture(index, "base-color")
    if use.texture == _abi.LUXFER_NONE:
        return np.ones(3)
    pixels = scene.texture(use.texture).numpy().astype(float)
    mean = pixels.reshape(-1, pixels.shape[2]).mean(axis=0)
    return mean[:3] if len(mean) >= 3 else np.full(3, mean[0])


@lru_cache(maxsize=256)
def _top_layer(roughness: float) -> tuple[float, float]:
    """Scale and bias of the mean reflectance f0 · scale + bias of GGX facets under diffuse light."""
    alpha = max(roughness * roughness, 1e-4)
    cosines = (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
    u = (np.arange(FACETS) + 0.5) / FACETS
    u1, u2 = (v.reshape(-1) for v in np.meshgrid(u, u))
    means = np.array([_directional(c, alpha, u1, u2) for c in cosines])
    scale, bias = (2 * (means * cosines[:, None]).sum(axis=0) / DIRECTIONS).tolist()
    return scale, bias


def _directional(cosine: float, alpha: float, u1: NDArray, u2: NDArray) -> tuple[float, float]:
    """Scale and bias for one direction, by sampling of visible facets (Heitz 2018)."""
    view = np.array([np.sqrt(1 - cosine * cosine), 0.0, cosine])
    stretched = np.array([alpha * view[0], 0.0, view[2]])
    stretched /= np.linalg.norm(stretched)
    r, phi = np.sqrt(u1), 2 * np.pi * u2
    first, second = r * np.cos(phi), r * np.sin(phi)
    s = 0.5 * (1 + stretched[2])
    second = (1 - s) * np.sqrt(np.maximum(0, 1 - first**2)) + s * second
    third = np.sqrt(np.maximum(0, 1 - first**2 - second**2))
    # The frame around the stretched view: its first axis is y, its second lies in the plane of the view.
    side = np.array([-stretched[2], 0.0, stretched[0]])
    normal = np.outer(second, side) + np.outer(third, stretched)
    normal[:, 1] += first
    facet = np.stack([alpha * normal[:, 0], alpha * normal[:, 1], np.maximum(normal[:, 2], 1e-9)], axis=1)
    facet /= np.linalg.norm(facet, axis=1)[:, None]
    along = facet @ view
    out = 2 * along * facet[:, 2] - view[2]
    tangent = np.where(out > 0, (1 - out**2) / np.maximum(out, 1e-9) ** 2, np.inf)
    seen = np.where(out > 0, 2 / (1 + np.sqrt(1 + alpha * alpha * tangent)), 0.0)
    grazing = (1 - np.clip(along, 0, 1)) ** 5
    return float((seen * (1 - grazing)).mean()), float((seen * grazing).mean())
