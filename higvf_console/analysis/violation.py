"""The hazard whose clearance a robot violates, by name and with the missing distance."""

from itertools import chain

import numpy as np

from higvf_console.core.arrays import floats
from higvf_console.core.state import Motion
from higvf_console.sim.unicycle import body_centres
from higvf_console.world.placement import obstacle_gaps, other_gaps
from higvf_console.world.setup import Setup


def violation_text(robot: int, motion: Motion, setup: Setup) -> str:
    """What a robot is too near to, e.g. "is inside fire 1's safety distance by 0.4 m".

    Args:
        robot: index of a robot whose clearance is violated.
        motion: the team in that moment.
        setup: obstacles, fires, walls and the clearances of bodies.
    """
    params = setup.params
    bodies = body_centres(motion.position, motion.heading, params.robots.look_ahead)
    own = bodies[robot : robot + 1]
    obstacles = setup.layout.obstacles.at(motion.tick * params.safety.control_period)
    burning = floats(np.where(motion.fire_burning, motion.fire_radius, -np.inf))  # no hazard once it is out
    hazards = chain(obstacle_gaps(own, obstacles), other_gaps(own, burning, setup.world))
    missing = [(params.safety.obstacle_clearance - float(gap[0]), name) for name, gap in hazards]
    distance = np.hypot(*(bodies - own[0]).T)
    missing += [
        (params.safety.robot_clearance - float(distance[other]), f"robot {other + 1}")
        for other in range(len(bodies))
        if other != robot
    ]
    depth, name = max(missing)
    return f"is inside {name}'s safety distance by {_metres(depth)}"


def _metres(depth: float) -> str:
    """At the tick in which a clearance is first violated, little is missing."""
    if depth >= 0.1:
        return f"{depth:.1f} m"
    if depth >= 0.01:
        return f"{100.0 * depth:.0f} cm"
    return f"{1000.0 * depth:.0f} mm" if depth >= 5e-4 else "less than 1 mm"
