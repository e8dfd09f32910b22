"""The conditions that a run rests on, checked on its history: the one place where the report asks the engine for them.

    stability     dt * (largest rate of the intention update) of the semi-implicit step: stable at any value; for an
                  explicit step it would have to stay below 2
    bound         max |v_s| <= max(w1 T/(w0 + w1), (w1 T + w3 H)/(w0 + w1 + w3)), T, H the largest |v_t|, |v_h| so far
    lambda_2      algebraic connectivity of the links, above 0 while the team is connected
    sampling      dt * rate * h_near^2 <= 1 for every kind of barrier
    least h       smallest barrier function, dimensionless
"""

from typing import NamedTuple

import numpy as np

from higvf_console.arrays import Floats
from higvf_console.control.barriers.certificate import sampling_conditions
from higvf_console.control.gains import IntentionGains
from higvf_console.lab.reproduce.runs import Run


class Certificates(NamedTuple):
    """What was checked on one run.

    Attributes:
        explicit_limit: dt * largest rate; below 2 even an explicit step would be stable.
        intention: largest |v_s| of the run.
        bound: its bound at the end of the run.
        bounded: whether |v_s| kept below its bound at every moment.
        lambda_2: smallest of the run.
        sampling: largest dt * rate * h_near^2 of all kinds of barrier.
        least_h: smallest barrier function of the run.
    """

    explicit_limit: float
    intention: float
    bound: float
    bounded: bool
    lambda_2: float
    sampling: float
    least_h: float


def certificates_of(run: Run) -> Certificates:
    """Checks every moment of a run."""
    gains, robots = run.setup.gains, run.position.shape[1]
    weights = gains.intention
    rate = weights.decay + weights.robot_weight + weights.human_weight + weights.neighbour_weight * robots
    intention = np.hypot(run.intention[..., 0], run.intention[..., 1]).max(axis=1)
    bound = intention_bound(run.robot_intention, run.human_intention, weights)
    conditions = sampling_conditions(run.setup.world, run.fire_radius[0], gains.safety)
    return Certificates(
        explicit_limit=gains.safety.control_period * rate,
        intention=float(intention.max()),
        bound=float(bound[-1]),
        bounded=bool((intention <= bound + 1e-9).all()),
        lambda_2=float(run.connectivity.min()),
        sampling=max(condition.value for condition in conditions),
        least_h=float(run.barrier.min()),
    )


def intention_bound(robot: Floats, human: Floats, weights: IntentionGains) -> Floats:
    """Bound (T,) on |v_s| at each moment, of the largest |v_t| and |v_h| (T,) up to it."""
    t, h = np.maximum.accumulate(robot), np.maximum.accumulate(human)
    alone = weights.decay + weights.robot_weight
    led = (weights.robot_weight * t + weights.human_weight * h) / (alone + weights.human_weight)
    return np.maximum(weights.robot_weight * t / alone, led)
