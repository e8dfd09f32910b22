"""Whose path, clutch and priorities are in force, whatever was confirmed, taken back or renumbered since."""

import pytest

from higvf_console.channels.attribution import Attribution, attributed
from higvf_console.core.arrays import floats
from higvf_console.core.commands import (
    ClearPath,
    Clutch,
    Confirm,
    LoadScenario,
    MovePathPoint,
    NextTask,
    OperatorCommand,
    Pick,
    Prioritise,
    Redo,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
    StrokeUse,
    TakeUpPath,
    Undo,
)
from higvf_console.core.edits import DeleteEntity, Edit
from higvf_console.runtime.history import rows_before
from higvf_console.runtime.run import Run
from tests.teams import stroke
from tests.world.editing.actions import SCENE, edited_run

WAY = [(700.0, 300.0), (500.0, 450.0), (300.0, 450.0), (200.0, 600.0)]
WAITS = [*stroke(WAY)[:2], StrokeEnd(preview=True)]
WITH_PATH = SCENE + "path: {circle: {at_m: [700, 300], radius_m: 100}}\n"
CIRCLE = floats([[450.0, 200.0], [550.0, 200.0], [550.0, 300.0], [450.0, 300.0]])


def attribution_of(run: Run, *said: tuple[str, list[OperatorCommand] | OperatorCommand]) -> Attribution:
    """What the channels have a claim to, after each has given its commands."""
    attribution = Attribution()
    for channel, commands in said:
        for command in commands if isinstance(commands, list) else [commands]:
            before, history = run.state, run.history
            run.apply(command)
            new = run.history is not history and isinstance(command, Edit | Undo | Redo)
            rows = rows_before(run.history, undone=isinstance(command, Undo)) if new else None
            attribution = attributed(attribution, channel, command, before, run.state, rows)
    return attribution


@pytest.mark.parametrize(
    ("said", "path"),
    [
        ([("gaze", stroke(WAY))], "gaze"),
        ([("gaze", WAITS)], ""),
        ([("gaze", WAITS), ("emg", Confirm())], "gaze"),
        ([("gaze", stroke(WAY)), ("console", WAITS), ("console", Confirm())], "console"),
        ([("gaze", stroke(WAY)), ("console", ClearPath())], ""),
        ([("gaze", stroke(WAY)), ("console", ClearPath()), ("console", Undo())], "console"),
        ([("gaze", stroke(WAY)), ("console", NextTask()), ("console", TakeUpPath(0))], "console"),
        ([("gaze", stroke(WAY)), ("console", MovePathPoint(floats([500, 450]), floats([500, 500])))], "console"),
        ([("gaze", stroke(WAY)), ("console", Pick(2))], "gaze"),
        ([("console", LoadScenario(text=WITH_PATH, name="path.yaml"))], ""),
        ([("gaze", stroke(WAY)), ("console", LoadScenario(text="version: 9", name="refused.yaml"))], "gaze"),
    ],
)
def test_a_path_is_the_channel_s_that_gave_it_its_course(
    said: list[tuple[str, list[OperatorCommand] | OperatorCommand]], path: str
) -> None:
    assert attribution_of(edited_run(), *said).path == path


def test_a_clutch_is_the_channel_s_that_closed_it() -> None:
    run = edited_run()
    assert attribution_of(run, ("emg", Clutch(closed=True)), ("gaze", Pick(1))).clutch == "emg"
    assert attribution_of(run, ("emg", Clutch(closed=True)), ("emg", Clutch(closed=False))).clutch == ""


def test_priorities_stay_those_of_their_channel_when_rows_are_renumbered_and_come_back() -> None:
    run = edited_run()
    attribution = attribution_of(
        run, ("gaze", Prioritise(fires=(1,), robot=2)), ("console", DeleteEntity("fire", 0)),
        ("console", DeleteEntity("robot", 0)), ("console", Undo()),
    )  # fmt: skip
    assert attribution.priorities == {(2.0, 0.0, 8.0): "gaze"}
    assert (attribution.robots("gaze"), attribution.robots("console")) == ([2], [])


def test_a_priority_that_another_channel_gives_again_is_that_channel_s() -> None:
    run = edited_run()
    again = attribution_of(run, ("gaze", Prioritise((0,), 1)), ("bci", Prioritise((0,), 1)))
    assert (again.robots("gaze"), again.robots("bci")) == ([], [1])
    run = edited_run()
    circled: list[OperatorCommand] = [StrokeBegin(), StrokePoints(CIRCLE), StrokeEnd(use=StrokeUse.PRIORITY)]
    mixed = attribution_of(run, ("gaze", Prioritise((0,), 0)), ("gaze", Prioritise((0,), 1)), ("console", circled))
    assert (mixed.robots("gaze"), mixed.robots("console")) == ([1], [0])
