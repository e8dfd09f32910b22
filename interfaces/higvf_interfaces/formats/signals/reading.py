"""Reading of EMG and BCI recordings, as decoded decisions or as raw signals."""

from collections.abc import Callable, Sequence
from typing import Generic, NamedTuple, TypeVar

from higvf_console.core.arguments import one_of
from higvf_console.core.errors import InputError
from higvf_interfaces.formats import command_log
from higvf_interfaces.formats.records import CommandLog
from higvf_interfaces.formats.registry import DECISIONS, SIGNALS, registered
from higvf_interfaces.formats.signals import bids_events, brainflow, brainvision, edf, mind_monitor, myo, openbci
from higvf_interfaces.formats.signals import plain as signal_csv
from higvf_interfaces.formats.signals.records import SignalRecord, SignalRequest, pick_channels
from higvf_interfaces.formats.text import TextFile, look
from higvf_interfaces.formats.xdf import markers as xdf_markers
from higvf_interfaces.formats.xdf import signals as xdf_signals

_Record = TypeVar("_Record")
AS_IT_IS = SignalRequest()


class SignalFormat(NamedTuple, Generic[_Record]):
    """A format: its name and title, and functions to recognise and read it."""

    name: str
    title: str
    matches: Callable[[TextFile], bool]
    reader: Callable[[TextFile, SignalRequest], _Record]

    def read(self, file: TextFile, request: SignalRequest) -> _Record:
        """Read a file in this format.

        Raises:
            InputError: If the file lacks a required part, or a stream is selected and the format is not XDF.
        """
        if request.stream is not None and self.name not in (xdf_signals.NAME, xdf_markers.NAME):
            wanted = f"{request.stream_option}={request.stream[:80]}"
            raise InputError(f"{file.path}: {wanted} is for XDF files; this is read as {self.name}")
        return self.reader(file, request)


def _read_jsonl(file: TextFile, request: SignalRequest) -> CommandLog:
    return command_log.read_jsonl(file, _period(request))


def _read_csv(file: TextFile, request: SignalRequest) -> CommandLog:
    return command_log.read_csv(file, _period(request))


def _period(request: SignalRequest) -> float | None:
    return None if request.rate is None else 1.0 / request.rate


SIGNAL_FORMATS: tuple[SignalFormat[SignalRecord], ...] = (
    SignalFormat(xdf_signals.NAME, xdf_signals.TITLE, xdf_signals.matches, xdf_signals.read_signals),
    SignalFormat(edf.NAME, edf.TITLE, edf.matches, edf.read_signals),
    SignalFormat(openbci.NAME, openbci.TITLE, openbci.matches, openbci.read_signals),
    SignalFormat(brainflow.NAME, brainflow.TITLE, brainflow.matches, brainflow.read_signals),
    SignalFormat(myo.NAME, myo.TITLE, myo.matches, myo.read_signals),
    SignalFormat(mind_monitor.NAME, mind_monitor.TITLE, mind_monitor.matches, mind_monitor.read_signals),
    SignalFormat(signal_csv.NAME, signal_csv.TITLE, signal_csv.matches, signal_csv.read_signals),
)
DECISION_FORMATS: tuple[SignalFormat[CommandLog], ...] = (
    SignalFormat(xdf_markers.NAME, xdf_markers.TITLE, xdf_markers.matches, xdf_markers.read_markers),
    SignalFormat(edf.MARKED_NAME, edf.MARKED_TITLE, edf.matches, edf.read_markers),
    SignalFormat(brainvision.NAME, brainvision.TITLE, brainvision.matches, brainvision.read_markers),
    SignalFormat(openbci.NAME, openbci.TITLE, openbci.matches, openbci.read_markers),
    SignalFormat(brainflow.NAME, brainflow.TITLE, brainflow.matches, brainflow.read_markers),
    SignalFormat(bids_events.NAME, bids_events.TITLE, bids_events.matches, bids_events.read_markers),
    SignalFormat(
        mind_monitor.MARKED_NAME, mind_monitor.MARKED_TITLE, mind_monitor.matches_marked, mind_monitor.read_markers
    ),
    SignalFormat(
        signal_csv.MARKED_NAME, signal_csv.MARKED_TITLE, signal_csv.matches_marked, signal_csv.read_markers
    ),
    SignalFormat(
        command_log.JSON_NAME, command_log.JSON_TITLE, command_log.matches_jsonl,
        _read_jsonl,
    ),
    SignalFormat(
        command_log.CSV_NAME, command_log.CSV_TITLE, command_log.matches_labels,
        _read_csv,
    ),
)  # fmt: skip


def signal_formats() -> tuple[SignalFormat[SignalRecord], ...]:
    """Return the formats of raw samples: those of other packages, then the console's own.

    Raises:
        InputError: If another package's format cannot be used.
    """
    return registered(SIGNALS, SIGNAL_FORMATS)


def decision_formats() -> tuple[SignalFormat[CommandLog], ...]:
    """Return the formats of decisions and events, likewise.

    Raises:
        InputError: As `signal_formats`.
    """
    return registered(DECISIONS, DECISION_FORMATS)


def read_signals(source: str, request: SignalRequest = AS_IT_IS) -> SignalRecord:
    """Read a recording of raw samples.

    Raises:
        InputError: If the file is missing or unrecognised, has no samples or times, or lacks the selected stream or
            channel; the message lists the choices.
    """
    formats = signal_formats()
    file = _looked(source, formats, "a signal")
    record = _chosen(file, request.format, formats, "a signal").read(file, request)
    return pick_channels(record, request.channels, source)


def read_decisions(source: str, request: SignalRequest = AS_IT_IS) -> CommandLog:
    """Read decoded labels or event markers.

    Raises:
        InputError: As `read_signals`, or if the file holds only raw samples, which need a decoder.
    """
    formats = decision_formats()
    file = _looked(source, formats, "decisions")
    if request.format is None and not any(known.matches(file) for known in formats):
        held = next((known for known in signal_formats() if known.matches(file)), None)
        if held is not None:
            raise InputError(f"{source}: holds raw samples ({held.title}), not decisions; give decoder=lda or ssvep")
    return _chosen(file, request.format, formats, "decisions").read(file, request)


def _looked(source: str, formats: Sequence[SignalFormat[_Record]], what: str) -> TextFile:
    file = look(source)
    if not file.head:
        raise InputError(f"{source}: is a folder; give a file of {what} ({_titles(formats)})")
    return file


def _chosen(
    file: TextFile, name: str | None, formats: Sequence[SignalFormat[_Record]], what: str
) -> SignalFormat[_Record]:
    named = [known for known in formats if known.name == name]
    if name is not None:
        one_of("format", name, [known.name for known in formats], InputError)
    found = named or [known for known in formats if known.matches(file)]
    if not found:
        raise InputError(
            f"{file.path}: unrecognised format of {what}; it has: {file.titles}; formats tried: {_titles(formats)}"
        )
    return found[0]


def _titles(formats: Sequence[SignalFormat[_Record]]) -> str:
    return "; ".join(f"{known.name}: {known.title}" for known in formats)
