"""Priority, the second kind of human intention: the operator multiplies the value of some fires for one robot."""

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import Prioritise
from higvf_console.core.outline import enclosed
from higvf_console.core.state import SimState
from higvf_console.operator.outcome import Outcome, no_robot, refuse, report
from higvf_console.world.setup import Setup


def prioritise_inside(state: SimState, outline: Floats, setup: Setup, time: float) -> Outcome:
    """Prioritises the burning fires whose centres lie inside an outline (n, 2) [m]."""
    inside = np.flatnonzero(state.motion.fire_burning & enclosed(outline, setup.world.fire_position)).tolist()
    if not inside:
        return state, refuse(time, "No priority: no burning fire has its centre inside the stroke.")
    return prioritise(state, Prioritise(fires=tuple(inside)), setup, time)


def prioritise(state: SimState, command: Prioritise, setup: Setup, time: float) -> Outcome:
    """Replaces the prioritised fires of one robot; see `Prioritise`."""
    intent, fires, robots = state.intent, len(state.motion.fire_radius), len(state.motion.position)
    robot = intent.influenced if command.robot is None else int(command.robot)
    factor = setup.params.perception.priority if command.factor is None else float(command.factor)
    if not 0 <= robot < robots:
        return state, no_robot(robot, robots, time)
    unknown = [fire for fire in command.fires if not 0 <= fire < fires]
    if unknown:
        return state, refuse(time, f"There is no fire {unknown[0] + 1}: the fires are 1 to {fires}.")
    if not factor >= 1.0:
        return state, refuse(time, f"Priority factor {factor:g} is below 1.")
    others = intent.priority[intent.priority[:, 0] != robot]
    own = floats([[robot, fire, factor] for fire in command.fires], -1, 3)
    state = state._replace(intent=intent._replace(priority=floats(np.concatenate([others, own]))))
    if not command.fires:
        return state, report(time, "priority", f"Robot {robot + 1} has no prioritised fires.", robot)
    names = ", ".join(str(fire + 1) for fire in command.fires)
    plural = "s" if len(command.fires) > 1 else ""
    text = f"Robot {robot + 1} prioritises fire{plural} {names} with factor {factor:g}."
    return state, report(time, "priority", text, robot)
