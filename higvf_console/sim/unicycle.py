"""Unicycles: robots that drive along their heading and turn, controlled by a point ahead of their centre.

    centre' = v (cos theta, sin theta),   theta' = omega,   p = centre + l e(theta)

The look-ahead point p can move any way, so it takes the single integrator's place in the controller and the filter, and
`Motion.position` is p. Bodies keep the clearances R_o and R_r, for |centre - p| = l and p keeps R_o + l, R_r + 2 l.

A velocity u of p, held for a control period, is driven exactly. A unicycle with constant v and omega turns by 2 y and
its centre moves by a chord c in the direction theta + y, so p moves by c along it and by 2 l sin y across it:

    u dt = c e(theta + y) + 2 l sin(y) n(theta + y)   =>   tan y = u_n dt / (2 l + u_e dt)
    omega = 2 y / dt,   v = (c / dt) y / sin y

with u_e, u_n the parts of u along and across the heading. Nothing is scaled afterwards, so what the filter guarantees
for p holds. With |u| dt <= 2 l sin(omega_max dt / 2) the limits hold exactly: 2 l |sin y| <= |u| dt gives |omega| <=
omega_max, and c^2 + (2 l sin y)^2 = (u dt)^2 with 1 / sin^2 y - 1 / y^2 <= 1 gives |v| <= |u| <= v_max.
`params.controlled` therefore limits |u| to min(v_max, (2 l / dt) sin(omega_max dt / 2)), nearly l omega_max.
"""

import math

import numpy as np

from higvf_console.control.kernel import kernel
from higvf_console.core.arrays import Floats


@kernel
def drive(ux: float, uy: float, heading: float, look_ahead: float, period: float) -> tuple[float, float]:
    """Speed v [m/s] and turn rate omega [rad/s] which, held for a period, move the look-ahead point by u times it.

    Args:
        ux: velocity u of the look-ahead point [m/s], |u| period <= 2 look_ahead.
        uy: the same.
        heading: at the start of the period [rad].
        look_ahead: l > 0 [m].
        period: dt [s].
    """
    along, across = math.cos(heading), math.sin(heading)
    forward, left = (ux * along + uy * across) * period, (uy * along - ux * across) * period
    half_turn = math.atan2(left, 2.0 * look_ahead + forward)
    chord = forward * math.cos(half_turn) + left * math.sin(half_turn)
    arc = chord if half_turn == 0.0 else chord * half_turn / math.sin(half_turn)
    return arc / period, 2.0 * half_turn / period


@kernel
def headings_after(heading: Floats, velocity: Floats, look_ahead: float, period: float) -> Floats:
    """Headings (N,) [rad] after a period in which the look-ahead points moved with `velocity` (N, 2) [m/s].

    Not wrapped; single integrators (`look_ahead` 0) keep theirs.
    """
    if look_ahead == 0.0:
        return heading
    after = np.empty(heading.shape[0])
    for i in range(heading.shape[0]):
        _, turn_rate = drive(velocity[i, 0], velocity[i, 1], heading[i], look_ahead, period)
        after[i] = heading[i] + turn_rate * period
    return after


@kernel
def body_centres(position: Floats, heading: Floats, look_ahead: float) -> Floats:
    """Centres of the bodies (N, 2) [m], from the controlled points (N, 2) [m] and the headings (N,) [rad]."""
    if look_ahead == 0.0:
        return position
    centre = np.empty(position.shape)
    for i in range(position.shape[0]):
        centre[i, 0] = position[i, 0] - look_ahead * math.cos(heading[i])
        centre[i, 1] = position[i, 1] - look_ahead * math.sin(heading[i])
    return centre
