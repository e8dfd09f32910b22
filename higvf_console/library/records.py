"""The engine's records as a public function was given them: every array's shape, type and range, every index.

A kernel trusts its records: a position array that is too short is read beyond its end. A record that passes is returned
itself, or as a copy with the arrays that had to be converted.
"""

import math
from collections import deque
from collections.abc import Mapping
from functools import lru_cache
from itertools import pairwise
from typing import Any, TypeVar, cast

import numpy as np

from higvf_console.control.forms import CORRECTED, PRINTED
from higvf_console.control.guidance.obstacles import LOOP, ONWARD, STOP
from higvf_console.control.parameters import Parameters
from higvf_console.core.arguments import instance, number, positive, whole
from higvf_console.core.arrays import FARTHEST, Shape, given_bools, given_floats, given_ints
from higvf_console.core.errors import ArgumentError, ArgumentTypeError, ScenarioError
from higvf_console.core.quantity import checked, quantities
from higvf_console.core.scale import Scale
from higvf_console.core.state import (
    GRID_CELL,
    GRID_COLUMNS,
    MOVER_ENDING,
    MOVER_PART,
    NOBODY,
    Intent,
    Motion,
    Path,
    PathEnding,
    PathKind,
    PathStatus,
    SimState,
    World,
)

_Record = TypeVar("_Record", bound=tuple[Any, ...])
_SPLINE = 4  # nodes along each side that a cubic B-spline takes
_KNOWN = deque[tuple[World, World]](maxlen=8)  # worlds as they were given, and as they passed
_MOST = 2**53  # whole numbers that a float can tell apart


def given_parameters(params: object, name: str = "parameters") -> Parameters:
    """Parameters whose every number is one, and in its range.

    Raises:
        ArgumentTypeError: no `Parameters`, or a group of another type.
        ArgumentError: a number out of its range; the message gives group, name, value, range and unit.
    """
    try:
        return _given_parameters(instance(name, params, Parameters), name)
    except TypeError as problem:  # not hashable, so something in it is no number
        if isinstance(problem, ArgumentTypeError):
            raise
        return _given_parameters.__wrapped__(cast(Parameters, params), name)


@lru_cache(maxsize=64)
def _given_parameters(params: Parameters, name: str) -> Parameters:
    groups, body = dict[str, Any](), instance(f"{name}.scale", params.scale, Scale)
    scale = Scale(*(positive(f"{name}.scale.{key}", value, FARTHEST) for key, value in body._asdict().items()))
    for group, default in Parameters()._asdict().items():
        if group == "scale":
            continue
        part = instance(f"{name}.{group}", getattr(params, group), type(default))  # pyright: ignore[reportUnknownArgumentType, reportUnknownVariableType]
        known = quantities(type(default))  # pyright: ignore[reportUnknownArgumentType]
        values: dict[str, float] = {}
        for key, value in cast(Any, part)._asdict().items():
            place = f"{name}.{group}.{key}"
            if key in known:
                try:
                    found = value.item() if isinstance(value, np.number) else value  # pyright: ignore[reportUnknownVariableType]
                    values[key] = checked(place, found, known[key].at(scale))  # pyright: ignore[reportUnknownArgumentType]
                except ScenarioError as problem:
                    raise ArgumentError(str(problem)) from problem
            elif key == "seed":
                values[key] = number(place, value, 0.0, float(_MOST))
            else:
                values[key] = number(place, value, CORRECTED, PRINTED)
        groups[group] = type(default)(**values)
    given = Parameters(**groups, scale=scale)
    reactive, repulsive = given.boundaries.reactive_margin, given.boundaries.repulsive_margin
    if reactive <= repulsive:
        raise ArgumentError(
            f"{name}.boundaries.reactive_margin is {reactive:g} m; expected more than repulsive_margin, {repulsive:g} m"
        )
    return given


def given_path(path: object, name: str = "path") -> Path:
    """A path that the kernels can follow, or NO_PATH.

    Raises:
        ArgumentTypeError: no `Path`.
        ArgumentError: a field that does not fit its kind.
    """
    given = instance(name, path, Path)
    kind = whole(f"{name}.kind", given.kind, 0, max(PathKind))
    segments = given_floats(f"{name}.spline", given.spline, ("S", 8))
    if kind == PathKind.SPLINE and not len(segments):
        raise ArgumentError(f"{name}.spline has no segment; expected at least one of a path of splines")
    return _like(
        given,
        kind=kind,
        shape=given_floats(f"{name}.shape", given.shape, (4,)),
        spline=segments,
        spacing=_above(f"{name}.spacing", given.spacing),
        length=number(f"{name}.length", given.length, 0.0),
        closed=bool(instance(f"{name}.closed", given.closed, bool, np.bool_)),
        direction=_sign(f"{name}.direction", given.direction),
        ending=whole(f"{name}.ending", given.ending, 0, max(PathEnding)),
        pace=number(f"{name}.pace", given.pace, 0.0, 10.0),
        duration=number(f"{name}.duration", given.duration, 0.0),
    )


