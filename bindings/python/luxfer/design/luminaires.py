"""Luminaires of a design: products with measured photometry, their places, and the scene that they light."""

from __future__ import annotations

import hashlib
import math
import os
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import Error
from ..photometry import LUMINAIRES, Distribution, luminaire_path
from ..scene import Scene

if TYPE_CHECKING:
    from ..context import Context
    from ..transfer import Transfer
    from .rooms import Room

#: Steps in degrees of the made distribution of a flat panel. [convention]
PANEL_STEP = 5


@dataclass(frozen=True)
class Product:
    """A type of luminaire."""

    name: str
    """Name as the list of luminaires prints it."""
    photometry: bytes
    """Bytes of its IES, EULUMDAT or TM-33 file; for a GLDF file, the bytes of a EULUMDAT file of its variant."""
    format: str
    """ "ies", "ldt" or "tm33"."""
    flux: float
    """Luminous flux in lumens at full power."""
    watts: float = 0
    """Electric power in watts at full power; 0 if unknown."""
    rendering: float = 0
    """Colour rendering index Ra; 0 if unknown."""
    size: tuple[float, float, float] = (0, 0, 0)
    """Luminous opening in metres, as in DistributionReport."""
    reference: str = ""
    """Source of the product's description, such as its GLDF file or catalogue number; schedules and reports print
    it."""

    @classmethod
    def load(
        cls,
        context: Context,
        path: str | os.PathLike[str],
        name: str | None = None,
        watts: float = 0,
        rendering: float = 0,
    ) -> Product:
        """A product from its .ies, .ldt, .xml (TM-33) or .gldf file; if watts or rendering is 0, the value of the file
        is used. The name of a variant may follow the name of a .gldf file, as in lamp.gldf#black."""
        file = luminaire_path(path)
        kind = file.suffix.lower().lstrip(".")
        if f".{kind}" not in LUMINAIRES:
            allowed = ".ies, .ldt, .xml or .gldf"
            raise ValueError(f"{file.name} is no photometry that can be used: the name must end in {allowed}")
        if kind == "gldf":
            return cls._of_container(context, path, name, watts, rendering)
        kind = kind if kind in ("ies", "ldt") else "tm33"
        return cls.from_bytes(context, file.read_bytes(), kind, name or file.stem, watts, rendering)

    @classmethod
    def _of_container(
        cls, context: Context, path: str | os.PathLike[str], name: str | None, watts: float, rendering: float
    ) -> Product:
        """A product from a variant of a GLDF file."""
        file = luminaire_path(path)
        file.stat()  # says that the file is missing as for the other formats
        try:
            with Distribution.load(context, path) as variant, tempfile.TemporaryDirectory() as folder:
                data = Path(folder, "variant.ldt")
                variant.save(data)
                found, name = data.read_bytes(), name or variant.name or file.stem
        except Error as error:
            raise ValueError(f"the photometry of {file.name!r} cannot be used for a design: {error}") from error
        product = cls.from_bytes(context, found, "ldt", name, watts, rendering)
        text = os.fspath(path)
        mark = text.lower().find(".gldf#")
        return replace(product, reference=file.name + (text[mark + len(".gldf") :] if mark >= 0 else ""))

    @classmethod
    def from_bytes(
        cls, context: Context, data: bytes, format: str, name: str, watts: float = 0, rendering: float = 0
    ) -> Product:
        """A product from the bytes of its file."""
        try:
            with Distribution.load_memory(context, data, format) as distribution:
                report = distribution.report
        except Error as error:
            raise ValueError(f"the photometry of {name!r} cannot be used for a design: {error}") from error
        if report.flux <= 0:
            raise ValueError(f"the photometry of {name!r} has no flux")
        return cls(
            name, data, format, report.flux, watts or report.watts, rendering or report.rendering, report.size
        )

    @classmethod
    def panel(
        cls,
        context: Context,
        length: float,
        width: float,
        flux: float,
        name: str = "",
        watts: float = 0,
        rendering: float = 0,
    ) -> Product:
        """A flat diffuse panel of that opening in metres, whose intensity falls with the cosine."""
        angles = range(0, 181, PANEL_STEP)
        peak = flux / math.pi
        candela = " ".join(f"{max(0.0, peak * math.cos(math.radians(a))) if a < 90 else 0:.6g}" for a in angles)
        # IES gives the width along C = 90 first, then the length along C = 0.
        text = (
            f"IESNA:LM-63-2002\n[LUMINAIRE] {name or 'diffuse panel'}\nTILT=NONE\n1 -1 1 {len(angles)} 1 1 2 "
            f"{width:.6g} "
            f"{length:.6g} 0\n1 1 {watts:.6g}\n{' '.join(str(a) for a in angles)}\n0\n{candela}\n"
        )
        made = cls.from_bytes(
            context, text.encode(), "ies", name or f"panel {length:.2f} x {width:.2f} m", watts, rendering
        )
        return replace(made, flux=flux)

    @property
    def hash(self) -> str:
        """The first 12 digits of the SHA-256 of the photometry."""
        return hashlib.sha256(self.photometry).hexdigest()[:12]


