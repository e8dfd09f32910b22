"""Undo and redo of every edit and every operator action.

Undo reverts actions, not elapsed time. It subtracts the difference that an action made from the present run state:
- Robots keep their present positions. Those that the action itself moved return; those in the way of what returns move
  to the nearest safe position.
- A fire keeps its present radius.
- A path whose redrawing is undone is followed on from the team's present position along it.
- If no time has passed since the action, the former run state is restored bit for bit.
- If the action was a reset or another scenario, the former run is restored as a whole, except for the pointer.

Undo never sets the team in motion after an emergency stop: the stop removes pauses from the history.
"""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.control.guidance.paths import EVERYWHERE, nearest
from higvf_console.core.arrays import Ints
from higvf_console.core.errors import ScenarioError
from higvf_console.core.state import ACTING, Intent, Motion, Path, PathKind, PointerState, SimState
from higvf_console.operator.outcome import proposal_dropped, with_pointer_state
from higvf_console.operator.path_commands import same_place
from higvf_console.runtime.phase import FIRST, RunPhase
from higvf_console.scenario.scenario import Scenario
from higvf_console.scenario.sections import FilterKind
from higvf_console.sim.certificates import Worst
from higvf_console.world.editing.carry import NEW, carried, inverse, led_on, same_rows, waiting_on
from higvf_console.world.editing.safe_places import diagonal, nearest_fit, newly_crowded, placed, robot_fits
from higvf_console.world.layout import Layout
from higvf_console.world.setup import Setup

KEPT = 200  # actions
_WAITING = ("pending", "pending_robot", "pending_repairs")  # of the pointer state: the path that waits


class Tally(NamedTuple):
    """Measures of a run so far.

    Attributes:
        extinguished: fire indices in the order in which they were extinguished.
        min_clearance: smallest clearance [m].
        infeasible_ticks: control periods in which a robot could not meet all constraints.
        deadlock_ticks: control periods in which a robot was deadlocked.
        worst: worst certificates of single ticks.
    """

    extinguished: tuple[int, ...] = ()
    min_clearance: float = math.inf
    infeasible_ticks: int = 0
    deadlock_ticks: int = 0
    worst: Worst = Worst()


class RunState(NamedTuple):
    """Everything that changes in a run.

    Attributes:
        setup: layout and world in force, and the start.
        state: now.
        tally: so far.
        filter: the safety filter that runs.
        scenario: where the run came from; None for a run that no scenario file describes.
        phase: whether it waits for its start, runs, or has ended.
    """

    setup: Setup
    state: SimState
    tally: Tally
    filter: FilterKind
    scenario: Scenario | None
    phase: RunPhase = FIRST


class Action(NamedTuple):
    """A command that changed the run, and can be undone.

    Attributes:
        time: session time [s].
        kind: name of the command.
        text: its effect, one sentence.
        before: run state before it.
        after: run state right after it, at the same time.
        robots: row before of each robot after, or `NEW`.
        fires: likewise.
        whole: whether undo restores the former run as a whole.
        repairs: whether it changed the path in force without replacing it.
    """

    time: float
    kind: str
    text: str
    before: RunState
    after: RunState
    robots: Ints
    fires: Ints
    whole: bool
    repairs: bool


class Entry(NamedTuple):
    """A line of the history as the console shows it."""

    time: float
    text: str
    undone: bool


class History(NamedTuple):
    """The actions that can be undone, oldest first, and those that can be redone, next first."""

    done: tuple[Action, ...] = ()
    undone: tuple[Action, ...] = ()

    def with_action(self, action: Action) -> "History":
        """The history after a new action, which cannot be followed by a redo."""
        return History((*self.done, action)[-KEPT:], ())

    def stopped(self) -> "History":
        """The history after an emergency stop."""
        pauses = ("Pause", "Resume")
        return History(*(tuple(action for action in actions if action.kind not in pauses) for actions in self))

    def entries(self) -> tuple[Entry, ...]:
        """All lines, oldest first."""
        return (
            *(Entry(action.time, action.text, False) for action in self.done),
            *(Entry(action.time, action.text, True) for action in self.undone),
        )


def undo(history: History, now: RunState) -> tuple[History, RunState, str]:
    """The history and the run state without the last action, and a sentence about it.

    Raises:
        ScenarioError: there is no action, or no robot could keep its clearance after it.
    """
    if not history.done:
        raise ScenarioError("nothing to undo")
    action = history.done[-1]
    if action.whole:
        run_state, aside = _restored(now, action.before), ""
    else:
        run_state, aside = _with_difference(now, action.after, action.before, *_rows_back(action), action.repairs)
    action = action._replace(after=_with_progress(action.after, now))
    return History(history.done[:-1], (action, *history.undone)), run_state, f"Undone: {action.text}{aside}"


