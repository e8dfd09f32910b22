"""Compiles, or loads, what a run calls: no tick can stall on it."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from higvf_console.control.guidance.boundaries import capsule_corners, convex_hull
from higvf_console.control.guidance.field import FieldKind, field_at
from higvf_console.control.guidance.paths import EVERYWHERE, circle_path, nearest, point_at, start_parameter
from higvf_console.control.kernel import closed
from higvf_console.control.parameters import Parameters, SafetyParameters, packed
from higvf_console.control.safety.hazards import COLUMNS
from higvf_console.control.safety.safety_filter import filter_velocities
from higvf_console.core.state import SimState, World
from higvf_console.sim.simulation import advance, advance_coupled, decide, run_ticks
from higvf_console.sim.unicycle import body_centres

_FILTER_ARGUMENTS = (np.zeros((1, 2)), np.zeros((1, 2)), np.zeros((0, COLUMNS)), SafetyParameters())


class Stage(NamedTuple):
    """A part of the engine.

    Attributes:
        name: of the part, for people.
        run: calls its kernels, so that they are compiled or loaded.
    """

    name: str
    run: Callable[[], object]


def stages(state: SimState, world: World, params: Parameters, coupled: bool = False) -> tuple[Stage, ...]:
    """The parts of the engine that a run of this state needs, the largest first.

    Args:
        state: any state of the run: sizes do not matter, types are always the same.
        world: of the run.
        params: of the run.
        coupled: whether the centralised safety filter is used as well.
    """
    found = [
        Stage("the control period", lambda: _control_period(state, world, params)),
        Stage("the vector field", lambda: _vector_field(state, world, params)),
        Stage("paths and obstacles", lambda: _small_parts(state)),
    ]
    if coupled:
        found.insert(1, Stage("the centralised filter", lambda: _centralised(state, world, params)))
    return tuple(found)


def warm_up(state: SimState, world: World, params: Parameters, coupled: bool = False) -> None:
    """Runs all stages; then forbids to compile the large ones anew, so that a wrong type is an error at once."""
    for stage in stages(state, world, params, coupled):
        stage.run()


def lower_controller(state: SimState, world: World, params: Parameters) -> None:
    """Lowers one half of the control period; the filter's is taken from the cache if another process left it there."""
    from higvf_console.control.compilation import handover  # noqa: PLC0415 (loads the compiler)

    handover.hand_over(filter_velocities)
    handover.lower(decide, state.motion, state.intent, world, packed(params))


def lower_safety_filter() -> None:
    """Lowers the other half, and leaves it in the cache."""
    from higvf_console.control.compilation import handover  # noqa: PLC0415

    handover.name_apart()
    handover.hand_over(filter_velocities)
    handover.lower(filter_velocities, *_FILTER_ARGUMENTS)


def _control_period(state: SimState, world: World, params: Parameters) -> None:
    advance(state, world, params)
    closed(run_ticks)


def _centralised(state: SimState, world: World, params: Parameters) -> None:
    from higvf_console.control.safety.coupled_filter import CoupledFilter  # noqa: PLC0415 (loads OSQP)

    advance_coupled(state, world, params, CoupledFilter())
    filter_velocities(*_FILTER_ARGUMENTS)  # where the program has no solution


def _vector_field(state: SimState, world: World, params: Parameters) -> None:
    field_at(FieldKind.BLENDED, np.zeros((1, 2)), state, world, params)


def _small_parts(state: SimState) -> None:
    path = circle_path(0.0, 0.0, 100.0)
    nearest(path, 0.0, EVERYWHERE, 0.0, 0.0)
    point_at(path, 0.0)
    start_parameter(path, 0.0, 0.0)
    convex_hull(capsule_corners(np.array([0.0, 0.0, 1.0, 0.0, 1.0])))
    body_centres(state.motion.position, state.motion.heading, 1.0)
