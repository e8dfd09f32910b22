"""Recordings: the scenario's text, the seed and every command with its tick are enough to repeat a session.

The polygons traced from the masks of the scenario, and of those loaded during the run, are recorded too, so that a
replay needs no image.

JSON lines: a header; `{"tick": 120, "command": "Pick", ...}` for each command; `{"mark": 150, "digest": ...}` each
second of session time; at the end a mark with `"end": true`. The digest is that of `run.TrajectoryDigest`. Numbers that
JSON does not have are written as {"number": "inf"}; null in an array is NaN. The header has the calibration of each
input that has one; `{"tick": 90, "calibration": "gaze", ...}` reports a new one. A replay needs neither: the points of
commands are on the ground already.

Version 0.1 wrote the same format with other names of some commands, which are still read (`_RENAMED`).
"""

import dataclasses
import json
import math
import platform
import time
from collections.abc import Callable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple, get_args

import numpy as np

from higvf_console.core.arguments import instance
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import Command, LoadScenario, OperatorCommand
from higvf_console.core.errors import InputError
from higvf_console.core.interface import current_channel, renamed_channel
from higvf_console.core.reading.node import Node
from higvf_console.core.reports import CalibrationReport
from higvf_console.core.state import Motion
from higvf_console.runtime.compiling import announce
from higvf_console.runtime.interrupts import held_back
from higvf_console.runtime.run import Run, Tick, TrajectoryDigest
from higvf_console.scenario.scenario import Scenario, parse_scenario
from higvf_console.scenario.sections import read_forms

FORMAT = 1
NONE_MEASURED: Mapping[str, CalibrationReport] = {}
_FLUSH_EVERY = 1.0  # [s] of wall clock: what a crash can lose
_KINDS: dict[str, type[Command]] = {kind.__name__: kind for kind in get_args(OperatorCommand)}
_ARRAYS = {"points": (-1, 2), "point": (2,), "grip": (2,), "sides": (4,)}  # fields that hold arrays, and their shapes
_CHAINS = ("outlines", "polygons")  # fields that hold tuples of arrays (n, 2)
_NUMBER = "number"
_RENAMED = {
    "Stop": "EmergencyStop", "ResetStop": "ResetEmergencyStop", "BendPath": "MovePathPoint", "AddThing": "AddEntity",
    "MoveThing": "MoveEntity", "ChangeThing": "ChangeEntity", "DeleteThing": "DeleteEntity",
}  # fmt: skip
_OF_ENTITIES = ("AddEntity", "MoveEntity", "ChangeEntity", "DeleteEntity")  # their `kind` was `thing`
_RENAMED_USES = {"amend": "redraw"}  # of StrokeEnd


class Recorder:
    """Writes a recording while a session runs."""

    def __init__(
        self,
        file: str | Path,
        scenario: Scenario,
        seed: int,
        calibrations: Mapping[str, CalibrationReport] = NONE_MEASURED,
    ) -> None:
        """Opens the file and writes the header.

        Args:
            file: where to.
            scenario: what is run.
            seed: of its start positions.
            calibrations: in use, by input.

        Raises:
            InputError: the file cannot be written.
        """
        file = Path(instance("file", file, str, Path))
        instance("scenario", scenario, Scenario)
        try:
            self._file = file.open("w", encoding="utf-8")
        except OSError as error:
            raise InputError(f"{file}: cannot be written: {error.strerror}") from error
        self._ticks = 0
        self._digest = TrajectoryDigest()
        self._mark_every = max(1, round(1.0 / scenario.params.safety.control_period))
        self._flushed = time.monotonic()
        header = {"recording": FORMAT, "scenario": scenario.name, "source": scenario.source, "seed": seed}
        forms = scenario.params.forms.words()
        polygons = [chain.tolist() for chain in scenario.obstacles.polygons]
        measured = {name: report._asdict() for name, report in calibrations.items()}
        self._write({**header, "forms": forms, "versions": versions(), "calibrations": measured,
                     "text": scenario.text, "polygons": polygons})  # fmt: skip

    def command(self, command: OperatorCommand, scenario: Scenario | None = None) -> None:
        """A command was applied before the next tick.

        Args:
            command: what was applied.
            scenario: in force from then on; it keeps what the images of a loaded one came to.
        """
        if isinstance(command, LoadScenario) and scenario is not None:
            command = dataclasses.replace(command, polygons=scenario.obstacles.polygons)
        fields = {field.name: _plain(getattr(command, field.name)) for field in dataclasses.fields(command)}
        self._write({"tick": self._ticks, "command": type(command).__name__, **fields})

    def calibration(self, channel: str, report: CalibrationReport) -> None:
        """An input has a new calibration."""
        self._write({"tick": self._ticks, "calibration": channel, **report._asdict()})

    def step(self, motion: Motion) -> None:
        """A tick was done."""
        self._ticks += 1
        self._digest.add(motion)
        if self._ticks % self._mark_every == 0:
            self._write({"mark": self._ticks, "digest": self._digest.hex()})
        if time.monotonic() - self._flushed > _FLUSH_EVERY:
            self._file.flush()
            self._flushed = time.monotonic()

    def close(self) -> None:
        """Writes the end; may be called twice."""
        if not self._file.closed:
            self._write({"mark": self._ticks, "digest": self._digest.hex(), "end": True})
            self._file.close()

    def _write(self, line: dict[str, Any]) -> None:
        self._file.write(json.dumps(line) + "\n")


