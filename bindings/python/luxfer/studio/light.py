"""The steps from the photo to the lit room.

Each step has a key: all inputs that decide its result. A step runs only if its key, or the key of a step before it, has
changed. So a new camera causes only a rendering, and a new offset causes no segmentation.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import luxfer
import numpy as np

from ..cli.plane import Plane
from . import intervals, layout, measure, mix, pictures
from .jobs import Latest
from .layout import Layout
from .project import Project
from .room import bounds, exposure_for, rectangle, work_plane
from .shot import Shot, send_warnings

#: Settings of every relighting. They do not depend on time, so that a project always gives the same light.
RELIGHT = {"target_error": 0.02, "paths": 1 << 18}
#: Number of pixels of the first picture, and its time in milliseconds.
FIRST_PIXELS, FIRST_MS = 36_000, 350
#: Minimum time between two reports of progress, in seconds.
REFRESH_SECONDS = 0.5
#: More paths per pixel than any picture gets: the time ends the rendering.
MAX_SAMPLES = 1 << 16
#: Stages whose warnings concern one surface of the room.
OF_ROOM = (luxfer.types.Stage.EMISSION, luxfer.types.Stage.RELIGHT)
#: The step whose result each step needs.
AFTER = {
    "view": "",
    "masks": "view",
    "unwarp": "masks",
    "others": "unwarp",
    "emission": "others",
    "texture": "emission",
    "relight": "emission",
    "expose": "relight",
    "mix": "relight",
    "lamps": "mix",
    "lux": "mix",
    "first": "mix",
    "before": "mix",
    "second": "mix",
    "plan": "first",
    "picture": "first",
    "compared": "mix",
}


class Light:
    """The results for one photo and one room."""

    def __init__(self, photo: luxfer.Image, room: luxfer.Scene, thread: Latest[Any], send: Callable[..., None]):
        self.context, self.photo, self.room = photo.context, photo, room
        self.thread, self.send = thread, send
        self.surface = room.candidates[0].name if room.candidates else ""
        self.shot = Shot(photo, thread, send)
        #: A shot for each surface that receives lamps; only the first one tells the page what it sees.
        self.shots = [self.shot]
        self.layouts: list[Layout] = []
        self.active = 0
        self.keys: dict[str, str] = {}
        self.shown: dict[str, tuple[luxfer.Render, bool, float]] = {}
        self.last_reported = 0.0
        self.exposure = 1.0
        self.exposed = (1.0, 1.0)  # the exposure that was chosen, and the white of the photo for which it was
        self.desks: dict[str, Any] = {}
        self.planned: dict[str, Any] = {}
        self.render: luxfer.Render | None = None
        #: For each step that files need, the project object to which its result belongs.
        self.done: dict[str, Project] = {}

    @property
    def transfer(self) -> luxfer.Transfer:
        """The transfer of the surface on which the user works."""
        return self.shots[self.active].transfer

    @property
    def ceiling(self) -> str:
        """The surface below which the illuminance is computed: the first one with a floor below it."""
        names = [one.surface for one in self.layouts]
        return next((name for name in names if not work_plane(self.room, name)[1]), names[0])

    def placed(self) -> list[layout.Placed]:
        return layout.place_all(self.room, [shot.transfer for shot in self.shots], self.layouts)

    def follow(self, project: Project, size: tuple[int, int], compare: str) -> None:
        """Runs all outdated steps and sends each result to the page."""
        self.layouts = layout.layouts(project, self.surface)
        self.active = layout.active(project, self.layouts, self.surface)
        surface = self.layouts[self.active].surface
        # The library solves for the strength of the texture as it was placed, so both stages need the same white.
        patterns = [[one[:3] for one in self.layouts], project["white"]]
        mixes = [[one.mix, one.added] for one in self.layouts]
        shot, photo = [project["camera"], size], self.shot
        self.step("view", [], photo.find_view)
        self.step("masks", project["strokes"], lambda: photo.make_masks(project))
        edits = [project["removed"], project["grid"], project["reshaped"]]
        self.step("unwarp", edits, lambda: photo.unwarp(project, self.room, surface))
        self.step("others", len(self.layouts), lambda: self.look_again(project))
        self.step("emission", patterns, lambda: self.make_textures(project))
        self.step("texture", surface, lambda: self.send_texture(surface))
        self.step("relight", [], lambda: self.relight(project))
        if "expose" in self.keys:  # light is proportional to the white, so the first picture need not wait
            self.exposure = self.exposed[0] * self.exposed[1] / project["white"]
        else:
            self.step("expose", [], lambda: self.choose_exposure(project))
        self.step("mix", mixes, self.mix)
        self.step("lamps", surface, self.send_lamps)
        self.done["mix"] = project
        self.step("first", shot, lambda: self.first_picture(project, size))
        self.step("expose", [], lambda: self.choose_exposure(project))
        self.step("lux", project["lux_plane"], lambda: self.measure(project))
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

    # -- the room

    def look_again(self, project: Project) -> None:
        """Makes a shot for each further surface."""
        del self.shots[len(self.layouts) :]
        while len(self.shots) < len(self.layouts):
            self.shots.append(Shot(self.photo, self.thread, lambda *_, **__: None))
        for other in self.shots[1:]:
            other.follow(self.shot, project)

    def make_textures(self, project: Project) -> None:
        """Makes the textures of all surfaces, and places them in one room."""
        settings: list[Any] = []
        for shot, one in zip(self.shots, self.layouts):
            shot.transfer.set_scene(self.room, one.surface)
            shot.transfer.set_zones(np.array(one.zones, np.float64).reshape(-1, 4))
            settings.append(layout.settings_of(project, one, shot.kept_distance))
        self.stage("emission", settings)

    def stage(self, name: str, settings: Any) -> None:
        """Runs one stage of the transfers of all surfaces together."""
        self.send("working", stage=name)
        transfers = [shot.transfer for shot in self.shots]
        try:
            self.thread.finish(luxfer.Transfer.start_all(transfers, name, name, settings))
        except luxfer.errors.InvalidArgument as error:
            if "light one surface" not in str(error):
                raise
            names = ", ".join(one.surface for one in self.layouts)
            raise ValueError(f"two of the surfaces {names} are one: choose another one") from None
        self.send_warnings()

    def send_warnings(self) -> None:
        """Sends the warnings of the photo, and for each surface those of its texture and its light."""
        found = self.shot.warnings()
        for shot, one in zip(self.shots, self.layouts):
            of_room = [w for w in shot.warnings() if w.stage in OF_ROOM]
            if len(self.layouts) == 1:
                continue
            found = [w for w in found if w not in of_room]
            found += [replace(w, message=f"{one.surface}: {w.message}") for w in of_room]
        send_warnings(self.send, found)

    def send_texture(self, surface: str) -> None:
        """Sends the texture of the surface on which the user works."""
        image, shot = self.transfer.image("emission"), self.shots[self.active]
        width, height, _ = image.size
        small = pictures.reduced(image, 300_000)
        values = small.numpy()
        report, known = self.transfer.report, self.photo.metadata
        proposed = report.proposed_white, report.proposed_white_low, report.proposed_white_high
        if shot.edited is not None and known.white_luminance > 0:  # a photo with reshaped lamps has no metadata
            proposed = known.white_luminance, known.white_luminance_low, known.white_luminance_high
        distance, error = self.distance()
        self.send(
            "texture",
            pictures.rgb(values, 1 / max(1e-9, float(values.max()))),
            width=small.size[0],
            height=small.size[1],
            texels=[width, height],
            digest=pictures.digest(image),
            surface={"name": surface, **(rectangle(self.room, surface) or {})},
            distance=distance,
            distance_range=intervals.around(distance, error),
            proposed_white=proposed,
        )

    def distance(self) -> tuple[float, float]:
        """Returns the distance of the photo's camera from the plane, and its relative standard deviation."""
        report = self.transfer.report
        return self.shots[self.active].kept_distance or (report.plane_distance, report.plane_distance_error)

    def relight(self, project: Project) -> None:
        self.stage("relight", {"white_luminance": project["white"], "relight": RELIGHT})

    def mix(self) -> None:
        """Gives each kind of lamp its share of the light."""
        self.lit = mix.apply(self.placed())

    def send_lamps(self) -> None:
        """Sends the lamps of the surface on which the user works, how their texture lies, and the light of others."""
        placed = self.placed()
        names = ("kind", "position", "axis", "normal", "size", "flux", "radiance", "cct", "duv")
        found = mix.lamps(placed[self.active])
        lamps = [{k: getattr(lamp, k) for k in names} | {"added": number} for lamp, number in found]
        report, solution = self.transfer.report, self.transfer.solution
        is_estimated = self.layouts[self.active].pattern["scale"] == "distance"
        scale_error = self.distance()[1] if is_estimated else 0.0
        others = [one for i, one in enumerate(placed) if i != self.active]
        self.send(
            "lamps",
            error=solution.error,
            list=lamps,
            kinds=intervals.of_kinds(
                self.context, [lamp for lamp, _ in found], solution, scale_error, report.texel_size
            ),
            to_texture=mix.texture_map(self.lit, placed[self.active].surface, len(placed)).tolist(),
            others=[
                {"surface": one.layout.surface, "lamps": len(found), "flux": math.fsum(lamp.flux for lamp, _ in found)}
                for one, found in ((one, mix.lamps(one)) for one in others)
            ],
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
        return mix.apply(self.placed(), "white")

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

    def choose_exposure(self, project: Project) -> None:
        """Chooses the exposure of the pictures by the work plane before lamps are dimmed, so dimmed light is darker."""
        self.desks = self.lux_on(work_plane(self.room, self.ceiling)[0], self.transfer.scene("lit"))
        self.exposure = exposure_for(self.desks["mean"])
        self.exposed = self.exposure, project["white"]

    def measure(self, project: Project) -> None:
        """Computes and sends the illuminance of the plane that the project chooses."""
        ceiling = self.ceiling
        plane, problem = measure.chosen_plane(self.room, ceiling, project)
        if plane is None:
            self.send("lux", problem=problem)
            return
        is_known = measure.is_default(project) and all(one.is_plain for one in self.layouts)
        found = self.desks if is_known else self.lux_on(plane, self.lit)
        self.send("lux", **found, **measure.place(self.room, ceiling, plane, project))

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
            "plan",
            noise=project["noise"],
            seconds=plan.report.seconds,
            seconds_range=intervals.of_plan(plan.report.seconds),
            error=plan.report.error,
            error_range=intervals.of_plan(plan.report.error),
            plan=self.planned,
        )
