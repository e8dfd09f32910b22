"""Every tunable of the controller, grouped by the part that uses it: unit, range, symbol, sentence, default.

One definition serves the kernels, the YAML checks, the sliders and the documentation; see `quantity`. A compiled step
takes all of them as one record (`packed`): passing 45 numbers one by one would cost more than the step.
"""

import math
from functools import lru_cache
from typing import Annotated as A  # noqa: N817 (a table needs narrow columns)
from typing import NamedTuple, Protocol, cast

import numpy as np

from higvf_console.control.forms import CORRECTED, Forms
from higvf_console.core.quantity import Quantity as Q  # noqa: N817
from higvf_console.core.quantity import quantities
from higvf_console.core.scale import USUAL_SCALE, Scale

INFINITE = float("inf")


class PathParameters(NamedTuple):
    """Guiding vector field of the desired path (paper, eq. 2)."""

    capture_distance: A[
        float, Q("m", 1.0, 500.0, "1/k", "Distance at which the field turns 45 degrees to the path.")
    ] = 40.0
    end_radius: A[float, Q("m", 1.0, 500.0, "", "An open path is finished this close to its end.")] = 40.0
    progress_timeout: A[float, Q("s", 0.1, 60.0, "", "No progress for this long ends the human intention.")] = 2.0
    stroke_smoothing: A[float, Q("m", 0.0, 100.0, "", "Standard deviation by which a path may leave its stroke.")] = 4.0


class BoundaryParameters(NamedTuple):
    """Reactive and repulsive boundaries and bump functions (paper, eq. 3-6, 29-31)."""

    reactive_margin: A[float, Q("m", 1.0, 500.0, "R", "Surface to reactive boundary: robots react inside.")] = 25.0
    repulsive_margin: A[float, Q("m", 0.0, 499.0, "Q", "Surface to repulsive boundary: only circulation inside.")] = (
        14.0
    )
    bump_in: A[float, Q("", 0.001, 10.0, "l_1", "Rate of the bump near the repulsive boundary.")] = 0.1
    bump_out: A[float, Q("", 0.001, 10.0, "l_2", "Rate of the bump near the reactive boundary.")] = 0.1


class PerceptionParameters(NamedTuple):
    """Observed fire value and target choice (paper, eq. 10-13)."""

    perception_range: A[float, Q("m", 0.0, INFINITE, "", "Fires farther away are not seen.")] = INFINITE
    target_band: A[
        float,
        Q("m", 0.1, 500.0, "", "Distance outside the stand-off circle of a fire over which robot intention fades."),
    ] = 50.0
    target_margin: A[float, Q("", 1.0, 10.0, "", "Factor by which another fire must look larger to win.")] = 1.05
    priority: A[float, Q("", 1.0, 1000.0, "", "Factor by which a robot values a fire more that it was pointed to.")] = (
        8.0
    )
    break_away: A[
        float, Q("rad", 0.0, INFINITE, "", "A fire that looks this large makes robots leave the human's path for it.")
    ] = INFINITE


class FormationParameters(NamedTuple):
    """Formation control (paper, eq. 12, 14)."""

    communication_range: A[float, Q("m", 0.0, INFINITE, "R_c", "Robots this close exchange intentions.")] = INFINITE
    formation_rate: A[float, Q("1/s", 0.0, 50.0, "k_form", "Stiffness of the formation.")] = 0.5
    formation_speed: A[float, Q("m/s", 0.0, 1000.0, "", "Largest formation velocity.")] = 30.0


class IntentionParameters(NamedTuple):
    """Shared intention (paper, eq. 15, 16)."""

    decay: A[float, Q("1/s", 0.0, 1000.0, "omega_0", "Weight of forgetting.")] = 2.5
    robot_weight: A[float, Q("1/s", 0.0, 1000.0, "omega_1", "Weight of the robot's own intention.")] = 5.0
    neighbour_weight: A[float, Q("1/s", 0.0, 1000.0, "omega_2", "Weight of each neighbour's intention.")] = 5.0
    human_weight: A[float, Q("1/s", 0.0, 1000.0, "omega_3", "Weight of the human intention.")] = 40.0
    dead_zone: A[float, Q("", 0.0, 10.0, "epsilon", "Neighbours that differ less have no influence.")] = 0.0


