"""The entrance to all readers: tells formats apart by content, or takes the one that `format=` names."""

from collections.abc import Callable, Sequence
from typing import Generic, NamedTuple, TypeVar

from higvf_console.errors import InputError
from higvf_interfaces.formats import command_log, gaze_csv, tobii_prolab
from higvf_interfaces.formats.records import CommandLog, GazeRecording
from higvf_interfaces.formats.text import TextFile, look

_Record = TypeVar("_Record")


class Format(NamedTuple, Generic[_Record]):
    """A format: its short name, what it is, and how to know and read it."""

    name: str
    title: str
    matches: Callable[[TextFile], bool]
    read: Callable[[TextFile], _Record]


GAZE_FORMATS: tuple[Format[GazeRecording], ...] = (
    Format(tobii_prolab.NAME, tobii_prolab.TITLE, tobii_prolab.matches, tobii_prolab.read),
    Format(gaze_csv.NAME, gaze_csv.TITLE, gaze_csv.matches, gaze_csv.read),
)
COMMAND_FORMATS: tuple[Format[CommandLog], ...] = (
    Format(command_log.JSON_NAME, command_log.JSON_TITLE, command_log.matches_jsonl, command_log.read_jsonl),
    Format(command_log.CSV_NAME, command_log.CSV_TITLE, command_log.matches_csv, command_log.read_csv),
)


def read_gaze(source: str, format_name: str | None = None) -> GazeRecording:
    """Reads a gaze recording.

    Raises:
        InputError: the file is missing or empty, of no known format, or without times or valid gaze.
    """
    recording = _read(source, format_name, GAZE_FORMATS)
    if not recording.valid.any():
        raise InputError(f"{source}: none of the {len(recording.time)} gaze samples is valid")
    return recording


def read_command_log(source: str, format_name: str | None = None) -> CommandLog:
    """Reads a log of decoded commands.

    Raises:
        InputError: the file is missing or empty, of no known format, or without times or labels.
    """
    return _read(source, format_name, COMMAND_FORMATS)


def _read(source: str, format_name: str | None, formats: Sequence[Format[_Record]]) -> _Record:
    file = look(source)
    if format_name is not None:
        for known in formats:
            if known.name == format_name:
                return known.read(file)
        raise InputError(f"format: {format_name!r} is not one of {', '.join(known.name for known in formats)}")
    for known in formats:
        if known.matches(file):
            return known.read(file)
    titles = "; ".join(f"{known.name}: {known.title}" for known in formats)
    raise InputError(f"{source}: not a known format ({titles}); its first line has: {file.titles}")
