"""Apply one operator command to the run, its history and its events.

intent of the operator     operator.reducer
beginning, end             runtime.phase
edits of the world         world.editing
another scenario           scenario.scenario
undo, redo                 runtime.history
"""

from typing import NamedTuple

from higvf_console.core.arrays import Ints
from higvf_console.core.command import Command
from higvf_console.core.commands import (
    ClearPath,
    Confirm,
    ContinueRun,
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
    StartRun,
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
from higvf_console.runtime.phase import Phase, RunPhase, again, begun, continued
from higvf_console.scenario.scenario import Scenario, parse_scenario
from higvf_console.world.editing.carry import NEW, same_rows
from higvf_console.world.editing.edit import edited
from higvf_console.world.editing.freehand import outline_of
from higvf_console.world.setup import Setup

Dispatched = tuple[RunState, History, tuple[Event, ...]]
_UNDOABLE = (
    StrokeEnd, Pick, Confirm, Discard, Pause, Resume, ClearPath, ReversePath, ShapePath, MovePathPoint, TakeUpPath,
    ForgetPath, Prioritise, NextTask, ResetRun,
)  # fmt: skip


_GOING = {StartRun: "The run begins.", ContinueRun: "The run goes on."}


class Prepared(NamedTuple):
    """A scenario that was read and built ahead, see `prepare`."""

    scenario: Scenario
    setup: Setup


def prepare(command: LoadScenario, seed: int) -> Prepared:
    """Reads and builds the scenario of a command, which may take seconds.

    Args:
        command: the file.
        seed: of the start positions.

    Raises:
        ScenarioError: it cannot be used.
    """
    scenario = parse_scenario(command.text, command.name, command.polygons)
    return Prepared(scenario, scenario.setup(seed))


def dispatch(  # noqa: PLR0911
    now: RunState, history: History, command: OperatorCommand, prepared: Prepared | None = None
) -> Dispatched:
    """The run state and the history after a command, and the events that report it.

    Args:
        now: present run state.
        history: what was done so far.
        command: what the operator asks for.
        prepared: of a LoadScenario, where it was prepared ahead.

    Raises:
        ScenarioError: the command is refused; nothing has changed.
    """
    match command:
        case Undo():
            history, run_state, text = undo(history, now)
            return run_state, history, _report(now, "undone", text)
        case Redo():
            history, run_state, text = redo(history, now)
            return run_state, history, _report(now, "undone", text)
        case StartRun() | ContinueRun():
            return _set_going(now, command), history, _report(now, "run", _GOING[type(command)])
        case LoadScenario():
            return _loaded(now, history, command, prepared or prepare(command, seed_of(now.setup)))
        case StrokeEnd(use=StrokeUse.OBSTACLE):
            return _outlined(now, history)
        case Edit():
            return _edited(now, history, command)
        case _:
            return _applied(now, history, command)


def _set_going(now: RunState, command: StartRun | ContinueRun) -> RunState:
    change = begun if isinstance(command, StartRun) else continued
    return now._replace(phase=change(now.phase))


def _applied(now: RunState, history: History, command: OperatorCommand) -> Dispatched:
    state, events = apply_command(now.state, command, now.setup)
    run_state = now._replace(state=state)
    if isinstance(command, ResetRun):
        run_state = run_state._replace(tally=Tally(), phase=again(now.phase))
    if isinstance(command, EmergencyStop):
        return run_state, history.stopped(), events
    effects = [event for event in events if event.kind not in ("refused", "clipped")]
    if isinstance(command, _UNDOABLE) and effects and _differs(now, run_state):
        rows = same_rows(len(state.motion.position)), same_rows(len(state.motion.fire_radius))
        history = _recorded(now, run_state, history, command, effects[-1].text, *rows)
    return run_state, history, events


def _differs(now: RunState, run_state: RunState) -> bool:
    """Whether more than cursor and growing stroke has changed."""
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
    history = _recorded(now, run_state, history, command, result.text, result.robots, result.fires)
    warnings = tuple(Event(_time(now), Severity.WARNING, "edited", warning) for warning in result.warnings)
    return run_state, history, _report(now, "edited", result.text) + warnings


def _outlined(now: RunState, history: History) -> Dispatched:
    """Makes the stroke the outline of an obstacle; the stroke ends even if the outline is refused."""
    stroke = now.state.pointer_state.stroke
    now = now._replace(state=apply_command(now.state, StrokeCancel(), now.setup)[0])
    try:
        return _edited(now, history, AddOutlines(outlines=(outline_of(stroke),)))
    except ScenarioError as error:
        return now, history, (Event(_time(now), Severity.WARNING, "refused", f"No obstacle: {error}."),)


def seed_of(setup: Setup) -> int:
    """By which the start positions of a run, and its errors, are drawn."""
    return int(setup.params.robots.seed)


def _loaded(now: RunState, history: History, command: LoadScenario, prepared: Prepared) -> Dispatched:
    scenario, setup = prepared
    start = started_again(now.state, setup)
    phase = RunPhase(Phase.READY if command.waits else Phase.RUNNING)
    run_state = RunState(setup, start, Tally(), scenario.filter, scenario, phase)
    rows = same_rows(len(start.motion.position)), same_rows(len(start.motion.fire_radius))
    text = f"The scenario '{scenario.title}' is loaded."
    history = _recorded(now, run_state, history, command, text, *rows)
    warnings = tuple(Event(0.0, Severity.WARNING, "scenario", warning) for warning in scenario.warnings)
    return run_state, history, _report(now, "loaded", text) + warnings


def _recorded(
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
