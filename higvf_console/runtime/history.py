"""What was done, to be undone and done again: every edit and every action of the operator.

Time does not run back: an undo takes the difference that a deed made out of the present moment. Robots stay where they
have come to since, but for those that the deed itself moved, and those that stand where something comes back, which
are set aside to the nearest safe place; a fire keeps what it has grown. Where no time has passed, all is as it was to
the last bit. Without a repair, a path is followed from where the team has come to on it. Where the deed was a reset or
another scenario, the former run comes back as a whole, but for what the operator's hand is doing.

An undo never sets the team in motion after a STOP: that takes pauses out of the history.
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
from higvf_console.scenario.scenario import Scenario
from higvf_console.scenario.sections import FilterKind
from higvf_console.sim.certificates import Worst
from higvf_console.world.editing.carry import NEW, carried, inverse, led_on, same_rows, waiting_on
from higvf_console.world.editing.safe_places import crowded, diagonal, nearest_fit, placed, robot_fits
from higvf_console.world.layout import Layout
from higvf_console.world.setup import Setup

KEPT = 200  # deeds
_WAITING = ("pending", "pending_robot", "pending_repairs")  # what a drawing has of the path that waits


class Tally(NamedTuple):
    """What a run has come to so far.

    Attributes:
        extinguished: fire indices in the order in which they went out.
        min_clearance: smallest clearance [m].
        infeasible_ticks: control periods in which a robot could not meet all barrier rows.
        deadlock_ticks: control periods in which a robot was deadlocked.
        worst: what the certificates of single ticks came to.
    """

    extinguished: tuple[int, ...] = ()
    min_clearance: float = math.inf
    infeasible_ticks: int = 0
    deadlock_ticks: int = 0
    worst: Worst = Worst()


class RunState(NamedTuple):
    """A run at one moment.

    Attributes:
        setup: world and gains in force, and the start.
        state: now.
        tally: so far.
        filter: the safety filter that runs.
        scenario: where it all came from; None for a run that no scenario file describes.
    """

    setup: Setup
    state: SimState
    tally: Tally
    filter: FilterKind
    scenario: Scenario | None


class Action(NamedTuple):
    """Something that was done.

    Attributes:
        time: session time [s].
        kind: name of the command.
        text: what was done, one sentence.
        before: the moment before.
        after: the moment after; no time has passed.
        robots: row before of each robot after, or `NEW`.
        fires: likewise.
        whole: whether the former run as a whole comes back when it is undone.
        repairs: whether it changed the path in force, and the team went on along it.
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
    """A line of the history as people read it."""

    time: float
    text: str
    undone: bool


class History(NamedTuple):
    """Deeds in the order in which they were done; `undone` ones in the order in which they would be done again."""

    done: tuple[Action, ...] = ()
    undone: tuple[Action, ...] = ()

    def with_action(self, action: Action) -> "History":
        """The history after something new was done: what was undone before is gone."""
        return History((*self.done, action)[-KEPT:], ())

    def stopped(self) -> "History":
        """The history after a STOP."""
        pauses = ("Pause", "Resume")
        return History(*(tuple(action for action in actions if action.kind not in pauses) for actions in self))

    def entries(self) -> tuple[Entry, ...]:
        """All lines, the oldest first."""
        return (
            *(Entry(action.time, action.text, False) for action in self.done),
            *(Entry(action.time, action.text, True) for action in self.undone),
        )


def undo(history: History, now: RunState) -> tuple[History, RunState, str]:
    """The moment without the last deed.

    Raises:
        ScenarioError: there is none, or no robot could keep its clearance after it.
    """
    if not history.done:
        raise ScenarioError("there is nothing to undo")
    action = history.done[-1]
    if action.whole:
        run_state, aside = _as_a_whole(now, action.before), ""
    else:
        run_state, aside = _turned(now, action.after, action.before, *_rows_back(action), action.repairs)
    action = action._replace(after=_with_progress(action.after, now))
    return History(history.done[:-1], (action, *history.undone)), run_state, f"Undone: {action.text}{aside}"


def redo(history: History, now: RunState) -> tuple[History, RunState, str]:
    """The moment with the deed that was undone last.

    Raises:
        ScenarioError: there is none, or no robot could keep its clearance after it.
    """
    if not history.undone:
        raise ScenarioError("there is nothing to do again")
    action = history.undone[0]
    if action.whole:
        run_state, aside = _as_a_whole(now, action.after), ""
    else:
        run_state, aside = _turned(now, action.before, action.after, action.robots, action.fires, action.repairs)
    action = action._replace(before=_with_progress(action.before, now))
    return History((*history.done, action), history.undone[1:]), run_state, f"Done again: {action.text}{aside}"


def rows_before(history: History, *, undone: bool) -> tuple[Ints, Ints]:
    """Row that each robot, and each fire, had before what the history came by, or `NEW`.

    Args:
        history: just now.
        undone: whether it came by an undo, else by a deed or a redo.

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
    """A moment of the past, for the way back to it, as far along its path as the team has come since."""
    state, motion = run_state.state, now.state.motion
    if state.intent.path is not now.state.intent.path or state.motion.path_parameter == motion.path_parameter:
        return run_state
    progress = {name: getattr(motion, name) for name in ("path_parameter", "path_status", "path_left")}
    return run_state._replace(state=state._replace(motion=state.motion._replace(**progress)))


def _as_a_whole(now: RunState, goal: RunState) -> RunState:
    """Another moment in place of the present one, but for what the operator's hand is doing."""
    intent, present = goal.state.intent, now.state.intent
    intent = intent._replace(paused=intent.paused or present.paused, stopped=present.stopped)
    state = proposal_dropped(now.state._replace(motion=goal.state.motion, intent=intent))
    back = {name: getattr(goal.state.pointer_state, name) for name in (*_WAITING, "paths")}
    return goal._replace(state=with_pointer_state(state, **back))