@dataclass(frozen=True)
class Luminaire:
    """A product at a place."""

    product: Product
    position: tuple[float, float, float]
    """Centre of the opening in metres."""
    dimmer: float = 1
    """Share of the full flux."""
    axis: tuple[float, float, float] = (0, -1, 0)
    """Direction in which it shines."""
    c0: tuple[float, float, float] = (1, 0, 0)
    """Direction of the plane C = 0."""
    colour: tuple[float, float, float] = (1, 1, 1)
    """Linear colour of its light."""
    group: str = ""
    """Luminaires of one group share a dimmer; empty: it has its own."""

    @property
    def flux(self) -> float:
        """Flux in lumens as dimmed."""
        return self.product.flux * self.dimmer

    @property
    def watts(self) -> float:
        """Power in watts as dimmed, in proportion to the flux; 0 if unknown."""
        return self.product.watts * self.dimmer


def dimmed(luminaires: Sequence[Luminaire], dimmers: Sequence[float]) -> list[Luminaire]:
    """The luminaires with other dimmers."""
    if len(luminaires) != len(dimmers):
        raise ValueError(f"there are {len(dimmers)} dimmers for {len(luminaires)} luminaires")
    return [replace(lamp, dimmer=float(d)) for lamp, d in zip(luminaires, dimmers)]


def lit_scene(scene: Scene, luminaires: Sequence[Luminaire], shape: str = "faces") -> Scene:
    """A copy of a scene with these luminaires; luminaires that are off are left out. With the shape "point" they have
    no body."""
    context = scene.context
    copy = Scene.from_bytes(context, scene.to_bytes(), keep_origin=1)
    loaded: dict[bytes, Distribution] = {}
    for lamp in luminaires:
        if lamp.flux <= 0:
            continue
        data = lamp.product.photometry
        if data not in loaded:
            loaded[data] = Distribution.load_memory(context, data, lamp.product.format)
        copy.add_luminaire(
            loaded[data],
            flux=lamp.flux,
            position=lamp.position,
            axis=lamp.axis,
            c0=lamp.c0,
            colour=lamp.colour,
            shape=shape,
        )
    return copy


def layout(
    room: Room, product: Product, columns: int, rows: int, below: float = 0.01, group: str = ""
) -> list[Luminaire]:
    """Equal luminaires in columns along the room and rows across it, at half the spacing from the walls, at a distance
    in metres below the ceiling."""
    if columns < 1 or rows < 1:
        raise ValueError(f"a layout of {columns} by {rows} luminaires has none")
    plan = [
        (room.length * (i + 0.5) / columns, room.width * (j + 0.5) / rows) for j in range(rows) for i in range(columns)
    ]
    c0 = (float(room.along[0]), float(room.along[1]), float(room.along[2]))
    places = room.world(plan, room.height - below)
    return [Luminaire(product, (float(x), float(y), float(z)), c0=c0, group=group) for x, y, z in places]


def from_transfer(
    context: Context, transfer: Transfer, product: Product | None = None, efficacy: float = 0, rendering: float = 0
) -> list[Luminaire]:
    """The lamps of a photo's lighting as luminaires: each at its place, with its flux and colour.

    Without a product each lamp becomes a flat diffuse panel of its size, of that efficacy in lm/W (0: power unknown)
    and colour rendering index. With a product, each lamp becomes this product, whose full flux must suffice: the dimmer
    is the photo's flux over the product's."""
    out = []
    for fixture in transfer.fixtures:
        if fixture.flux <= 0:
            continue
        peak = max(fixture.radiance)
        colour = tuple(max(v, 0.0) / peak for v in fixture.radiance)
        kind, dimmer = product, 1.0
        if kind is None:
            watts = fixture.flux / efficacy if efficacy > 0 else 0
            kind = Product.panel(context, *fixture.size, fixture.flux, watts=watts, rendering=rendering)
        else:
            dimmer = fixture.flux / kind.flux
        # A little off the surface, so that this does not shade the lamp.
        place = np.array(fixture.position) + 0.005 * np.array(fixture.normal)
        out.append(Luminaire(kind, _three(place), dimmer, fixture.normal, fixture.axis, _three(colour)))
    if not out:
        raise ValueError("the transfer has no lamp that shines: run it up to the stage RELIGHT")
    return out


def points(luminaires: Sequence[Luminaire]) -> list[str]:
    """Sentences about luminaires whose photometry states no size, which therefore shine from points."""
    names = {lamp.product.name: None for lamp in luminaires if sum(v != 0 for v in lamp.product.size) < 2}
    return [
        f"{name}: its photometry states no size of the opening, so it shines from a point, which is right at distances "
        f"of at least five times its size."
        for name in names
    ]


def _three(values: Sequence[float] | np.ndarray) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in values)
    return x, y, z
