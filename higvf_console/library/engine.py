"""The compiled engine as the library calls it: the one place to change when the engine's own interface changes."""

from functools import lru_cache
from time import perf_counter

from higvf_console.control.forms import PRINTED
from higvf_console.control.parameters import Parameters, SafetyParameters, controlled
from higvf_console.control.safety import safety_filter
from higvf_console.control.safety.barriers.sampling import check_sampling
from higvf_console.control.safety.hazards import GROWTH
from higvf_console.core.arrays import Bools, Floats, Ints
from higvf_console.library.hazards import Hazards
from higvf_console.runtime.compiling import announce
from higvf_console.sim.warm_up import warm_up
from higvf_console.world.setup import Setup


def compiled(setup: Setup) -> float:
    """Compiles the engine, or loads it from the cache; returns how long that took [s]."""
    started = perf_counter()
    announce()
    warm_up(setup.start, setup.world, setup.params)
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
        FilterError: with these parameters the barriers do not hold between two control steps.
    """
    safety = controlled(params).safety._replace(h_index=params.forms.h_index)
    table = _checked_table(hazards, safety, params.forms.fire_constraint)
    announce()
    return safety_filter.filter_velocities(positions, nominal, table, safety)


@lru_cache(maxsize=16)
def _checked_table(hazards: Hazards, safety: SafetyParameters, fire_constraint: float) -> Floats:
    """The table of hazards that the filter takes; without growth in [27] as printed."""
    table = hazards.table.copy()
    if fire_constraint == PRINTED:
        table[:, GROWTH] = 0.0
    check_sampling(table, safety)
    return table
