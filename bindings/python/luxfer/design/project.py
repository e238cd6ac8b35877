"""A design with everything that belongs to it, so that it can be checked, solved and reported in one line each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..scene import Scene
from . import emergency, fingerprint, scenes
from . import energy as energies
from .areas import Area
from .arrange import Arrangement, Offer, Search, arrange
from .check import Checked, Settings, check, with_energy
from .luminaires import Luminaire, Product, lit_scene
from .observers import Observers
from .rooms import Room
from .scenes import LightScene
from .solve import Solution, Wishes, solve
from .standard import Place, Requirement, requirements


@dataclass(frozen=True)
class Project:
    """A room with its luminaires, areas, observers and requirements.

    >>> from luxfer.design import areas, layout
    >>> room = Room.find(luxfer_scene)
    >>> desk = areas.task_on(room, "desk", "Table")
    >>> project = Project(room, layout(room, panel, 3, 2), (desk,), settings=Settings(maintenance=0.8))
    >>> project = project.requiring(Requirement("mean", "desk", at_least=100))
    >>> print(project.check().verdict())
    all 1 requirements pass, each with at least 97.5 %
    """

    room: Room
    luminaires: Sequence[Luminaire]
    areas: Sequence[Area]
    observers: Sequence[Observers] = ()
    requirements: Sequence[Requirement] = ()
    settings: Settings | None = None
    unit: str = "m"
    """Unit of lengths in the report: "m", "mm" or "inch"."""
    name: str = "Lighting design"
    """Title of the report."""
    author: str = ""
    """Name beside the signature."""
    scenes: Sequence[LightScene] = ()
    """Named states of the dimmers."""
    standby: energies.Standby = energies.Standby()
    """Power used besides the power of the light, for the energy of the design."""

    def requiring(self, *more: Requirement) -> Project:
        """The project with further requirements."""
        return replace(self, requirements=(*self.requirements, *more))

    def for_place(self, row: Place, modified: bool = False) -> Project:
        """The project with the requirements of a place for all its areas and observers. One of the areas must be a
        task: without it nothing would ask for the illuminance of the place."""
        if not any(a.kind == "task" for a in self.areas):
            raise ValueError(
                f"no area is a task, so the illuminance of {row.name!r} would not be checked: "
                "add one by areas.task or areas.task_on; where the task may be anywhere, it is the whole floor"
            )
        kinds = {a.name: a.kind for a in self.areas} | {o.name: "observers" for o in self.observers}
        return self.requiring(*requirements(row, kinds, modified))

    @property
    def chosen(self) -> Settings:
        """The settings; without them the maintenance factor is unknown, which is an error."""
        if self.settings is None:
            raise ValueError(
                "the project has no settings: give Settings(maintenance=...), such as 0.8 for a clean office"
            )
        return self.settings

    def lit(self) -> Scene:
        """The scene with the luminaires at their initial flux."""
        return lit_scene(self.room.scene, self.luminaires)

    def in_scene(self, name: str) -> Project:
        """The design in one of its light scenes, with the requirements of this state alone."""
        state = scenes.find(self.scenes, name)
        settings = self.chosen
        if state.maintenance is not None:
            settings = replace(settings, maintenance=state.maintenance)
        room = emergency.dark(self.room) if state.direct else self.room
        lamps = state.lamps(self.luminaires)
        limits = state.requirements
        return replace(self, room=room, luminaires=lamps, requirements=limits, settings=settings, scenes=())

    def check_scenes(self) -> dict[str, Checked]:
        """Checks each light scene that has requirements, by its name."""
        return {s.name: self.in_scene(s.name).check() for s in self.scenes if s.requirements}

    def energy(self) -> energies.Energy | None:
        """The energy of a year by the hours of the light scenes; None if no light scene has hours."""
        return energies.energy(self.luminaires, self.scenes, self.room.floor_area, self.standby)

    def check(self) -> Checked:
        """Checks all requirements."""
        return check(
            self.lit(),
            self.luminaires,
            self.requirements,
            self.areas,
            self.observers,
            floor_area=self.room.floor_area,
            settings=self.chosen,
            energy=self._leni(),
        )

    def solve(self, wishes: Wishes = Wishes()) -> Solution:
        """Finds the dimmers closest to the present ones that meet the requirements."""
        found = solve(
            self.room.scene,
            self.luminaires,
            self.requirements,
            self.areas,
            self.observers,
            floor_area=self.room.floor_area,
            settings=self.chosen,
            wishes=wishes,
        )
        if not self._limits_energy:
            return found
        return replace(found, checked=with_energy(found.checked, self.solved(found)._leni()))

    def arrange(
        self, offers: Sequence[Offer | Product], wishes: Wishes = Wishes(), search: Search = Search()
    ) -> Arrangement:
        """Finds places, product and dimmers together that are closest to the look of the present luminaires and meet
        the requirements (see luxfer.design.arrange)."""
        return arrange(self, offers, wishes, search)

    def solved(self, solution: Solution) -> Project:
        """The project with the luminaires of a solution."""
        return replace(self, luminaires=solution.luminaires)

    def _leni(self) -> float | None:
        """LENI, if a requirement limits it and light scenes have hours of use."""
        used = self.energy() if self._limits_energy else None
        return used.leni if used else None

    @property
    def _limits_energy(self) -> bool:
        return any(r.quantity == "energy" for r in self.requirements)

    def record(self) -> dict[str, Any]:
        """All inputs on which the numbers depend (see fingerprint)."""
        return fingerprint.record(
            self.room.scene,
            self.luminaires,
            self.requirements,
            self.areas,
            self.observers,
            self.chosen,
            self.scenes,
            self.standby,
        )
