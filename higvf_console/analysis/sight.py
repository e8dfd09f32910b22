"""What a robot sees of each fire: the target scores theta [10], and which obstacles hide how much of a fire."""

from typing import NamedTuple

import numpy as np

from higvf_console.analysis.active_constraints import part_name
from higvf_console.analysis.explain import Moved
from higvf_console.control.guidance.obstacles import world_at
from higvf_console.control.intention.perception import fire_value, half_angle, interval_room
from higvf_console.core.arrays import Floats
from higvf_console.sim.disturbances import seen_positions
from higvf_console.world.setup import Setup


class Sight(NamedTuple):
    """A burning fire as one robot sees it.

    Attributes:
        fire: index.
        value: observed fire value theta [rad].
        whole: the angle under which it would be seen if nothing hid it [rad].
        in_range: whether it is within the perception range.
        hidden_by: the parts of obstacles that hide some of it, see `control.guidance.obstacles`; the one that hides
            most first.
    """

    fire: int
    value: float
    whole: float
    in_range: bool
    hidden_by: tuple[int, ...]


def sights(robot: int, moved: Moved, setup: Setup) -> list[Sight]:
    """The burning fires as a robot saw them in one control period."""
    motion, activation_distance = moved.before.motion, setup.params.perception.perception_range
    world = world_at(setup.world, motion.tick, setup.params.safety.control_period)
    x, y = seen_positions(motion, setup.params)[robot].tolist()
    found: list[Sight] = []
    for fire in np.flatnonzero(motion.fire_burning).tolist():
        fx, fy = world.fire_position[fire].tolist()
        radius = float(motion.fire_radius[fire])
        distance = float(np.hypot(fx - x, fy - y))
        whole = 2.0 * half_angle(radius, distance)
        in_range = distance - radius <= activation_distance
        hidden = hidden_by(x, y, fx, fy, radius, world.capsules) if in_range else ()
        found.append(Sight(fire, float(moved.trace.fire_value[robot, fire]), whole, in_range, hidden))
    return found


def hidden_by(x: float, y: float, fx: float, fy: float, radius: float, capsules: Floats) -> tuple[int, ...]:
    """Which capsules (K, 5), each alone, hide some of a fire (fx, fy, radius) from (x, y) [m]; most hiding first."""
    room = interval_room(capsules)
    clear = fire_value(x, y, fx, fy, radius, np.inf, capsules[:0], room)
    left = np.array([fire_value(x, y, fx, fy, radius, np.inf, capsules[k : k + 1], room) for k in range(len(capsules))])
    order = np.argsort(left, kind="stable")
    return tuple(int(part) for part in order if left[part] < clear)


def hider_names(sight: Sight, setup: Setup) -> tuple[str, ...]:
    """Names of what hides a fire, each once."""
    return tuple(dict.fromkeys(part_name(part, setup) for part in sight.hidden_by))
