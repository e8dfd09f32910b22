"""A recording holds enough to run the session again, bit for bit, also when it was cut off."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, get_args, get_type_hints

import cv2
import numpy as np
import pytest

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import (
    Clutch,
    Confirm,
    ControlChange,
    Cursor,
    Discard,
    Freeze,
    HandOver,
    InjectFault,
    LoadScenario,
    MovePathPoint,
    OperatorCommand,
    Pause,
    Pick,
    Prioritise,
    ProposePick,
    Redo,
    ResetRun,
    Resume,
    ShapePath,
    Step,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
    Undo,
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
from higvf_console.core.errors import InputError
from higvf_console.runtime.headless import run_headless
from higvf_console.runtime.recording import Recorder, read_recording, replay
from higvf_console.runtime.run import Run
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import Scenario, parse_scenario
from tests.fake_interfaces import FakeConsole, FakeInterface
from tests.teams import stroke

STROKE = np.array([[650.1, 250.0], [500.0, 400.0], [400.0, 1.0 / 3.0], [300.0, 300.0]])
PLAN: list[tuple[float, OperatorCommand]] = [
    (0.2, Cursor(np.array([np.nan, np.nan]), source="gaze")),
    (0.22, ProposePick(1, 3.0, source="bci", confidence=0.5)),
    (0.24, StrokeBegin(source="gaze")),
    (0.24, StrokePoints(STROKE[::-1], source="gaze")),
    (0.26, StrokeEnd(source="gaze", preview=True)),
    (0.40, Confirm(source="emg")),
    (0.42, Discard(source="emg")),
    (0.5, StrokeBegin(source="gaze")),
    (0.5, StrokePoints(STROKE[:2], source="gaze")),
    (0.7, Clutch(closed=True, source="emg", confidence=0.75)),
    (0.9, StrokePoints(STROKE[2:], source="gaze", sequence=7)),
    (1.0, StrokeEnd(smoothing=2.0, robot=1, source="gaze")),
    (1.5, Pause(source="emg")),
    (1.7, Resume(source="emg")),
    (1.9, HandOver("Browser 2", ControlChange.TAKEN, operator="Browser 2")),
    (2.0, Pick(2, source="bci", operator="ada")),
]


def recorded(scenario: Scenario, file: Path, *plan: tuple[float, OperatorCommand], duration: float = 4.3) -> str:
    """Runs and records; the digest of the run."""
    session = Session(scenario, [FakeInterface("plan", *plan)], seed=5, recorder=Recorder(file, scenario, 5))
    report = run_headless(session, duration)
    session.close()
    return report["digest"]


def test_a_replay_agrees_with_the_run_that_was_recorded(team: Scenario, tmp_path: Path) -> None:
    digest = recorded(team, tmp_path / "run.jsonl", *PLAN)
    result = replay(read_recording(tmp_path / "run.jsonl"))
    assert (result.digest, result.expected, result.ticks) == (digest, digest, 215)
    assert result.agrees
    assert result.complete
    assert result.changed_versions == ()


def test_a_recording_is_strict_json(team: Scenario, tmp_path: Path) -> None:
    recorded(team, tmp_path / "run.jsonl", *PLAN)

    def refuse(constant: str) -> None:
        raise ValueError(constant)

    for line in (tmp_path / "run.jsonl").read_text().splitlines():
        json.loads(line, parse_constant=refuse)


def test_every_command_is_read_back_as_it_was_given(team: Scenario, tmp_path: Path) -> None:
    recorded(team, tmp_path / "run.jsonl", *PLAN)
    recording = read_recording(tmp_path / "run.jsonl")
    for time, given in PLAN:
        same = [command for command in recording.commands[round(time / 0.02)] if type(command) is type(given)]
        for name, value in vars(given).items():
            np.testing.assert_array_equal(getattr(same[0], name), value)


def test_a_reset_and_a_frozen_clock_replay_too(team: Scenario, tmp_path: Path) -> None:
    plan: list[tuple[float, OperatorCommand]] = [(1.0, ResetRun()), (0.6, Pick(1)), (0.4, Freeze(frozen=True))]
    session = Session(team, console := [FakeConsole(*plan)], 5, Recorder(tmp_path / "run.jsonl", team, 5))
    for tick in range(200):
        if tick in (30, 40):
            console[0].push(Step())
        if tick == 50:
            console[0].push(Freeze(frozen=False))
        session.tick()
    session.close()
    result = replay(read_recording(tmp_path / "run.jsonl"))
    assert result.ticks == session.ticks
    assert result.agrees


def test_a_recording_that_was_cut_off_replays_up_to_there(team: Scenario, tmp_path: Path) -> None:
    recorded(team, tmp_path / "run.jsonl", *PLAN)
    whole = (tmp_path / "run.jsonl").read_text()
    third_mark = whole.index('{"mark": 150')
    (tmp_path / "cut.jsonl").write_text(whole[: third_mark + 30])
    result = replay(read_recording(tmp_path / "cut.jsonl"))
    assert not result.complete
    assert result.agrees
    assert result.ticks == 100


def test_a_changed_command_is_noticed_and_where(team: Scenario, tmp_path: Path) -> None:
    recorded(team, tmp_path / "run.jsonl", *PLAN)
    whole = (tmp_path / "run.jsonl").read_text()
    (tmp_path / "forged.jsonl").write_text(whole.replace('"robot": 2', '"robot": 0'))
    result = replay(read_recording(tmp_path / "forged.jsonl"))
    assert not result.agrees
    assert result.differs_after == 100


def test_a_recording_cut_before_its_first_digest_agrees_with_nothing(team: Scenario, tmp_path: Path) -> None:
    recorded(team, tmp_path / "run.jsonl", *PLAN)
    header = (tmp_path / "run.jsonl").read_text().split("\n")[0]
    (tmp_path / "cut.jsonl").write_text(header + "\n")
    result = replay(read_recording(tmp_path / "cut.jsonl"))
    assert (result.ticks, result.agrees, result.expected) == (0, False, None)


def test_other_versions_are_named(team: Scenario, tmp_path: Path) -> None:
    recorded(team, tmp_path / "run.jsonl")
    header, _, rest = (tmp_path / "run.jsonl").read_text().partition("\n")
    changed = json.loads(header)
    changed["versions"]["numpy"] = "1.0"
    (tmp_path / "old.jsonl").write_text(json.dumps(changed) + "\n" + rest)
    (change,) = replay(read_recording(tmp_path / "old.jsonl")).changed_versions
    assert change == f"numpy 1.0 -> {np.__version__}"


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('{"recording": 1', '{"recording": 2', "recording format 2 is not known; known formats: 1"),
        ('"seed": 5', '"sede": 5', "the header of the recording has no 'seed'"),
        ('"formation": "corrected"', '"formation": "new"', "forms.formation: 'new' is not one of corrected"),
        ('{"mark": 50', '{"mark": 50 oops', r"line \d+ is damaged"),
        ('{"mark": 50', '{"foo": 50', r"line \d+ is damaged"),
        ('{"mark": 50', '{"mark": "50"', r"line \d+ is damaged"),
        ('"command": "Pick"', '"command": "Jump"', r"line \d+: not a command that this console knows: .*'Jump'"),
        ('"robot": 2', '"robots": 2', r"line \d+: not a command that this console knows: .*robots"),
    ],
)
def test_a_damaged_recording_is_refused_with_the_line(
    team: Scenario, tmp_path: Path, old: str, new: str, sentence: str
) -> None:
    recorded(team, tmp_path / "run.jsonl", *PLAN)
    whole = (tmp_path / "run.jsonl").read_text()
    assert old in whole
    (tmp_path / "damaged.jsonl").write_text(whole.replace(old, new))
    with pytest.raises(InputError, match=sentence):
        read_recording(tmp_path / "damaged.jsonl")


def test_files_that_cannot_be_opened_are_input_errors(team: Scenario, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.jsonl: No such file"):
        read_recording(tmp_path / "none.jsonl")
    with pytest.raises(InputError, match="cannot be written: Is a directory"):
        Recorder(tmp_path, team, 0)


def test_a_full_disk_ends_the_recording_and_not_the_run(
    team: Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recorder = Recorder(tmp_path / "run.jsonl", team, 0)

    def full(_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(recorder, "step", full)
    session = Session(team, [], recorder=recorder)
    for _ in range(5):
        session.tick()
    assert session.ticks == 5
    alarms = [event.text for event in session.snapshot.events if event.kind == "recording"]
    assert alarms == ["The recording ends here: No space left on device."]


def test_what_is_commanded_while_the_clock_stands_reaches_the_file(
    team: Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("higvf_console.runtime.recording.recorder._FLUSH_EVERY", -1.0)  # each beat is late enough
    file = tmp_path / "run.jsonl"
    console = FakeConsole((0.0, Freeze(frozen=True)))
    session = Session(team, [console], recorder=Recorder(file, team, 0))
    session.tick()
    for robot in (1, 2, 0):
        console.push(Pick(robot))
        session.tick()
    assert session.ticks <= 1
    assert file.read_text().count('"command": "Pick"') == 3  # as a killed process leaves it


def test_a_recording_is_never_overwritten(team: Scenario, tmp_path: Path) -> None:
    file = tmp_path / "run.jsonl"
    file.touch()
    Recorder(file, team, 0).close()  # an empty file holds nothing
    (tmp_path / "run-2.jsonl").touch()
    before = file.read_text()
    with pytest.raises(InputError, match=r"run\.jsonl: exists already.*: give a new name, such as .*run-3\.jsonl, or"):
        Recorder(file, team, 0)
    assert file.read_text() == before


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_a_disk_that_fills_is_told_once_and_not_tried_again(team: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("higvf_console.runtime.recording.recorder._FLUSH_EVERY", -1.0)
    recorder = Recorder("/dev/full", team, 0)
    session = Session(team, [], recorder=recorder)
    for _ in range(3):
        session.tick()
    recorder.close()
    session.close()
    alarms = [event.text for event in session.snapshot.events if event.kind == "recording"]
    assert alarms == ["The recording ends here: No space left on device."]


FORMER = {
    '"AddThing"': '"AddEntity"', '"MoveThing"': '"MoveEntity"', '"ChangeThing"': '"ChangeEntity"',
    '"DeleteThing"': '"DeleteEntity"', '"BendPath"': '"MovePathPoint"', '"Stop"': '"EmergencyStop"',
    '"ResetStop"': '"ResetEmergencyStop"', '"thing"': '"kind"', '"amend"': '"redraw"',
}  # fmt: skip


def test_a_recording_of_version_0_1_replays_as_with_the_names_of_today(tmp_path: Path) -> None:
    old = Path(__file__).parent / "recording_of_version_0_1.jsonl"
    text = old.read_text(encoding="utf-8")
    for former, name in FORMER.items():
        assert former in text
        text = text.replace(former, name)
    (tmp_path / "new.jsonl").write_text(text, encoding="utf-8")
    first, second = read_recording(old), read_recording(tmp_path / "new.jsonl")
    assert [type(command).__name__ for tick in sorted(first.commands) for command in first.commands[tick]] == [
        "AddEntity", "StrokeBegin", "StrokePoints", "StrokeEnd", "MovePathPoint", "StrokeBegin", "StrokePoints",
        "StrokeEnd", "MoveEntity", "ChangeEntity", "EmergencyStop", "AskReset", "ResetEmergencyStop", "Resume",
        "SetParameters", "DeleteEntity",
    ]  # fmt: skip
    assert replay(first).digest == replay(second).digest
    assert [warning.partition(": ")[2] for warning in first.scenario.warnings] == [
        "parameters.rings: renamed; write parameters.boundaries",
        "parameters.path.patience: renamed; write parameters.path.progress_timeout",
    ]


def test_every_command_of_the_recording_of_version_0_1_is_obeyed() -> None:
    recording = read_recording(Path(__file__).parent / "recording_of_version_0_1.jsonl")
    run = Run(recording.scenario.setup(recording.seed), recording.scenario.filter, recording.scenario)
    said: list[str] = []
    for tick in range(130):
        for command in recording.commands.get(tick, ()):
            assert isinstance(command, OperatorCommand)
            said += [f"{event.kind}: {event.text}" for event in run.apply(command)]
        run.step()
    assert not [text for text in said if text.startswith("refused")]
    assert "edited: safety.pair_gain is 2 1/s. safety.pair_rate is renamed; write safety.pair_gain." in said


OUTLINE = floats([[100.0, 500.0], [200.0, 500.0], [150.0, 600.0 + 1.0 / 3.0]])
ACTIONS: list[tuple[float, OperatorCommand]] = [
    (0.2, AddEntity("robot", floats([300.0, 600.0]), source="plan")),
    (0.2, AddOutlines((OUTLINE, OUTLINE + 150.0), source="plan")),
    (0.4, MoveEntity("robot", 1, floats([900.0, 1.0 / 3.0 + 100.0]), source="plan")),
    (0.6, ToggleLink(0, 1, source="plan")),
    (0.6, SetParameters({"perception.perception_range": math.inf, "blending.cruise_speed": 70.1}, source="plan")),
    (0.8, Prioritise(fires=(0,), robot=1, factor=3.0, source="plan")),
    *((0.8, part) for part in stroke([(700.0, 300.0), (500.0, 450.0), (200.0, 500.0)])[:2]),
    (0.8, StrokeEnd(ending="hold", pace=0.7, duration=math.inf)),
    (1.2, MovePathPoint(floats([500.0, 450.0]), floats([520.0, 480.0]))),
    (1.4, Undo()),
    (1.5, ShapePath(closed=True)),
    (1.6, DeleteEntity("robot", 0)),
    (1.8, Undo()),
    (1.8, Undo()),
    (2.0, Redo()),
    (2.0, SetArena(floats([-10.0, 0.0, 1300.0, 700.0]), walls=False)),
    (2.2, LinkByRange()),
    (2.4, ChangeEntity("fire", 0, "radius", 40.0)),
]


def test_edits_undo_and_redo_replay_bit_for_bit_and_are_read_back_as_given(team: Scenario, tmp_path: Path) -> None:
    digest = recorded(team, tmp_path / "run.jsonl", *ACTIONS)
    recording = read_recording(tmp_path / "run.jsonl")
    result = replay(recording)
    assert (result.digest, result.agrees) == (digest, True)
    given = [command for _, command in ACTIONS]
    read = [command for tick in sorted(recording.commands) for command in recording.commands[tick]]
    assert len(read) == len(given)
    for one, other in zip(given, read, strict=True):
        assert type(one) is type(other)
        for name, value in vars(one).items():
            np.testing.assert_equal(getattr(other, name), value)


SAMPLES: dict[object, object] = {
    str: "word", int: 1, float: 0.5, bool: True, Floats: floats([[1.0, 2.0], [math.nan, math.inf]]),
    tuple[Floats, ...]: (OUTLINE,), tuple[int, ...]: (1, 0), Mapping[str, float]: {"a.b": math.inf},
}  # fmt: skip
SHAPED = {"point": floats([1.0, -math.inf]), "grip": floats([1.0, 2.0]), "sides": floats([0.0, 1.0, 2.0, 3.0])}


WORDS: dict[tuple[type, str], str] = {
    (StrokeEnd, "use"): "redraw", (StrokeEnd, "ending"): "hold", (ShapePath, "ending"): "loop",
    (InjectFault, "kind"): "drop", (HandOver, "how"): "taken", (AddEntity, "kind"): "fire",
    (MoveEntity, "kind"): "bar", (ChangeEntity, "kind"): "circle", (DeleteEntity, "kind"): "polygon",
}  # fmt: skip


def sample_of(kind: type[OperatorCommand]) -> OperatorCommand:
    """A command of a kind, with something in each field."""
    fields: dict[str, object] = {}
    for name, hint in get_type_hints(kind).items():
        wanted = get_args(hint)[0] if type(None) in get_args(hint) else hint
        fields[name] = WORDS.get((kind, name), SHAPED.get(name, SAMPLES[wanted]))
    return kind(**fields)  # pyright: ignore[reportArgumentType]


def test_every_command_can_be_recorded_and_read(team: Scenario, tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "run.jsonl", team, 0)
    given = [sample_of(kind) for kind in get_args(OperatorCommand)]
    for command in given:
        recorder.command(command)
    recorder.close()
    for one, other in zip(given, read_recording(tmp_path / "run.jsonl").commands[0], strict=True):
        assert type(one) is type(other)
        for name, value in vars(one).items():
            np.testing.assert_equal(getattr(other, name), value)


MASKED = """
version: 1
name: masked
arena: {size_m: [1200, 700]}
robots: {start_m: [[150, 350], [105, 325], [105, 375]], jitter_m: 1}
fires: [{at_m: [620, 580], radius_m: 20}]
obstacles: {masks: [{image: plan.png, at_m: [300, 100], metres_per_pixel: 5}]}
"""


def test_a_loaded_scenario_replays_without_the_images_that_it_needed(team: Scenario, tmp_path: Path) -> None:
    folder = tmp_path / "plans"
    folder.mkdir()
    picture = np.full((40, 60), 255, np.uint8)
    picture[10:30, 20:40] = 0
    cv2.imwrite(str(folder / "plan.png"), picture)
    plan: list[tuple[float, OperatorCommand]] = [
        (0.4, LoadScenario(text=MASKED, name=str(folder / "masked.yaml"))),
        (0.6, LoadScenario(text=MASKED.replace("plan.png", "none.png"), name=str(folder / "none.yaml"))),
        (1.0, AddEntity("robot", floats([300.0, 600.0]))),
        (2.0, Undo()),
        (2.0, Undo()),
        (3.0, Redo()),
    ]
    digest = recorded(team, tmp_path / "run.jsonl", *plan)
    (folder / "plan.png").rename(folder / "none.png")
    result = replay(read_recording(tmp_path / "run.jsonl"))
    assert (result.digest, result.agrees) == (digest, True)


def test_a_load_that_was_refused_is_not_recorded_though_the_scenario_in_force_has_that_text(tmp_path: Path) -> None:
    picture = np.full((40, 60), 255, np.uint8)
    picture[10:30, 20:40] = 0
    cv2.imwrite(str(tmp_path / "plan.png"), picture)
    masked = parse_scenario(MASKED, str(tmp_path / "masked.yaml"))
    recorded(masked, tmp_path / "run.jsonl", (0.4, LoadScenario(text=MASKED, name="masked.yaml")))  # not its folder
    recording = read_recording(tmp_path / "run.jsonl")
    assert recording.commands == {}
    assert replay(recording).agrees


def test_a_command_that_cannot_be_written_ends_the_recording_and_not_the_run(team: Scenario, tmp_path: Path) -> None:
    odd: Any = {0}
    session = Session(
        team, [FakeInterface("bci", (0.1, Prioritise(fires=odd)))], recorder=Recorder(tmp_path / "run.jsonl", team, 0)
    )
    for _ in range(20):
        session.tick()
    assert len(session.snapshot.state.intent.priority) == 1
    assert any("The recording ends here" in event.text for event in session.snapshot.events)
    assert session.snapshot.time == pytest.approx(0.4)


def test_a_recording_with_a_channels_name_from_before_is_read_with_one_warning(team: Scenario, tmp_path: Path) -> None:
    file = tmp_path / "run.jsonl"
    drawn = stroke([(700.0, 300.0), (500.0, 450.0), (200.0, 500.0)])
    digest = recorded(team, file, *((0.2, command) for command in drawn))
    file.write_text(file.read_text().replace('"source": "console"', '"source": "mouse"'))
    recording = read_recording(file)
    assert recording.warnings == (f"{file}: channel 'mouse' is renamed; write 'console'",)
    assert {getattr(command, "source", "") for given in recording.commands.values() for command in given} == {"console"}
    assert (replay(recording).digest, replay(recording).agrees) == (digest, True)
