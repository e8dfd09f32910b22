"""Obstacles of one's own: capsules, polygons, walls, moving ones; the safety filter alone also takes growing ones."""

import higvf_console as hc

# An L-shaped building, a wall with round ends, and the arena's four sides. Each call returns a new `Hazards`.
hazards = (
    hc.Hazards()
    .polygon([[300, 250], [420, 250], [420, 300], [350, 300], [350, 420], [300, 420]])
    .capsule((600, 200), (600, 420), half_width=6)
    .inside((0, 0, 1000, 700))
)
path = hc.sketch_path([[100, 330], [450, 360], [800, 330]])
setup = hc.make_setup([[100, 330], [60, 300], [60, 360]], hazards, path=path)
end, history = hc.roll(setup.start, setup.world, setup.params, ticks=1500)
print(f"Robot 1 is at {end.motion.position[0].round(0).tolist()}; clearance left: {history.clearance.min():.2f} m.")

# In a run, circles and capsules may move: this truck crosses the path, and robots give way to it.
truck = hc.Hazards().capsule((350, 480), (350, 510), half_width=8, velocity=(0, -15))
setup = hc.make_setup([[100, 330], [60, 300], [60, 360]], truck, path=path)
end, history = hc.roll(setup.start, setup.world, setup.params, ticks=1000)
print(f"With a truck robot 1 is at {end.motion.position[0].round(0).tolist()}; left: {history.clearance.min():.2f} m.")

# The filter alone also takes what grows, such as a spill. One that grows 5 m/s pushes a standing robot away.
spill = hc.Hazards().circle((0, 0), radius=20, growth=5.0)
pushed = hc.filter_velocities([[32.5, 0.0]], [[0.0, 0.0]], spill)
print(f"A robot that wants to stand beside the spill moves at {pushed.velocity[0].round(2).tolist()} m/s.")

# What cannot be is refused in one line.
try:
    hazards.polygon([[0, 0], [10, 10], [10, 0], [0, 10]])
except hc.ArgumentError as error:
    print(f"Refused: {error}")