def redo(history: History, now: RunState) -> tuple[History, RunState, str]:
    """The history and the run state with the action that was undone last, and a sentence about it.

    Raises:
        ScenarioError: there is no action, or no robot could keep its clearance after it.
    """
    if not history.undone:
        raise ScenarioError("nothing to redo")
    action = history.undone[0]
    if action.whole:
        run_state, aside = _restored(now, action.after), ""
    else:
        run_state, aside = _with_difference(
            now, action.before, action.after, action.robots, action.fires, action.repairs
        )
    action = action._replace(before=_with_progress(action.before, now))
    return History((*history.done, action), history.undone[1:]), run_state, f"Redone: {action.text}{aside}"


def rows_before(history: History, *, undone: bool) -> tuple[Ints, Ints]:
    """Row that each robot, and each fire, had before the latest change of the history, or `NEW`.

    Args:
        history: after that change.
        undone: whether that change was an undo; else it was an action or a redo.

    Returns:
        (N,), (M,) rows; none where the whole run has become another.
    """
    action = history.undone[0] if undone else history.done[-1]
    if action.whole:
        return same_rows(0), same_rows(0)
    return _rows_back(action) if undone else (action.robots, action.fires)


def _rows_back(action: Action) -> tuple[Ints, Ints]:
    """Row after of each robot and of each fire before, or `NEW`."""
    motion = action.before.state.motion
    return inverse(action.robots, len(motion.position)), inverse(action.fires, len(motion.fire_radius))


def _with_progress(run_state: RunState, now: RunState) -> RunState:
    """A past run state with the team's present progress along its path."""
    state, motion = run_state.state, now.state.motion
    if state.intent.path is not now.state.intent.path or state.motion.path_parameter == motion.path_parameter:
        return run_state
    progress = {name: getattr(motion, name) for name in ("path_parameter", "path_status", "path_left")}
    return run_state._replace(state=state._replace(motion=state.motion._replace(**progress)))


def _restored(now: RunState, goal: RunState) -> RunState:
    """Another run state in place of the present one, except for the pointer."""
    intent, present = goal.state.intent, now.state.intent
    intent = intent._replace(paused=intent.paused or present.paused, stopped=present.stopped)
    state = proposal_dropped(now.state._replace(motion=goal.state.motion, intent=intent))
    back = {name: getattr(goal.state.pointer_state, name) for name in (*_WAITING, "paths")}
    return goal._replace(state=with_pointer_state(state, **back))


def _with_difference(
    now: RunState, source: RunState, goal: RunState, robots: Ints, fires: Ints, repairs: bool
) -> tuple[RunState, str]:
    """The present run state plus the difference between two past ones, and which robots were in the way."""
    if now.state.motion is source.state.motion:
        intent = goal.state.intent._replace(paused=_paused(now, source, goal), stopped=now.state.intent.stopped)
        state = SimState(goal.state.motion, intent, _pointer_state_back(now, source, goal, robots))
        return now._replace(setup=goal.setup, state=state, tally=goal.tally), ""
    layout = goal.setup.layout
    count = len(now.state.motion.fire_radius)
    motion = carried(now.state.motion, robots, fires, now.setup.world, goal.setup.world)
    motion, intent = led_on(motion, now.state.intent, robots, fires, count)
    motion = _fires_back(motion, source, goal, fires)
    motion = _robots_back(motion, source, goal, robots, layout)
    in_the_way = newly_crowded((now.setup.layout, now.state.motion), (layout, motion), robots)
    motion, aside = _moved_aside(motion, in_the_way, layout)
    led_by = led_on(source.state.motion, source.state.intent, robots, fires, count)[1].influenced
    if led_by != goal.state.intent.influenced:
        intent = intent._replace(influenced=goal.state.intent.influenced)
    intent = intent._replace(paused=_paused(now, source, goal))
    motion, intent = _intent_back(motion, intent, source.state, goal.state, repairs)
    state = SimState(motion, intent, _pointer_state_back(now, source, goal, robots))
    tally = now.tally._replace(extinguished=_numbers_back(now.tally, goal.tally, fires))
    return now._replace(setup=goal.setup, state=state, tally=tally), aside


def _robots_back(motion: Motion, source: RunState, goal: RunState, robots: Ints, layout: Layout) -> Motion:
    """Returns robots that the action moved or removed to where they were, or to the nearest safe position."""
    was, then = source.state.motion, goal.state.motion
    for robot, row in enumerate(robots.tolist()):
        same = row != NEW and (was.position[row] == then.position[robot]).all()
        if same and was.heading[row] == then.heading[robot]:
            continue
        heading = motion.heading.copy()
        heading[robot] = then.heading[robot]
        motion = placed(motion._replace(heading=heading), robot, then.position[robot])
        motion = _held(motion, robot, layout)
    return motion


