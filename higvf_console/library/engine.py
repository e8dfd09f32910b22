"""The compiled engine as the library calls it: the one place to change when the engine's own interface changes."""

import os
import sys
from functools import cache, lru_cache
from pathlib import Path
from time import perf_counter

import numpy as np

from higvf_console.control.forms import PRINTED
from higvf_console.control.parameters import Parameters, SafetyParameters, controlled
from higvf_console.control.safety import safety_filter
from higvf_console.control.safety.barriers.certificate import check_sampling
from higvf_console.core.arrays import Bools, Floats, Ints, bools, floats, ints
from higvf_console.core.errors import ArgumentError
from higvf_console.core.state import World
from higvf_console.library.hazards import Hazards
from higvf_console.sim import simulation
from higvf_console.sim.setup import Setup

COMPILING = "Compiling the engine, once; this takes up to a minute ..."
TICK, ROLL, FILTER = "simulation.tick", "simulation._roll", "safety_filter.filter_velocities"
FIELD, PATH = "field._field", "paths.nearest"


@cache
def announce(name: str) -> None:
    """Says on standard error, once a process, that a kernel is about to be compiled; not where it is in the cache.

    Args:
        name: module and function of the kernel.
    """
    folder = os.environ.get("NUMBA_CACHE_DIR")
    compiles = hasattr(simulation.tick, "signatures")  # not under NUMBA_DISABLE_JIT=1
    if compiles and (folder is None or not any(Path(folder).rglob(f"{name}-*.nbi"))):
        say_once()


@cache
def say_once() -> None:
    """Says that the engine is being compiled, once a process."""
    print(COMPILING, file=sys.stderr, flush=True)


def compiled(setup: Setup) -> float:
    """Compiles the engine, or loads it from the cache; returns how long that took [s]."""
    started = perf_counter()
    announce(TICK)
    simulation.warm_up(setup.start, setup.world, setup.params)
    return perf_counter() - started


def filtered(positions: Floats, nominal: Floats, hazards: Hazards, params: Parameters) -> tuple[Floats, Ints, Bools]:
    """The distributed safety filter on checked arguments; clearances are enlarged for controlled points.

    Args:
        positions: (N, 2) controlled points [m].
        nominal: (N, 2) [m/s].
        hazards: what else there is to keep clear of.
        params: those of the bodies.

    Returns:
        Velocities (N, 2) [m/s], active constraints (N,) and infeasible (N,).

    Raises:
        ArgumentError: a hazard that the engine cannot represent.
    """
    safety = controlled(params).safety._replace(h_index=params.forms.h_index)
    growing = hazards.growing
    rate = np.zeros(len(growing)) if params.forms.fire_constraint == PRINTED else growing[:, 3].copy()
    announce(FILTER)
    return safety_filter.filter_velocities(
        positions, nominal, hazards.circles, hazards.capsules, hazards.half_planes, floats(growing[:, :2]),
        floats(growing[:, 2]), rate, bools([True] * len(growing)), safety,
    )  # fmt: skip


def check_filter(hazards: Hazards, params: Parameters) -> None:
    """Refuses parameters with which the barriers do not hold between two control steps.

    Raises:
        FilterError: with the numbers and what to change.
    """
    _check_filter(hazards, controlled(params).safety)


@lru_cache(maxsize=16)
def _check_filter(hazards: Hazards, safety: SafetyParameters) -> None:
    growing, none = hazards.growing, floats([], 0, 2)
    world = World(
        circles=hazards.circles, bars=hazards.capsules, walls=hazards.half_planes, fire_position=floats(growing[:, :2]),
        fire_growth=floats(growing[:, 3]), fire_needs=ints([1] * len(growing)), formation=none, link_start=ints([]),
        link_to=ints([]), boundary=floats([], 0, 9), boundary_start=ints([0, 0, 0], 3, 1), hull=none, part=ints([]),
        pocket=floats([], 0, 3),
    )  # fmt: skip
    check_sampling(world, floats(growing[:, 2]), safety)


def refuse_motion(hazards: Hazards, where: str) -> None:
    """Refuses hazards that move, and growing ones that are not round, where the engine has no barrier for them.

    Raises:
        ArgumentError: with the number and kind of the hazard.
    """
    for number, item in enumerate(hazards.items, 1):
        if item.velocity != (0.0, 0.0):
            raise ArgumentError(
                f"hazard {number}, a {item.kind}, moves at {item.velocity} m/s; {where} takes still ones"
            )
        if item.growth != 0.0 and item.start != item.end:
            raise ArgumentError(f"hazard {number}, a {item.kind}, grows; only circles and fires may grow in {where}")
