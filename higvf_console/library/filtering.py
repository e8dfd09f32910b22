"""The safety filter alone: nominal velocities in, safe velocities out, [20]-[28]."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import FARTHEST, Bools, Floats, Ints, floats, given_floats
from higvf_console.core.errors import ArgumentError
from higvf_console.library import engine
from higvf_console.library.hazards import Hazards, given_hazards
from higvf_console.library.records import given_parameters
from higvf_console.sim.unicycle import drive

_FASTEST = 1e6  # [m/s]


class Filtered(NamedTuple):
    """What the safety filter made of nominal velocities.

    Attributes:
        velocity: (N, 2) [m/s]; the nominal one bit for bit where no constraint is active.
        active_constraints: (N,) barrier constraints that shaped it.
        infeasible: (N,) no velocities of the team meet the robot's constraints, so the least violation was taken.
    """

    velocity: Floats
    active_constraints: Ints
    infeasible: Bools


def filter_velocities(
    positions: ArrayLike,
    nominal: ArrayLike,
    hazards: Hazards | None = None,
    parameters: Parameters | None = None,
    *,
    headings: ArrayLike | None = None,
) -> Filtered:
    """The velocities nearest to the nominal ones with which robots keep all clearances.

    min |u - v|^2  subject to a.u <= b for each neighbour, obstacle, fire and wall, and |u| <= v_max, [28]

    Every robot solves its own problem; a pair of robots shares its constraint in halves, [25]. Clearances are enlarged
    here for unicycles (`parameters.robots.look_ahead`) and for errors of measured positions (`position_noise`).

    Args:
        positions: (N, 2) centres of the robots [m].
        nominal: (N, 2) desired velocities v [m/s], of unicycles those of the point `look_ahead` in front; shortened to
            the speed limit first.
        hazards: what to keep clear of; None = the other robots alone.
        parameters: clearances, class-K gains, speed limit and control period; None = the defaults.
        headings: (N,) of unicycles, or one for all [rad]; not needed where `look_ahead` is 0.

    Returns:
        Velocities (N, 2), of unicycles those of the point in front, and what shaped them.

    Raises:
        ArgumentError: an argument has another shape or type, or holds NaN or infinite values.
        FilterError: with these parameters the barriers do not hold between two control steps.
    """
    params = Parameters() if parameters is None else given_parameters(parameters)
    centres = given_floats("positions", positions, ("N", 2), most=FARTHEST)
    robots = len(centres)
    wanted = given_floats("nominal", nominal, (robots, 2), most=_FASTEST, why=f"positions has {robots} robots")
    points = controlled_points(centres, headings, params)
    dangers = given_hazards(hazards)
    return Filtered(*engine.filtered(points, wanted, dangers, params))


def controlled_points(centres: Floats, headings: ArrayLike | None, params: Parameters) -> Floats:
    """Controlled points (N, 2) [m] of robots at checked `centres` (N, 2): the centres, or points in front of unicycles.

    Raises:
        ArgumentError: `headings` (N,) [rad] are wrong, or missing for unicycles.
    """
    look_ahead = params.robots.look_ahead
    if look_ahead == 0.0:
        return centres
    if headings is None:
        raise ArgumentError(f"headings is None; expected headings [rad], for robots.look_ahead is {look_ahead:g} m")
    return floats(centres + look_ahead * _directions(given_headings(headings, len(centres))))


def given_headings(headings: object, robots: int) -> Floats:
    """Headings (N,) [rad]; one number stands for all robots.

    Raises:
        ArgumentError: another shape, or not finite.
    """
    if np.ndim(headings) == 0:  # pyright: ignore[reportArgumentType] (whatever it is)
        return np.full(robots, float(given_floats("headings", headings, ())))
    return given_floats("headings", headings, (robots,), why=f"there are {robots} robots")


def unicycle_commands(velocities: ArrayLike, headings: ArrayLike, parameters: Parameters) -> Floats:
    """Speed and turn rate with which unicycles follow velocities of the points in front of them.

    Held for a control period, they move each point by exactly dt u; |v| and |omega| stay within the limits.

    Args:
        velocities: (N, 2) u, from `filter_velocities` or `Controller.step` [m/s].
        headings: (N,) at the start of the period, or one for all [rad].
        parameters: with `robots.look_ahead` above 0.

    Returns:
        (N, 2) speed v [m/s] and turn rate omega [rad/s].

    Raises:
        ArgumentError: an argument has another shape or type, or the robots are no unicycles.
    """
    params = given_parameters(parameters)
    if params.robots.look_ahead == 0.0:
        raise ArgumentError("parameters.robots.look_ahead is 0 m; expected more, as unicycles have")
    point = given_floats("velocities", velocities, ("N", 2), most=_FASTEST)
    angles = given_headings(headings, len(point))
    plain = getattr(drive, "py_func", drive)  # called for a few robots: not worth compiling
    period = params.safety.control_period
    drives = [
        plain(x, y, angle, params.robots.look_ahead, period)
        for (x, y), angle in zip(point.tolist(), angles.tolist(), strict=True)
    ]
    return floats(drives, -1, 2)


def _directions(headings: Floats) -> Floats:
    """Unit vectors (N, 2) along headings (N,), as a scenario's start makes them."""
    return floats([(math.cos(angle), math.sin(angle)) for angle in headings.tolist()], -1, 2)
