"""The part of the guide in which Radiance recomputes a lighting design."""

import luxfer
from luxfer import design
from luxfer.design import areas

context = luxfer.Context()
room = design.Room.find(luxfer.Scene.demo(context, "target-room"))
desk = areas.task_on(room, "desk", "Table")
panel = design.Product.panel(context, 0.6, 0.6, flux=5000, watts=40, rendering=80)
settings = design.Settings(maintenance=0.8, samples=64)
project = design.Project(room, design.layout(room, panel, columns=2, rows=1), (desk,), settings=settings)
project = project.requiring(design.Requirement("mean", "desk", at_least=100))

# --8<-- [start:radiance]
checked = project.check()
design.radiance.export(project, "radiance")
second = design.radiance.recompute(project, checked, "radiance")
print(*second, sep="\n")
design.save(project, "report.html", checked, second=second)
# --8<-- [end:radiance]

assert len(second) == 1 and second[0].confirms and abs(second[0].difference) < 0.03, second
