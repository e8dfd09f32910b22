"""Runs to be edited at random, and what must be true of them; shared by the tests of edits and of the history."""

from typing import Any

import numpy as np
from hypothesis import strategies as st

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import (
    ClearPath,
    NextTask,
    OperatorCommand,
    Pause,
    Pick,
    Prioritise,
    Resume,
    ReversePath,
    ShapePath,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
)
from higvf_console.core.edits import (
    AddEntity,
    AddOutlines,
    ChangeEntity,
    DeleteEntity,
    LinkByRange,
    MoveEntity,
    SetArena,
    SetParameters,
    ToggleLink,
)
from higvf_console.core.events import Event
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import parse_scenario
from higvf_console.world.placement import obstacle_gaps, wall_gaps

SCENE = """
version: 1
arena: {size_m: [1200, 700]}
robots: {start_m: [[700, 300], [670, 350], [730, 350], [640, 300]]}
fires: [{at_m: [500, 250], radius_m: 20}, {at_m: [900, 600], radius_m: 30, robots_needed: 3}]
obstacles:
  circles: [{at_m: [300, 200], radius_m: 20}, {at_m: [650, 430], radius_m: 25}]
  bars: [{from_m: [900, 230], to_m: [900, 400], half_width_m: 6}]
  polygons: [{points_m: [[100, 100], [300, 100], [300, 300], [100, 300]],
              free_m: [[[120, 120], [120, 280], [280, 280], [280, 120]]]},
             {points_m: [[500, 500], [600, 500], [600, 520], [520, 520], [520, 600], [500, 600]]}]
"""
UNICYCLES = """
parameters:
  robots: {look_ahead: 6, turn_rate_limit: 4, position_noise: 0.5, packet_loss: 0.3}
  safety: {robot_clearance: 20, obstacle_clearance: 10, speed_limit: 30}
  blending: {cruise_speed: 20}
  boundaries: {reactive_margin: 30, repulsive_margin: 18}
  fires: {stand_off: 30}
"""
LINKED = "links: [[1, 2], [2, 3], [3, 4]]\n"
SCENES = {"integrators": SCENE, "linked": SCENE + LINKED, "unicycles": SCENE + UNICYCLES}
HAIR = 2e-6  # [m]

POINTS = st.tuples(st.floats(30.0, 1170.0), st.floats(30.0, 670.0))
PLACES = st.one_of(POINTS, st.tuples(st.floats(600.0, 770.0), st.floats(260.0, 390.0))).map(floats)
KINDS = st.sampled_from(["robot", "fire", "circle", "bar", "polygon"])
NUMBERS = st.sampled_from(["x", "y", "heading", "radius", "growth", "needs", "length", "half width", "angle", "size"])
VALUES = st.one_of(st.floats(0.1, 5.0), st.floats(5.0, 700.0), st.sampled_from([1.0, 2.0, 3.0, 4.0]))
ROBOTS, ROWS = st.integers(0, 4), st.integers(0, 2)
OUTLINES = st.tuples(PLACES, st.floats(5.0, 120.0)).map(
    lambda given: floats([[-1, -1], [1, -1], [1.5, 0.2], [0, 1]]) * given[1] + given[0]
)
PARAMETERS = st.one_of(
    st.floats(30.0, 80.0).map(lambda speed: {"blending.cruise_speed": speed}),
    st.floats(10.0, 40.0).map(lambda clearance: {"safety.robot_clearance": clearance}),
    st.floats(5.0, 22.0).map(lambda clearance: {"safety.obstacle_clearance": clearance}),
    st.floats(50.0, 500.0).map(lambda reach: {"formation.communication_range": reach}),
    st.floats(0.1, 30.0).map(lambda rate: {"formation.formation_rate": rate}),
)
EDITS = st.one_of(
    st.builds(AddEntity, kind=KINDS, point=PLACES),
    st.builds(AddOutlines, outlines=st.tuples(OUTLINES)),
    st.builds(MoveEntity, kind=KINDS, index=ROWS, point=PLACES),
    st.builds(ChangeEntity, kind=KINDS, index=ROWS, name=NUMBERS, value=VALUES),
    st.builds(DeleteEntity, kind=KINDS, index=ROWS),
    st.builds(ToggleLink, first=ROBOTS, second=ROBOTS),
    st.builds(LinkByRange),
    st.builds(
        SetArena, sides=st.sampled_from([(0, 0, 1200, 700), (-50, 0, 1300, 800), (200, 0, 1200, 700)]).map(floats),
        walls=st.booleans(),
    ),
    st.builds(SetParameters, values=PARAMETERS),
)  # fmt: skip
STROKES = st.lists(POINTS, min_size=3, max_size=5).map(
    lambda points: (StrokeBegin(), StrokePoints(floats(points)), StrokeEnd())
)
ACTIONS = st.one_of(
    st.builds(Pick, robot=ROBOTS),
    st.builds(Prioritise, fires=st.tuples(ROWS), robot=ROBOTS),
    st.builds(
        ShapePath, ending=st.sampled_from([None, "hold", "loop", "release"]),
        pace=st.sampled_from([None, 0.5, 1.5]), duration=st.sampled_from([None, 0.0, 2.0]),
        closed=st.sampled_from([None, True, False]),
    ),
    st.sampled_from([Pause(), Resume(), ClearPath(), ReversePath(), NextTask()]),
)  # fmt: skip
ONE = st.one_of(EDITS, ACTIONS).map(lambda command: (command,))
GIVEN = st.one_of(ONE, STROKES)  # commands that belong together


