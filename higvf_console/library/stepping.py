"""The pure step for callers outside the engine: its arguments are checked, then the same kernels run.

The engine's own loop calls `sim.simulation` and `operator.reducer`, which trust their arguments.
"""

import dataclasses
from typing import Any, get_args

import numpy as np
from numpy.typing import ArrayLike

from higvf_console.control.parameters import Parameters
from higvf_console.core.arguments import brief, instance, number, whole
from higvf_console.core.arrays import FARTHEST, Floats, floats, given_floats
from higvf_console.core.command import Command
from higvf_console.core.commands import OperatorCommand
from higvf_console.core.errors import ArgumentError, ArgumentTypeError, HigvfError
from higvf_console.core.state import SimState, Trace, World
from higvf_console.core.viewport import Arena
from higvf_console.library.records import given_parameters, given_state, given_world
from higvf_console.operator import reducer
from higvf_console.operator.outcome import Outcome
from higvf_console.runtime.compiling import announce
from higvf_console.sim import simulation
from higvf_console.sim.simulation import Rollout
from higvf_console.world.layout import Layout
from higvf_console.world.setup import Setup

_MOST_TICKS = 10_000_000
_COMMANDS: tuple[type[Command], ...] = get_args(OperatorCommand)
_POINTS = {"points": ("N", 2), "grip": (2,), "sides": (4,)}  # fields of commands that hold arrays
_WHOLE = ("robot", "number", "index", "first", "second")


def advance(state: SimState, world: World, params: Parameters) -> tuple[SimState, Trace]:
    """The state one control period later, and why the team moved so.

    Args:
        state: of N robots and M fires, as `world` has them.
        world: from `make_setup` or a scenario's `setup`.
        params: all tunables, those of the bodies.

    Returns:
        The next state, a new one, and its `Trace`.

    Raises:
        ArgumentError: a record has a field of another shape or type, NaN, or an index of what does not exist.
    """
    place, tunables = given_world(world), given_parameters(params, "params")
    now = given_state(state, place)
    announce()
    return simulation.advance(now, place, tunables)


def roll(state: SimState, world: World, params: Parameters, ticks: int) -> tuple[SimState, Rollout]:
    """The state `ticks` control periods later, nothing commanded on the way, and the history.

    Args:
        state: as in `advance`.
        world: as in `advance`.
        params: as in `advance`.
        ticks: control periods, from 0.

    Returns:
        The last state, bit for bit that of as many calls of `advance`, and a `Rollout` of arrays by tick.

    Raises:
        ArgumentError: as in `advance`.
    """
    place, tunables = given_world(world), given_parameters(params, "params")
    now, count = given_state(state, place), whole("ticks", ticks, 0, _MOST_TICKS)
    announce()
    return simulation.roll(now, place, tunables, count)


def initial_state(position: ArrayLike, fire_radius: ArrayLike, world: World, heading: float = 0.0) -> SimState:
    """The state at tick 0: robots at rest, all fires burning.

    Args:
        position: (N, 2) controlled points [m].
        fire_radius: (M,) [m].
        world: of N robots and M fires.
        heading: of all unicycles [rad].

    Raises:
        ArgumentError: an argument has another shape or type, or holds NaN or infinite values.
    """
    place = given_world(world)
    robots, fires = len(place.formation), len(place.fire_position)
    points = given_floats("position", position, (robots, 2), most=FARTHEST, why=f"the world has {robots} robots")
    radius = given_floats("fire_radius", fire_radius, (fires,), most=FARTHEST, why=f"the world has {fires} fires")
    if (radius < 0.0).any():
        raise ArgumentError(f"fire_radius has {radius.min():g} m; expected numbers from 0")
    return simulation.initial_state(points, radius, place, number("heading", heading, -1e6, 1e6))


def given_setup(setup: object, name: str = "setup") -> Setup:
    """A setup whose world, parameters and start fit each other.

    Raises:
        ArgumentError: they do not; the message names the field.
    """
    given = instance(name, setup, Setup)
    instance(f"{name}.layout", given.layout, Layout)
    world, arena = given_world(given.world, f"{name}.world"), instance(f"{name}.arena", given.arena, Arena)
    given_floats(f"{name}.arena", list(arena), (4,), most=FARTHEST)
    params = given_parameters(given.params, f"{name}.params")
    layout = given.layout if params is given.params else given.layout._replace(params=params)
    return given._replace(layout=layout, world=world, start=given_state(given.start, world, f"{name}.start"))


def apply_command(state: SimState, command: OperatorCommand, setup: Setup) -> Outcome:
    """The state after one operator command, and the events that a person should read.

    Args:
        state: as in `advance`.
        command: what the operator asks for; one that cannot be carried out changes nothing, and an event says why.
        setup: arena, world and parameters in force.

    Raises:
        ArgumentError: no command, one with a field of another shape or type, or a state that does not fit the setup.
    """
    place = given_setup(setup)
    given = given_command(command)
    try:
        return reducer.apply_command(given_state(state, place.world), given, place)
    except HigvfError:
        raise
    except (TypeError, ValueError, IndexError, AttributeError) as problem:  # a field of a kind that nothing can use
        raise ArgumentError(f"command is {brief(command)}, which cannot be used: {problem}") from problem


def given_command(command: object) -> OperatorCommand:
    """An operator command whose arrays and indices are such.

    Raises:
        ArgumentTypeError: no command of `core.commands`.
        ArgumentError: a field has another shape or type.
    """
    if not isinstance(command, _COMMANDS):
        raise ArgumentTypeError(f"command is {brief(command)}; expected a command of higvf_console.commands")
    changed: dict[str, Any] = {}
    for field in dataclasses.fields(command):
        name, value = f"command.{field.name}", getattr(command, field.name)
        if field.name in _POINTS:
            changed[field.name] = given_floats(name, value, _POINTS[field.name], most=FARTHEST)
        elif field.name == "point":  # a cursor that is out of sight is NaN
            changed[field.name] = _point(name, value)
        elif field.name in _WHOLE and value is not None:
            changed[field.name] = whole(name, value, 0)
    return dataclasses.replace(command, **changed)  # pyright: ignore[reportReturnType] (a member of the union)


def _point(name: str, value: object) -> Floats:
    point = given_floats(name, value, (2,), finite=False)
    return point if np.isnan(point).any() else floats(given_floats(name, point, (2,), most=FARTHEST))
