"""A scenario in Python, no file: run it, look at every control period, record it, replay it, save it."""

import tempfile
from pathlib import Path

import higvf_console as hc

setup = hc.make_setup(
    positions=[[700, 300], [670, 350], [730, 350]],
    hazards=hc.Hazards()
    .fire((500, 250), radius=20)
    .fire((300, 450), radius=30)
    .circle((480, 400), 20)
    .inside((0, 0, 1200, 700)),
    parameters=hc.make_parameters(fires={"extinguish_time": 0.02}),
)
scenario = hc.make_scenario(setup, "two-fires", title="Two fires", duration=60.0)

with tempfile.TemporaryDirectory() as folder:
    record = Path(folder, "run.jsonl")
    path_of_robot_1: list[list[float]] = []
    report = hc.run(
        scenario, record=record, each=lambda tick: path_of_robot_1.append(tick.state.motion.position[0].tolist())
    )
    again = hc.replay(hc.read_recording(record))
    Path(folder, "two-fires.yaml").write_text(scenario.text)  # `higvf run two-fires.yaml` opens it in the console

burnt = report["loss_area_total_m2"]
print(f"Fires {report['extinguished']} are out after {report['duration_s']:.1f} s; {burnt:.0f} m^2 burnt.")
print(f"Robot 1 went from {path_of_robot_1[0]} to {path_of_robot_1[-1]} in {len(path_of_robot_1)} steps.")
print(f"The replay agrees bit for bit: {again.agrees}.")
