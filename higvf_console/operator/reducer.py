"""Applies one operator command to the state: a pure reducer that returns the next state and its events.

A command that cannot be carried out leaves the state unchanged and returns the reason as an event. The session handles
the commands on the clock (StartRun, ContinueRun, Freeze, Step, SetSpeed), the channels (Acknowledge, InjectFault), the
history and the world (LoadScenario, Undo, Redo, edits); the reducer ignores them. HandOver is only reported.
"""

import math
from typing import TypeAlias, assert_never

import numpy as np

from higvf_console.control.guidance.paths import sketch_path
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.command import SESSION
from higvf_console.core.commands import (
    Acknowledge,
    Arm,
    AskArm,
    AskReset,
    ClearPath,
    Clutch,
    Confirm,
    ContinueRun,
    ControlChange,
    Cursor,
    Disarm,
    Discard,
    EmergencyStop,
    ForgetPath,
    Freeze,
    HandOver,
    InjectFault,
    LoadScenario,
    MovePathPoint,
    NextTask,
    OperatorCommand,
    Pause,
    Pick,
    Prioritise,
    ProposePick,
    Redo,
    ReleaseRobot,
    ResetEmergencyStop,
    ResetRun,
    Resume,
    ReversePath,
    SetSpeed,
    ShapePath,
    StartRun,
    Step,
    StopRobot,
    StrokeBegin,
    StrokeCancel,
    StrokeEnd,
    StrokePoints,
    StrokeUse,
    TakeUpPath,
    Undo,
)
from higvf_console.core.edits import Edit
from higvf_console.core.errors import PathError
from higvf_console.core.events import Event, Severity
from higvf_console.core.numbers import measured
from higvf_console.core.path_terms import terms_of_stroke
from higvf_console.core.state import NO_PATH, NOBODY, Path, PathKind, PointerState, SimState
from higvf_console.core.viewport import Arena
from higvf_console.operator.outcome import (
    Outcome,
    no_robot,
    path_dropped,
    proposal_dropped,
    refuse,
    report,
    with_pointer_state,
)
from higvf_console.operator.path_commands import (
    PATHS_KEPT,
    finish,
    follow,
    forget,
    repair_path,
    repaired,
    shaped,
    take_up,
    with_terms,
)
from higvf_console.operator.path_edits import bent, redrawn
from higvf_console.operator.priority import prioritise, prioritise_inside
from higvf_console.operator.stop_commands import pause_or_stop
from higvf_console.world.setup import Setup

_PointerCommand: TypeAlias = StrokeBegin | StrokePoints | StrokeEnd | StrokeCancel | Cursor | Clutch
_PathCommand: TypeAlias = ClearPath | ReversePath | ShapePath | MovePathPoint | TakeUpPath | ForgetPath
_NO_STROKE = np.zeros((0, 2))


def apply_command(state: SimState, command: OperatorCommand, setup: Setup) -> Outcome:  # noqa: PLR0911, PLR0912
    """Applies one operator command.

    Args:
        state: present state.
        command: what the operator asks for.
        setup: arena, world and parameters of the run.

    Returns:
        The next state, and the events to report.
    """
    time = state.motion.tick * setup.params.safety.control_period
    match command:
        case StrokeBegin() | StrokePoints() | StrokeEnd() | StrokeCancel() | Cursor() | Clutch():
            return _point_or_draw(state, command, setup, time)
        case Pick(robot=robot):
            return _pick(proposal_dropped(state), robot, time)
        case ProposePick():
            return _propose(state, command, time)
        case Confirm():
            return _confirm(state, time)
        case Discard(proposal=robot_too):
            return _discard(state, time, robot_too=robot_too)
        case Pause() | Resume() | EmergencyStop() | AskReset() | ResetEmergencyStop():
            return pause_or_stop(state, command, time)
        case ClearPath() | ReversePath() | ShapePath() | MovePathPoint() | TakeUpPath() | ForgetPath():
            return _change_path(state, command, setup, time)
        case Prioritise():
            return prioritise(state, command, setup, time)
        case NextTask():
            return finish(state, time)
        case ResetRun():
            return started_again(state, setup), report(0.0, "reset", "The run restarts.")
        case HandOver():
            return state, _control_events(command, time)
        case StartRun() | ContinueRun() | Freeze() | Step() | SetSpeed() | Acknowledge() | InjectFault():
            return state, ()
        case AskArm() | Arm() | Disarm() | StopRobot() | ReleaseRobot():  # see `team.commands`
            return state, ()
        case LoadScenario() | Undo() | Redo() | Edit():
            return state, ()
        case _:
            assert_never(command)


