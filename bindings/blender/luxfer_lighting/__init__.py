"""Lighting from one photo onto the scene, and painting it by example: panels in the sidebar of the 3D view, tab "Luxfer".

    photo ─▶ strokes painted on it ─▶ masks ─▶ transfer ─▶ an emissive material in cd/m² on the chosen object
    ball ─▶ artwork painted over it ─▶ stylise ─▶ an image

One file for each thing: `convert` turns Blender's data into luxfer's and back, `work` runs jobs behind the user
interface, `lighting` and `painting` are the operators, `live` shows masks while strokes are painted, `passes` has a second
Blender render (`render_passes`), `panels` is what is seen of them, `settings` what is stored in the .blend.
One unit of radiance in Blender is taken as one cd/m², so numbers in materials are nits.
"""

from . import lighting, live, painting, panels, settings, work

MODULES = (settings, work, lighting, live, painting, panels)


def register() -> None:
    for module in MODULES:
        module.register()


def unregister() -> None:
    for module in reversed(MODULES):
        module.unregister()