def versions() -> dict[str, str]:
    """Versions of what decides the last bit of a trajectory."""
    names = ("higvf-console", "numba", "numpy", "scipy")
    return {"python": platform.python_version(), **{name: version(name) for name in names}}


def _plain(value: Any) -> Any:
    """A field's value as JSON has it."""
    match value:
        case np.ndarray():
            array: Floats = value
            return [None if np.isnan(number) else _plain(number) for number in array.ravel().tolist()]
        case tuple() | list():
            return [_plain(item) for item in value]
        case Mapping():
            return {name: _plain(item) for name, item in value.items()}
        case np.generic():
            return _plain(value.item())
        case float() if not math.isfinite(value):
            return {_NUMBER: str(value)}
        case _:
            return value


def _given(name: str, value: Any) -> Any:
    """The value of a field as it was given."""
    value = _numbers(value)
    if name in _ARRAYS:
        return floats(value, *_ARRAYS[name])
    if name in _CHAINS and value is not None:
        return tuple(floats(chain, -1, 2) for chain in value)
    return tuple(value) if isinstance(value, list) else value


def _numbers(value: Any) -> Any:
    """The same, with the numbers that JSON does not have."""
    if isinstance(value, dict):
        content: dict[str, Any] = value
        return float(content[_NUMBER]) if set(content) == {_NUMBER} else {k: _numbers(v) for k, v in content.items()}
    return [_numbers(item) for item in value] if isinstance(value, list) else value


class Mark(NamedTuple):
    """The digest after so many ticks."""

    ticks: int
    digest: str


class Recording(NamedTuple):
    """A recording, as far as it could be read.

    Attributes:
        scenario: what was run.
        seed: of its start positions.
        versions: of the console that recorded it.
        commands: by the tick before which they were applied.
        marks: digests on the way.
        complete: whether the recording has its end.
        warnings: what was read otherwise than it is written.
    """

    scenario: Scenario
    seed: int
    versions: dict[str, str]
    commands: dict[int, list[OperatorCommand]]
    marks: list[Mark]
    complete: bool
    warnings: tuple[str, ...] = ()


class Replay(NamedTuple):
    """The result of repeating a recording.

    Attributes:
        ticks: control periods run.
        digest: of this run.
        expected: digest of the recording after as many ticks; None when it was cut before its first mark.
        differs_after: ticks up to which both agreed, when they do not; else None.
        complete: whether the recording has its end.
        changed_versions: "numpy 2.3.0 -> 2.4.6" and the like.
    """

    ticks: int
    digest: str
    expected: str | None
    differs_after: int | None
    complete: bool
    changed_versions: tuple[str, ...]

    @property
    def agrees(self) -> bool:
        """Whether every digest of the recording was met."""
        return self.differs_after is None and self.expected is not None


