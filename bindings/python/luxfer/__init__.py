"""Lighting from one photo onto a 3D scene, and illumination-guided stylisation.

Create a Context, create objects in it, and start a stage, or run it and wait. Images are numpy arrays. Units:
metres, radians, right-handed, Y up; scene-linear Rec.709, luminance in cd/m², illuminance in lux, flux in lumens.

Settings are keyword arguments, and enumerations may be given by name ("srgb", "plane-mask"). Errors of the library are
exceptions of errors.Error with its message. `abi` has the whole C interface, callable through `library`.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import _abi as abi
    from . import errors, types
    from ._library import library
    from .candidate import SurfaceCandidate
    from .context import Context
    from .daylight import Weather, sun_position
    from .demo import DemoPhoto
    from .emission import Emission
    from .errors import Error
    from .features import Features
    from .guides import Guides
    from .illuminance import Illuminance
    from .image import Image, homography, merge_exposures
    from .importance import Importance
    from .job import Job, Task
    from .lamps import Lamps
    from .pendant import find_pendants
    from .photometry import (
        Distribution,
        colour_of_temperature,
        colour_temperature,
        false_colour,
        fit_temperature,
        glare,
        mix_primaries,
        presets,
    )
    from .plan import Plan
    from .rectify import Rectify
    from .relight import Relight
    from .render import Render
    from .scene import Scene
    from .segment import Segment
    from .sheet import align_sheet, print_sheet
    from .strokes import Strokes
    from .stylize import Stylize
    from .transfer import Transfer
    from .warning import StageWarning

__all__ = [
    "Context",
    "DemoPhoto",
    "Distribution",
    "Emission",
    "Error",
    "Features",
    "Guides",
    "Illuminance",
    "Image",
    "Importance",
    "Job",
    "Lamps",
    "Plan",
    "Rectify",
    "Relight",
    "Render",
    "Scene",
    "Segment",
    "StageWarning",
    "Strokes",
    "Stylize",
    "SurfaceCandidate",
    "Task",
    "Transfer",
    "Weather",
    "abi",
    "align_sheet",
    "colour_of_temperature",
    "colour_temperature",
    "errors",
    "false_colour",
    "find_pendants",
    "fit_temperature",
    "glare",
    "homography",
    "library",
    "merge_exposures",
    "mix_primaries",
    "presets",
    "print_sheet",
    "sun_position",
    "types",
]

#: The module of each name that is not a class in a module of its own name.
_MODULES = {
    "abi": "_abi",
    "library": "_library",
    "Error": "errors",
    "SurfaceCandidate": "candidate",
    "Weather": "daylight",
    "sun_position": "daylight",
    "DemoPhoto": "demo",
    "homography": "image",
    "merge_exposures": "image",
    "Task": "job",
    "find_pendants": "pendant",
    "StageWarning": "warning",
    "align_sheet": "sheet",
    "print_sheet": "sheet",
    **dict.fromkeys(
        (
            "Distribution",
            "colour_of_temperature",
            "colour_temperature",
            "false_colour",
            "fit_temperature",
            "glare",
            "mix_primaries",
            "presets",
        ),
        "photometry",
    ),
}


def _module_of(name: str) -> str:
    return _MODULES.get(name, name.lower())


def __getattr__(name: str) -> Any:
    """Imports a name, with its module, when it is first used: `luxfer --help` needs neither numpy nor the library."""
    if name == "__version__":
        abi = importlib.import_module("._abi", __name__)
        value: Any = f"{abi.LUXFER_VERSION_MAJOR}.{abi.LUXFER_VERSION_MINOR}.{abi.LUXFER_VERSION_PATCH}"
    elif name in __all__:
        module = importlib.import_module("." + _module_of(name), __name__)
        value = module if name in ("abi", "errors", "types") else getattr(module, name)
    elif name in map(_module_of, __all__):
        value = importlib.import_module("." + name, __name__)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