def edited_run(scene: str = "integrators", ticks: int = 0) -> Run:
    scenario = parse_scenario(SCENES[scene], f"{scene}.yaml")
    run = Run(scenario.setup(3), scenario.filter, scenario)
    for _ in range(ticks):
        run.step()
    return run


def give(run: Run, *commands: OperatorCommand) -> tuple[Event, ...]:
    """Applies commands; what the last one came to."""
    events: tuple[Event, ...] = ()
    for command in commands:
        events = run.apply(command)
    return events


def go(run: Run, ticks: int = 60) -> None:
    """Control periods go by."""
    for _ in range(ticks):
        run.step()


def refused(events: tuple[Event, ...]) -> bool:
    return any(event.kind == "refused" for event in events)


def shortfalls(run: Run) -> Floats:
    """(N,) by how much each robot's controlled point misses a clearance [m], negative where none is missed."""
    layout, motion = run.setup.layout, run.state.motion
    position, safety, robots = motion.position, layout.params.safety, layout.params.robots
    margin = robots.look_ahead + robots.position_noise
    gaps = [gap for _, gap in obstacle_gaps(position, layout.obstacles)]
    gaps += list(wall_gaps(position, layout.arena)) if layout.walls else []
    for (x, y), radius, burns in zip(layout.fire_position, motion.fire_radius, motion.fire_burning, strict=True):
        gaps += [np.hypot(*(position - (x, y)).T) - radius] if burns else []
    room = np.min([np.full(len(position), np.inf), *gaps], axis=0) - safety.obstacle_clearance - margin
    apart = np.hypot(*(position[:, None] - position[None]).transpose(2, 0, 1))
    np.fill_diagonal(apart, np.inf)
    return -np.minimum(room, apart.min(axis=1) - safety.robot_clearance - 2.0 * margin)


def assert_same(first: Any, second: Any, place: str = "") -> None:
    """Both are the same to the last bit, whatever they are made of."""
    if isinstance(first, np.ndarray):
        assert (first.shape, first.tobytes()) == (second.shape, second.tobytes()), place
    elif hasattr(first, "_fields"):
        for name in first._fields:
            assert_same(getattr(first, name), getattr(second, name), f"{place}.{name}")
    elif isinstance(first, tuple):
        assert len(first) == len(second), place
        for number, (one, other) in enumerate(zip(first, second, strict=True)):
            assert_same(one, other, f"{place}[{number}]")
    else:
        assert first == second or (first != first and second != second), place  # noqa: PLR0124 (NaN)
