"""Disturbances: errors of measured positions, and what stays safe with them and with lost messages.

Every draw is a hash, see `control.intention.packet_loss`.

Noise. The controller and the safety filter see p' = p + error, |error| <= e, new for each robot in each tick; physics
and metrics know p. The filter's clearances are enlarged, R' = R + E, with E = e for obstacles and E = 2 e for pairs,
where both robots err. Then a distance d >= R stays so, as long as no robot is flagged infeasible:

    measured outside, d' >= R'. The filter keeps p' + u dt at R' or farther (`barriers.sampling`), and the robot ends
    up within E of that: d_next >= R' - E = R.

    measured inside, d' < R', and no nearer than R' - 2 E. The row asks for a speed w along the measured direction n,
    w dt >= c (R' - d') with c = min(rate dt, v dt / 2 E), v = v_max for obstacles and 2 v_max for pairs. Let q be the
    point of the (convex) danger nearest to p', and p - q = a n + b t. The danger lies behind the line through q across
    n, so d_next >= a + w dt. If g = R - a > 0, then a^2 + b^2 >= d^2 >= R^2 gives b^2 >= g (R + a), and d' <= a +
    sqrt(E^2 - b^2) gives R' - d' >= g + b^2 / 2 E >= g (1 + (R + a) / 2 E). With E <= R / 2 this is a >= R - E, and
    with E <= c R then c (R' - d') >= g, hence d_next >= R.

A fire's growth is added to both sides, and taken from v; walls have an exact direction and need no condition.
`noise_limit` is the largest e that meets the conditions. Constraints may contradict each other: a robot that is
measured inside two clearances at once may have no velocity that leaves both. It then takes the least violation, and is
flagged.

Losses. A lost link carries nothing in either direction for one tick, as an exchange that is not acknowledged: the
graph stays undirected, so formation forces cancel in pairs. Only shared intentions and formation use messages. Barriers
rest on what robots sense themselves, so clearances do not depend on losses; and v_s stays a weighted mean of what is
received, so that its bound holds. Sides and leadership are agreed on the whole graph: they are held
between ticks, and a message lost for 20 ms does not revoke them.
"""

import math

import numpy as np

from higvf_console.control.intention.packet_loss import MEASURING, chance
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import Parameters, RobotParameters, packed
from higvf_console.core.arrays import Floats
from higvf_console.core.state import Motion


@kernel
def measured(position: Floats, tick: int, robots: RobotParameters) -> Floats:
    """Measured positions (N, 2) [m]: each off by an error that is uniform in a disc of radius `position_noise`."""
    seen = np.empty(position.shape)
    for i in range(position.shape[0]):
        radius = robots.position_noise * math.sqrt(chance(robots.seed, tick, MEASURING, i, 0))
        angle = 2.0 * math.pi * chance(robots.seed, tick, MEASURING, i, 1)
        seen[i, 0] = position[i, 0] + radius * math.cos(angle)
        seen[i, 1] = position[i, 1] + radius * math.sin(angle)
    return seen


@kernel
def as_measured(motion: Motion, robots: RobotParameters) -> Motion:
    """The motion as controller and filter see it: with measured positions."""
    return Motion(
        tick=motion.tick,
        position=measured(motion.position, motion.tick, robots),
        heading=motion.heading,
        velocity=motion.velocity,
        intention=motion.intention,
        target=motion.target,
        target_value=motion.target_value,
        circulation=motion.circulation,
        stalled=motion.stalled,
        recovery_stage=motion.recovery_stage,
        fire_radius=motion.fire_radius,
        fire_progress=motion.fire_progress,
        fire_burning=motion.fire_burning,
        path_parameter=motion.path_parameter,
        path_status=motion.path_status,
        path_idle=motion.path_idle,
        path_gap=motion.path_gap,
        path_left=motion.path_left,
        robot_peak=motion.robot_peak,
        human_peak=motion.human_peak,
    )


def seen_positions(motion: Motion, params: Parameters) -> Floats:
    """Positions (N, 2) [m] as controller and safety filter measure them."""
    if params.robots.position_noise == 0.0:
        return motion.position
    return measured(motion.position, motion.tick, packed(params)[0].robots)


def noise_limit(params: Parameters, growth: float) -> float:
    """The largest `position_noise` [m] under which true clearances are kept, by the conditions above.

    Args:
        params: those of the controlled point without noise.
        growth: of the fastest fire [m/s].
    """
    safety = params.safety
    dt, way = safety.control_period, safety.speed_limit * safety.control_period
    obstacle, pair = safety.obstacle_clearance, safety.robot_clearance
    return min(
        obstacle * min(safety.obstacle_gain * dt, 0.5),
        math.sqrt(max(way - growth * dt, 0.0) * obstacle / 2.0),
        pair * min(safety.pair_gain * dt, 0.5) / 2.0,
        math.sqrt(way * pair) / 2.0,
    )