def _point_or_draw(state: SimState, command: _PointerCommand, setup: Setup, time: float) -> Outcome:  # noqa: PLR0911
    match command:
        case StrokeBegin():
            return with_pointer_state(state, stroke=_NO_STROKE, stroke_source=command.source), ()
        case StrokePoints(points=points):
            return _append_points(state, command.source, points), ()
        case StrokeEnd() | StrokeCancel() if not _owns_stroke(state.pointer_state, command.source):
            return state, ()
        case StrokeCancel():
            return with_pointer_state(state, stroke=_NO_STROKE, stroke_source=""), ()
        case StrokeEnd():
            return _end_stroke(state, command, setup, time)
        case Cursor(point=point):
            return with_pointer_state(state, cursor=floats(point, 2)), ()
        case Clutch(closed=closed):
            return with_pointer_state(state, clutch=bool(closed)), ()
        case _:
            assert_never(command)


def _change_path(state: SimState, command: _PathCommand, setup: Setup, time: float) -> Outcome:
    scale = setup.params.scale
    match command:
        case ClearPath():
            return follow(state, NO_PATH), report(time, "path", "The path is cleared.")
        case ReversePath():
            return repaired(state, time, lambda path: path._replace(direction=-path.direction))
        case ShapePath():
            restart = command.duration is not None
            return repaired(state, time, lambda path: shaped(path, command, scale), restart=restart)
        case MovePathPoint(grip=grip, point=point, preview=preview):
            place = clipped(floats(point, 1, 2), setup.arena)[0][0]
            return repaired(state, time, lambda path: bent(path, floats(grip, 2), place, scale), preview=preview)
        case TakeUpPath(number=number):
            return take_up(state, number, time)
        case ForgetPath(number=number):
            return forget(state, number, time)
        case _:
            assert_never(command)


def clipped(points: Floats, arena: Arena) -> tuple[Floats, bool]:
    """Stroke points (n, 2) [m] clipped to the arena, and whether any point lay outside."""
    inside = np.clip(points, [arena.x_min, arena.y_min], [arena.x_max, arena.y_max])
    return inside, bool((inside != points).any())


def started_again(now: SimState, setup: Setup) -> SimState:
    """The start state of a run; an active STOP stays active."""
    stopped, start = now.intent.stopped, setup.start
    return start._replace(intent=start.intent._replace(stopped=stopped, paused=start.intent.paused or stopped))


def proposal(pointer_state: PointerState, time: float) -> int:
    """The proposed robot at session time `time` [s]; NOBODY when there is none or the proposal has expired."""
    return pointer_state.proposed if time <= pointer_state.proposed_until else NOBODY


def waiting(pointer_state: PointerState, time: float) -> bool:
    """Whether a path or a robot waits for a Confirm at session time `time` [s]."""
    return pointer_state.pending.kind != PathKind.NONE or proposal(pointer_state, time) != NOBODY


def _end_stroke(state: SimState, command: StrokeEnd, setup: Setup, time: float) -> Outcome:
    points, left = clipped(state.pointer_state.stroke, setup.arena)
    smoothing = setup.params.path.stroke_smoothing if command.smoothing is None else command.smoothing
    scale = setup.params.scale
    state = with_pointer_state(state, stroke=_NO_STROKE, stroke_source="")
    if command.use == StrokeUse.PRIORITY:
        return prioritise_inside(state, points, setup, time)
    if command.use == StrokeUse.REDRAW:
        return repaired(state, time, lambda path: redrawn(path, points, smoothing, scale), preview=command.preview)
    try:
        path = with_terms(sketch_path(points, smoothing, scale=scale), terms_of_stroke(command))
    except PathError as error:
        return state, refuse(time, f"No path: {error}.")
    robot = NOBODY if command.robot is None else int(command.robot)
    ended, events = (_set_pending if command.preview else _commit)(state, path, robot, time)
    if left:
        events += (Event(time, Severity.WARNING, "clipped", "The stroke left the arena and was clipped to it."),)
    return ended, events


def _set_pending(state: SimState, path: Path, robot: int, time: float) -> Outcome:
    robots = len(state.motion.position)
    if robot != NOBODY and not 0 <= robot < robots:
        return state, no_robot(robot, robots, time)
    events = report(time, "pending", f"A path of {measured(path.length)} m is pending: commit or discard it.")
    return with_pointer_state(state, pending=path, pending_robot=robot, pending_repairs=False), events


