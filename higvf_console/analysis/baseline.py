"""The run that nobody touches: loss area without an operator, computed while the session already runs."""

from threading import Event as Signal
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.sim.simulation import roll
from higvf_console.world.setup import Setup

_CHUNK = 250  # ticks between two looks at whether the session still wants the result


class Baseline(NamedTuple):
    """Total loss area over time without an operator.

    Attributes:
        time: (T,) [s].
        loss_area: (T,) summed over all fires [m^2].
    """

    time: Floats
    loss_area: Floats


def compute_baseline(setup: Setup, duration: float, stopping: Signal) -> Baseline | None:
    """Rolls the scenario out until all fires are out or `duration` [s] ends.

    Returns:
        None without fires, or when `stopping` was set.
    """
    if not setup.start.motion.fire_burning.any():
        return None
    dt = setup.params.safety.control_period
    losses: list[Floats] = []
    state, ticks = setup.start, 0
    while ticks * dt < duration and state.motion.fire_burning.any():
        if stopping.is_set():
            return None
        state, rollout = roll(state, setup.world, setup.params, _CHUNK)
        losses.append(rollout.loss_area.sum(axis=1))
        ticks += _CHUNK
    return Baseline(dt * floats(range(1, ticks + 1)), np.concatenate(losses))
