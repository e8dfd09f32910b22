"""Records of one control period: what is known at its start, and what it results in before the safety filter."""

from typing import NamedTuple

from higvf_console.control.kernel import kernel
from higvf_console.core.arrays import Bools, Floats, Ints


class Sight(NamedTuple):
    """What N robots perceive of M fires.

    Attributes:
        fire_value: (N, M) observed fire values theta [rad], [10].
        target: (N,) fire index that the robot wants, or NOBODY.
        target_value: (N,) largest observed fire value of the target since it was chosen [rad].
        robot_intention: (N, 2) v_t, [13].
    """

    fire_value: Floats
    target: Ints
    target_value: Floats
    robot_intention: Floats


class Situation(NamedTuple):
    """What is known at the start of a control period, before any velocity is computed; other fields as in `Plan`.

    Attributes:
        delivered_start: (N + 1,) with `delivered_to`, the links whose messages arrive in this period, as `link_start`.
        delivered_to: (F,) the neighbour at the other end of each.
        sight: what the robots perceive.
        leader: the influenced robot while it follows a path, or NOBODY.
        held: (N,) whether the robot's component waits at the end of a path.
    """

    link_start: Ints
    link_to: Ints
    delivered_start: Ints
    delivered_to: Ints
    component: Ints
    sight: Sight
    path_parameter: float
    path_status: int
    path_idle: float
    path_gap: float
    path_left: float
    leader: int
    steered: Bools
    held: Bools


class Plan(NamedTuple):
    """Result of one control period before the safety filter, for N robots, M fires and K boundaries.

    Attributes:
        nominal: (N, 2) velocity that the filter is given: after the composite step and the speed clip [m/s].
        intention: (N, 2) shared intention v_s, [15].
        target: (N,) fire index that the robot wants, or NOBODY.
        target_value: (N,) largest observed fire value of the target since it was chosen [rad].
        circulation: (N, K) circulation direction round each boundary, see `Motion`.
        recovery_stage: (N,) how many ways out of a deadlock have been tried, see `control.guidance.recovery`.
        path_parameter: arc length w of the influenced robot on the desired path [m].
        path_status: a `PathStatus`.
        path_idle: how long the influenced robot has made no progress along the path [s].
        path_gap: least travel that was ever left to the path's end [m].
        path_left: time that is left of the path's duration [s].
        steered: (N,) whether a human intention acts in the robot's component.
        fire_value: (N, M) observed fire values theta [rad], [10].
        robot_intention: (N, 2) v_t, [13].
        human_intention: (N, 2) v_h, zero but for the influenced robot, [9].
        formation: (N, 2) v_f [m/s], [14].
        blending: (N,) lambda, from 0 to 1, [19].
        blended: (N, 2) lambda v_s + (1 - lambda) v_f [m/s], [18].
        link_start: (N + 1,) the neighbours of robot i are `link_to[link_start[i]:link_start[i + 1]]`.
        link_to: (E,) robot index of each neighbour; a link is in it twice, once from each end.
        component: (N,) connected component, named by its smallest robot index.
    """

    nominal: Floats
    intention: Floats
    target: Ints
    target_value: Floats
    circulation: Ints
    recovery_stage: Ints
    path_parameter: float
    path_status: int
    path_idle: float
    path_gap: float
    path_left: float
    steered: Bools
    fire_value: Floats
    robot_intention: Floats
    human_intention: Floats
    formation: Floats
    blending: Floats
    blended: Floats
    link_start: Ints
    link_to: Ints
    component: Ints


@kernel
def planned(
    at: Situation, robot: Floats, human: Floats, formation: Floats, intention: Floats, blended: Floats,
    blending: Floats, circulation: Ints, recovery_stage: Ints, nominal: Floats,
) -> Plan:  # fmt: skip
    """Collects the results of one control period.

    Args:
        at: what was known at its start.
        robot: (N, 2) v_t.
        human: (N, 2) v_h.
        formation: (N, 2) v_f [m/s].
        intention: (N, 2) v_s.
        blended: (N, 2) [m/s].
        blending: (N,) lambda.
        circulation: (N, K) see `Motion`.
        recovery_stage: (N,) for the next period.
        nominal: (N, 2) [m/s].
    """
    return Plan(
        nominal=nominal,
        intention=intention,
        target=at.sight.target,
        target_value=at.sight.target_value,
        circulation=circulation,
        recovery_stage=recovery_stage,
        path_parameter=at.path_parameter,
        path_status=at.path_status,
        path_idle=at.path_idle,
        path_gap=at.path_gap,
        path_left=at.path_left,
        steered=at.steered,
        fire_value=at.sight.fire_value,
        robot_intention=robot,
        human_intention=human,
        formation=formation,
        blending=blending,
        blended=blended,
        link_start=at.link_start,
        link_to=at.link_to,
        component=at.component,
    )
