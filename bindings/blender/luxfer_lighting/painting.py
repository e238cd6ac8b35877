"""Operators of the stylisation: the exemplar to paint over, a sample artwork, and the stylised scene."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import bpy
import luxfer
import numpy as np

from . import artworks, convert, parts, passes, targets, work

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


def sample_steps(width: int, height: int, samples: int, style: str, owner: str) -> Generator[work.Step, Any, None]:
    """Steps that draw an artwork for the object of that name or, if it is empty, for the scene."""
    guides, job = ball(width, height, samples)
    yield job
    artwork = guides.demo_artwork(style).numpy(np.uint8, "srgb")[..., :3]
    stored = convert.store(f"{ARTWORK} of {owner}" if owner else ARTWORK, artwork / np.float32(255), linear=False)
    if owner:
        bpy.data.objects[owner].luxfer_artwork = stored
    else:
        bpy.context.scene.luxfer.artwork = stored


def stylise_steps(
    artwork: luxfer.Image,
    target: targets.ByLibrary | targets.ByCycles,
    groups: list[artworks.Group],
    samples: int,
    preset: str,
    match_light: float,
) -> Generator[work.Step, Any, None]:
    """Steps of a stylisation: the picture with the artwork of the scene, then each group of objects that has an
    artwork of its own."""
    try:
        source, job = ball(*artwork.size[:2], samples)
        yield job
        yield from target.steps()
    finally:  # if the work ends before the rendering was used
        target.close()
    stylize = luxfer.Stylize(work.context(), artwork)
    target.add(stylize, source)
    if groups:  # what lies around the groups goes on behind them
        ours, theirs = target.arrays(source)
        passes.add(stylize, ours, artworks.extended(theirs, sum(target.covers) <= artworks.FREE))
    yield stylize.start(preset, match_appearance=match_light)
    picture = stylize.image()
    if groups:
        painted = artworks.Painted(picture.numpy()[..., :3].copy(), stylize.report.halvings)
        sources = {artwork.size[:2]: source}
        for group, cover in zip(groups, target.covers):
            yield from group_steps(painted, group, cover, target, sources, samples, preset, match_light)
        picture = luxfer.Image(work.context(), painted.picture)
    convert.store(PICTURE, picture.numpy(np.uint8, "srgb")[..., :3] / np.float32(255), linear=False)


def group_steps(
    painted: artworks.Painted,
    group: artworks.Group,
    cover: np.ndarray,
    target: targets.ByLibrary | targets.ByCycles,
    sources: dict[tuple[int, int], luxfer.Guides],
    samples: int,
    preset: str,
    match_light: float,
) -> Generator[work.Step, Any, None]:
    """Steps that paint a group of objects onto the picture. `sources` are the guides of the ball by their size."""
    box, size = painted.box(cover), group.artwork.size[:2]
    if box is None:
        return
    if size not in sources:
        sources[size], job = ball(*size, samples)
        yield job
    source = sources[size]
    trial = luxfer.Stylize(work.context(), group.artwork)  # whether its strokes follow the shapes
    trial.add_guides(source, source)
    yield trial.start("preview")
    ours, theirs = target.arrays(source, trial.report.normals_weight > 0)
    ours = artworks.matched(ours, theirs, match_light)
    theirs = artworks.extended({name: guide[box] for name, guide in theirs.items()}, cover[box] >= artworks.COVERED)
    if group.part is not None:  # the mask decides it
        del ours["materials"]
    stylize = luxfer.Stylize(work.context(), group.artwork)
    passes.add(stylize, ours, theirs)
    if "normals" in ours:
        stylize.add_guide("normals", ours["normals"], theirs["normals"], trial.report.normals_weight, "data")
    if group.part is not None:
        codes = source.image("materials").numpy()
        stylize.set_source_mask((codes == passes.colours(codes)[group.part]).all(-1).astype(np.float32))
    yield stylize.start(preset)
    painted.lay(stylize.image().numpy(), cover, box)


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
    for_object: bpy.props.BoolProperty(
        name="For the Object", description="Make it the active object's own artwork", default=False, options={"SKIP_SAVE"}
    )

    def make(self, context: bpy.types.Context) -> tuple[Generator[work.Step, Any, None], int]:
        settings, owner = context.scene.luxfer, ""
        if self.for_object:
            if context.object is None:
                raise ValueError("choose an object first")
            owner = context.object.name
        size = settings.exemplar_width, settings.exemplar_height
        return sample_steps(*size, settings.guide_samples, self.style, owner), 1


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
        artwork, samples = convert.image(work.context(), settings.artwork), settings.guide_samples
        found = parts.of(scene) if settings.guide_parts else None
        groups = artworks.groups(scene, found)
        names = {"materials": settings.guide_parts, "edges": settings.guide_edges}
        extras = "|".join(name for name, is_wanted in names.items() if is_wanted)
        if settings.guides_by == "CYCLES":
            each = [group.names for group in groups]
            target = targets.ByCycles(passes.Rendering(scene, context.view_layer, samples, found, each), extras)
        else:
            room = convert.scene(work.context(), scene, None if found is None else parts.Renaming(found))
            params = dict(zip(("width", "height"), convert.resolution(scene)), samples=samples)
            target = targets.ByLibrary(room, view, params, extras, groups)
        count = 3 + bool(groups) + 2 * len(groups)
        return stylise_steps(artwork, target, groups, samples, settings.preset, settings.match_light), count


CLASSES = (LUXFER_OT_exemplar, LUXFER_OT_sample_artwork, LUXFER_OT_stylise)


def register() -> None:
    for kind in CLASSES:
        bpy.utils.register_class(kind)


def unregister() -> None:
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