class BlendingParameters(NamedTuple):
    """Speed and policy blending (paper, eq. 17-19)."""

    cruise_speed: A[float, Q("m/s", 0.1, 400.0, "C", "Desired speed of the team.")] = 60.0
    intention_gain: A[float, Q("", 0.001, 1000.0, "k_s", "Weight of the shared intention in the blend.")] = 1.0
    formation_gain: A[float, Q("s/m", 0.0, 1000.0, "k_f", "Weight of the formation in the blend.")] = 0.02
    intention_floor: A[float, Q("", 0.0001, 1.0, "delta", "Below this shared intention the robot slows down.")] = 0.05


class SafetyParameters(NamedTuple):
    """Safety barriers: clearances, class-K gains and speed limit (paper, eq. 20-28)."""

    robot_clearance: A[float, Q("m", 0.1, 1000.0, "R_r", "Least distance between robot centres.")] = 25.0
    obstacle_clearance: A[float, Q("m", 0.1, 1000.0, "R_o", "Least distance from robot centre to a surface.")] = 12.0
    pair_gain: A[float, Q("1/s", 0.01, 1000.0, "alpha", "Rate at which robots may close in on each other.")] = 20.0
    obstacle_gain: A[float, Q("1/s", 0.01, 1000.0, "beta", "Rate at which a robot may close in on an obstacle.")] = 20.0
    speed_limit: A[float, Q("m/s", 0.1, 600.0, "v_max", "No robot is ever faster.")] = 90.0
    control_period: A[float, Q("s", 0.001, 0.1, "dt", "Time between two control steps.", scales=False)] = 0.02
    h_index: float = CORRECTED  # set by `Parameters.forms`: which margin an obstacle's constraint takes


class FireParameters(NamedTuple):
    """The firefighting world of Table I."""

    stand_off: A[float, Q("m", 0.1, 500.0, "", "A robot extinguishes a fire this close to its edge.")] = 25.0
    extinguish_time: A[float, Q("s/m", 0.0, 10.0, "kappa", "Seconds of work per metre of fire radius.")] = 0.05
    start_delay: A[float, Q("s", 0.0, 600.0, "", "Robots set out this long after the fires start.")] = 0.0


class StallParameters(NamedTuple):
    """Deadlock detection, and the stages of the recovery from a deadlock."""

    stall_fraction: A[float, Q("", 0.001, 0.5, "", "Slower than this share of the cruise speed is a stall.")] = 0.05
    stall_time: A[float, Q("s", 0.1, 60.0, "", "A stall this long is a deadlock.")] = 1.0
    human_boost: A[
        float, Q("", 1.0, 100.0, "", "Factor of the human weight, where that turns a robot out of a deadlock.")
    ] = 4.0


class RobotParameters(NamedTuple):
    """The robots' model, `sim.unicycle`, and what disturbs it, `sim.disturbances`."""

    look_ahead: A[float, Q("m", 0.0, 100.0, "l", "Centre of a unicycle to its controlled point; 0 = no unicycles.")] = (
        0.0
    )
    turn_rate_limit: A[float, Q("rad/s", 0.0, INFINITE, "omega_max", "No unicycle ever turns faster.")] = INFINITE
    position_noise: A[float, Q("m", 0.0, 100.0, "e", "Largest error of a measured position.")] = 0.0
    packet_loss: A[float, Q("", 0.0, 1.0, "", "Probability that a link carries nothing in a control period.")] = 0.0
    seed: float = 0.0  # of errors and losses; set by the run


