"""One command, whatever it is about: the moment after it, the history with it, and what there is to say.

what the operator asks of the team    operator.reducer
what the world is made of             world.editing
another scenario                      scenario.scenario
undo, redo                            runtime.history
"""

from higvf_console.core.arrays import Ints
from higvf_console.core.command import Command
from higvf_console.core.commands import (
    BendPath,
    ClearPath,
    Confirm,
    Discard,
    ForgetPath,
    LoadScenario,
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
    Stop,
    StrokeCancel,
    StrokeEnd,
    StrokeUse,
    TakeUpPath,
    Undo,
)
from higvf_console.core.edits import AddOutlines, Edit
from higvf_console.core.errors import ScenarioError
from higvf_console.core.state import PathKind
from higvf_console.operator.reducer import apply_command, started_again
from higvf_console.runtime.history import Deed, History, Moment, Tally, redo, undo
from higvf_console.scenario.scenario import parse_scenario
from higvf_console.sim.setup import Event, Severity
from higvf_console.world.editing.carry import NEW, same_rows
from higvf_console.world.editing.edit import edited
from higvf_console.world.editing.freehand import outline_of

Done = tuple[Moment, History, tuple[Event, ...]]
_REMEMBERED = (
    StrokeEnd, Pick, Confirm, Discard, Pause, Resume, ClearPath, ReversePath, ShapePath, BendPath, TakeUpPath,
    ForgetPath, Prioritise, NextTask, ResetRun,
)  # fmt: skip


def done(now: Moment, history: History, command: OperatorCommand) -> Done:
    """The run after a command.

    Raises:
        ScenarioError: it cannot be done; nothing has changed.
    """
    match command:
        case Undo():
            history, moment, text = undo(history, now)
            return moment, history, _say(now, "undone", text)
        case Redo():
            history, moment, text = redo(history, now)
            return moment, history, _say(now, "undone", text)
        case LoadScenario():
            return _loaded(now, history, command)
        case StrokeEnd(use=StrokeUse.OBSTACLE):
            return _outlined(now, history)
        case Edit():
            return _edited(now, history, command)
        case _:
            return _asked(now, history, command)


def _asked(now: Moment, history: History, command: OperatorCommand) -> Done:
    state, events = apply_command(now.state, command, now.setup)
    moment = now._replace(state=state)
    if isinstance(command, ResetRun):
        moment = moment._replace(tally=Tally())
    if isinstance(command, Stop):
        return moment, history.stopped(), events
    said = [event for event in events if event.kind not in ("refused", "clipped")]
    if isinstance(command, _REMEMBERED) and said and _differs(now, moment):
        rows = same_rows(len(state.motion.position)), same_rows(len(state.motion.fire_radius))
        history = _remembered(now, moment, history, command, said[-1].text, *rows)
    return moment, history, events


def _differs(now: Moment, moment: Moment) -> bool:
    """Whether more than the growing stroke has changed."""
    was, become = now.state, moment.state
    return (
        was.intent is not become.intent or was.motion is not become.motion
        or was.drawing.pending is not become.drawing.pending or was.drawing.paths is not become.drawing.paths
    )  # fmt: skip


def _edited(now: Moment, history: History, command: Edit) -> Done:
    result = edited(now.setup, now.state, command)
    kept = {old: new for new, old in enumerate(result.fires.tolist()) if old != NEW}
    out = tuple(kept[fire] for fire in now.tally.extinguished if fire in kept)
    moment = now._replace(setup=result.setup, state=result.state, tally=now.tally._replace(extinguished=out))
    history = _remembered(now, moment, history, command, result.text, result.robots, result.fires)
    return moment, history, _say(now, "edited", result.text)


def _outlined(now: Moment, history: History) -> Done:
    """The stroke is the outline of an obstacle; it is over, whether that can be or not."""
    stroke = now.state.drawing.stroke
    now = now._replace(state=apply_command(now.state, StrokeCancel(), now.setup)[0])
    try:
        return _edited(now, history, AddOutlines(outlines=(outline_of(stroke),)))
    except ScenarioError as error:
        return now, history, (Event(_time(now), Severity.WARNING, "refused", f"No obstacle: {error}."),)


def _loaded(now: Moment, history: History, command: LoadScenario) -> Done:
    scenario = parse_scenario(command.text, command.name, command.polygons)
    setup = scenario.setup(int(now.setup.gains.robots.seed))
    start = started_again(now.state, setup)
    moment = Moment(setup, start, Tally(), scenario.filter, scenario)
    rows = same_rows(len(start.motion.position)), same_rows(len(start.motion.fire_radius))
    said = f"The scenario '{scenario.title}' is loaded."
    history = _remembered(now, moment, history, command, said, *rows)
    warnings = tuple(Event(0.0, Severity.WARNING, "scenario", warning) for warning in scenario.warnings)
    return moment, history, _say(now, "loaded", said) + warnings


def _remembered(
    now: Moment, moment: Moment, history: History, command: Command, text: str, robots: Ints, fires: Ints
) -> History:
    whole = isinstance(command, ResetRun | LoadScenario)
    kind = type(command).__name__
    return history.with_deed(Deed(_time(now), kind, text, now, moment, robots, fires, whole, _mends(now, command)))


def _mends(now: Moment, command: Command) -> bool:
    """Whether a command changes the path in force, and does not replace it."""
    match command:
        case ReversePath() | ShapePath() | BendPath() | StrokeEnd(use=StrokeUse.AMEND):
            return True
        case Confirm():
            return now.state.drawing.pending_mends and now.state.intent.path.kind != PathKind.NONE
        case _:
            return False


def _say(now: Moment, kind: str, text: str) -> tuple[Event, ...]:
    return (Event(_time(now), Severity.INFO, kind, text),)


def _time(now: Moment) -> float:
    return now.state.motion.tick * now.setup.gains.safety.control_period
