"""One command, whatever it is about: the moment after it, the history with it, and what there is to say.

what the operator asks of the team    operator.reducer
what the world is made of             world.editing
another scenario                      scenario.scenario
undo, redo                            runtime.history
"""

from higvf_console.core.arrays import Ints
from higvf_console.core.command import Command
from higvf_console.core.commands import (
    ClearPath,
    Confirm,
    Discard,
    EmergencyStop,
    ForgetPath,
    LoadScenario,
    MovePathPoint,
    NextTask,
    OperatorCommand,
    Pause,
    Pick,
    Prioritise,
    Redo,
    ResetRun,
    Resume,
    ReversePath,
    ShapePath,
    StrokeCancel,
    StrokeEnd,
    StrokeUse,
    TakeUpPath,
    Undo,
)
from higvf_console.core.edits import AddOutlines, Edit
from higvf_console.core.errors import ScenarioError
from higvf_console.core.events import Event, Severity
from higvf_console.core.state import PathKind
from higvf_console.operator.reducer import apply_command, started_again
from higvf_console.runtime.history import Action, History, RunState, Tally, redo, undo
from higvf_console.scenario.scenario import parse_scenario
from higvf_console.world.editing.carry import NEW, same_rows
from higvf_console.world.editing.edit import edited
from higvf_console.world.editing.freehand import outline_of

Dispatched = tuple[RunState, History, tuple[Event, ...]]
_REMEMBERED = (
    StrokeEnd, Pick, Confirm, Discard, Pause, Resume, ClearPath, ReversePath, ShapePath, MovePathPoint, TakeUpPath,
    ForgetPath, Prioritise, NextTask, ResetRun,
)  # fmt: skip


def dispatch(now: RunState, history: History, command: OperatorCommand) -> Dispatched:
    """The run after a command.

    Raises:
        ScenarioError: it cannot be done; nothing has changed.
    """
    match command:
        case Undo():
            history, run_state, text = undo(history, now)
            return run_state, history, _report(now, "undone", text)
        case Redo():
            history, run_state, text = redo(history, now)
            return run_state, history, _report(now, "undone", text)
        case LoadScenario():
            return _loaded(now, history, command)
        case StrokeEnd(use=StrokeUse.OBSTACLE):
            return _outlined(now, history)
        case Edit():
            return _edited(now, history, command)
        case _:
            return _asked(now, history, command)


def _asked(now: RunState, history: History, command: OperatorCommand) -> Dispatched:
    state, events = apply_command(now.state, command, now.setup)
    run_state = now._replace(state=state)
    if isinstance(command, ResetRun):
        run_state = run_state._replace(tally=Tally())
    if isinstance(command, EmergencyStop):
        return run_state, history.stopped(), events
    said = [event for event in events if event.kind not in ("refused", "clipped")]
    if isinstance(command, _REMEMBERED) and said and _differs(now, run_state):
        rows = same_rows(len(state.motion.position)), same_rows(len(state.motion.fire_radius))
        history = _remembered(now, run_state, history, command, said[-1].text, *rows)
    return run_state, history, events


def _differs(now: RunState, run_state: RunState) -> bool:
    """Whether more than the growing stroke has changed."""
    was, become = now.state, run_state.state
    return (
        was.intent is not become.intent
        or was.motion is not become.motion
        or was.pointer_state.pending is not become.pointer_state.pending
        or was.pointer_state.paths is not become.pointer_state.paths
    )


def _edited(now: RunState, history: History, command: Edit) -> Dispatched:
    result = edited(now.setup, now.state, command)
    kept = {old: new for new, old in enumerate(result.fires.tolist()) if old != NEW}
    out = tuple(kept[fire] for fire in now.tally.extinguished if fire in kept)
    run_state = now._replace(setup=result.setup, state=result.state, tally=now.tally._replace(extinguished=out))
    history = _remembered(now, run_state, history, command, result.text, result.robots, result.fires)
    return run_state, history, _report(now, "edited", result.text)


def _outlined(now: RunState, history: History) -> Dispatched:
    """The stroke is the outline of an obstacle; it is over, whether that can be or not."""
    stroke = now.state.pointer_state.stroke
    now = now._replace(state=apply_command(now.state, StrokeCancel(), now.setup)[0])
    try:
        return _edited(now, history, AddOutlines(outlines=(outline_of(stroke),)))
    except ScenarioError as error:
        return now, history, (Event(_time(now), Severity.WARNING, "refused", f"No obstacle: {error}."),)


def _loaded(now: RunState, history: History, command: LoadScenario) -> Dispatched:
    scenario = parse_scenario(command.text, command.name, command.polygons)
    setup = scenario.setup(int(now.setup.params.robots.seed))
    start = started_again(now.state, setup)
    run_state = RunState(setup, start, Tally(), scenario.filter, scenario)
    rows = same_rows(len(start.motion.position)), same_rows(len(start.motion.fire_radius))
    said = f"The scenario '{scenario.title}' is loaded."
    history = _remembered(now, run_state, history, command, said, *rows)
    warnings = tuple(Event(0.0, Severity.WARNING, "scenario", warning) for warning in scenario.warnings)
    return run_state, history, _report(now, "loaded", said) + warnings


def _remembered(
    now: RunState, run_state: RunState, history: History, command: Command, text: str, robots: Ints, fires: Ints
) -> History:
    whole = isinstance(command, ResetRun | LoadScenario)
    kind = type(command).__name__
    return history.with_action(
        Action(
            time=_time(now),
            kind=kind,
            text=text,
            before=now,
            after=run_state,
            robots=robots,
            fires=fires,
            whole=whole,
            repairs=_repairs(now, command),
        )
    )


def _repairs(now: RunState, command: Command) -> bool:
    """Whether a command changes the path in force, and does not replace it."""
    match command:
        case ReversePath() | ShapePath() | MovePathPoint() | StrokeEnd(use=StrokeUse.REDRAW):
            return True
        case Confirm():
            return now.state.pointer_state.pending_repairs and now.state.intent.path.kind != PathKind.NONE
        case _:
            return False


def _report(now: RunState, kind: str, text: str) -> tuple[Event, ...]:
    return (Event(_time(now), Severity.INFO, kind, text),)


def _time(now: RunState) -> float:
    return now.state.motion.tick * now.setup.params.safety.control_period
