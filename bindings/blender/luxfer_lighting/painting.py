"""Operators of the stylisation: the exemplar to paint over, a sample artwork, and the stylised scene."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import bpy
import luxfer
import numpy as np

from . import convert, parts, passes, work

EXEMPLAR, ARTWORK, PICTURE = "Luxfer exemplar", "Luxfer artwork", "Luxfer stylised"


def ball(width: int, height: int, samples: int) -> tuple[luxfer.Guides, luxfer.Job]:
    """Starts to render the guides of the exemplar; returns them and the job."""
    guides = luxfer.Guides(work.context(), luxfer.Scene.demo(work.context(), "sphere-on-table"))
    return guides, guides.start(width=width, height=height, samples=samples)


def exemplar_steps(width: int, height: int, samples: int) -> Generator[work.Step, Any, None]:
    guides, job = ball(width, height, samples)
    yield job
    light = guides.image("full").numpy()
    shown = luxfer.Image(work.context(), light * (0.9 / np.percentile(light, 98)))
    convert.store(EXEMPLAR, shown.numpy(np.uint8, "srgb") / np.float32(255), linear=False)


def sample_steps(width: int, height: int, samples: int, style: str) -> Generator[work.Step, Any, None]:
    guides, job = ball(width, height, samples)
    yield job
    artwork = guides.demo_artwork(style).numpy(np.uint8, "srgb")[..., :3]
    bpy.context.scene.luxfer.artwork = convert.store(ARTWORK, artwork / np.float32(255), linear=False)


def stylise_steps(
    artwork: luxfer.Image,
    target: luxfer.Scene | passes.Rendering,
    params: dict[str, Any],
    preset: str,
    match_light: float,
    extras: str,
) -> Generator[work.Step, Any, None]:
    """Steps of a stylisation. The target is a scene, whose guides the library renders, or a running rendering of
    guides by Cycles, which has no edges."""
    try:
        stylize = luxfer.Stylize(work.context(), artwork)
        source, job = ball(*artwork.size[:2], params["samples"])
        yield job
        if isinstance(target, passes.Rendering):
            yield target
            passes.add_light(stylize, passes.light_of(source), target.light())
            if "materials" in extras:
                passes.add_parts(stylize, source, target.parts)
        else:
            guides = luxfer.Guides(work.context(), target)
            yield guides.start(**params)
            stylize.add_guides(source, guides, extras or 0)
    finally:  # if the work ends before the rendering was used
        if isinstance(target, passes.Rendering):
            target.close()
    yield stylize.start(preset, match_appearance=match_light)
    painted = stylize.image().numpy(np.uint8, "srgb")
    convert.store(PICTURE, painted[..., :3] / np.float32(255), linear=False)


class LUXFER_OT_exemplar(work.Background, bpy.types.Operator):
    """Render a ball on a table to paint over, as the image "Luxfer exemplar\""""

    bl_idname = "luxfer.exemplar"
    bl_label = "Render Exemplar"
    title = "Exemplar"

    def make(self, context: bpy.types.Context) -> tuple[Generator[work.Step, Any, None], int]:
        settings = context.scene.luxfer
        return exemplar_steps(settings.exemplar_width, settings.exemplar_height, settings.guide_samples), 1


class LUXFER_OT_sample_artwork(work.Background, bpy.types.Operator):
    """Generate an artwork of the exemplar, to try stylisation without an artist"""

    bl_idname = "luxfer.sample_artwork"
    bl_label = "Sample Artwork"
    title = "Artwork"

    style: bpy.props.EnumProperty(
        name="Style",
        items=(
            ("paint", "Paint", "Oil on canvas"),
            ("pen", "Pen", "Hatching with a pen and two inks"),
            ("stipple", "Stipple", "Dots of two inks"),
        ),
    )

    def make(self, context: bpy.types.Context) -> tuple[Generator[work.Step, Any, None], int]:
        settings = context.scene.luxfer
        return sample_steps(settings.exemplar_width, settings.exemplar_height, settings.guide_samples, self.style), 1


class LUXFER_OT_stylise(work.Background, bpy.types.Operator):
    """Paint the view of the active camera in the style of the artwork, as the image "Luxfer stylised\""""

    bl_idname = "luxfer.stylise"
    bl_label = "Stylise"
    title = "Stylisation"

    def make(self, context: bpy.types.Context) -> tuple[Generator[work.Step, Any, None], int]:
        scene, settings = context.scene, context.scene.luxfer
        view = convert.camera(scene)
        if settings.artwork is None:
            raise ValueError("choose an artwork first: the exemplar after painting")
        if view is None:
            raise ValueError("the scene has no camera")
        artwork, params = convert.image(work.context(), settings.artwork), {"samples": settings.guide_samples}
        found = parts.of(scene) if settings.guide_parts else None
        if settings.guides_by == "CYCLES":
            target = passes.Rendering(scene, context.view_layer, settings.guide_samples, found)
        else:
            target = convert.scene(work.context(), scene, None if found is None else parts.Renaming(found))
            params["width"], params["height"] = convert.resolution(scene)
            params["camera"] = target.add_camera(**view)
        names = {"materials": settings.guide_parts, "edges": settings.guide_edges}
        extras = "|".join(name for name, is_wanted in names.items() if is_wanted)
        return stylise_steps(artwork, target, params, settings.preset, settings.match_light, extras), 3


CLASSES = (LUXFER_OT_exemplar, LUXFER_OT_sample_artwork, LUXFER_OT_stylise)


def register() -> None:
    for kind in CLASSES:
        bpy.utils.register_class(kind)


def unregister() -> None:
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
