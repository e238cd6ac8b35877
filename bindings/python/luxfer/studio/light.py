"""The steps from the photo to the lit room.

Each step has a key: all inputs that decide its result. A step runs only if its key, or the key of a step before it, has
changed. So a new camera causes only a rendering, and a new offset causes no segmentation.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable
from typing import Any

import luxfer
import numpy as np

from ..cli.plane import Plane
from . import grid, measure, mix, pictures, reshape
from .jobs import Latest
from .live import strokes_of
from .project import Project
from .room import MAX_TEXELS, bounds, exposure_for, rectangle, texture_settings, work_plane

#: Settings of every relighting. They do not depend on time, so that a project always gives the same light.
RELIGHT = {"target_error": 0.02, "paths": 1 << 18}
#: Number of pixels of the first picture, and its time in milliseconds.
FIRST_PIXELS, FIRST_MS = 36_000, 350
#: Minimum time between two reports of progress, in seconds.
REFRESH_SECONDS = 0.5
#: More paths per pixel than any picture gets: the time ends the rendering.
MAX_SAMPLES = 1 << 16
#: The step whose result each step needs.
AFTER = {
    "view": "",
    "masks": "view",
    "unwarp": "masks",
    "emission": "unwarp",
    "relight": "emission",
    "expose": "relight",
    "mix": "relight",
    "lux": "mix",
    "first": "mix",
    "before": "mix",
    "second": "mix",
    "plan": "first",
    "picture": "first",
    "compared": "mix",
}
#: Maximum distance of a point from the lamp that it selects, as a share of the photo's width.
MAX_LAMP_DISTANCE = 0.015


class Light:
    """The results for one photo and one room."""

    def __init__(self, photo: luxfer.Image, room: luxfer.Scene, thread: Latest[Any], send: Callable[..., None]):
        self.context, self.photo, self.room = photo.context, photo, room
        self.thread, self.send = thread, send
        self.surface = room.candidates[0].name if room.candidates else ""
        self.transfer = luxfer.Transfer(self.context, photo)
        self.keys: dict[str, str] = {}
        self.shown: dict[str, tuple[luxfer.Render, bool, float]] = {}
        self.last_reported = 0.0
        self.exposure = 1.0
        self.desks: dict[str, Any] = {}
        self.planned: dict[str, Any] = {}
        self.is_replaced = False  # whether the mask of the lights is not the library's own
        self.is_edited = False  # whether the transfer has a photo with reshaped lamps
        #: The distance from the plane, and its error, before lamps were reshaped: they change size, and the room does not.
        self.kept_distance: tuple[float, float] | None = None
        self.is_dragged = False  # whether the camera of the photo comes from the dragged grid
        #: Directions of the room axes and focal length of the dragged grid.
        self.camera_by_grid: tuple[list[list[float]], float] | None = None
        self.lights: luxfer.Image | None = None
        self.render: luxfer.Render | None = None
        #: For each step that files need, the project object to which its result belongs.
        self.done: dict[str, Project] = {}

    def follow(self, project: Project, size: tuple[int, int], compare: str) -> None:
        """Runs all outdated steps and sends each result to the page."""
        surface = project["surface"] or self.surface
        # The library solves for the strength of the texture as it was placed, so both stages need the same white.
        pattern = [surface, project["pattern"], project["zones"], project["white"]]
        shot = [project["camera"], size]
        self.step("view", [], self.find_view)
        self.step("masks", project["strokes"], lambda: self.make_masks(project))
        edits = [project["removed"], project["grid"], project["reshaped"]]
        self.step("unwarp", edits, lambda: self.unwarp(project, surface))
        self.step("emission", pattern, lambda: self.make_texture(project, surface))
        self.step("relight", [], lambda: self.relight(project))
        self.step("expose", [], lambda: self.choose_exposure(surface))
        self.step("mix", [project["mix"], project["added"]], lambda: self.mix(project, surface))
        self.done["mix"] = project
        self.step("lux", project["lux_plane"], lambda: self.measure(project, surface))
        self.step("first", shot, lambda: self.first_picture(project, size))
        if compare != "off":
            self.step("before", [compare, *shot], lambda: self.first_before(project, size, compare))
        self.step("second", shot, lambda: self.second_picture(project, size))
        self.done["second"] = project
        if not project["plan"]:
            self.step("plan", project["noise"], lambda: self.plan(project, size))
            project["plan"] = self.planned
        self.done["plan"] = project
        self.step("picture", project["plan"], lambda: self.refine(project, size))
        if compare != "off":
            inputs = [compare, *shot, project["plan"]]
            self.step("compared", inputs, lambda: self.refine_before(project, size, compare))

    def step(self, name: str, inputs: Any, work: Callable[[], None]) -> None:
        """Runs a step if it is outdated."""
        self.thread.check()
        key = self.keys.get(AFTER[name], "") + json.dumps([name, inputs])
        if self.keys.get(name) == key:
            return
        self.keys[name] = ""
        start = time.perf_counter()
        work()
        self.keys[name] = key
        self.send("step", name=name, seconds=time.perf_counter() - start)

    def stage(self, first: str, last: str, **settings: Any) -> None:
        """Runs stages of the transfer."""
        self.send("working", stage=last)
        self.thread.finish(self.transfer.start(first, last, **settings))

    # -- the photo

    def find_view(self) -> None:
        self.stage("view", "view")

    def make_masks(self, project: Project) -> None:
        self.transfer.set_strokes(strokes_of(self.context, project, self.photo.size[:2]))
        self.lights = None
        try:
            self.find_masks()
        finally:
            self.send_warnings()
        self.lights = self.transfer.image("lights-mask")

    def find_masks(self) -> None:
        """Computes the masks. They always follow the photo as it is, and the camera that the library has found."""
        self.restore_photo()
        self.stage("view" if self.is_dragged else "features", "lights")
        self.is_dragged = self.is_replaced = False

    def restore_photo(self) -> None:
        """Takes the reshaped lamps back."""
        if self.is_edited:
            self.transfer.set_photo(self.photo)
        self.is_edited, self.kept_distance = False, None

    def unwarp(self, project: Project, surface: str) -> None:
        assert self.lights is not None
        self.restore_photo()
        if (self.is_replaced and not project["removed"]) or self.is_dragged:
            self.find_masks()
        mask = self.lights.numpy()[..., 0]
        if project["removed"]:
            mask = pictures.without(mask, project["removed"], MAX_LAMP_DISTANCE * mask.shape[1])
            if not (mask > 0.5).any():
                raise ValueError("all lamps have been taken out of the photo: undo one")
            self.transfer.use_mask("lights", luxfer.Image(self.context, mask))
            self.is_replaced = True
        self.send_masks(mask)
        try:
            settings = self.plane_of(project)
            self.stage("unwarp", "unwarp", **settings)
            self.send("shapes", list=reshape.rectangles(mask, self.transfer.view, self.photo.size[:2]))
            if project["reshaped"]:
                self.change_lamps(project, mask, surface)
                self.stage("unwarp", "unwarp", **settings)
        finally:
            self.send_view(project)
            self.send_warnings()

    def change_lamps(self, project: Project, mask: np.ndarray[Any, Any], surface: str) -> None:
        """Replaces photo and mask by ones with the reshaped lamps, at the scale that the lamps had before."""
        self.transfer.set_scene(self.room, surface)
        self.stage("emission", "emission", max_texels=MAX_TEXELS)
        report = self.transfer.report
        self.kept_distance = report.plane_distance, report.plane_distance_error
        pixels, plane = self.photo.numpy(), self.transfer.image("plane-mask").numpy()[..., 0]
        changed = reshape.apply(pixels, mask, plane, project["reshaped"], MAX_LAMP_DISTANCE * mask.shape[1])
        if not (changed[1] > 0.5).any():
            raise ValueError("no reshaped lamp lies in the photo: undo one")
        self.transfer.set_photo(luxfer.Image(self.context, changed[0]))
        self.transfer.use_mask("lights", luxfer.Image(self.context, changed[1]))
        self.is_edited = self.is_replaced = True
        self.send_masks(changed[1])

    def plane_of(self, project: Project) -> dict[str, Any]:
        """Replaces the camera by the camera of the dragged grid, and returns the settings of the stage "unwarp"."""
        self.camera_by_grid = None
        if not project["grid"]:
            return {}
        size = self.photo.size[:2]
        axes, focal = grid.camera_of(project["grid"], size, self.transfer.view.focal)
        plane_axes = grid.use(self.transfer, axes.tolist(), focal, size)
        self.is_dragged = True
        self.camera_by_grid = axes.tolist(), focal
        return {"rectify": {"plane_axes": plane_axes}}

    def send_masks(self, lights: np.ndarray[Any, Any]) -> None:
        """Sends the masks at full size, and the lamps of the photo."""
        plane, lamps = self.transfer.image("plane-mask"), luxfer.Image(self.context, lights)
        report = self.transfer.report
        size, plane_bits = pictures.bits(plane)
        header = {
            **size,
            "live": False,
            "digest": pictures.digest(plane, lamps),
            "lamps": pictures.boxes(*pictures.regions(lights > 0.5)),
            "errors": {"plane": report.plane_error, "lights": report.lights_error},
        }
        self.send("masks", plane_bits + pictures.bits(lamps)[1], **header)

    def send_view(self, project: Project) -> None:
        """Sends the vanishing points and, once the plane has been unwarped, its rectangle."""
        view = self.transfer.view
        photo_width, photo_height = self.photo.size[:2]
        width, height, _ = self.transfer.image("unwarped").size if view.is_unwarped else (0, 0, 0)
        self.send(
            "view",
            vanishing=view.vanishing_points,
            support=view.vanishing_support,
            errors=view.vanishing_errors,
            focal=view.focal,
            dragged=self.is_dragged,
            unwarped=[width, height] if view.is_unwarped else None,
            to_photo=view.to_photo if view.is_unwarped else None,
            pixel_size=view.pixel_size,
            lens=[*view.principal, 4 * view.undone / (photo_width**2 + photo_height**2)],
        )

    def send_warnings(self) -> None:
        try:
            warnings = self.transfer.warnings
        except luxfer.errors.NotReady:
            return
        self.send(
            "warnings",
            list=[
                {
                    "code": w.code.name,
                    "stage": w.stage.name.lower(),
                    "message": w.message,
                    "advice": w.advice,
                    "at": w.place,
                }
                for w in warnings
            ],
        )

    # -- the room

    def make_texture(self, project: Project, surface: str) -> None:
        self.transfer.set_scene(self.room, surface)
        self.transfer.set_zones(np.array(project["zones"], np.float64).reshape(-1, 4))
        self.stage("emission", "emission", **texture_settings(project, self.kept_distance))
        self.send_warnings()
        image = self.transfer.image("emission")
        width, height, _ = image.size
        small = pictures.reduced(image, 300_000)
        values = small.numpy()
        report, known = self.transfer.report, self.photo.metadata
        proposed = report.proposed_white, report.proposed_white_low, report.proposed_white_high
        if self.is_edited and known.white_luminance > 0:  # a photo with reshaped lamps has no metadata
            proposed = known.white_luminance, known.white_luminance_low, known.white_luminance_high
        distance = self.kept_distance or (report.plane_distance, report.plane_distance_error)
        self.send(
            "texture",
            pictures.rgb(values, 1 / max(1e-9, float(values.max()))),
            width=small.size[0],
            height=small.size[1],
            texels=[width, height],
            digest=pictures.digest(image),
            surface={"name": surface, **(rectangle(self.room, surface) or {})},
            distance=distance[0],
            distance_error=distance[1],
            proposed_white=proposed,
        )

    def relight(self, project: Project) -> None:
        self.stage("relight", "relight", white_luminance=project["white"], relight=RELIGHT)
        self.send_warnings()

    def mix(self, project: Project, surface: str) -> None:
        """Gives each kind of lamp its share of the light, and sends the lamps and how their texture lies."""
        placed = self.room.find_surface(surface)
        self.lit = mix.apply(self.transfer, placed, project["mix"], project["added"])
        names = ("kind", "position", "axis", "normal", "size", "flux", "radiance", "cct", "duv")
        shown = mix.lamps(self.transfer.fixtures, placed, project["mix"], project["added"])
        lamps = [{k: getattr(lamp, k) for k in names} | {"added": number} for lamp, number in shown]
        self.send(
            "lamps",
            error=self.transfer.solution.error,
            list=lamps,
            to_texture=mix.texture_map(self.lit, placed).tolist(),
        )

    def camera(self, project: Project) -> dict[str, Any]:
        """Returns the camera of the project, or else the first one of the room, or else one near a corner of the
        room."""
        if project["camera"]:
            return dict(project["camera"])
        if self.room.counts.cameras:
            return {k: v for k, v in self.room.camera(0).items() if k != "up"}
        low, high = bounds(self.room)
        position = low + (high - low) * (0.9, 0.55, 0.9)
        return {"position": tuple(position), "target": tuple((low + high) / 2), "fov_y": 1.0}

    def first_picture(self, project: Project, size: tuple[int, int]) -> None:
        self.render = self.quick(self.lit, project, size, "after")

    def second_picture(self, project: Project, size: tuple[int, int]) -> None:
        """Renders and sends a picture of full size, with one path per pixel and the noise filter."""
        render = luxfer.Render(self.context, self.lit)
        render.set_camera(**self.camera(project))
        start = time.perf_counter()
        self.send("working", stage="render")
        self.thread.finish(render.start(width=size[0], height=size[1], samples=1, preview=1.0))
        self.render = render
        self.send_picture(render, project, "after", False, time.perf_counter() - start)

    def room_before(self, project: Project, compare: str) -> luxfer.Scene:
        """Returns the room with the light that the page compares with."""
        if compare != "white":
            return self.room
        placed = self.room.find_surface(project["surface"] or self.surface)
        return mix.apply(self.transfer, placed, project["mix"], project["added"], "white")

    def first_before(self, project: Project, size: tuple[int, int], compare: str) -> None:
        self.quick(self.room_before(project, compare), project, size, "before")

    def refine_before(self, project: Project, size: tuple[int, int], compare: str) -> None:
        """Renders the picture to compare with like the picture of the lit room, after that one has ended."""
        settings = {**project["plan"]["render"], "width": size[0], "height": size[1], "preview": 1.0}
        render = luxfer.Render(self.context, self.room_before(project, compare))
        render.set_camera(**self.camera(project))
        start = time.perf_counter()
        self.send("working", stage="compare")
        self.thread.finish(render.start(**settings))
        self.send_picture(render, project, "before", True, time.perf_counter() - start)

    def quick(self, scene: luxfer.Scene, project: Project, size: tuple[int, int], which: str) -> luxfer.Render:
        """Renders and sends a small picture within a fixed time."""
        share = min(1.0, math.sqrt(FIRST_PIXELS / (size[0] * size[1])))
        render = luxfer.Render(self.context, scene)
        render.set_camera(**self.camera(project))
        if which == "before":
            share = min(1.0, 2 * share)
        width, height = (max(16, round(side * share)) for side in size)
        budget = FIRST_MS if which == "after" else 4 * FIRST_MS
        self.thread.finish(
            render.start(width=width, height=height, preview=1.0, samples=MAX_SAMPLES, time_budget_ms=budget)
        )
        self.send_picture(render, project, which, False)
        return render

    def lux_on(self, plane: Plane, scene: luxfer.Scene) -> dict[str, Any]:
        """Computes the illuminance of a plane."""
        columns, rows = measure.points(plane)
        job = luxfer.Illuminance(self.context, scene).start_grid(
            plane.grid(), columns=columns, rows=rows, samples=measure.LUX_SAMPLES
        )
        return measure.numbers(self.thread.finish(job))

    def choose_exposure(self, surface: str) -> None:
        """Chooses the exposure of the pictures by the work plane before lamps are dimmed, so dimmed light is darker."""
        self.desks = self.lux_on(work_plane(self.room, surface)[0], self.transfer.scene("lit"))
        self.exposure = exposure_for(self.desks["mean"])

    def measure(self, project: Project, surface: str) -> None:
        """Computes and sends the illuminance of the plane that the project chooses."""
        plane, problem = measure.chosen_plane(self.room, surface, project)
        if plane is None:
            self.send("lux", problem=problem)
            return
        is_known = measure.is_default(project) and mix.is_plain(project["mix"], project["added"])
        found = self.desks if is_known else self.lux_on(plane, self.lit)
        self.send("lux", **found, **measure.place(self.room, surface, plane, project))

    def refine(self, project: Project, size: tuple[int, int]) -> None:
        """Renders the picture at full size and sends each intermediate state, until it has the paths of the plan."""
        settings = {**project["plan"]["render"], "width": size[0], "height": size[1], "preview": 1.0}
        render = luxfer.Render(self.context, self.lit)
        render.set_camera(**self.camera(project))
        start, shown = time.perf_counter(), 1

        def show(share: float) -> None:
            nonlocal shown
            self.send_progress(share, time.perf_counter() - start)
            try:
                if render.report.samples > shown:
                    self.render = render
                    self.send_picture(render, project, "after", False, time.perf_counter() - start)
                    shown = render.report.samples
            except luxfer.errors.NotReady:
                pass  # its first pass has not ended

        self.send("working", stage="render")
        self.thread.finish(render.start(**settings), show)
        self.render = render
        self.send_picture(render, project, "after", True, time.perf_counter() - start)

    def send_progress(self, share: float, seconds: float) -> None:
        """Sends the progress of the picture, at most every REFRESH_SECONDS."""
        if seconds - self.last_reported >= REFRESH_SECONDS or seconds < self.last_reported:
            self.last_reported = seconds
            self.send("progress", share=share, seconds=seconds)

    def send_picture(
        self, render: luxfer.Render, project: Project, which: str, is_done: bool, seconds: float = 0.0
    ) -> None:
        image, report = render.image("preview"), render.report
        values = image.numpy()
        exposure = project["exposure"] or self.exposure
        self.shown[which] = (render, is_done, seconds)
        self.send(
            "picture",
            pictures.rgb(values, exposure),
            which=which,
            width=image.size[0],
            height=image.size[1],
            done=is_done,
            samples=report.samples,
            noise=report.error if math.isfinite(report.error) else None,
            bias=report.preview_bias if math.isfinite(report.preview_bias) else None,
            seconds=seconds,
            mean=float(values.mean()),
            exposure=self.exposure,
            camera=self.camera(project),
        )

    def show_again(self, project: Project) -> None:
        """Sends the current pictures again, for example with another exposure."""
        for which, (render, is_done, seconds) in list(self.shown.items()):
            self.send_picture(render, project, which, is_done, seconds)

    def plan(self, project: Project, size: tuple[int, int]) -> None:
        """Plans the settings for the wanted noise, and sends the predicted time and error."""
        self.send("working", stage="plan")
        render, plan = luxfer.Render(self.context, self.lit), luxfer.Plan(self.context)
        render.set_camera(**self.camera(project))
        job = plan.start_render(render, target_error=project["noise"], settings={"width": size[0], "height": size[1]})
        self.thread.finish(job)
        chosen = {k: v for k, v in plan.render_params.items() if k in ("samples", "target_error", "seed")}
        self.planned = {"render": chosen}
        self.send(
            "plan", noise=project["noise"], seconds=plan.report.seconds, error=plan.report.error, plan=self.planned
        )
