"""The program of the guide that saves and loads USD files."""

# --8<-- [start:usd]
import luxfer
import luxfer.usd

context = luxfer.Context()
room = luxfer.Scene.demo(context, "exemplar-room")
luxfer.usd.save(room, "room.usdz")

scene = luxfer.usd.load(context, "room.usdz")  # or luxfer.usd.from_stage(context, stage), for an open stage
render = luxfer.Render(context, scene)
render.run(width=64, height=48, samples=8).image().save("room.png", exposure=0.01)
# --8<-- [end:usd]

import numpy as np  # noqa: E402

first = luxfer.Render(context, room).run(width=64, height=48, samples=8).image().numpy()
second = render.image().numpy()
assert abs(second.mean() / first.mean() - 1) < 0.01, (first.mean(), second.mean())
assert np.median(np.abs(second - first)) <= 0.05 * first.mean()
print("USD: the same room, the same light")
