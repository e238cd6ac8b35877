"""Renders to a goal of noise or time, with settings that the library plans, and filters the picture."""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .console import Console, clock, doubt, percent
from .exits import usage
from .options import CLEAN, QUALITIES

if TYPE_CHECKING:
    from ..image import Image
    from ..render import Render
    from ..scene import Scene
    from ..types import CameraParams, RenderParams, RenderReport
    from .values import Camera

#: Strength of the noise filter: the default of the library.
FILTER = 1.0
#: Noise above which a warning doubts even the filtered picture.
ROUGH = 0.1


@dataclass(frozen=True)
class Goal:
    """The noise to reach and the time to use: the rendering ends when one of them is reached. 0 stands for no goal."""

    error: float = 0.0
    seconds: float = 0.0
    is_budget: bool = False
    """Whether the time is for the whole run, as with --time, and not for the rendering alone."""

    @classmethod
    def of(cls, args: argparse.Namespace) -> Goal:
        """Returns the goal that --time, --error or --quality states."""
        if args.time is not None:
            return cls(seconds=args.time, is_budget=True)
        if args.error is not None:
            return cls(error=args.error)
        error, seconds = QUALITIES[args.quality]
        return cls(error=error, seconds=seconds)

    def for_plan(self, passed: float) -> dict[str, Any]:
        """Returns the goal as settings of a plan, `passed` seconds after the start of the run."""
        if self.is_budget:
            return {"time_budget_ms": max(100, round(1000 * (self.seconds - passed)))}
        return {"target_error": self.error}

    def settings(self, planned: RenderParams, args: argparse.Namespace) -> dict[str, Any]:
        """Completes the settings of a plan to the settings of the rendering."""
        out = dict(planned)
        if not self.is_budget and self.seconds:
            out["time_budget_ms"] = round(1000 * self.seconds)
        return {**out, "preview": 0.0 if args.no_filter else FILTER}


def camera_of(scene: Scene, wanted: Camera | None) -> CameraParams:
    """Returns the settings of the camera that --camera states, or else of the scene's first camera."""
    count = scene.counts.cameras
    if wanted is not None and wanted.index is None:
        return {"position": wanted.position, "target": wanted.target, "fov_y": wanted.fov_y or 1.0}
    index = wanted.index if wanted is not None and wanted.index is not None else 0
    if index < count:
        return scene.camera(index)
    if count == 0:
        raise usage("--camera: the scene has no camera; give POSITION/TARGET, such as --camera 1,1.6,2/4,1,0")
    raise usage(f"--camera: there is no camera {index}; the scene has {count}, from 0")


def base_settings(args: argparse.Namespace) -> RenderParams:
    """Returns the settings that do not depend on the goal."""
    width, height = args.size
    return {"width": width, "height": height, "seed": args.seed}


@dataclass(frozen=True)
class Picture:
    """A rendering, and its image that is shown."""

    exact: Image
    shown: Image
    report: RenderReport
    is_filtered: bool
    goal: Goal
    is_black: bool

    @property
    def filter_error(self) -> float | None:
        """The stated error of the filtered picture; None if it is not filtered or has too few paths for a statement."""
        error = self.report.preview_error
        return error if self.is_filtered and math.isfinite(error) else None

    def facts(self) -> dict[str, Any]:
        """Returns the picture's figures in the form in which JSON shows them."""
        return {
            "paths_per_pixel": self.report.samples,
            "error": self.report.error,
            "filtered": self.is_filtered,
            "filter_error": self.filter_error,
        }

    def words(self) -> str:
        """Describes the quality in a line."""
        noise = f"{percent(self.report.error)} of noise at {self.report.samples} paths per pixel"
        if not self.is_filtered:
            return noise
        if self.filter_error is None:
            return f"{noise}; the PNG is filtered"
        return f"{noise}; the PNG is filtered, with an error of {percent(self.filter_error)}"

    def doubts(self) -> list[dict[str, Any]]:
        """Returns reasons to doubt the picture."""
        out = []
        if self.is_black:
            out.append(
                doubt(
                    "render",
                    "black",
                    "the picture is black: the scene has no light",
                    "try another camera or --sky 100",
                )
            )
        elif not self.report.error <= max(ROUGH if self.is_filtered else ROUGH / 2, self.goal.error):
            message = f"the picture has {percent(self.report.error)} of noise"
            out.append(doubt("render", "noise", message, "try a longer --time, or --quality best"))
        elif self.goal.error and self.report.error > 1.2 * self.goal.error:
            message = f"the picture has {percent(self.report.error)} of noise instead of {percent(self.goal.error)}"
            out.append(
                doubt(
                    "render", "noise", message, f"try --error {100 * self.goal.error:g}%, which has no limit of time"
                )
            )
        return out

    def save(self, path: Path, white: float) -> None:
        """Saves the shown image as PNG, or the unfiltered values as EXR."""
        if path.suffix.lower() == ".png":
            self.shown.save(path, exposure=1 / white)
        else:
            self.exact.save(path)


def plan_render(
    render: Render, args: argparse.Namespace, goal: Goal, passed: float, console: Console
) -> dict[str, Any]:
    """Plans a rendering and returns its settings."""
    from ..plan import Plan

    plan = Plan(render.context)
    plan.run_render(render, console.step("planning"), settings=base_settings(args), **goal.for_plan(passed))
    return goal.settings(plan.render_params, args)


def run(render: Render, settings: dict[str, Any], goal: Goal, console: Console, title: str = "rendering") -> Picture:
    """Renders, and chooses between the filtered and the unfiltered image."""
    render.run(console.step(title), **settings)
    report, exact = render.report, render.image("beauty")
    # Without light each path returns 0, and the relative error is not a number.
    is_black = not bool(exact.numpy().any())
    is_filtered = settings.get("preview", 0) > 0 and not report.error <= CLEAN and not is_black
    shown = render.image("preview") if is_filtered else exact
    return Picture(exact, shown, report, is_filtered, goal, is_black)


def automatic_white(picture: Picture) -> float:
    """Chooses the luminance to show as white: the 99th percentile of the pixels, but at most eight times the median."""
    import numpy as np

    from .values import LUMINANCE

    luminance = np.nan_to_num(picture.exact.numpy()[:, :, :3]) @ np.array(LUMINANCE)
    lit = luminance[luminance > 0]
    if not lit.size:
        return 100.0
    white = min(float(np.quantile(lit, 0.99)), 8 * float(np.median(lit)))
    return float(f"{white:.2g}") if math.isfinite(white) and white > 0 else 100.0


def expected(seconds: float, error: float) -> str:
    """Describes the prediction of a plan."""
    return f"{clock(seconds)} until {percent(error)} of noise"