def _turned(
    now: RunState, source: RunState, goal: RunState, robots: Ints, fires: Ints, repairs: bool
) -> tuple[RunState, str]:
    """The present moment with the difference between two moments of the past, and who was in the way of that."""
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
    already = set(crowded(now.setup.layout, now.state.motion))
    motion, aside = _set_aside(motion, [robot for robot, row in enumerate(robots) if int(row) not in already], layout)
    led_by = led_on(source.state.motion, source.state.intent, robots, fires, count)[1].influenced
    if led_by != goal.state.intent.influenced:
        intent = intent._replace(influenced=goal.state.intent.influenced)
    intent = intent._replace(paused=_paused(now, source, goal))
    motion, intent = _asked_back(motion, intent, source.state, goal.state, repairs)
    state = SimState(motion, intent, _pointer_state_back(now, source, goal, robots))
    tally = now.tally._replace(extinguished=_numbers_back(now.tally, goal.tally, fires))
    return now._replace(setup=goal.setup, state=state, tally=tally), aside


def _robots_back(motion: Motion, source: RunState, goal: RunState, robots: Ints, layout: Layout) -> Motion:
    """Robots that the deed moved, or took away, are where they were, or at the nearest safe place."""
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


def _set_aside(motion: Motion, movable: list[int], layout: Layout) -> tuple[Motion, str]:
    """Robots that stand where something comes back are at the nearest safe place, and which these are, in words."""
    aside: list[int] = []
    for robot in crowded(layout, motion):
        if robot in movable and not robot_fits(robot, layout, motion)(motion.position[robot : robot + 1])[0]:
            motion = _held(motion, robot, layout)
            aside.append(robot + 1)
    if not aside:
        return motion, ""
    numbers = ", ".join(map(str, aside))
    return motion, f" Robot {numbers} was in the way and is set aside." if len(aside) == 1 else (
        f" Robots {numbers} were in the way and are set aside."
    )


def _held(motion: Motion, robot: int, layout: Layout) -> Motion:
    """With a robot at the safe place that is nearest to where it is."""
    place = nearest_fit(motion.position[robot], robot_fits(robot, layout, motion), diagonal(layout))
    if place is None:
        raise ScenarioError(f"there is no safe place for robot {robot + 1} in the arena")
    return placed(motion, robot, place)


def _fires_back(motion: Motion, source: RunState, goal: RunState, fires: Ints) -> Motion:
    """Fires that the deed resized, or took away, are as they were."""
    was, then = source.state.motion, goal.state.motion
    radius, progress, burning = motion.fire_radius.copy(), motion.fire_progress.copy(), motion.fire_burning.copy()
    for fire, row in enumerate(fires.tolist()):
        if row == NEW or was.fire_radius[row] != then.fire_radius[fire]:
            radius[fire] = then.fire_radius[fire]
        if row == NEW:
            progress[fire], burning[fire] = then.fire_progress[fire], then.fire_burning[fire]
    return motion._replace(fire_radius=radius, fire_progress=progress, fire_burning=burning)


def _paused(now: RunState, source: RunState, goal: RunState) -> bool:
    """Whether the team is paused where the deed changed that; a team that is stopped stays paused."""
    was, then, intent = source.state.intent.paused, goal.state.intent.paused, now.state.intent
    return intent.paused if was == then else then or intent.stopped


def _asked_back(
    motion: Motion, intent: Intent, source: SimState, goal: SimState, repairs: bool
) -> tuple[Motion, Intent]:
    """Path and priorities, where the deed changed them."""
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
    """What waits, and the list of paths, where the deed changed them."""
    pointer_state, was, then = (
        waiting_on(now.state.pointer_state, robots),
        source.state.pointer_state,
        goal.state.pointer_state,
    )
    if was.pending is not then.pending:
        pointer_state = pointer_state._replace(**{name: getattr(then, name) for name in _WAITING})
    return pointer_state if was.paths is then.paths else pointer_state._replace(paths=then.paths)


def _repaired(motion: Motion, path: Path, source: SimState, goal: SimState) -> Motion:
    """On the path without, or with, a repair, where the team has come to on the one in force."""
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
    """On a former path, an open one where it was left, any other at the nearest point."""
    path, w = goal.intent.path, goal.motion.path_parameter
    if path.kind != PathKind.NONE and (path.closed or path.kind != PathKind.SPLINE):
        x, y = motion.position[robot].tolist()
        w = nearest(path, w, EVERYWHERE, x, y)[0]
    return motion._replace(
        path_parameter=w, path_status=goal.motion.path_status, path_idle=0.0, path_gap=math.inf,
        path_left=goal.motion.path_left, recovery_stage=np.zeros_like(motion.recovery_stage),
    )  # fmt: skip


def _numbers_back(now: Tally, goal: Tally, fires: Ints) -> tuple[int, ...]:
    """Fires that are out, by their numbers; those that come back with the deed as they were."""
    numbers = {old: new for new, old in enumerate(fires.tolist()) if old != NEW}
    kept = tuple(numbers[fire] for fire in now.extinguished if fire in numbers)
    return kept + tuple(fire for fire in goal.extinguished if fires[fire] == NEW)
