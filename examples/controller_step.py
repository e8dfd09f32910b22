"""The method on positions of one's own: a motion-capture system measures, the controller answers.

The loop below stands for a laboratory: `measured` is where the robots are, `velocities` is what they are sent.
"""

import numpy as np

import higvf_console as hc

start = [[100.0, 350.0], [60.0, 320.0], [60.0, 380.0]]  # (N, 2) [m]
hazards = hc.Hazards().circle((300, 330), radius=20).inside((0, 0, 1200, 700))
parameters = hc.make_parameters(safety={"robot_clearance": 20.0, "speed_limit": 80.0})
controller = hc.Controller(hc.make_setup(start, hazards, parameters))

path = hc.sketch_path([[100, 350], [300, 330], [500, 350], [700, 300]])  # robot 0 is led along it
period = parameters.safety.control_period  # [s]

measured = np.array(start)
for _ in range(500):
    velocities = controller.step(measured, path, influenced=0)  # (N, 2) [m/s], safe
    measured = measured + period * velocities  # here the robots would drive

assert controller.trace is not None
print(f"After {500 * period:g} s the robots are at {measured.round(1).tolist()}.")
print(f"Clearance left: {controller.trace.clearance.min():.1f} m; infeasible: {controller.trace.infeasible.any()}.")
