"""When the barriers hold in discrete time: the sampling condition, the culling distances and the least stand-off.

A constraint only speaks for the instant. Over a control period it gives h_next >= h (1 - dt rate h^2), which keeps h >=
0 as long as `dt rate h^2 <= 1` wherever the robot could reach h = 0 in one period, that is below h_near = ((R + s
dt)/R)^2 - 1 at the closing speed s. The smaller the clearance R, the stricter.
"""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.control.parameters import SafetyParameters
from higvf_console.control.safety.hazards import GROWTH, RADIUS, VX, VY, hazard_word
from higvf_console.core.arrays import Floats
from higvf_console.core.errors import FilterError

SAMPLING_LIMIT = 1.0
_ORDER = ("circle", "bar", "fire", "wall")  # in which they are reported; other kinds follow


class SamplingCondition(NamedTuple):
    """One kind of barrier: safe in discrete time when `value` <= SAMPLING_LIMIT.

    Attributes:
        kind: "pair", "circle", "bar", "fire" or "wall".
        clearance: the smallest R of the kind [m].
        closing_speed: s, how fast the gap can close [m/s].
        value: dt rate h_near^2.
    """

    kind: str
    clearance: float
    closing_speed: float
    value: float

    @property
    def met(self) -> bool:
        """Whether the barriers of this kind hold in discrete time."""
        return self.value <= SAMPLING_LIMIT


def sampling_conditions(hazards: Floats, safety: SafetyParameters) -> tuple[SamplingCondition, ...]:
    """The sampling condition of every kind of barrier, robot pairs first.

    Args:
        hazards: (H, 9) see `control.safety.hazards`; of each kind the smallest and the fastest counts.
        safety: clearances, rates, speed limit and control period.
    """
    limit, margin, rate = safety.speed_limit, safety.obstacle_clearance, safety.obstacle_gain
    found = [_round("pair", safety.robot_clearance, 2.0 * limit, safety.pair_gain, safety.control_period)]
    kinds = np.array([hazard_word(hazard) for hazard in hazards])
    for kind in dict.fromkeys((*_ORDER, *kinds.tolist())):
        of_kind = hazards[kinds == kind]
        if not len(of_kind):
            continue
        if kind == "wall":
            h_near = limit * safety.control_period / margin
            found.append(SamplingCondition("wall", margin, limit, safety.control_period * rate * h_near**2))
        else:
            closing = limit + float((np.abs(of_kind[:, GROWTH]) + np.hypot(of_kind[:, VX], of_kind[:, VY])).max())
            found.append(_round(kind, margin + float(of_kind[:, RADIUS].min()), closing, rate, safety.control_period))
    return tuple(found)


def check_sampling(hazards: Floats, safety: SafetyParameters) -> None:
    """Refuses hazards of which the barriers do not hold in discrete time.

    Raises:
        FilterError: a kind of barrier misses the sampling condition; the message gives the numbers and what to change.
    """
    for condition in sampling_conditions(hazards, safety):
        if not condition.met:
            raise FilterError(
                f"{condition.kind} barriers do not hold between two control steps: dt * rate * h_near^2 ="
                f" {condition.value:.3g} exceeds {SAMPLING_LIMIT:g} at clearance {condition.clearance:g} m and closing"
                f" speed {condition.closing_speed:g} m/s; lower speed_limit ({safety.speed_limit:g} m/s),"
                f" control_period ({safety.control_period:g} s) or"
                f" {'pair_gain' if condition.kind == 'pair' else 'obstacle_gain'}, or raise the clearance"
            )


def least_stand_off(fire_radius: float, growth: float, safety: SafetyParameters) -> float:
    """Smallest stand-off [m] at which a robot can hold at a fire: its growing barrier pushes it that far.

    R_o + R_k (sqrt(1 + (2 R'/(beta R_k))^(1/3)) - 1), R_k = radius + R_o

    Args:
        fire_radius: the largest radius at which the fire is fought; the distance grows with it [m].
        growth: R', growth of the radius [m/s].
        safety: R_o and beta.
    """
    clearance = fire_radius + safety.obstacle_clearance
    h = (2.0 * growth / (safety.obstacle_gain * clearance)) ** (1.0 / 3.0)
    return safety.obstacle_clearance + clearance * (math.sqrt(1.0 + h) - 1.0)


def _round(kind: str, clearance: float, closing: float, rate: float, period: float) -> SamplingCondition:
    h_near = ((clearance + closing * period) / clearance) ** 2 - 1.0
    return SamplingCondition(kind, clearance, closing, period * rate * h_near**2)
