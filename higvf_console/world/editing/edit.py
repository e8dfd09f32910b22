"""Applies an edit to a setup and a state, or refuses it with the reason and the choices.

An obstacle put on a robot, and a robot put on an obstacle, are held at the nearest safe position. An edit before the
first step changes the start of the run too. A later edit leaves the start alone, except for robots that could no longer
start safely: they start at their nearest safe position.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, Ints, floats
from higvf_console.core.edits import (
    AddEntity,
    AddOutlines,
    ChangeEntity,
    DeleteEntity,
    Edit,
    EntityKind,
    LinkByRange,
    MoveEntity,
    SetArena,
    SetParameters,
    ToggleLink,
)
from higvf_console.core.errors import ScenarioError
from higvf_console.core.quantity import COORDINATE
from higvf_console.core.state import Motion, SimState, World
from higvf_console.core.viewport import Arena
from higvf_console.world.editing import bodies
from higvf_console.world.editing.carry import NEW, carried, led_on, same_rows, waiting_on
from higvf_console.world.editing.checks import Stand, check_edit, check_fires, check_walls
from higvf_console.world.editing.entities import NUMBERS, EntityRef, centres, how_many, name_of, numbers_of
from higvf_console.world.editing.parameters import with_parameters
from higvf_console.world.editing.safe_places import diagonal, held_words, nearest_fit, placed, resettled, robot_fits
from higvf_console.world.layout import Fire, Layout, with_radii
from higvf_console.world.misfits import unavoidable
from higvf_console.world.setup import Setup, rebuilt

FIRE_RADIUS, FIRE_GROWTH = 20.0, 1.0  # of a new fire at the usual scale [m], [m/s]
_OF_PATH = ("path_parameter", "path_status", "path_idle", "path_gap", "path_left")  # what a start keeps of its motion


class Edited(NamedTuple):
    """The result of an edit.

    Attributes:
        setup: after it.
        state: after it.
        robots: (N,) row that each robot had before, or `carry.NEW`.
        fires: (M,) likewise.
        text: what was done, one sentence.
        warnings: what is allowed but probably not meant, and was not so before.
    """

    setup: Setup
    state: SimState
    robots: Ints
    fires: Ints
    text: str
    warnings: tuple[str, ...]


class _Draft(NamedTuple):
    """An edit before its checks: the new layout, and how it changes a motion."""

    layout: Layout
    robots: Ints
    fires: Ints
    finish: Callable[[Motion], Motion]  # gives new and moved rows their places
    text: str


def edited(setup: Setup, state: SimState, command: Edit) -> Edited:
    """Apply one edit to a setup and a state.

    Raises:
        ScenarioError: the edit is refused; nothing has changed.
    """
    before = setup.layout
    draft = _draft(before, state, command)
    layout = draft.layout
    world = setup.world if layout is before else rebuilt(layout, setup)
    motion = draft.finish(carried(state.motion, draft.robots, draft.fires, setup.world, world))
    if state.motion.tick == 0:
        start = motion._replace(**{name: getattr(setup.start.motion, name) for name in _OF_PATH})
        layout = layout._replace(formation=_shifted_formation(layout, draft, setup.start.motion, motion))
        world = world._replace(formation=layout.formation)
    else:
        start = _start(setup, draft, layout, world)
    steered = state.intent.influenced
    still = int((draft.robots == steered).argmax())  # the first robot, where the one that is steered goes
    check_edit(Stand(before, setup.world, state.motion, steered), Stand(layout, world, motion, still), draft.robots)
    if state.motion.tick > 0:
        check_fires(Stand(before, setup.world, setup.start.motion, steered), Stand(layout, world, start, still))
    motion, intent = led_on(motion, state.intent, draft.robots, draft.fires, len(state.motion.fire_radius))
    start, start_intent = led_on(start, setup.start.intent, draft.robots, draft.fires, len(state.motion.fire_radius))
    layout = layout._replace(fires=with_radii(layout.fires, start.fire_radius))
    new = Setup(layout, world, setup.start._replace(motion=start, intent=start_intent))
    pointer_state = waiting_on(state.pointer_state, draft.robots)
    known = unavoidable(before)
    return Edited(
        setup=new,
        state=SimState(motion, intent, pointer_state),
        robots=draft.robots,
        fires=draft.fires,
        text=draft.text,
        warnings=tuple(warning for warning in unavoidable(layout) if warning not in known),
    )


def _start(setup: Setup, draft: _Draft, layout: Layout, world: World) -> Motion:
    """The start with rows added and removed; robots that could no longer start safely are moved."""
    start = carried(setup.start.motion, draft.robots, draft.fires, setup.world, world)
    if (draft.robots == NEW).any() or (draft.fires == NEW).any():
        start = draft.finish(start)
    start = resettled(layout, start)
    if start is None:
        raise ScenarioError("there would be no room for the robots where a run starts")
    return start


def _shifted_formation(layout: Layout, draft: _Draft, before: Motion, after: Motion) -> Floats:
    """The formation, which follows robots that are moved before the first step."""
    formation = layout.formation.copy()
    kept = draft.robots != NEW
    if len(formation) == len(after.position):
        formation[kept] += after.position[kept] - before.position[draft.robots[kept]]
    return formation


def _draft(layout: Layout, state: SimState, command: Edit) -> _Draft:  # noqa: PLR0911
    motion = state.motion
    match command:
        case AddEntity(kind=kind, point=point):
            return _add(layout, motion, EntityKind(kind), _on_ground(point)[0])
        case AddOutlines(outlines=outlines):
            return _plain(layout, *bodies.with_outlines(layout, motion, [_on_ground(outline) for outline in outlines]))
        case MoveEntity(kind=kind, index=index, point=point):
            return _move(layout, motion, _entity(layout, kind, index), _on_ground(point)[0])
        case ChangeEntity(kind=kind, index=index, name=name, value=value):
            return _change(layout, motion, _entity(layout, kind, index), name, value)
        case DeleteEntity(kind=kind, index=index):
            return _delete(layout, _entity(layout, kind, index))
        case ToggleLink(first=first, second=second):
            return _plain(layout, *_toggle(layout, motion, first, second))
        case LinkByRange():
            return _plain(layout, layout._replace(links=None), "The communication range decides who is linked.")
        case SetArena(sides=sides, walls=walls):
            arena = Arena(*_on_ground(sides).ravel().tolist())
            check_walls(arena, bool(walls), layout, motion)
            text = f"The arena is {arena.width:g} m x {arena.height:g} m, {'walled' if walls else 'open'}."
            return _plain(layout, layout._replace(arena=arena, walls=bool(walls)), text)
        case SetParameters(values=values):
            params, text = with_parameters(layout, values)
            return _plain(layout, layout._replace(params=params), text)
        case _:
            raise ScenarioError(f"{type(command).__name__} is not an edit that this console knows")


def _on_ground(points: Floats) -> Floats:
    """Points (n, 2) [m], if they are within the coordinates that a scenario may have."""
    points = floats(points, -1, 2)
    for x, y in points[~((points >= COORDINATE.low) & (points <= COORDINATE.high)).all(axis=1)]:
        raise ScenarioError(
            f"({x:g}, {y:g}) is not a position: coordinates go from {COORDINATE.low:g} to {COORDINATE.high:g} m"
        )
    return points


def _plain(layout: Layout, new: Layout, text: str) -> _Draft:
    """An edit after which every robot and fire is where it was."""
    same = same_rows(len(layout.formation)), same_rows(len(layout.fires))
    return _Draft(new, *same, _as_it_is, text)


def _as_it_is(motion: Motion) -> Motion:
    return motion


def _pair(point: Floats) -> tuple[float, float]:
    x, y = point.tolist()
    return x, y


def _entity(layout: Layout, word: str, row: int) -> EntityRef:
    kind = EntityKind(word)
    count = how_many(kind, layout)
    if not 0 <= row < count:
        known = f"there are {kind.value}s 1 to {count}" if count else f"there is no {kind.value}"
        raise ScenarioError(f"there is no {kind.value} {row + 1}: {known}")
    return EntityRef(kind, int(row))


def _add(layout: Layout, motion: Motion, kind: EntityKind, point: Floats) -> _Draft:
    robots, fires = same_rows(len(layout.formation)), same_rows(len(layout.fires))
    if kind is EntityKind.ROBOT:
        offset = (layout.formation - motion.position).mean(axis=0)
        new = layout._replace(formation=floats(np.vstack([layout.formation, point + offset])))
        text = f"Robot {len(robots) + 1} is added"
        return _Draft(new, np.append(robots, NEW), fires, _robot_put(new, len(robots), point), f"{text}.")
    if kind is EntityKind.FIRE:
        row, needs, scale = len(fires), min(2, len(robots)), layout.params.scale
        size = FIRE_RADIUS * scale.length
        place, held = bodies.fire_place(layout, motion, point, size)
        new = layout._replace(fires=(*layout.fires, Fire(_pair(place), size, FIRE_GROWTH * scale.speed, needs)))

        def kindled(carried_on: Motion) -> Motion:
            radius = carried_on.fire_radius.copy()
            radius[row] = size
            return carried_on._replace(fire_radius=radius)

        return _Draft(new, robots, np.append(fires, NEW), kindled, f"Fire {row + 1} is lit{held}.")
    return _plain(layout, *bodies.with_body(layout, motion, kind, point))


def _robot_put(layout: Layout, robot: int, centre: Floats) -> Callable[[Motion], Motion]:
    """Puts a robot's centre at a point (2,), or where it is safe near it."""

    def finish(motion: Motion) -> Motion:
        ahead, heading = layout.params.robots.look_ahead, float(motion.heading[robot])
        point = centre + ahead * np.array([math.cos(heading), math.sin(heading)])
        place = nearest_fit(point, robot_fits(robot, layout, motion), diagonal(layout))
        if place is None:
            raise ScenarioError(f"there is no safe place for robot {robot + 1} in the arena")
        return placed(motion, robot, place)

    return finish


