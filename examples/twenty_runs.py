"""Twenty runs in a table: three robots start at random places and put out a fire behind two pillars."""

import numpy as np

import higvf_console as hc

hazards = hc.Hazards().circle((380, 330), radius=15).circle((420, 420), radius=15).fire((550, 350), radius=25)
parameters = hc.make_parameters(fires={"extinguish_time": 0.02})

print(f"{'start':>5} {'out after [s]':>14} {'burnt [m^2]':>12} {'clearance left [m]':>19} {'deadlocked [s]':>15}")
times: list[float] = []
for seed in range(20):
    random = np.random.default_rng(seed)
    corner = random.uniform((50, 100), (200, 550))
    start = corner + np.array([[0, 0], [0, 60], [50, 30]]) + random.uniform(-5, 5, (3, 2))
    report = hc.run(hc.make_setup(start, hazards, parameters), duration=60.0)
    times.append(report["duration_s"])
    left = report["min_clearance_margin_m"]  # None where no robot came near anything
    print(
        f"{seed:5} {report['duration_s']:14.1f} {report['loss_area_total_m2']:12.0f} "
        f"{'-' if left is None else f'{left:.2f}':>19} {report['deadlock_s']:15.2f}"
    )
print(f"median {np.median(times):.1f} s")
