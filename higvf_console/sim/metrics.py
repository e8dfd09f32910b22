"""Metrics of a run: loss area, clearance, stalls."""

import math

import numpy as np

from higvf_console.control.guidance.obstacles import part_at
from higvf_console.control.intention.neighbours import within
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import Parameters, SafetyParameters
from higvf_console.control.plan import Plan
from higvf_console.control.safety.safety_filter import blocked
from higvf_console.core.arrays import Bools, Floats, Ints
from higvf_console.core.state import NOBODY, Motion, World


def loss_area(motion: Motion) -> Floats:
    """(M,) area that each fire has burnt [m^2]: pi times its largest radius squared."""
    return math.pi * motion.fire_radius**2


@kernel
def clearances(
    body: Floats, fire_radius: Floats, fire_burning: Bools, world: World, safety: SafetyParameters
) -> tuple[Floats, Floats]:
    """Each robot's nearest danger: what is left of the clearance, and its barrier function.

    Args:
        body: (N, 2) true centres of the bodies [m].
        fire_radius: (M,) [m].
        fire_burning: (M,).
        world: obstacles and walls.
        safety: clearances of the bodies.

    Returns:
        clearance: (N,) smallest of |p_i - p_j| - R_r and |p - o| - R_k [m]; exact below R_r, inf when nothing is near.
        barrier: (N,) smallest h = d^2/R^2 - 1 of [20] and [26], and of the walls; inf likewise.
    """
    nearest = np.full(body.shape[0], math.inf)
    barrier = np.full(body.shape[0], math.inf)
    start, to = within(body, 2.0 * safety.robot_clearance)
    for i in range(nearest.shape[0]):
        x, y = body[i, 0], body[i, 1]
        for entry in range(start[i], start[i + 1]):
            dx, dy = body[to[entry], 0] - x, body[to[entry], 1] - y
            _note(i, math.sqrt(dx * dx + dy * dy), safety.robot_clearance, math.inf, nearest, barrier)
        for k in range(world.capsules.shape[0]):
            gap, _, _ = part_at(k, x, y, world)
            radius = world.capsules[k, 4]
            _note(i, gap + radius, radius + safety.obstacle_clearance, safety.robot_clearance, nearest, barrier)
        for j in range(world.fire_position.shape[0]):
            if fire_burning[j]:
                dx, dy = x - world.fire_position[j, 0], y - world.fire_position[j, 1]
                clearance = fire_radius[j] + safety.obstacle_clearance
                _note(i, math.sqrt(dx * dx + dy * dy), clearance, safety.robot_clearance, nearest, barrier)
        for k in range(world.walls.shape[0]):
            inside = world.walls[k, 0] * x + world.walls[k, 1] * y - world.walls[k, 2]
            barrier[i] = min(barrier[i], inside / safety.obstacle_clearance - 1.0)
    return nearest, barrier


@kernel
def _note(
    i: int, distance: float, clearance: float, activation_distance: float, nearest: Floats, barrier: Floats
) -> None:
    gap = distance - clearance
    if gap < activation_distance:
        nearest[i] = min(nearest[i], gap)
        barrier[i] = min(barrier[i], (distance / clearance) ** 2 - 1.0)


@kernel
def stalls(
    motion: Motion, plan: Plan, velocity: Floats, active_constraints: Ints, crew: Ints, world: World, params: Parameters
) -> Floats:
    """(N,) how long each robot has stood still against active constraints although it wants to move [s].

    A robot that is in reach of its fire, or whose fire is being extinguished, is at work, not stalled.
    """
    slow = params.stall.stall_fraction * params.blending.cruise_speed
    stalled = np.zeros(motion.stalled.shape[0])
    for i in range(stalled.shape[0]):
        at_work = False
        fire = plan.target[i]
        if fire != NOBODY and not plan.steered[i]:
            dx = motion.position[i, 0] - world.fire_position[fire, 0]
            dy = motion.position[i, 1] - world.fire_position[fire, 1]
            activation_distance = motion.fire_radius[fire] + params.fires.stand_off
            at_work = (
                crew[fire] >= world.fire_needs[fire] or dx * dx + dy * dy <= activation_distance * activation_distance
            )
        if not at_work and blocked(
            velocity[i, 0], velocity[i, 1], plan.nominal[i, 0], plan.nominal[i, 1], active_constraints[i], slow
        ):
            stalled[i] = motion.stalled[i] + params.safety.control_period
    return stalled
