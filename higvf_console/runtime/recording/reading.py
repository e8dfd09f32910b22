"""Reads a recording: every line is checked, and a damaged one is refused with its number."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from higvf_console.core.arguments import brief, instance
from higvf_console.core.arrays import Floats
from higvf_console.core.commands import OperatorCommand
from higvf_console.core.errors import InputError
from higvf_console.core.interface import current_channel, renamed_channel
from higvf_console.core.reading.node import Node
from higvf_console.runtime.recording import command_fields, team_lines
from higvf_console.runtime.recording.recorder import FORMAT, mark_every
from higvf_console.scenario.scenario import Scenario, parse_scenario
from higvf_console.scenario.sections import read_forms
from higvf_console.team.state import TeamReport
from higvf_console.team.tracking import Rules


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
        commands: by the tick before which they were applied; between them what a team told, in order.
        marks: digests on the way.
        complete: whether the recording has its end.
        warnings: what was read otherwise than it is written.
        rules: of the team that drove; None = the robots were integrated.
    """

    scenario: Scenario
    seed: int
    versions: dict[str, str]
    commands: dict[int, list[OperatorCommand | TeamReport]]
    marks: list[Mark]
    complete: bool
    warnings: tuple[str, ...] = ()
    rules: Rules | None = None


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
    recording = _begun(header, file)
    renamed: dict[str, str] = {}  # warnings by the name that they are about
    every, marked = mark_every(recording.scenario), 0
    for number, line in enumerate(lines[1:-1], 2):
        place, entry = f"{file}: line {number}", _parsed(line)
        if entry is None or not (_marks(entry) if "mark" in entry else _is_count(entry.get("tick"))):
            raise InputError(f"{place} is damaged: {brief(line)}")
        tick = entry["mark"] if "mark" in entry else entry["tick"]
        if not marked <= tick <= marked + every:
            raise InputError(f"{place} is damaged: tick {tick} after a mark at {marked}; a mark follows every {every}")
        if "mark" in entry:
            marked = tick
            recording.marks.append(Mark(tick, entry["digest"]))
            recording = recording._replace(complete="end" in entry)
        elif "team" in entry:
            recording.commands.setdefault(tick, []).append(_report(recording, entry["team"], place))
        elif "calibration" not in entry:
            renamed |= _rename(entry)
            recording.commands.setdefault(tick, []).append(_command(entry, place))
    return recording._replace(warnings=tuple(f"{file}: {warning}" for warning in renamed.values()))


def _begun(header: dict[str, Any], file: Path) -> Recording:
    """The recording that a header begins.

    Raises:
        InputError: of an unknown format, or a value is missing or of another type.
        ScenarioError: its scenario cannot be used.
    """
    if header["recording"] != FORMAT:
        found = brief(header["recording"])
        raise InputError(f"{file}: recording format {found} is not known; known formats: {FORMAT}")
    for name, (meets, wanted) in _HEADER.items():
        if name not in header:
            raise InputError(f"{file}: the header of the recording has no '{name}'")
        if not meets(header[name]):
            raise InputError(f"{file}: {name} in the header is {brief(header[name])}; expected {wanted}")
    polygons = None
    if "polygons" in header:
        polygons = _polygons(header["polygons"], file)
    scenario = parse_scenario(header["text"], header["source"], polygons)
    if "forms" in header:
        scenario = scenario.with_forms(read_forms(Node(header["forms"], str(file), "forms", InputError)))
    rules = team_lines.rules_read(header["team"], str(file)) if "team" in header else None
    return Recording(scenario, header["seed"], header["versions"], {}, [], False, rules=rules)


def _report(recording: Recording, entry: object, place: str) -> TeamReport:
    if recording.rules is None:
        raise InputError(f"{place} tells of a team, and the header has none")
    return team_lines.read(entry, place, len(recording.scenario.robots.points))


def _polygons(value: Any, file: Path) -> tuple[Floats, ...]:
    """The chains of points (n, 2) [m] of a header."""
    items = Node(value, str(file), "polygons", InputError).items()
    return tuple(chain.points(least=3) for chain in items)


def _is_count(value: object) -> bool:
    return type(value) is int and value >= 0


def _is_versions(value: object) -> bool:
    return isinstance(value, dict) and all(isinstance(text, str) for text in value.values())  # pyright: ignore[reportUnknownVariableType]


# What a header must have: what each value must meet, and that in words.
_HEADER: dict[str, tuple[Callable[[object], bool], str]] = {
    "text": (lambda value: isinstance(value, str), "text"),
    "source": (lambda value: isinstance(value, str), "text"),
    "seed": (_is_count, "a whole number from 0"),
    "versions": (_is_versions, "versions by name"),
}


def _rename(entry: dict[str, Any]) -> dict[str, str]:
    """Gives the channels of a command their present names; the warnings, by the former name."""
    given = {field: entry[field] for field in ("source", "channel") if isinstance(entry.get(field), str)}
    entry |= {field: current_channel(name) for field, name in given.items()}
    return {name: warning for name in given.values() if (warning := renamed_channel(name))}


def _marks(entry: dict[str, Any]) -> bool:
    return _is_count(entry.get("mark")) and isinstance(entry.get("digest"), str)


def _parsed(line: str) -> dict[str, Any] | None:
    try:
        entry = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return entry if isinstance(entry, dict) else None  # pyright: ignore[reportUnknownVariableType]


def _command(entry: dict[str, Any], place: str) -> OperatorCommand:
    try:
        return command_fields.read(entry)
    except ValueError as error:
        raise InputError(f"{place}: not a command that this console knows: {error}") from error
