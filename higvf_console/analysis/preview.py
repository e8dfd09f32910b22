"""What would happen: the closed loop run ahead on a copy of the state, with the stroke and without it.

    wish      the state as it would be if the growing stroke ended now, or if what waits were confirmed now
    foresee   both futures rolled out, and what an operator asks of them

The wish is made by the command that would make it real, the futures by the step that the run itself takes: if nothing
else is done, what is foreseen is bit for bit what happens.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from higvf_console.control.guidance.paths import path_points
from higvf_console.core.arrays import Bools, Floats, floats
from higvf_console.core.commands import Confirm, OperatorCommand, StrokeEnd, StrokeUse
from higvf_console.core.state import Motion, Path, PathKind, PathStatus, SimState
from higvf_console.operator.reducer import apply_command, waiting
from higvf_console.sim.simulation import Rollout, roll
from higvf_console.world.polygons import obstacles_of, segment_distance, signed_distance
from higvf_console.world.setup import Setup

SHORTEST, USUAL, LONGEST = 5.0, 20.0, 60.0  # horizons [s]
CHUNK = 100  # ticks between two looks at whether the result is still wanted
_TRACK_POINTS = 120  # of a robot's track
_MOST_POINTS = 12_000  # of all tracks together
_LEAST_POINTS = 12
_PATH_POINTS = 240  # at which a path is tested for repulsive areas

FiresOut = tuple[tuple[int, float], ...]


class Future(NamedTuple):
    """A run ahead: what it comes to at its horizon.

    Attributes:
        fires_out: (fire index, seconds from now), in the order in which they go out.
        loss_area: burnt by all fires together [m^2].
    """

    fires_out: FiresOut
    loss_area: float


class Preview(NamedTuple):
    """What is foreseen from one moment; N robots, K points of a track, times in seconds from then.

    Attributes:
        start: the state that was rolled out: the wish fulfilled, the team not paused.
        resumed: whether the team is paused, so that all this begins with Resume.
        horizon: how far ahead was looked [s].
        tracks: (N, K, 2) controlled points, from now to the horizon [m].
        future: with the wish.
        otherwise: without it.
        clearance: smallest clearance of the team [m]; inf when nobody comes near anything.
        deadlock: when a robot is deadlocked first; None = never.
        infeasible: when a robot cannot meet all barrier constraints first; None = never.
        given_up: when the path is given up; None = it is not.
        finish: when the path is finished; None = not within the horizon.
        repulsive: (S, 2, 2) pieces of the path inside repulsive areas [m].
    """

    start: SimState
    resumed: bool
    horizon: float
    tracks: Floats
    future: Future
    otherwise: Future
    clearance: float
    deadlock: float | None
    infeasible: float | None
    given_up: float | None
    finish: float | None
    repulsive: Floats


def wish(state: SimState, setup: Setup, end: StrokeEnd | None = None) -> SimState | None:
    """The state as it would be if the growing stroke ended now, or if what waits were confirmed now.

    Args:
        state: now.
        setup: of the run.
        end: how the growing stroke will end; None = as an ordinary path.

    Returns:
        None when there is none, when it would be refused, and for the outline of an obstacle: that is no wish
        of the team but another world.
    """
    command: OperatorCommand
    if state.pointer_state.stroke_source:
        # Only the interface that draws a stroke may end it.
        command = replace(StrokeEnd() if end is None else end, source=state.pointer_state.stroke_source)
        if command.use == StrokeUse.OBSTACLE:
            return None
    elif waiting(state.pointer_state, state.motion.tick * setup.params.safety.control_period):
        command = Confirm()
    else:
        return None
    wished = apply_command(state, command, setup)[0]
    if (
        wished.pointer_state.pending.kind != PathKind.NONE
        and wished.pointer_state.pending is not state.pointer_state.pending
    ):
        wished = apply_command(wished, Confirm(), setup)[0]  # a repair of the path that waits
    return None if wished.intent is state.intent else wished


def foresee(
    state: SimState, wished: SimState, setup: Setup, horizon: float = USUAL, unwanted: Callable[[], bool] = bool
) -> Preview | None:
    """Rolls both futures out; takes some 20 us a robot and second, without holding the interpreter's lock.

    Args:
        state: now.
        wished: as `wish` made it of `state`.
        setup: of the run.
        horizon: how far to look ahead [s].
        unwanted: asked every `CHUNK` ticks; once it is true the work is dropped.

    Returns:
        None when the work was dropped.
    """
    period = setup.params.safety.control_period
    ticks = max(1, round(horizon / period))
    start = _going_on(wished)
    ahead = _rolled(start, setup, ticks, unwanted)
    otherwise = None if ahead is None else _rolled(_going_on(state), setup, ticks, unwanted)
    if ahead is None or otherwise is None:
        return None
    led = start.motion.path_status in (PathStatus.FOLLOWING, PathStatus.BREAK_AWAY)  # else it is over already
    status = np.where(led, ahead.path_status, PathStatus.NONE)
    return Preview(
        start=start,
        resumed=state.intent.paused or state.intent.stopped,
        horizon=ticks * period,
        tracks=tracks(state.motion.position, ahead.position),
        future=_future(state.motion, ahead, period),
        otherwise=_future(state.motion, otherwise, period),
        clearance=float(ahead.clearance.min()),
        deadlock=_first(ahead.deadlocked, period),
        infeasible=_first(ahead.infeasible, period),
        given_up=_first(status == PathStatus.BLOCKED, period),
        finish=_first((status == PathStatus.FINISHED) | (status == PathStatus.HOLDING), period),
        repulsive=repulsive_pieces(start.intent.path, state.motion, setup),
    )


def tracks(position: Floats, history: Floats) -> Floats:
    """Tracks (N, K, 2) from `position` (N, 2) through some moments of `history` (T, N, 2), the last among them [m]."""
    ticks, robots = history.shape[:2]
    most = max(_LEAST_POINTS, min(_TRACK_POINTS, _MOST_POINTS // max(robots, 1)))
    chosen = np.unique(np.linspace(0, ticks, min(most, ticks + 1)).round().astype(np.int64))  # pyright: ignore[reportUnknownArgumentType, reportUnknownMemberType, reportUnknownVariableType]
    return np.concatenate([position[None], history])[chosen].transpose(1, 0, 2)


def repulsive_pieces(path: Path, motion: Motion, setup: Setup) -> Floats:
    """Pieces (S, 2, 2) of a path within the repulsive boundary of an obstacle or a burning fire, [3] [m]."""
    if path.kind != PathKind.SPLINE:
        return floats([], 0, 2, 2)
    points = path_points(path, np.linspace(0.0, path.length, _PATH_POINTS + 1))
    middle = (points[1:] + points[:-1]) / 2
    inside = surface_distance(middle, motion, setup) < setup.params.boundaries.repulsive_margin
    return np.stack([points[:-1], points[1:]], axis=1)[inside]


def surface_distance(points: Floats, motion: Motion, setup: Setup) -> Floats:
    """Distance (n,) of points (n, 2) from the nearest obstacle or burning fire [m], negative inside; inf without."""
    world, obstacles = setup.world, setup.layout.obstacles_at(motion.tick)
    burning = np.column_stack([world.fire_position, motion.fire_radius])[motion.fire_burning]
    gaps = [np.full(len(points), np.inf)]
    gaps += [np.hypot(*(points - disc[:2]).T) - disc[2] for disc in (*obstacles.circles, *burning)]
    gaps += [segment_distance(points, bar[:2], bar[2:4]) - bar[4] for bar in obstacles.bars]
    gaps += [signed_distance(chains, points) for chains in obstacles_of(obstacles.polygons)]
    return np.min(gaps, axis=0)


def _going_on(state: SimState) -> SimState:
    return state._replace(intent=state.intent._replace(paused=False, stopped=False))


def _rolled(state: SimState, setup: Setup, ticks: int, unwanted: Callable[[], bool]) -> Rollout | None:
    pieces: list[Rollout] = []
    for done in range(0, ticks, CHUNK):
        if unwanted():
            return None
        state, piece = roll(state, setup.world, setup.params, min(CHUNK, ticks - done))
        pieces.append(piece)
    return Rollout(*(np.concatenate(parts) for parts in zip(*pieces, strict=True)))


def _future(motion: Motion, ahead: Rollout, period: float) -> Future:
    out: list[tuple[float, int]] = []
    for fire in np.flatnonzero(motion.fire_burning).tolist():
        time = _first(~ahead.burning[:, fire], period)
        if time is not None:
            out.append((time, fire))
    return Future(tuple((fire, time) for time, fire in sorted(out)), float(ahead.loss_area[-1].sum()))


def _first(holds: Bools, period: float) -> float | None:
    """When a condition, known after each tick (T,), holds first [s from now]."""
    return (int(holds.argmax()) + 1) * period if holds.any() else None
