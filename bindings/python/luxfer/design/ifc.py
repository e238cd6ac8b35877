"""Building models: spaces and light fixtures of IFC files as rooms and luminaires, and designs as IFC files.

Both need ifcopenshell: `pip install luxfer[ifc]`.

- `load` reads the spaces of a file: walls, floor and ceiling of a space as a room, its light fixtures with their
  photometry (IfcLightSourceGoniometric, or a file that the type refers to), its lighting zones as task areas, and its
  furniture.
- `save` writes a design: the space, a fixture for each luminaire with its photometry as a distribution and as a file
  beside the model, task areas as lighting zones, and each result with its interval and outcome.

Not read: openings for windows and doors, materials and their colours, and fixtures without photometry, which the notes
name.
"""

from __future__ import annotations

from .ifc_read import Building, load
from .ifc_write import save

__all__ = ["Building", "load", "save"]
