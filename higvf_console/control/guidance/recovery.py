"""Deadlock recovery in stages: reverse the circulation, weigh the human intention more, ask the operator.

A robot is deadlocked when its safety constraints stop it against its nominal velocity for `stall_time`. Scaling the
nominal velocity does not free it: the filtered velocity is zero exactly if the nominal velocity lies in the cone of the
active normals, and then every positive multiple lies in it too. Each stage therefore changes a direction. A robot
enters the next stage each time its stall lasts another `stall_time`, and returns to stage 0 when its component has left
all reactive boundaries:

    1  the component reverses its circulation direction and drops its formation
    2  the first direction again; the human intention weighs more if that turns the shared intention of the leader
    3  the operator is asked for a new stroke; stages 4, 8, 16 ... reverse the direction again

A team can also stop without an active constraint: the formation velocity at its cap may cancel a weak intention. The
formation weight therefore also decreases while the influenced robot makes no progress on its path.
"""

import math

import numpy as np

from higvf_console.control.intention.intention import shared_intention
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Bools, Floats, Ints
from higvf_console.core.state import NOBODY, Motion

OTHER_DIRECTION, MORE_HUMAN, ASK = 1, 2, 3
GIVE_UP = 9  # stages from here on do not extend the progress timeout
EN_ROUTE_TIMEOUTS = 40.0  # a robot that moves has this many times the progress timeout
_LOOSENING = 0.1  # share of the progress timeout after which an idle team keeps no formation
_SHUTTLE = 0.125  # share of the progress timeout between two recovery stages of a robot that moves without progress
_TURNED = 0.985  # cosine of 10 degrees: a smaller turn does not count


@kernel
def recover(motion: Motion, leader: int, params: Parameters) -> tuple[Ints, Bools]:
    """Recovery stages (N,) after this tick, and which robots (N,) reverse the circulation direction now.

    A stalled robot enters the next stage each time its stall lasts another `stall_time`. The influenced robot, which is
    `leader`, also does so while it moves without progress on its path: a boundary may turn it back repeatedly.
    """
    recovery_stage, flip = motion.recovery_stage.copy(), np.zeros(motion.recovery_stage.shape[0], np.bool_)
    period = params.safety.control_period
    slow = params.stall.stall_fraction * params.blending.cruise_speed
    for i in range(recovery_stage.shape[0]):
        recovers = passes(float(motion.stalled[i]), params.stall.stall_time, period)
        if i == leader and math.hypot(motion.velocity[i, 0], motion.velocity[i, 1]) > slow:
            wait = _SHUTTLE * params.path.progress_timeout
            recovers = recovers or passes(motion.path_idle, wait, period / EN_ROUTE_TIMEOUTS)
        if recovers:
            recovery_stage[i] += 1
            flip[i] = recovery_stage[i] & (recovery_stage[i] - 1) == 0  # 1, 2, 4, 8, ...
    return recovery_stage, flip


@kernel
def formation_grip(recovery_stage: Ints, component: Ints, leader: int, idle: float, params: Parameters) -> Floats:
    """Formation weight (N,) of each robot, from 0 (no formation) to 1.

    Args:
        recovery_stage: (N,) from `recover`.
        component: (N,) connected component of each robot.
        leader: the influenced robot, or NOBODY.
        idle: time without progress on its path [s], see `following.progress`.
        params: holds the progress timeout [s].
    """
    grip = np.ones(recovery_stage.shape[0])
    loose = np.zeros(recovery_stage.shape[0], np.bool_)  # by component
    for i in range(recovery_stage.shape[0]):
        loose[component[i]] = loose[component[i]] or recovery_stage[i] > 0
    for i in range(recovery_stage.shape[0]):
        if loose[component[i]]:
            grip[i] = 0.0
        elif leader != NOBODY and component[i] == component[leader]:
            grip[i] = max(0.0, 1.0 - idle / (_LOOSENING * params.path.progress_timeout))
    return grip


@kernel
def passes(time: float, step: float, period: float) -> bool:
    """Whether `time` has passed a positive multiple of `step` within the last `period`, all in [s]."""
    return time >= step and time % step < period


@kernel
def receptivity(
    leader: int,
    recovery_stage: Ints,
    robot: Floats,
    human: Floats,
    intention: Floats,
    start: Ints,
    to: Ints,
    params: Parameters,
) -> float:
    """Receptivity psi of the influenced robot, [15]: 1, or `human_boost` from stage 2 on if that turns v_s.

    Args:
        leader: the influenced robot, or NOBODY.
        recovery_stage: (N,) from `recover`.
        robot: (N, 2) v_t.
        human: (N, 2) v_h.
        intention: (N, 2) v_s.
        start: (N + 1,) neighbour lists: those of robot i are `to[start[i]:start[i + 1]]`.
        to: (E,) neighbours.
        params: weights and boost.
    """
    if leader == NOBODY or recovery_stage[leader] < MORE_HUMAN:
        return 1.0
    plain_x, plain_y = _fixed_point(leader, 1.0, robot, human, intention, start, to, params)
    more_x, more_y = _fixed_point(leader, params.stall.human_boost, robot, human, intention, start, to, params)
    along = plain_x * more_x + plain_y * more_y
    turned = along < _TURNED * math.hypot(plain_x, plain_y) * math.hypot(more_x, more_y)
    return params.stall.human_boost if turned else 1.0


@kernel
def _fixed_point(
    i: int, psi: float, robot: Floats, human: Floats, intention: Floats, start: Ints, to: Ints, params: Parameters
) -> tuple[float, float]:
    return shared_intention(
        i, intention[i, 0], intention[i, 1], robot[i, 0], robot[i, 1], human[i, 0], human[i, 1], psi, intention,
        start, to, params.intention, params.forms, math.inf,
    )  # fmt: skip


@kernel
def forgotten(recovery_stage: Ints, circulation: Ints, stalled: Floats) -> Ints:
    """Stages (N,), reset to 0 for robots that do not stall and whose row of `circulation` (N, K) is 0."""
    kept = recovery_stage.copy()
    for i in range(kept.shape[0]):
        inside = stalled[i] > 0.0
        for k in range(circulation.shape[1]):
            inside = inside or circulation[i, k] != 0
        if not inside:
            kept[i] = 0
    return kept