def given_world(world: object, name: str = "world") -> World:
    """A world whose arrays have the shapes and indices that `core.state.World` documents.

    The last few worlds that passed are not checked again: a world's arrays are never written.

    Raises:
        ArgumentTypeError: no `World`, or an array of another kind.
        ArgumentError: another shape, or an index out of range.
    """
    given = instance(name, world, World)
    for known, passed in tuple(_KNOWN):
        if known is given:
            return passed
    passed = _given_world(given, name)
    _KNOWN.append((given, passed))
    return passed


def _given_world(w: World, name: str) -> World:
    fires, robots = _length(w.fire_position), _length(w.formation)
    floats = _floats(name, w, {
        "capsules": ("K", 5), "walls": ("W", 3), "fire_position": ("M", 2), "fire_growth": (fires,),
        "formation": ("N", 2), "boundary": ("G", 9), "hull": ("H", 2), "pocket": ("C", 3),
        "capsule_velocity": (_length(w.capsules), 2), "mover": ("V", 8), "course": ("C", 3),
    })  # fmt: skip
    groups, parts, movers = _length(w.boundary), _length(w.capsules), len(floats["mover"])
    links = given_ints(f"{name}.link_to", w.link_to, ("E",), 0, robots - 1)
    start = given_ints(f"{name}.link_start", w.link_start, ("N",), 0, len(links))
    if len(start):
        start = given_ints(f"{name}.link_start", start, (robots + 1,), 0, len(links), why="robots + 1, or none")
        _rises(f"{name}.link_start", start, len(links))
    elif len(links):
        raise ArgumentError(f"{name}.link_start is empty; expected the rows of the {len(links)} entries of link_to")
    course_start = given_ints(f"{name}.course_start", w.course_start, (movers + 1,), 0, len(floats["course"]))
    _rises(f"{name}.course_start", course_start, len(floats["course"]))
    _courses(name, floats["mover"], floats["course"], course_start, parts)
    still = parts - movers
    ends = (len(floats["hull"]), still, len(floats["pocket"]))
    table = given_ints(f"{name}.boundary_start", w.boundary_start, (3, groups + 1), 0, max(ends))
    for row, end in zip(table, ends, strict=True):
        _rises(f"{name}.boundary_start", row, end)
    _whole_grids(name, floats["boundary"], table[2])
    return _like(
        w, **floats, link_start=start, link_to=links, boundary_start=table, course_start=course_start,
        fire_needs=given_ints(f"{name}.fire_needs", w.fire_needs, (fires,), 1, _MOST),
        circle_count=whole(f"{name}.circle_count", w.circle_count, 0, parts),
        part=given_ints(f"{name}.part", w.part, (still,), 0, parts - 1),
    )  # fmt: skip


def given_state(state: object, world: World, name: str = "state") -> SimState:
    """A state that fits `world`: one row per robot, fire and boundary; every index refers to one that exists.

    Args:
        state: to check.
        world: checked.
        name: of the argument, for errors.

    Raises:
        ArgumentTypeError: no `SimState`, or an array of another kind.
        ArgumentError: another shape, NaN, or an index out of range; the message names the field.
    """
    given = instance(name, state, SimState)
    robots, fires = len(world.formation), len(world.fire_position)
    motion = _given_motion(instance(f"{name}.motion", given.motion, Motion), world, f"{name}.motion")
    intent, place = instance(f"{name}.intent", given.intent, Intent), f"{name}.intent"
    priority = given_floats(f"{place}.priority", intent.priority, ("P", 3))
    if len(priority):
        given_ints(f"{place}.priority's robots", priority[:, 0].astype(np.int64), ("P",), 0, robots - 1)
        given_ints(f"{place}.priority's fires", priority[:, 1].astype(np.int64), ("P",), 0, fires - 1)
    path = given_path(intent.path, f"{place}.path")
    if robots == 0 and path.kind != PathKind.NONE:
        raise ArgumentError(f"{place}.path is a path; expected NO_PATH, for the team has no robots")
    intent = _like(
        intent, path=path, priority=priority,
        influenced=whole(f"{place}.influenced", intent.influenced, 0, max(robots - 1, 0)),
        paused=bool(instance(f"{place}.paused", intent.paused, bool, np.bool_)),
        stopped=bool(instance(f"{place}.stopped", intent.stopped, bool, np.bool_)),
    )  # fmt: skip
    return _like(given, motion=motion, intent=intent)


