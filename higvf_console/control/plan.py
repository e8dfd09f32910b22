"""Records of one control period: what is known at its start, and what it results in before the safety filter."""

from typing import NamedTuple

from higvf_console.control.kernel import kernel
from higvf_console.core.arrays import Bools, Floats, Ints


class Sight(NamedTuple):
    """Perception of all robots; fields as in `Motion` and `Trace`."""

    fire_value: Floats
    target: Ints
    target_value: Floats
    robot_intention: Floats


class Situation(NamedTuple):
    """What is known at the start of a control period, before any velocity is computed; fields as in `Plan`."""

    link_start: Ints
    link_to: Ints
    delivered_start: Ints  # links whose messages arrive in this period
    delivered_to: Ints
    component: Ints
    sight: Sight
    path_parameter: float
    path_status: int
    path_idle: float
    path_gap: float
    path_left: float
    leader: int  # the influenced robot while it follows a path, or NOBODY
    steered: Bools
    held: Bools  # (N,) whether the robot's component waits at the end of a path


class Plan(NamedTuple):
    """Result of one control period before the safety filter; fields as in `Motion` and `Trace`."""

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
    steered: Bools  # (N,) whether a human intention acts in the robot's component
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
    """Collects the results of one control period."""
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