def _commit(state: SimState, path: Path, robot: int, time: float) -> Outcome:
    robots, events = len(state.motion.position), ()
    if robot != NOBODY and not 0 <= robot < robots:
        return state, no_robot(robot, robots, time)
    state = path_dropped(state)
    if robot != NOBODY:
        state, events = _pick(state, robot, time)
    kind = "closed" if path.closed else "open"
    text = f"Robot {state.intent.influenced + 1} follows a new {kind} path of {measured(path.length)} m."
    if state.intent.stopped:
        text = f"The path of {measured(path.length)} m waits: the STOP is active. Reset it, then resume."
    elif state.intent.paused:
        text = f"The path of {measured(path.length)} m waits: the team is paused. Resume (P) to follow it."
    drawn = tuple(old for old in state.pointer_state.paths if old is not path)
    state = with_pointer_state(state, paths=(*drawn, path)[-PATHS_KEPT:])
    waits = state.intent.stopped or state.intent.paused
    severity = Severity.WARNING if waits else Severity.INFO
    return follow(state, path), (*events, Event(time, severity, "path", text, robot=state.intent.influenced))


def _propose(state: SimState, command: ProposePick, time: float) -> Outcome:
    robots, robot = len(state.motion.position), int(command.robot)
    if not 0 <= robot < robots:
        return state, no_robot(robot, robots, time)
    if robot == state.intent.influenced:
        return proposal_dropped(state), ()
    trust = "" if command.confidence is None else f" (confidence {command.confidence:.2f})"
    text = f"Robot {robot + 1} is proposed{trust}: commit or discard it within {command.within:g} s."
    events = report(time, "proposed", text, robot)
    return with_pointer_state(state, proposed=robot, proposed_until=time + float(command.within)), events


def _confirm(state: SimState, time: float) -> Outcome:
    """Picks the proposed robot first, so that it follows the pending path."""
    pointer_state = state.pointer_state
    if not waiting(pointer_state, time):
        return state, refuse(time, "Nothing is pending.")
    state, events, robot = proposal_dropped(state), (), proposal(pointer_state, time)
    if robot != NOBODY:
        state, events = _pick(state, robot, time)
    if pointer_state.pending.kind == PathKind.NONE:
        return state, events
    if pointer_state.pending_repairs and state.intent.path.kind != PathKind.NONE:
        state, more = repair_path(path_dropped(state), pointer_state.pending, time)
    else:
        state, more = _commit(state, pointer_state.pending, pointer_state.pending_robot, time)
    return state, events + more


def _discard(state: SimState, time: float, *, robot_too: bool) -> Outcome:
    robot = proposal(state.pointer_state, time) if robot_too else NOBODY
    pending = state.pointer_state.pending.kind != PathKind.NONE or robot != NOBODY
    dropped = path_dropped(proposal_dropped(state) if robot_too else state)
    return dropped, report(time, "discarded", "The pending path or proposal is discarded.") if pending else ()


def _pick(state: SimState, robot: int, time: float) -> Outcome:
    robots, robot = len(state.motion.position), int(robot)
    if not 0 <= robot < robots:
        return state, no_robot(robot, robots, time)
    if robot == state.intent.influenced:
        return state, ()
    motion = state.motion._replace(path_idle=0.0, path_gap=math.inf)
    picked = state._replace(motion=motion, intent=state.intent._replace(influenced=robot))
    return picked, report(time, "picked", f"Robot {robot + 1} is now the influenced robot.", robot)


def _append_points(state: SimState, source: str, points: Floats) -> SimState:
    """Appends points to the stroke of the interface that began it; points of other interfaces are ignored."""
    if state.pointer_state.stroke_source != source:
        return state
    return with_pointer_state(state, stroke=np.vstack([state.pointer_state.stroke, floats(points, -1, 2)]))


def _owns_stroke(pointer_state: PointerState, source: str) -> bool:
    """Whether this source may end the stroke: the interface that began it, or the session."""
    return pointer_state.stroke_source in ("", source) or source == SESSION


def _control_events(command: HandOver, time: float) -> tuple[Event, ...]:
    by, page = command.operator, command.page
    steers = f"{page} steers" if page else "nobody steers"
    texts: dict[str, str] = {
        ControlChange.FIRST: f"{page} steers.",
        ControlChange.ASKED: f"{page} asks for control.",
        ControlChange.REFUSED: f"{by} refuses control to {page}.",
        ControlChange.GRANTED: f"{by} grants control to {page}.",
        ControlChange.TAKEN: f"{page} takes over control.",
        ControlChange.RELEASED: f"{by} releases control: {steers}.",
        ControlChange.LOST: f"{by}, which steered, is lost: {steers}.",
    }
    alerts = command.how in (ControlChange.TAKEN, ControlChange.LOST)
    severity = Severity.WARNING if alerts else Severity.INFO
    return (Event(time, severity, "control", texts[command.how]),)
