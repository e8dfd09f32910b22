"""One experiment for each doubtful equation, with a number that shows how the printed form fails.

Each function takes the parameters, whose `forms` select the form of the equation, runs the step of the engine and
returns the measured value.
"""

import math

import numpy as np

from higvf_console.control.guidance.bump import zero_in
from higvf_console.control.intention.blending import blending_weight
from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Floats
from higvf_console.core.state import SimState
from higvf_console.scenario.scenario import load_scenario, parse_scenario
from higvf_console.sim.simulation import advance, roll
from higvf_console.world.setup import Setup, with_params

_HEAD = "version: 1\narena: {x_min: -400, y_min: -400, x_max: 400, y_max: 400, walls: false}\n"
_PAIR = _HEAD + "robots: {start_m: [[-15, 0], [15, 0]]}\nformation_m: [[0, 0], [60, 0]]\n"
_AHEAD = (
    _HEAD + "robots: {start_m: [[-200, 1]]}\nobstacles: {circles: [{at_m: [0, 0], radius_m: 20}]}\n"
    "path: {line: {at_m: [-200, 0], angle_deg: 0}}\n"
)
_TEAM = (
    _HEAD + "robots: {start_m: [[-200, 0], [-240, 30], [-240, -30]]}\npath: {line: {at_m: [-200, 0], angle_deg: 0}}\n"
)
_BESIDE_FIRE = (
    _HEAD
    + "robots: {start_m: [[-40, 0]]}\nfires: [{at_m: [0, 0], radius_m: 25, growth_m_per_s: 1, robots_needed: 1}]\n"
)
_TWO_CIRCLES = (
    _HEAD + "robots: {start_m: [[-200, 1]]}\n"
    "obstacles: {circles: [{at_m: [0, 300], radius_m: 20}, {at_m: [0, 0], radius_m: 20}]}\n"
    "path: {line: {at_m: [-200, 0], angle_deg: 0}}\n"
)


def _start(text: str, params: Parameters) -> Setup:
    return with_params(parse_scenario(text, "experiment").setup(), params)


def formation_distance(params: Parameters) -> float:
    """Final distance of two robots that move by formation velocity only, from 30 m, with 60 m desired [m]."""
    setup = _start(_PAIR, params)
    state, dt = setup.start, params.safety.control_period
    for _ in range(1500):
        after, trace = advance(state, setup.world, params)
        moved = state.motion.position + dt * trace.formation
        state = SimState(after.motion._replace(position=moved), state.intent, state.pointer_state)
    return float(np.hypot(*(state.motion.position[1] - state.motion.position[0])))


def intention_peak(params: Parameters) -> float:
    """Largest |v_s| of three robots in the first second, while one of them follows a line."""
    setup = _start(_TEAM, params)
    state, peak = setup.start, 0.0
    for _ in range(50):
        state, _ = advance(state, setup.world, params)
        peak = max(peak, _longest(state.motion.intention))
    return peak


def target_length(params: Parameters) -> float:
    """Largest robot intention |v_t| at the start of Table I; a human intention is at most 1."""
    setup = load_scenario("firefighting").setup()
    _, trace = advance(setup.start, setup.world, params)
    return _longest(trace.robot_intention)


def way_past_obstacle(params: Parameters) -> float:
    """Distance that a robot covers in 15 s along a path with a circle centred at 200 m [m]; 220 m is beyond it."""
    setup = _start(_AHEAD, params)
    _, history = roll(setup.start, setup.world, params, 750)
    return float(history.position[-1, 0, 0] - setup.start.motion.position[0, 0])


def speed_at_rest(params: Parameters) -> float:
    """|blended velocity| of a robot at rest without any intention [m/s]; NaN if it is 0/0."""
    setup = _start(_PAIR.replace("[60, 0]", "[30, 0]"), params)
    _, trace = advance(setup.start, setup.world, params)
    return _longest(trace.blended)


def weight_near_rest(params: Parameters) -> float:
    """Lambda at |v_s| = 1e-9 and v_f = 0; continuity with lambda(0, 0) = 0 requires a value near 0."""
    return float(blending_weight(1e-9, 0.0, params.blending, params.forms))


def bump_at_boundary(params: Parameters) -> float:
    """S at 0.01 m outside the repulsive boundary of an obstacle of radius 20 m; S is 0 on the boundary."""
    return float(zero_in(20.0 + params.boundaries.repulsive_margin + 0.01, 20.0, params.boundaries, params.forms))


def clearance_at_fire(params: Parameters) -> float:
    """Minimum clearance of a paused robot beside a fire that grows by 1 m/s, over 60 s [m]."""
    setup = _start(_BESIDE_FIRE, params._replace(fires=params.fires._replace(extinguish_time=10.0)))
    paused = setup.start._replace(intent=setup.start.intent._replace(paused=True))
    slow = setup.params._replace(fires=setup.params.fires._replace(stand_off=0.1))
    _, history = roll(paused, setup.world, slow, 3000)
    return float(history.clearance.min())


def clearance_by_index(params: Parameters) -> float:
    """Minimum clearance of a robot on a path through the second of two circles, the first being far away [m]."""
    narrow = params._replace(boundaries=params.boundaries._replace(reactive_margin=1.0, repulsive_margin=0.0))
    setup = _start(_TWO_CIRCLES, narrow)
    _, history = roll(setup.start, setup.world, narrow, 300)
    return float(history.clearance.min())


def _longest(vectors: Floats) -> float:
    """Largest length of vectors (N, 2); NaN if one of them is NaN."""
    lengths = np.hypot(vectors[:, 0], vectors[:, 1])
    return math.nan if np.isnan(lengths).any() else float(lengths.max())