def _move(layout: Layout, motion: Motion, entity: EntityRef, point: Floats) -> _Draft:
    if entity.kind is EntityKind.ROBOT:
        put = _robot_put(layout, entity.row, point)
        held = held_words(centres(layout, put(motion))[entity.row], point)
        return _plain(layout, layout, f"Robot {entity.row + 1} is moved{held}.")._replace(finish=put)
    if entity.kind is EntityKind.FIRE:
        at, held = bodies.fire_place(layout, motion, point, float(motion.fire_radius[entity.row]))
        moved = bodies.with_fire(layout, entity.row, layout.fires[entity.row]._replace(position=_pair(at)))
        return _plain(layout, moved, f"Fire {entity.row + 1} is moved{held}.")
    return _plain(layout, *bodies.moved(layout, motion, entity, point))


def _change(layout: Layout, motion: Motion, entity: EntityRef, name: str, value: float) -> _Draft:
    known = NUMBERS[entity.kind]
    if name not in known:
        raise ScenarioError(f"{name_of(entity)} has no number '{name}'; it has {', '.join(known)}")
    low, high, unit = known[name].low, known[name].high, known[name].unit
    if not low <= value <= high:
        raise ScenarioError(f"{name} of {name_of(entity)}: {value:g} is not from {low:g} to {high:g} {unit}".rstrip())
    numbers = numbers_of(entity, layout, motion)
    if name == "speed" and name not in numbers:
        raise ScenarioError(f"{name_of(entity)} does not move: give it a path or a velocity in the scenario file")
    numbers[name] = float(value)
    if name in ("x", "y"):
        return _move(layout, motion, entity, floats([numbers["x"], numbers["y"]]))
    text = f"{name_of(entity).capitalize()} has {name} {value:g} {unit}".rstrip() + "."
    if entity.kind is EntityKind.ROBOT:
        if layout.params.robots.look_ahead == 0.0:
            raise ScenarioError("the robots have no heading; only unicycles have one")
        return _plain(layout, layout, text)._replace(finish=_turned(layout, entity.row, value))
    if entity.kind is EntityKind.FIRE:
        return _plain(layout, *bodies.fire_changed(layout, motion, entity, name, value, text))._replace(
            finish=bodies.fire_sized(entity.row, numbers["radius"])
        )
    return _plain(layout, bodies.reshaped(layout, motion, entity, numbers), text)


