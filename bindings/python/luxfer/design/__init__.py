"""Lighting design that can be signed: requirements of EN 12464-1, areas and grids, checks with confidence, dimmers
closest to a photo's look, and a report.

A Project holds a room, luminaires, areas, observers and requirements. Lengths are metres unless a unit is given.
"""

from . import areas, emergency, ifc, observers, radiance, schedule, standard
from .arrange import Arrangement, Offer, Search, arrange
from .check import Checked, Finding, Settings, check
from .command import main
from .energy import Energy, Hours, Standby
from .glare_table import UgrTable, ugr_table
from .lamps import Lamp
from .likeness import Likeness
from .look import Distance, distance
from .luminaires import Luminaire, Product, dimmed, from_transfer, layout, lit_scene
from .products import Found, find_products
from .project import Project
from .report import save
from .rooms import Room
from .scenes import LightScene
from .solve import Solution, Wishes, solve
from .standard import Place, Requirement, place, places_from, requirements

__all__ = [
    "Arrangement",
    "Checked",
    "Distance",
    "Energy",
    "Finding",
    "Found",
    "Hours",
    "Lamp",
    "LightScene",
    "Likeness",
    "Luminaire",
    "Offer",
    "Place",
    "Product",
    "Project",
    "Requirement",
    "Room",
    "Search",
    "Settings",
    "Solution",
    "Standby",
    "UgrTable",
    "Wishes",
    "areas",
    "arrange",
    "check",
    "dimmed",
    "distance",
    "emergency",
    "find_products",
    "from_transfer",
    "ifc",
    "layout",
    "lit_scene",
    "main",
    "observers",
    "place",
    "places_from",
    "radiance",
    "requirements",
    "save",
    "schedule",
    "solve",
    "standard",
    "ugr_table",
]