def _given_motion(motion: Motion, world: World, name: str) -> Motion:
    robots, fires = len(world.formation), len(world.fire_position)
    boundaries = len(world.boundary) + fires + len(world.mover)
    plane, row = (robots, 2), (robots,)
    why = f"the world has {robots} robots, {fires} fires and {boundaries - fires} groups of obstacles and moving ones"
    floats = _floats(name, motion, {
        "position": plane, "heading": row, "velocity": plane, "intention": plane, "target_value": row, "stalled": row,
        "fire_radius": (fires,), "fire_progress": (fires,),
    }, why)  # fmt: skip
    numbers = {
        key: number(f"{name}.{key}", getattr(motion, key))
        for key in ("path_parameter", "path_idle", "path_gap", "path_left", "robot_peak", "human_peak")
    }
    if not math.isfinite(numbers["path_parameter"]):
        raise ArgumentError(f"{name}.path_parameter is {numbers['path_parameter']}; expected a finite number")
    return _like(
        motion, **floats, **numbers,
        tick=whole(f"{name}.tick", motion.tick, 0, _MOST),
        target=given_ints(f"{name}.target", motion.target, row, NOBODY, fires - 1, why=why),
        circulation=given_ints(f"{name}.circulation", motion.circulation, (robots, boundaries), -3, 3, why=why),
        recovery_stage=given_ints(f"{name}.recovery_stage", motion.recovery_stage, row, 0, _MOST, why=why),
        fire_burning=given_bools(f"{name}.fire_burning", motion.fire_burning, (fires,), why=why),
        path_status=whole(f"{name}.path_status", motion.path_status, 0, max(PathStatus)),
    )  # fmt: skip


def _floats(name: str, record: object, shapes: Mapping[str, Shape], why: str = "") -> dict[str, Any]:
    return {
        key: given_floats(f"{name}.{key}", getattr(record, key), shape, most=FARTHEST * FARTHEST, why=why)
        for key, shape in shapes.items()
    }


def _like(record: _Record, **fields: Any) -> _Record:
    """The record itself where it has these very values of these types, else a copy that has them."""
    for key, value in fields.items():
        held = getattr(record, key)
        if held is not value and (isinstance(value, np.ndarray | tuple) or type(held) is not type(value)):
            return cast(Any, record)._replace(**fields)
    return record


def _length(value: object) -> int:
    """The rows of what may be no array at all; its shape is checked elsewhere."""
    try:
        return len(cast(Any, value))
    except TypeError:
        return 0


def _rises(name: str, start: Any, end: int) -> None:
    """Refuses the starts of rows that do not rise from 0 to `end`."""
    if start[0] != 0 or start[-1] != end or (np.diff(start) < 0).any():
        raise ArgumentError(f"{name} is {start.tolist()[:8]}; expected starts of rows that rise from 0 to {end}")


def _whole_grids(name: str, boundary: Any, start: Any) -> None:
    """Refuses pockets whose nodes do not make at least four whole rows of at least four columns."""
    cell, columns, nodes = boundary[:, GRID_CELL], boundary[:, GRID_COLUMNS], np.diff(start)
    grid = columns != 0.0
    whole_rows = (columns == np.floor(columns)) & (columns >= _SPLINE) & (nodes >= _SPLINE * columns) & (cell > 0.0)
    if (nodes[~grid] != 0).any() or not (whole_rows[grid] & (nodes[grid] % columns[grid] == 0)).all():
        raise ArgumentError(f"{name}.pocket does not hold the whole rows of nodes that {name}.boundary needs")


def _courses(name: str, mover: Any, course: Any, start: Any, parts: int) -> None:
    """Refuses moving obstacles that are no part, and courses that do not lead on."""
    part, ending = mover[:, MOVER_PART], mover[:, MOVER_ENDING]
    if not (np.isin(part, np.arange(parts)).all() and len(np.unique(part)) == len(part)):
        raise ArgumentError(
            f"{name}.mover moves parts {part.tolist()[:8]}; expected different ones from 0 to {parts - 1}"
        )
    if not np.isin(ending, (STOP, LOOP, ONWARD)).all():
        raise ArgumentError(f"{name}.mover has endings {ending.tolist()[:8]}; expected {STOP}, {LOOP} or {ONWARD}")
    for first, last in pairwise(start.tolist()):
        if last - first < 2 or course[first, 2] != 0.0 or not (np.diff(course[first:last, 2]) > 0.0).all():
            raise ArgumentError(f"{name}.course does not rise from arc length 0 over at least two points of each mover")


def _above(name: str, value: object) -> float:
    found = number(name, value)
    if not 0.0 < found < math.inf:
        raise ArgumentError(f"{name} is {found:g}; expected a finite number above 0")
    return found


def _sign(name: str, value: object) -> float:
    found = number(name, value)
    if found not in (-1.0, 1.0):
        raise ArgumentError(f"{name} is {found:g}; expected 1 or -1")
    return found
