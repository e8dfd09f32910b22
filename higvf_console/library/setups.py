"""What a run starts from, built in Python: a team, what stands in its way, fires, links, a path, parameters."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from higvf_console.control.forms import Forms, forms_named
from higvf_console.control.parameters import GROUPS, Parameters, defaults_at
from higvf_console.core.arguments import instance, positive, sequence, whole
from higvf_console.core.arrays import FARTHEST, Floats, floats, given_floats, given_ints
from higvf_console.core.errors import ArgumentError, ScenarioError
from higvf_console.core.quantity import with_values
from higvf_console.core.scale import BODY_RADIUS, SPEED_LIMIT, Scale
from higvf_console.core.state import Path, PathKind
from higvf_console.core.viewport import Arena
from higvf_console.library.filtering import controlled_points, given_headings
from higvf_console.library.hazards import CAPSULE, CIRCLE, FIRE, Hazard, Hazards, given_arena, given_hazards
from higvf_console.library.records import given_parameters, given_path
from higvf_console.operator.path_commands import follow
from higvf_console.runtime.compiling import announce
from higvf_console.world import setup as world_setup
from higvf_console.world.layout import Fire, Layout
from higvf_console.world.network import check_formation, start_network
from higvf_console.world.obstacles import SPEED, Courses, Obstacles, course_straight
from higvf_console.world.placement import check_barriers, check_robots, check_start
from higvf_console.world.setup import Setup

_MARGIN = 100.0  # of an arena round what is in it, at the usual scale [m]
_NAME = "setup"  # in errors


def make_parameters(
    forms: str | Forms = "corrected",
    *,
    body_radius: float = BODY_RADIUS,
    speed_limit: float = SPEED_LIMIT,
    **groups: Mapping[str, float],
) -> Parameters:
    """Parameters that differ from the defaults in what is given.

        make_parameters(safety={"speed_limit": 60.0}, blending={"cruise_speed": 40.0})
        make_parameters(body_radius=0.055, speed_limit=0.2)  # every default fits such a robot

    Args:
        forms: of the equations: "corrected", "zero-in" or "printed".
        body_radius: of a robot [m]; with `speed_limit` it sets the scale of all defaults and ranges.
        speed_limit: of a robot [m/s].
        groups: numbers by the names of `Parameters` and of its groups.

    Raises:
        ArgumentError: an unknown group or name, or a number out of its range; the message gives the choices.
    """
    params = defaults_at(Scale(positive("body_radius", body_radius), positive("speed_limit", speed_limit)))
    for group, values in groups.items():
        if group not in GROUPS:
            raise ArgumentError(f"parameters.{group}: unknown group; known groups: {', '.join(GROUPS)}")
        instance(f"parameters.{group}", values, Mapping)
        try:
            part = with_values(getattr(params, group), values, f"parameters.{group}", params.scale)
            params = params._replace(**{group: part})
        except ScenarioError as problem:
            raise ArgumentError(str(problem)) from problem
    try:
        return given_parameters(params._replace(forms=forms_named(forms) if isinstance(forms, str) else forms))
    except ScenarioError as problem:
        raise ArgumentError(str(problem)) from problem


def make_setup(
    positions: ArrayLike,
    hazards: Hazards | None = None,
    parameters: Parameters | None = None,
    *,
    arena: Arena | ArrayLike | None = None,
    headings: ArrayLike = 0.0,
    formation: ArrayLike | None = None,
    links: Iterable[tuple[int, int]] | None = None,
    path: Path | None = None,
    influenced: int = 0,
) -> Setup:
    """What a run starts from: world, parameters and the first state, checked as a scenario file is.

    Args:
        positions: (N, 2) centres of the robots at the start [m].
        hazards: obstacles, fires and, by `Hazards.inside`, the arena's walls; None = none.
        parameters: all tunables; None = the defaults. Clearances are those of the bodies: they are enlarged for
            unicycles and for errors of measured positions.
        arena: what is seen on screen, (x_min, y_min, x_max, y_max) [m]; None = that of `hazards.inside`, else the
            rectangle round everything.
        headings: (N,) of unicycles, or one for all [rad].
        formation: (N, 2) shape whose pairwise distances the team keeps [m]; None = `positions`.
        links: pairs of robot indices that exchange intentions; None = the communication range decides.
        path: the human's path in force from the start; None = none.
        influenced: index of the robot that receives the human intention.

    Raises:
        ArgumentError: an argument has another shape or type, or holds NaN or infinite values.
        ScenarioError: the start is not safe, or the parameters do not fit the team; the message gives the numbers.
    """
    params = Parameters() if parameters is None else given_parameters(parameters)
    centres = given_floats("positions", positions, ("N", 2), most=FARTHEST)
    robots, dangers = len(centres), given_hazards(hazards)
    angles = given_headings(headings, robots)
    points = floats(controlled_points(centres, angles, params))
    shape = points if formation is None else given_floats("formation", formation, (robots, 2), most=FARTHEST)
    chosen = None if path is None else given_path(path)
    leader = whole("influenced", influenced, 0, max(robots - 1, 0))
    if robots == 0 and chosen is not None and chosen.kind != PathKind.NONE:
        raise ArgumentError("path is given to a team without robots; expected None")
    fires = [item for item in dangers.items if item.kind == FIRE]
    layout = _layout(
        dangers, fires, _arena(arena, dangers, centres, params.scale.length), shape, _links(links, robots), params
    )
    setup = world_setup.make_setup(layout, points)
    if robots:
        _check(points, layout)
        check_start(points, layout.fire_radius, setup.world, layout.obstacles, params, f"{_NAME}: positions")
    check_barriers(setup.world, layout.fire_radius, params, _NAME)
    start = setup.start
    start = start._replace(
        motion=start.motion._replace(heading=angles), intent=start.intent._replace(influenced=leader)
    )
    if chosen is not None:
        announce()
        start = follow(start, chosen)
    return setup._replace(start=start)


def _layout(
    dangers: Hazards, fires: list[Hazard], arena: Arena, shape: Floats, links: Any, params: Parameters
) -> Layout:
    own_walls = 4 if dangers.arena is not None else 0
    if len(dangers.walls) != own_walls:
        raise ArgumentError(
            f"hazards has {len(dangers.walls) - own_walls} walls besides those of an arena; expected none in a run"
        )
    robots = len(shape)
    needs = [fire.robots_needed or max(1, min(2, robots)) for fire in fires]
    for number, need in enumerate(needs, 1):
        if need > max(robots, 1):
            raise ArgumentError(f"hazards: fire {number} needs {need} robots; expected at most {robots}, all there are")
    return Layout(
        arena=arena,
        walls=dangers.arena is not None,
        obstacles=_obstacles(dangers),
        fires=tuple(Fire(f.start, f.radius, f.growth, need) for f, need in zip(fires, needs, strict=True)),
        formation=shape,
        links=links,
        params=params,
    )


def _obstacles(dangers: Hazards) -> Obstacles:
    """The obstacles of a run, of which those with a velocity move straight on."""
    for number, item in enumerate(dangers.items, 1):
        if item.growth != 0.0 and item.kind != FIRE:
            raise ArgumentError(f"hazard {number}, a {item.kind}, grows; expected no growth: in a run, only fires grow")
        if math.hypot(*item.velocity) > SPEED.high:
            speed = math.hypot(*item.velocity)
            raise ArgumentError(
                f"hazard {number}, a {item.kind}, moves at {speed:g} m/s; expected {SPEED.high:g} at most"
            )
    return Obstacles(
        dangers.circles, dangers.bars, dangers.polygons, _courses(dangers, CIRCLE), _courses(dangers, CAPSULE)
    )


def _courses(dangers: Hazards, kind: str) -> Courses:
    found = [item.velocity for item in dangers.items if item.kind == kind]
    return tuple(course_straight(vx, vy) if (vx, vy) != (0.0, 0.0) else None for vx, vy in found)


def _check(points: Floats, layout: Layout) -> None:
    """Refuses parameters that do not fit the team, as `scenario.parse_scenario` does."""
    network = start_network(points, layout.links, layout.params.formation.communication_range)
    check_formation(network.degree, layout.params, _NAME)
    check_robots(layout.params, max((fire.growth for fire in layout.fires), default=0.0), _NAME)


def _links(links: object, robots: int) -> tuple[tuple[int, int], ...] | None:
    if links is None:
        return None
    pairs = given_ints("links", list(sequence("links", links)), ("E", 2), 0, robots - 1, why="pairs of robot indices")
    if (pairs[:, 0] == pairs[:, 1]).any():
        raise ArgumentError(
            f"links joins robot {int(pairs[pairs[:, 0] == pairs[:, 1]][0, 0])} to itself; expected pairs"
        )
    return tuple(sorted({(min(i, j), max(i, j)) for i, j in pairs.tolist()}))


def _arena(arena: object, dangers: Hazards, centres: Floats, scale: float) -> Arena:
    if dangers.arena is not None:
        if arena is not None and given_arena(arena) != dangers.arena:
            raise ArgumentError("arena differs from that of hazards.inside; expected one of them")
        return dangers.arena
    if arena is not None:
        return given_arena(arena)
    ends = [point for item in dangers.items for point in (item.start, item.end)]
    around = np.concatenate([centres, floats(ends, -1, 2), *dangers.polygons, np.zeros((0, 2))])
    if not len(around):
        return Arena(0.0, 0.0, 1200.0 * scale, 700.0 * scale)
    reach = _MARGIN * scale + max((item.radius for item in dangers.items), default=0.0)
    step = 10.0 ** math.floor(math.log10(scale))  # whole metres at the usual scale
    (x_min, y_min), (x_max, y_max) = (
        step * np.floor((around.min(axis=0) - reach) / step), step * np.ceil((around.max(axis=0) + reach) / step),
    )  # fmt: skip
    return Arena(*(float(v) for v in (x_min, y_min, x_max, y_max)))
