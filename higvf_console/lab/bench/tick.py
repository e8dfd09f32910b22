"""Time of one control period: controller, safety filter, motion of the robots and growth of the fires.

advance   one tick with its trace
roll      one tick of a rollout in a single compiled call
session   one tick of a live run, with events and metrics
"""

import math
from collections.abc import Callable

from higvf_console.lab.bench.timing import Case, Suite, take_turns
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import parse_scenario
from higvf_console.sim.simulation import advance, roll

TEAMS = (3, 30, 100, 1000)
_ROLLED = 20  # ticks of one rollout
_WARM_UP = 50  # ticks until the team moves

_SCENARIO = """
version: 1
arena: {{size_m: [{width}, {width}], walls: true}}
robots: {{count: {robots}, spacing_m: 40, jitter_m: 5}}
fires:
  - {{at_m: [60, 60], radius_m: 20, robots_needed: 2}}
  - {{at_m: [60, {far}], radius_m: 25, robots_needed: 2}}
  - {{at_m: [{far}, 60], radius_m: 30, robots_needed: 2}}
  - {{at_m: [{far}, {far}], radius_m: 20, robots_needed: 2}}
obstacles:
  circles:
    - {{at_m: [60, {middle}], radius_m: 20}}
    - {{at_m: [{far}, {middle}], radius_m: 20}}
parameters:
  formation: {{communication_range: 60}}
"""


def run() -> Suite:
    """Measures teams of 3 to 1000 robots that move to four fires."""
    return Suite("Control period", "advance", tuple(_case(robots) for robots in TEAMS))


def _case(robots: int) -> Case:
    width = 40.0 * math.ceil(math.sqrt(robots)) + 500.0
    text = _SCENARIO.format(width=width, far=width - 60.0, middle=width / 2.0, robots=robots)
    setup = parse_scenario(text, "the benchmark's scenario").setup()
    live = Run(setup)
    for _ in range(_WARM_UP):
        live.step()
    state = live.state
    contenders: dict[str, Callable[[int], object]] = {
        "advance": lambda _: advance(state, setup.world, setup.params),
        "roll": lambda _: roll(state, setup.world, setup.params, _ROLLED),
        "session": lambda _: live.step(),
    }
    taken: dict[str, float | None] = {**take_turns(contenders)}
    rolled = taken["roll"]
    assert rolled is not None
    taken["roll"] = rolled / _ROLLED
    return Case("swarm", robots, taken, {})