class Parameters(NamedTuple):
    """All tunables, the forms of the equations, and the scale at which the ranges of the tunables are meant."""

    path: PathParameters = PathParameters()
    boundaries: BoundaryParameters = BoundaryParameters()
    perception: PerceptionParameters = PerceptionParameters()
    formation: FormationParameters = FormationParameters()
    intention: IntentionParameters = IntentionParameters()
    blending: BlendingParameters = BlendingParameters()
    safety: SafetyParameters = SafetyParameters()
    fires: FireParameters = FireParameters()
    stall: StallParameters = StallParameters()
    robots: RobotParameters = RobotParameters()
    forms: Forms = Forms()
    scale: Scale = USUAL_SCALE


GROUPS = tuple(name for name in Parameters._fields if name not in ("forms", "scale"))  # of tunables


def defaults_at(scale: Scale) -> Parameters:
    """The defaults at a scale.

    The control period is that of the clock, unless the barriers of a small, fast robot need a shorter one.
    """
    if scale == USUAL_SCALE:
        return Parameters()
    params = Parameters(scale=scale)
    for group in GROUPS:
        part = getattr(params, group)
        factors = {name: scale.factor(meaning.unit) for name, meaning in quantities(type(part)).items()}
        changed = {name: factor * getattr(part, name) for name, factor in factors.items()}
        params = params._replace(**{group: part._replace(**changed)})
    period = Parameters().safety.control_period
    return params._replace(safety=params.safety._replace(control_period=period * min(1.0, scale.time)))


RENAMED = {
    "rings": "boundaries",
    "path.patience": "path.progress_timeout",
    "safety.pair_rate": "safety.pair_gain",
    "safety.obstacle_rate": "safety.obstacle_gain",
}  # groups and names of version 0.1, which scenarios, scripts and recordings may still hold


def current_name(name: str) -> str:
    """The name today of a group, or of a parameter "group.name"."""
    group, _, key = name.partition(".")
    group = RENAMED.get(group, group)
    name = f"{group}.{key}" if key else group
    return RENAMED.get(name, name)


class ParameterRecord(Parameters):
    """What kernels read as `packed[0]`; for type checkers only."""

    body: SafetyParameters  # the safety parameters of the bodies


class PackedParameters(Protocol):
    """A structured array (1,) of all parameters; kernels read `packed[0].path.capture_distance`."""

    def __getitem__(self, index: int, /) -> ParameterRecord:
        """The one record, for index 0."""
        ...


def controlled(params: Parameters, budget: float = 0.0) -> Parameters:
    """The same tunables for the point of a robot that is controlled, as that robot measures it.

    Its clearances are those of the body, enlarged by its distance l from the centre, by the largest error e of a
    measured position and by `budget` [m] (twice all between robots); its speed limit is one that a unicycle can always
    drive. The budget is what else a robot may be away from where it is believed to be.
    """
    robots, safety = params.robots, params.safety
    margin, limit = robots.look_ahead + robots.position_noise + budget, safety.speed_limit
    if robots.look_ahead > 0.0:
        half_turn = 0.5 * min(robots.turn_rate_limit * safety.control_period, math.pi)
        limit = min(limit, 2.0 * robots.look_ahead * math.sin(half_turn) / safety.control_period)
    return params._replace(
        safety=safety._replace(
            robot_clearance=safety.robot_clearance + 2.0 * margin,
            obstacle_clearance=safety.obstacle_clearance + margin,
            speed_limit=limit,
        )
    )


def filter_parameters(params: Parameters, budget: float = 0.0) -> SafetyParameters:
    """What the safety filter keeps for the controlled points; `budget` [m] as of `controlled`."""
    return controlled(params, budget).safety._replace(h_index=params.forms.h_index)


@lru_cache(maxsize=64)
def packed(params: Parameters, budget: float = 0.0) -> PackedParameters:
    """All tunables of the controlled points as an array (1,) of one record with the same names.

    One more part, `body`, keeps the safety parameters of the bodies. Equal parameters give the same array.
    """
    groups = {**controlled(params, budget)._asdict(), "body": params.safety}
    parts = [
        (name, np.dtype((np.record, [(key, np.float64) for key in part._fields]))) for name, part in groups.items()
    ]
    record = np.array([tuple(tuple(part) for part in groups.values())], dtype=np.dtype((np.record, parts)))
    return cast(PackedParameters, record)