def _moved_aside(motion: Motion, in_the_way: list[int], layout: Layout) -> tuple[Motion, str]:
    """Moves robots that are in the way of what returns to the nearest safe position, and names them."""
    aside: list[int] = []
    for robot in in_the_way:
        if not robot_fits(robot, layout, motion)(motion.position[robot : robot + 1])[0]:
            motion = _held(motion, robot, layout)
            aside.append(robot + 1)
    if not aside:
        return motion, ""
    numbers = ", ".join(map(str, aside))
    return motion, f" Robot {numbers} was in the way and is set aside." if len(aside) == 1 else (
        f" Robots {numbers} were in the way and are set aside."
    )


def _held(motion: Motion, robot: int, layout: Layout) -> Motion:
    """Moves a robot to the nearest safe position."""
    place = nearest_fit(motion.position[robot], robot_fits(robot, layout, motion), diagonal(layout))
    if place is None:
        raise ScenarioError(f"there is no safe place for robot {robot + 1} in the arena")
    return placed(motion, robot, place)


def _fires_back(motion: Motion, source: RunState, goal: RunState, fires: Ints) -> Motion:
    """Restores fires that the action resized or removed."""
    was, then = source.state.motion, goal.state.motion
    radius, progress, burning = motion.fire_radius.copy(), motion.fire_progress.copy(), motion.fire_burning.copy()
    for fire, row in enumerate(fires.tolist()):
        if row == NEW or was.fire_radius[row] != then.fire_radius[fire]:
            radius[fire] = then.fire_radius[fire]
        if row == NEW:
            progress[fire], burning[fire] = then.fire_progress[fire], then.fire_burning[fire]
    return motion._replace(fire_radius=radius, fire_progress=progress, fire_burning=burning)


def _paused(now: RunState, source: RunState, goal: RunState) -> bool:
    """Whether the team is paused, restored if the action changed it; a stopped team stays paused."""
    was, then, intent = source.state.intent.paused, goal.state.intent.paused, now.state.intent
    return intent.paused if was == then else then or intent.stopped


def _intent_back(
    motion: Motion, intent: Intent, source: SimState, goal: SimState, repairs: bool
) -> tuple[Motion, Intent]:
    """Restores path and priorities that the action changed."""
    was, then = source.intent, goal.intent
    if was.priority.tobytes() != then.priority.tobytes():
        intent = intent._replace(priority=then.priority)
    of_path = (was.path is not then.path, source.motion.path_status != goal.motion.path_status)
    if any(of_path) or source.motion.path_left != goal.motion.path_left:
        goes_on = repairs and intent.path.kind != PathKind.NONE
        motion = _repaired(motion, intent.path, source, goal) if goes_on else _rejoined(motion, goal, intent.influenced)
        intent = intent._replace(path=then.path)
    return motion, intent


def _pointer_state_back(now: RunState, source: RunState, goal: RunState, robots: Ints) -> PointerState:
    """Restores the path that waits and the list of paths, where the action changed them."""
    pointer_state, was, then = (
        waiting_on(now.state.pointer_state, robots),
        source.state.pointer_state,
        goal.state.pointer_state,
    )
    if was.pending is not then.pending:
        pointer_state = pointer_state._replace(**{name: getattr(then, name) for name in _WAITING})
    return pointer_state if was.paths is then.paths else pointer_state._replace(paths=then.paths)


def _repaired(motion: Motion, path: Path, source: SimState, goal: SimState) -> Motion:
    """On the path before (or after) it was redrawn, at the place that corresponds to the present one."""
    was, then = source.motion, goal.motion
    revives = (was.path_status in ACTING) != (then.path_status in ACTING)
    lasts = source.intent.path.duration == goal.intent.path.duration
    return motion._replace(
        path_parameter=same_place(path, goal.intent.path, motion.path_parameter),
        path_status=then.path_status if revives else motion.path_status,
        path_left=motion.path_left if lasts else then.path_left,
        path_idle=0.0, path_gap=math.inf,
    )  # fmt: skip


def _rejoined(motion: Motion, goal: SimState, robot: int) -> Motion:
    """On a former path: an open one where it was left, any other at the nearest point."""
    path, w = goal.intent.path, goal.motion.path_parameter
    if path.kind != PathKind.NONE and (path.closed or path.kind != PathKind.SPLINE):
        x, y = motion.position[robot].tolist()
        w = nearest(path, w, EVERYWHERE, x, y)[0]
    return motion._replace(
        path_parameter=w, path_status=goal.motion.path_status, path_idle=0.0, path_gap=math.inf,
        path_left=goal.motion.path_left, recovery_stage=np.zeros_like(motion.recovery_stage),
    )  # fmt: skip


def _numbers_back(now: Tally, goal: Tally, fires: Ints) -> tuple[int, ...]:
    """Extinguished fires by their present numbers; those that return keep their former order."""
    numbers = {old: new for new, old in enumerate(fires.tolist()) if old != NEW}
    kept = tuple(numbers[fire] for fire in now.extinguished if fire in numbers)
    return kept + tuple(fire for fire in goal.extinguished if fires[fire] == NEW)
