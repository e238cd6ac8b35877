"""The inputs of a design as one record and one hash: equal records give equal designs, to the bit."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any

from .. import _abi

if TYPE_CHECKING:
    from ..scene import Scene
    from .areas import Area
    from .check import Settings
    from .energy import Standby
    from .luminaires import Luminaire
    from .observers import Observers
    from .scenes import LightScene
    from .standard import Requirement

#: Version of the record's form.
FORM = 2


def version() -> str:
    """Version of the library."""
    return f"{_abi.LUXFER_VERSION_MAJOR}.{_abi.LUXFER_VERSION_MINOR}.{_abi.LUXFER_VERSION_PATCH}"


def record(
    scene: Scene,
    luminaires: Sequence[Luminaire],
    requirements: Sequence[Requirement],
    areas: Sequence[Area],
    observers: Sequence[Observers],
    settings: Settings,
    scenes: Sequence[LightScene] = (),
    standby: Standby | None = None,
) -> dict[str, Any]:
    """All inputs on which the numbers of a report depend; the scene, the photometry and the grids are given by their
    SHA-256."""
    return {
        "form": FORM,
        "luxfer": version(),
        "scene": hashlib.sha256(scene.to_bytes()).hexdigest(),
        "settings": asdict(settings),
        "luminaires": [
            {
                "product": lamp.product.name,
                "photometry": hashlib.sha256(lamp.product.photometry).hexdigest(),
                "flux": lamp.product.flux,
                "watts": lamp.product.watts,
                "rendering": lamp.product.rendering,
                "dimmer": lamp.dimmer,
                "position": list(lamp.position),
                "axis": list(lamp.axis),
                "c0": list(lamp.c0),
                "colour": list(lamp.colour),
            }
            for lamp in luminaires
        ],
        "requirements": [asdict(r) for r in requirements],
        "areas": {a.name: _digest(*(v for p in a.patches for v in (p.points, p.normal, p.keep))) for a in areas},
        "scenes": [_state(s, luminaires) for s in scenes],
        "standby": asdict(standby) if standby else None,
        "observers": {o.name: _digest(o.positions, o.directions) for o in observers},
    }


def _state(scene: LightScene, luminaires: Sequence[Luminaire]) -> dict[str, Any]:
    """The inputs on which the numbers of a light scene depend."""
    dimmers = [lamp.dimmer for lamp in scene.lamps(luminaires)]
    rest = {f.name: getattr(scene, f.name) for f in fields(scene) if f.name != "dimmers"}
    kept = {"requirements": [asdict(r) for r in scene.requirements], "hours": scene.hours and asdict(scene.hours)}
    return {**rest, "dimmers": dimmers, **kept}


def digest(made_of: dict[str, Any]) -> str:
    """SHA-256 of a record."""
    return hashlib.sha256(json.dumps(made_of, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def _digest(*arrays: Any) -> str:
    out = hashlib.sha256()
    for array in arrays:
        out.update(repr(array.shape).encode() + array.tobytes())
    return out.hexdigest()
