"""The controller with [9], [13] and [14] as printed, "zero-in": velocities fade to zero near obstacles.

Nothing turns a robot round an obstacle, and there is no deadlock recovery. The corrected method is
`controller.compute`; the other doubtful equations take their form one by one, see `forms`.
"""

import numpy as np

from higvf_console.control.controller import attend, blend, guide, keep_formation, limit_speed, share
from higvf_console.control.guidance.boundaries import find_boundaries
from higvf_console.control.guidance.guiding import agree_circulation, zero_in_product
from higvf_console.control.guidance.recovery import forgotten
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import Parameters
from higvf_console.control.plan import Plan, planned
from higvf_console.core.arrays import Floats
from higvf_console.core.state import Intent, Motion, World


@kernel
def compute(motion: Motion, intent: Intent, world: World, params: Parameters) -> Plan:
    """Computes one control period with each intention and formation velocity multiplied by the zero-in bumps.

    Args:
        motion: state of the robots, fires and path progress.
        intent: active path, influenced robot, priorities, pause and emergency stop.
        world: obstacles, fires, links and formation.
        params: all tunable parameters.
    """
    team = motion.position.shape[0]
    at = attend(motion, intent, motion.recovery_stage, world, params)
    fade = _bumps(motion, world, params)
    robot = _faded(at.sight.robot_intention, fade)
    human = _faded(guide(at.leader, at.path_parameter, motion, intent, params), fade)
    firm = np.ones(team)
    whole = keep_formation(motion.position, firm, world, at.delivered_start, at.delivered_to, params)
    formation = _faded(whole, fade)
    intention = share(at, 1.0, robot, human, motion, intent, params)
    blended, blending = blend(intention, formation, at.steered, intent.path.pace, params)
    boundaries = find_boundaries(motion, world, params.safety.obstacle_clearance)
    circulation = agree_circulation(
        blended, motion.position, motion.circulation, at.component, at.leader, np.zeros(team, np.bool_), boundaries,  # pyright: ignore[reportUnknownArgumentType]
        params.boundaries,
    )  # fmt: skip
    nominal = limit_speed(blended, intent, params)
    stages = forgotten(motion.recovery_stage, circulation, motion.stalled)
    return planned(at, robot, human, formation, intention, blended, blending, circulation, stages, nominal)


@kernel
def _bumps(motion: Motion, world: World, params: Parameters) -> Floats:
    """(N,) product of the zero-in bumps of all obstacles and burning fires at each robot."""
    product = np.empty(motion.position.shape[0])
    for i in range(product.shape[0]):
        x, y = motion.position[i, 0], motion.position[i, 1]
        product[i] = zero_in_product(x, y, motion, world, params.boundaries, params.forms)
    return product


@kernel
def _faded(velocity: Floats, fade: Floats) -> Floats:
    """Velocities (N, 2), each times its robot's bump."""
    faded = np.empty(velocity.shape)
    for i in range(velocity.shape[0]):
        for axis in range(2):
            faded[i, axis] = velocity[i, axis] * fade[i]
    return faded
