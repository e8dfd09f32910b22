"""Fires: who extinguishes them, how fast they grow, when they go out."""

import numpy as np

from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Bools, Floats, Ints
from higvf_console.core.state import Motion, World


@kernel
def crews(motion: Motion, steered: Bools, world: World, params: Parameters) -> Ints:
    """(M,) robots that count towards extinguishing each fire: within its stand-off, not led by the human."""
    crew = np.zeros(world.fire_position.shape[0], np.int64)
    if motion.tick * params.safety.control_period < params.fires.start_delay:
        return crew
    for j in range(crew.shape[0]):
        if not motion.fire_burning[j]:
            continue
        activation_distance = motion.fire_radius[j] + params.fires.stand_off
        for i in range(motion.position.shape[0]):
            dx = motion.position[i, 0] - world.fire_position[j, 0]
            dy = motion.position[i, 1] - world.fire_position[j, 1]
            if not steered[i] and dx * dx + dy * dy <= activation_distance * activation_distance:
                crew[j] += 1
    return crew


@kernel
def growth_rates(motion: Motion, crew: Ints, world: World) -> Floats:
    """(M,) dR/dt over the coming period [m/s]: a fire stands still while enough robots extinguish it."""
    rate = np.zeros(crew.shape[0])
    for j in range(crew.shape[0]):
        if motion.fire_burning[j] and crew[j] < world.fire_needs[j]:
            rate[j] = world.fire_growth[j]
    return rate


@kernel
def burn(motion: Motion, crew: Ints, rate: Floats, world: World, params: Parameters) -> tuple[Floats, Floats, Bools]:
    """Fire radius [m], progress [s] and burning flags (M,) after one period; progress is kept when robots leave."""
    dt = params.safety.control_period
    radius = motion.fire_radius + rate * dt
    progress, burning = motion.fire_progress.copy(), motion.fire_burning.copy()
    for j in range(crew.shape[0]):
        if burning[j] and crew[j] >= world.fire_needs[j]:
            progress[j] += dt
            burning[j] = progress[j] < params.fires.extinguish_time * radius[j]
    return radius, progress, burning