def _turned(layout: Layout, robot: int, degrees: float) -> Callable[[Motion], Motion]:
    """Turns a unicycle about its centre; its controlled point goes with it, to where it is safe."""

    def finish(motion: Motion) -> Motion:
        centre, heading = centres(layout, motion)[robot], motion.heading.copy()
        heading[robot] = math.radians(degrees)
        return _robot_put(layout, robot, centre)(motion._replace(heading=heading))

    return finish


def _delete(layout: Layout, entity: EntityRef) -> _Draft:
    robots, fires = same_rows(len(layout.formation)), same_rows(len(layout.fires))
    text = f"{name_of(entity).capitalize()} is deleted."
    if entity.kind is EntityKind.ROBOT:
        if len(robots) == 1:
            raise ScenarioError("robot 1 is the last one; a team has at least one robot")
        kept = np.delete(robots, entity.row)
        return _plain(layout, _without_robot(layout, entity.row), text)._replace(robots=kept)
    if entity.kind is EntityKind.FIRE:
        kept = np.delete(fires, entity.row)
        new = layout._replace(fires=tuple(layout.fires[row] for row in kept.tolist()))
        return _plain(layout, new, text)._replace(fires=kept)
    return _plain(layout, bodies.without(layout, entity), text)


def _without_robot(layout: Layout, robot: int) -> Layout:
    links = layout.links
    if links is not None:
        kept = [(i, j) for i, j in links if robot not in (i, j)]
        links = tuple((i - (i > robot), j - (j > robot)) for i, j in kept)
    robots = len(layout.formation) - 1
    return layout._replace(
        formation=floats(np.delete(layout.formation, robot, axis=0)),
        fires=tuple(fire._replace(needs=min(fire.needs, robots)) for fire in layout.fires),
        links=links,
    )


def _toggle(layout: Layout, motion: Motion, first: int, second: int) -> tuple[Layout, str]:
    low, high = sorted((_entity(layout, "robot", first).row, _entity(layout, "robot", second).row))
    if low == high:
        raise ScenarioError(f"robot {low + 1} cannot be linked to itself")
    links = set(bodies.links_now(layout, motion))
    links ^= {(low, high)}
    change = "Linked" if (low, high) in links else "Unlinked"
    return layout._replace(links=tuple(sorted(links))), f"{change} robots {low + 1} and {high + 1}."
