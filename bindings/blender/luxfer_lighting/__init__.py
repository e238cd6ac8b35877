"""Transfers lighting from one photo to the scene, and paints the scene by example: tab "Luxfer" in the 3D view's
sidebar.

    photo ─▶ strokes painted on it ─▶ masks ─▶ transfer ─▶ an emissive material in cd/m² on the chosen object
    ball ─▶ artwork painted over it ─▶ stylise ─▶ an image

Files: `convert` converts Blender's data to luxfer's and back, `work` runs jobs in the background, `lighting` and
`painting` have the operators, `live` shows masks while strokes are painted, `parts` decides which objects are painted
like the ball, `passes` renders guides in a second Blender (`render_passes`), `panels` draws the panels, `settings` has
the data that the .blend stores. One unit of radiance in Blender is one cd/m², so the numbers in materials are nits.
"""

from . import lighting, live, painting, panels, settings, work

MODULES = (settings, work, lighting, live, painting, panels)


def register() -> None:
    for module in MODULES:
        module.register()


def unregister() -> None:
    for module in reversed(MODULES):
        module.unregister()
