"""Damaged recordings: whatever a line holds, it is read, or refused in one line, and no replay runs without end."""

import json
import random
from pathlib import Path
from typing import Any

import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.commands import (
    Cursor,
    LoadScenario,
    MovePathPoint,
    OperatorCommand,
    Pause,
    Pick,
    Prioritise,
    Resume,
    ShapePath,
)
from higvf_console.core.edits import AddEntity, AddOutlines, ChangeEntity, SetArena, SetParameters, ToggleLink
from higvf_console.core.errors import HigvfError, InputError
from higvf_console.runtime.recording import Recorder, read_recording, replay
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import parse_scenario
from tests.teams import stroke

MUTATIONS = 300
SMALL = """
version: 1
name: small
arena: {size_m: [400, 300]}
robots: {start_m: [[100, 150], [60, 150]]}
fires: [{at_m: [300, 150], radius_m: 20}]
obstacles: {polygons: [{points_m: [[180, 40], [220, 40], [220, 70]]}]}
parameters: {safety: {control_period: 0.1, speed_limit: 30, obstacle_gain: 2, pair_gain: 2}}
duration_s: 2
"""
COMMANDS: list[OperatorCommand] = [
    Cursor(floats([10.0, float("nan")])),
    *stroke([(120.0, 150.0), (200.0, 200.0), (320.0, 240.0)], robot=0),
    MovePathPoint(floats([200.0, 200.0]), floats([210.0, 220.0])),
    ShapePath(pace=0.7, ending="hold"),
    Pick(1),
    Prioritise((0,), 1, 3.0),
    AddEntity("circle", floats([250.0, 60.0])),
    AddOutlines((floats([[300.0, 20.0], [340.0, 20.0], [320.0, 50.0]]),)),
    ChangeEntity("fire", 0, "radius", 25.0),
    SetParameters({"path.capture_distance": 30.0}),
    SetArena(floats([0.0, 0.0, 420.0, 300.0]), walls=True),
    ToggleLink(0, 1),
    Pause(),
    Resume(),
    LoadScenario(SMALL, "again.yaml"),
]


@pytest.fixture(scope="module")
def lines(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The lines of a recording of two seconds that has a command of most kinds."""
    file = tmp_path_factory.mktemp("small") / "run.jsonl"
    scenario = parse_scenario(SMALL, "small.yaml")
    run, recorder = Run(scenario.setup(0), scenario.filter, scenario), Recorder(file, scenario, 0)
    for tick in range(20):
        for command in COMMANDS[tick : tick + 1]:
            run.apply(command)
            recorder.command(command, run.scenario)
        run.step()
        recorder.step(run.state.motion)
    recorder.close()
    assert replay(read_recording(file)).agrees
    return file.read_text(encoding="utf-8").splitlines()


ODD: list[Any] = [
    None, True, -1, 0, 1, 7, 999_999_999, 10**400, -0.5, 1e308, float("nan"), float("inf"), "", "word", "7", [], [[]],
    [1, "a"], [None], {}, {"number": "inf"}, {"number": "x"}, {"number": 3}, {"a": {}}, [[0, 0], [1, 1]], "\ud800",
]  # fmt: skip


def mutated(lines: list[str], rng: random.Random) -> list[str]:
    """The lines with one thing changed: a value, a key, a character, a line."""
    lines = list(lines)
    number = rng.choice([0, rng.randrange(len(lines)), rng.randrange(len(lines))])
    entry = json.loads(lines[number])
    key = rng.choice(list(entry))
    match rng.randrange(8):
        case 0 | 1 | 2:
            entry[key] = rng.choice(ODD)
            lines[number] = json.dumps(entry)
        case 3:
            del entry[key]
            lines[number] = json.dumps(entry)
        case 4:
            entry[rng.choice([*entry, "tick", "mark", "command", "other", ""])] = entry.pop(key)
            lines[number] = json.dumps(entry)
        case 5:
            at = rng.randrange(len(lines[number]))
            lines[number] = lines[number][:at] + rng.choice('"{}[],:0x-\x00é') + lines[number][at + rng.randrange(3) :]
        case 6:
            lines[number] = rng.choice(["", "[]", "null", "7", '{"tick": 3}', "[" * 5000, lines[-1], lines[0]])
        case _:
            other = rng.randrange(len(lines))
            lines[number], lines[other] = lines[other], lines[number]
    return lines


def test_hundreds_of_damaged_recordings_are_read_or_refused_in_one_line(lines: list[str], tmp_path: Path) -> None:
    rng, refused, file = random.Random(13), 0, tmp_path / "damaged.jsonl"
    for _ in range(MUTATIONS):
        text = "\n".join([*mutated(lines, rng), ""])
        file.write_text(text, encoding="utf-8", errors="surrogatepass")
        try:
            assert replay(read_recording(file)).ticks <= 30
        except HigvfError as error:
            refused += 1
            assert "\n" not in str(error)
            assert len(str(error)) < 500
    assert refused > MUTATIONS // 3


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('{"tick": 5', '{"tick": 999999999', r"line \d+ is damaged: tick 999999999 after a mark at 0; a mark follows"),
        ('{"tick": 5', '{"tick": -5', r"line \d+ is damaged"),
        ('{"tick": 5', '{"tick": true', r"line \d+ is damaged"),
        ('{"mark": 20', '{"mark": 999999999', "a mark follows every 10"),
        ('{"mark": 20', '{"mark": 5', "tick 5 after a mark at 10"),
        ('"seed": 0', '"seed": -1', "seed in the header is -1; expected a whole number from 0"),
        ('"seed": 0', '"seed": "x"', "seed in the header is 'x'; expected a whole number from 0"),
        ('"versions": {', '"versions": [], "were": {', r"versions in the header is \[\]; expected versions by name"),
        ('"source": "small.yaml"', '"source": 4', "source in the header is 4; expected text"),
        ('"polygons": [[[180.0', '"polygons": [[["x"', r"polygons\[1\]"),
        ('"factor": 3.0', '"factor": "3.0"', "factor is '3.0'; expected a number"),
        ('"fires": [0]', '"fires": [0.5]', r"fires is \[0.5\]; expected a list of whole numbers"),
        ('"point": [250.0, 60.0]', '"point": [250.0]', r"point is \[250.0\]; expected an array of numbers"),
        ('"use": "path"', '"use": "pth"', r"line \d+: not a command .*: StrokeEnd.use: 'pth' is not one of path"),
        ('"pace": 0.7', '"speed": 0.7', "ShapePath has no field 'speed'; it has time, source"),
    ],
)
def test_an_odd_value_is_refused_with_its_place(
    lines: list[str], tmp_path: Path, old: str, new: str, sentence: str
) -> None:
    text = "\n".join([*lines, ""])
    assert old in text
    (tmp_path / "odd.jsonl").write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match=sentence):
        read_recording(tmp_path / "odd.jsonl")
