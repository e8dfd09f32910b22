"""The run that nobody touches: loss area without an operator, computed while the session already runs."""

from threading import Event as Signal
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Bools, Floats, floats
from higvf_console.sim.simulation import roll
from higvf_console.world.setup import Setup

_CHUNK = 250  # ticks between two looks at whether the session still wants the result


class Baseline(NamedTuple):
    """Loss area over time without an operator, of M fires.

    Attributes:
        time: (T,) [s].
        loss_area: (T,) summed over all fires [m^2].
        by_fire: (T, M) of each [m^2].
        burning: (T, M) which fires burn.
    """

    time: Floats
    loss_area: Floats
    by_fire: Floats
    burning: Bools


def compute_baseline(setup: Setup, duration: float, stopping: Signal) -> Baseline | None:
    """Rolls the scenario out until all fires are out or `duration` [s] ends.

    Returns:
        None without fires, or when `stopping` was set.
    """
    if not setup.start.motion.fire_burning.any():
        return None
    dt = setup.params.safety.control_period
    losses, burning = list[Floats](), list[Bools]()
    state, ticks = setup.start, 0
    while ticks * dt < duration and state.motion.fire_burning.any():
        if stopping.is_set():
            return None
        state, rollout = roll(state, setup.world, setup.params, _CHUNK)
        losses.append(rollout.loss_area)
        burning.append(rollout.burning)
        ticks += _CHUNK
    loss = np.concatenate(losses)
    return Baseline(dt * floats(range(1, ticks + 1)), loss.sum(axis=1), loss, np.concatenate(burning))
