"""A team led along a stroke past an obstacle: how near robot 1 came to the path, and all robots to anything."""

import numpy as np

import higvf_console as hc

stroke = [[100, 350], [250, 420], [400, 300], [550, 260], [700, 350], [850, 400]]  # as drawn [m]
path = hc.sketch_path(stroke, ending="hold")  # the team waits at its end
hazards = hc.Hazards().circle((620, 360), radius=20)
setup = hc.make_setup([[100, 350], [60, 320], [60, 380]], hazards, path=path)

# `roll` computes 1 000 control periods in one call; `advance` does one at a time.
end, history = hc.roll(setup.start, setup.world, setup.params, ticks=1000)

drawn = hc.path_points(path)
travelled = history.position[:, 0]  # (T, 2) of robot 1
distance = np.linalg.norm(travelled[:, None] - drawn[None], axis=2).min(axis=1)
print(f"A path of {path.length:.0f} m, followed for {1000 * setup.params.safety.control_period:g} s.")
print(f"Robot 1 was {np.median(distance):.1f} m from it (median), {distance.max():.1f} m at most, round the obstacle.")
print(f"It has come {end.motion.path_parameter:.0f} m along; smallest clearance left: {history.clearance.min():.2f} m.")
