"""The lit scene of a transfer, and its lamps in another colour or strength: --colour and --lux.

Light is linear in the emission, so both are factors of the emission, and nothing is solved again."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .console import Console
from .exits import failed
from .values import LUMINANCE

if TYPE_CHECKING:
    from ..scene import Scene
    from ..transfer import Transfer
    from ..types import Fixture

#: Columns of luminaires.csv, as the library writes them.
COLUMNS = (
    "x_m,y_m,z_m,normal_x,normal_y,normal_z,axis_x,axis_y,axis_z,length_m,width_m,area_m2,"
    "red_cd_m2,green_cd_m2,blue_cd_m2,flux_lm,cct_k,duv,kind"
)

#: Seed of the paths that measure the illuminance after --lux; they are independent of the paths that set the factor.
#: [convention]
RECHECK_SEED = 2


def luminance(colour: Any) -> float:
    """Returns the luminance of a linear colour."""
    return float(sum(w * c for w, c in zip(LUMINANCE, colour)))


@dataclass
class Lit:
    """The lit scene, with the changes of --colour and --lux."""

    scene: Scene
    transfer: Transfer
    white: float
    """The luminance that pictures show as white."""
    lamps: list[Fixture]
    lux: float | None = None
    """The mean illuminance after --lux, measured with the new light."""
    lux_error: float = 0.0
    """Its standard error."""
    lux_target: float | None = None
    """The mean illuminance that was asked for."""
    lux_words: str = ""
    is_changed: bool = False

    @classmethod
    def of(cls, transfer: Transfer, white: float) -> Lit:
        """Returns the scene that the stage RELIGHT has lit."""
        return cls(transfer.scene("lit"), transfer, white, transfer.fixtures)

    @property
    def material(self) -> int:
        """Index of the emissive material, which the transfer adds as the last one."""
        return self.scene.counts.materials - 1

    @property
    def flux(self) -> float:
        """Returns the luminous flux of all lamps in lumens."""
        return sum(lamp.flux for lamp in self.lamps)

    def multiply(self, factors: Any) -> None:
        """Multiplies the light of all lamps, per channel."""
        from ..photometry import colour_temperature

        emission = self.scene.material(self.material)["emission"]
        self.scene.set_material(self.material, emission=[e * f for e, f in zip(emission, factors)])
        lamps = []
        for lamp in self.lamps:
            radiance = tuple(r * f for r, f in zip(lamp.radiance, factors))
            before, after = luminance(lamp.radiance), luminance(radiance)
            cct, duv = colour_temperature(self.scene.context, radiance) if after > 0 else (0.0, 0.0)
            flux = lamp.flux * after / before if before > 0 else 0.0
            lamps.append(dataclasses.replace(lamp, radiance=radiance, flux=flux, cct=cct, duv=duv))
        self.lamps, self.is_changed = lamps, True

    def mean_colour(self) -> tuple[float, ...]:
        """Returns the sum of the light of all lamps, per channel."""
        return tuple(sum(lamp.radiance[i] * lamp.area for lamp in self.lamps) for i in range(3))

    def recolour(self, wanted: float | tuple[float, ...]) -> None:
        """Changes the mean colour of the lamps to a colour temperature or a linear RGB colour, at equal flux."""
        from ..photometry import colour_of_temperature

        colour = colour_of_temperature(self.scene.context, wanted) if isinstance(wanted, float) else wanted
        now = self.mean_colour()
        if luminance(now) <= 0 or any(n <= 0 < c for n, c in zip(now, colour)):
            raise failed("--colour: the lamps have no light in a colour channel that the colour needs")
        scale = luminance(now) / luminance(colour)
        self.multiply([max(0.0, c) * scale / n if n > 0 else 0.0 for c, n in zip(colour, now)])

    def dim_to(self, lux: float, surface: str, console: Console) -> None:
        """Dims the lamps to a mean illuminance of the plane of desks, and adapts the exposure of the picture."""
        from .lux import measure
        from .plane import above_floor

        plane = above_floor(self.transfer.scene("unsolved"), self._ceiling(surface))
        emission = self.scene.material(self.material)["emission"]
        whole = measure(self.scene, plane, 0.25, 0.005, console).report.mean
        self.scene.set_material(self.material, emission=(0, 0, 0))
        other = measure(self.scene, plane, 0.25, 0.005, console).report.mean if self._has_other_light() else 0.0
        self.scene.set_material(self.material, emission=emission)
        if lux < other:
            raise failed(f"--lux is {lux:g}, but the scene's other lights alone give {other:.0f} lux on {plane.words}")
        if whole - other <= 1e-6 * whole:
            raise failed(f"--lux: no light of the lamps reaches {plane.words}")
        factor = (lux - other) / (whole - other)
        self.multiply((factor,) * 3)
        self.white *= lux / whole
        reached = measure(self.scene, plane, 0.25, 0.005, console, RECHECK_SEED).report
        self.lux, self.lux_error = reached.mean, reached.mean_error
        self.lux_target, self.lux_words = lux, plane.words

    def _ceiling(self, surface: str) -> str:
        """Returns the name of the emissive surface, which the transfer has split off the ceiling."""
        return self.scene.mesh_name(self.scene.counts.meshes - 1) or surface

    def _has_other_light(self) -> bool:
        """Whether the scene has other light than the lamps; valid while the lamps are off."""
        return int(self.scene.requirements().lights) != 0

    def save_lamps(self, path: Path) -> None:
        """Writes luminaires.csv."""
        if not self.is_changed:
            self.transfer.save_fixtures(path)
            return
        from . import files

        lines = [COLUMNS]
        for lamp in self.lamps:
            numbers = (
                *lamp.position,
                *lamp.normal,
                *lamp.axis,
                *lamp.size,
                lamp.area,
                *lamp.radiance,
                lamp.flux,
                lamp.cct,
                lamp.duv,
            )
            lines.append(",".join(f"{n:.7g}" for n in numbers) + f",{lamp.kind}")
        files.write_text(path, "\n".join(lines) + "\n")

    def facts(self) -> dict[str, Any]:
        """Returns the lamps in the form in which JSON shows them."""
        return {"lamps": len(self.lamps), "flux_lm": self.flux, "cct_k": self.cct, **self._lux_facts()}

    def _lux_facts(self) -> dict[str, Any]:
        if self.lux is None:
            return {"lux": None}
        return {"lux": self.lux, "lux_error": self.lux_error, "lux_target": self.lux_target}

    @property
    def cct(self) -> float | None:
        """Returns the correlated colour temperature of the mean colour of the lamps."""
        from ..photometry import colour_temperature

        colour = self.mean_colour()
        return colour_temperature(self.scene.context, colour)[0] if luminance(colour) > 0 else None

    def words(self) -> list[str]:
        """Describes the lamps in lines."""
        temperature = f", {self.cct:.0f} K" if self.cct else ""
        lines = [f"{len(self.lamps)} lamps, {self.flux:.0f} lm together{temperature}"]
        if self.lux is not None:
            asked = f"{self.lux_target:g} asked for"
            lines.append(f"{self.lux:.1f} ± {2 * self.lux_error:.1f} lux on {self.lux_words}, {asked}")
        return lines
