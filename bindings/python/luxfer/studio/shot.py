"""The steps in the photo: its camera, its masks, and its plane seen from the front."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import luxfer
import numpy as np

from . import grid, pictures, reshape
from .jobs import Latest
from .live import strokes_of
from .project import Project
from .room import MAX_TEXELS

#: Maximum distance of a point from the lamp that it selects, as a share of the photo's width.
MAX_LAMP_DISTANCE = 0.015


class Shot:
    """A photo with the transfer that looks at it. Each surface that receives lamps has a shot of its own, because a
    transfer has one surface; their masks are alike."""

    def __init__(self, photo: luxfer.Image, thread: Latest[Any], send: Callable[..., None]):
        self.context, self.photo, self.thread, self.send = photo.context, photo, thread, send
        self.transfer = luxfer.Transfer(self.context, photo)
        self.is_replaced = False  # whether the mask of the lights is not the library's own
        self.is_dragged = False  # whether the camera of the photo comes from the dragged grid
        #: Photo and mask of the lights with the reshaped lamps, if there are any.
        self.edited: tuple[luxfer.Image, luxfer.Image] | None = None
        #: The distance from the plane, and its error, before lamps were reshaped: they change, and the room does not.
        self.kept_distance: tuple[float, float] | None = None
        #: Directions of the room axes and focal length of the dragged grid.
        self.camera_by_grid: tuple[list[list[float]], float] | None = None
        self.lights: luxfer.Image | None = None

    def stage(self, first: str, last: str, **settings: Any) -> None:
        """Runs stages of the transfer."""
        self.send("working", stage=last)
        self.thread.finish(self.transfer.start(first, last, **settings))

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
        if self.edited is not None:
            self.transfer.set_photo(self.photo)
        self.edited = self.kept_distance = None

    def unwarp(self, project: Project, room: luxfer.Scene, surface: str) -> None:
        """Shows the plane from the front. The surface of the room decides nothing here."""
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
                self.transfer.set_scene(room, surface)
                self.change_lamps(project, mask)
                self.stage("unwarp", "unwarp", **settings)
        finally:
            self.send_view(project)
            self.send_warnings()

    def follow(self, other: Shot, project: Project) -> None:
        """Repeats what another shot of this photo has done."""
        self.find_view()
        self.make_masks(project)
        if project["removed"]:
            self.transfer.use_mask("lights", other.transfer.image("lights-mask"))
            self.is_replaced = True
        settings = self.plane_of(project)
        if other.edited is not None:
            self.edited, self.kept_distance = other.edited, other.kept_distance
            self.transfer.set_photo(self.edited[0])
            self.transfer.use_mask("lights", self.edited[1])
            self.is_replaced = True
        self.stage("unwarp", "unwarp", **settings)

    def change_lamps(self, project: Project, mask: np.ndarray[Any, Any]) -> None:
        """Replaces photo and mask by ones with the reshaped lamps, at the scale that the lamps had before."""
        self.stage("emission", "emission", max_texels=MAX_TEXELS)
        report = self.transfer.report
        self.kept_distance = report.plane_distance, report.plane_distance_error
        pixels, plane = self.photo.numpy(), self.transfer.image("plane-mask").numpy()[..., 0]
        changed = reshape.apply(pixels, mask, plane, project["reshaped"], MAX_LAMP_DISTANCE * mask.shape[1])
        if not (changed[1] > 0.5).any():
            raise ValueError("no reshaped lamp lies in the photo: undo one")
        self.edited = luxfer.Image(self.context, changed[0]), luxfer.Image(self.context, changed[1])
        self.transfer.set_photo(self.edited[0])
        self.transfer.use_mask("lights", self.edited[1])
        self.is_replaced = True
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
            lens=[*view.principal, reshape.bend(view, self.photo.size[:2])],
        )

    def warnings(self) -> list[luxfer.StageWarning]:
        try:
            return self.transfer.warnings
        except luxfer.errors.NotReady:
            return []

    def send_warnings(self) -> None:
        send_warnings(self.send, self.warnings())


def send_warnings(send: Callable[..., None], warnings: list[luxfer.StageWarning]) -> None:
    send(
        "warnings",
        list=[
            {"code": w.code.name, "stage": w.stage.name.lower(), "message": w.message, "advice": w.advice, "at": w.place}
            for w in warnings
        ],
    )
