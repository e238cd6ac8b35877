"""The scene to paint, as guides by the library or by Cycles: steps that render them, and the guides as arrays."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import luxfer
import numpy as np

from . import artworks, passes, work

Arrays = dict[str, np.ndarray]


class ByLibrary:
    """Guides of a scene of the library, with all extras."""

    def __init__(
        self, scene: luxfer.Scene, view: dict[str, Any], params: dict[str, Any], extras: str, groups: list[artworks.Group]
    ) -> None:
        self._scene, self._view, self._extras, self._groups = scene, view, extras, groups
        self._params = {**params, "camera": scene.add_camera(**view)}
        self._guides = luxfer.Guides(work.context(), scene)
        self.covers: list[np.ndarray] = []

    def steps(self) -> Generator[work.Step, Any, None]:
        yield self._guides.start(**self._params)
        if self._groups:
            width, height = self._params["width"], self._params["height"]
            covers = artworks.Covers(self._scene, self._view, width, height, self._groups)
            yield covers.job
            self.covers = covers.arrays()

    def add(self, stylize: luxfer.Stylize, source: luxfer.Guides) -> None:
        stylize.add_guides(source, self._guides, self._extras or 0)

    def arrays(self, source: luxfer.Guides, normals: bool = False) -> tuple[Arrays, Arrays]:
        """The guides of the exemplar and of the scene at a common exposure, with the extras."""
        extras = [name for name in self._extras.split("|") if name] + ["normals"] * normals
        light = passes.exposed(*(passes.light_of(guides) for guides in (source, self._guides)))
        for found, guides in zip(light, (source, self._guides)):
            found.update((name, guides.image(name).numpy()) for name in extras)
        return light[0], light[1]

    def close(self) -> None:
        pass


class ByCycles:
    """Guides by Cycles, which have neither edges nor normals."""

    def __init__(self, rendering: passes.Rendering, extras: str) -> None:
        self._rendering, self._has_parts = rendering, "materials" in extras
        self.covers: list[np.ndarray] = []

    def steps(self) -> Generator[work.Step, Any, None]:
        yield self._rendering
        self._light = self._rendering.light()
        self.covers = self._rendering.covers

    def add(self, stylize: luxfer.Stylize, source: luxfer.Guides) -> None:
        passes.add(stylize, *self.arrays(source))

    def arrays(self, source: luxfer.Guides, normals: bool = False) -> tuple[Arrays, Arrays]:
        ours, theirs = passes.exposed(passes.light_of(source), self._light)
        if self._has_parts:
            ours["materials"] = source.image("materials").numpy()
            theirs["materials"] = passes.coded(passes.colours(ours["materials"]), self._rendering.parts)
        return ours, theirs

    def close(self) -> None:
        self._rendering.close()