def read_recording(file: str | Path) -> Recording:
    """Reads a recording up to its end, or up to the line that was cut off.

    Args:
        file: written by a `Recorder`.

    Raises:
        InputError: not a recording, of an unknown format, or damaged in the middle.
    """
    file = Path(instance("file", file, str, Path))
    try:
        lines = file.read_text(encoding="utf-8", errors="replace").split("\n")
    except OSError as error:
        raise InputError(f"{file}: {error.strerror}") from error
    header = _parsed(lines[0])
    if header is None or "recording" not in header:
        raise InputError(f"{file}: not a recording: its first line is not a header")
    if header["recording"] != FORMAT:
        raise InputError(f"{file}: recording format {header['recording']!r} is not known; known formats: {FORMAT}")
    missing = [name for name in ("text", "source", "seed", "versions") if name not in header]
    if missing:
        raise InputError(f"{file}: the header of the recording has no '{missing[0]}'")
    polygons = tuple(floats(chain, -1, 2) for chain in header["polygons"]) if "polygons" in header else None
    scenario = parse_scenario(header["text"], header["source"], polygons)
    if "forms" in header:
        scenario = scenario.with_forms(read_forms(Node(header["forms"], str(file), "forms", InputError)))
    recording = Recording(scenario, header["seed"], header["versions"], {}, [], False)
    renamed: dict[str, str] = {}  # warnings by the name that they are about
    for number, line in enumerate(lines[1:-1], 2):
        entry = _parsed(line)
        if entry is None or not (_marks(entry) or isinstance(entry.get("tick"), int)):
            raise InputError(f"{file}: line {number} is damaged: {line[:60]!r}")
        if "mark" in entry:
            recording.marks.append(Mark(entry["mark"], entry["digest"]))
            recording = recording._replace(complete="end" in entry)
        elif "calibration" not in entry:
            renamed |= _rename(entry)
            recording.commands.setdefault(entry["tick"], []).append(_command(entry, f"{file}: line {number}"))
    return recording._replace(warnings=tuple(f"{file}: {warning}" for warning in renamed.values()))


def _rename(entry: dict[str, Any]) -> dict[str, str]:
    """Gives the channels of a command their present names; the warnings, by the former name."""
    given = {field: entry[field] for field in ("source", "channel") if isinstance(entry.get(field), str)}
    entry |= {field: current_channel(name) for field, name in given.items()}
    return {name: warning for name in given.values() if (warning := renamed_channel(name))}


def _marks(entry: dict[str, Any]) -> bool:
    return isinstance(entry.get("mark"), int) and isinstance(entry.get("digest"), str)


def _parsed(line: str) -> dict[str, Any] | None:
    try:
        entry = json.loads(line)
    except ValueError:
        return None
    return entry if isinstance(entry, dict) else None


def _command(entry: dict[str, Any], place: str) -> OperatorCommand:
    try:
        name, fields = _current(entry)
        return _KINDS[name](**fields)  # pyright: ignore[reportReturnType] (the members of the union)
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{place}: not a command that this console knows: {error}") from error


def _current(entry: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """A command's name and fields, by their present names."""
    command: str = entry["command"]
    name = _RENAMED.get(command, command)
    fields = {key: _given(key, value) for key, value in entry.items() if key not in ("tick", "command")}
    if name in _OF_ENTITIES and "thing" in fields:
        fields["kind"] = fields.pop("thing")
    if name == "StrokeEnd" and "use" in fields:
        fields["use"] = _RENAMED_USES.get(fields["use"], fields["use"])
    return name, fields


def replay(recording: Recording, each: Callable[[Tick], object] | None = None) -> Replay:
    """Repeats a recording as far as it goes, and compares the digests.

    Args:
        recording: from `read_recording`.
        each: called after every control period.

    Raises:
        ArgumentTypeError: no recording.
    """
    instance("recording", recording, Recording)
    announce()
    run = Run(recording.scenario.setup(recording.seed), recording.scenario.filter, recording.scenario)
    digest = TrajectoryDigest()
    expected = {mark.ticks: mark.digest for mark in recording.marks}
    last = max([*expected, *recording.commands, 0])
    agreed, differs_after = 0, None
    with held_back() as give_interrupt:
        for tick in range(1, last + 1):
            give_interrupt()
            for command in recording.commands.get(tick - 1, ()):
                run.apply(command)
            run.step()
            digest.add(run.state.motion)
            if each is not None:
                each(Tick(run.time, run.state, run.trace, run.setup))
            if tick in expected and differs_after is None:
                if digest.hex() != expected[tick]:
                    differs_after = agreed
                agreed = tick
    here = versions()
    changed = [f"{name} {old} -> {here.get(name)}" for name, old in recording.versions.items() if here.get(name) != old]
    final = recording.marks[-1].digest if recording.marks else None
    return Replay(last, digest.hex(), final, differs_after, recording.complete, tuple(changed))
