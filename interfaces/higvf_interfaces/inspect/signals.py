"""Inspection of raw EMG and EEG signals in one pass: channels, rate, validity, gaps, and markers in the same file."""

from collections import Counter
from collections.abc import Mapping

import numpy as np

from higvf_console.core.errors import InputError
from higvf_interfaces.decisions.options import signal_request
from higvf_interfaces.formats import command_log
from higvf_interfaces.formats.gaze.plain import TIMES
from higvf_interfaces.formats.reading import choose_format
from higvf_interfaces.formats.signals.reading import decision_formats, read_decisions, signal_formats
from higvf_interfaces.formats.signals.records import SignalRecord, pick_channels
from higvf_interfaces.formats.xdf.file import fitting, survey
from higvf_interfaces.inspect import commands as inspect_commands
from higvf_interfaces.inspect import streams as inspect_streams
from higvf_interfaces.inspect.description import Request, description

_LONGEST_GAP = 0.1  # a longer time between samples is reported as a gap [s]
_SHOWN = 30  # labels


def knows(request: Request) -> bool:
    """Return whether the file is a recording of raw samples; a command log, or an XDF file of events only, is none."""
    if request.format is not None:
        return request.format in [known.name for known in signal_formats()]
    if inspect_streams.knows(request):
        wanted = signal_request(request.options).stream
        meant = fitting(survey(request.file.path).streams, wanted)
        return not meant or not all(stream.marks for stream in meant)
    played = next((known.name for known in decision_formats() if known.matches(request.file)), None)
    is_log = played == command_log.CSV_NAME and request.file.find(*TIMES) is not None
    return not is_log and any(known.matches(request.file) for known in signal_formats())


def describe(request: Request) -> Mapping[str, object]:
    """Read and describe the recording.

    Raises:
        InputError: If it has no samples or no times, or lacks the requested stream or channel.
    """
    wanted = signal_request(request.options)
    known = choose_format(request.file, request.format, signal_formats())
    try:
        record = pick_channels(known.read(request.file, wanted), wanted.channels, str(request.file.path))
    except InputError as refusal:
        if inspect_streams.knows(request):
            return inspect_streams.describe(request, str(refusal))
        raise
    samples, finite, first, last, gaps = 0, 0, None, 0.0, [0.0]
    for chunk in record.chunks():
        first = float(chunk.times[0]) if first is None else first
        steps = np.diff(chunk.times, prepend=last if samples else first)
        gaps += steps[steps > _LONGEST_GAP].tolist()
        samples, last = samples + len(chunk.times), float(chunk.times[-1])
        finite += int(np.count_nonzero(np.isfinite(chunk.values).all(axis=1)))
    picture = ("no picture: not available for raw signals",) if request.plot is not None else ()
    return description(
        format_name=record.format,
        kind="signals",
        streams=[stream.info for stream in survey(request.file.path).streams] if inspect_streams.knows(request) else [],
        columns=_titled(record),
        samples=samples,
        duration=0.0 if first is None else last - first,
        rate=record.rate,
        valid_share=finite / max(samples, 1),
        gaps={"count": len(gaps) - 1, "longest_s": round(max(gaps), 3), "total_s": round(sum(gaps), 3)},
        epoch_s=record.epoch,
        labels=_labels(request),
        becomes={"commands": _commands(request)},
        warnings=(*record.notes, *picture),
    )


def _commands(request: Request) -> object:
    """Return the counts of the commands that the request's channel and decoder give; without these, what they need."""
    if request.spec.channel not in inspect_commands.CHANNELS:
        return "with a decoder, on the channel emg or bci: decoder=lda or decoder=ssvep"
    if not request.options.has("decoder"):
        return "with a decoder: decoder=lda or decoder=ssvep"
    return inspect_commands.commands_given(request)


def _titled(record: SignalRecord) -> list[str]:
    return [f"{name} [{unit}]" if unit else name for name, unit in zip(record.names, record.units, strict=True)]


def _labels(request: Request) -> Mapping[str, int]:
    """Return the counts of the markers in the same file; empty if there are none."""
    if not any(known.matches(request.file) for known in decision_formats()):
        return {}
    try:
        log = read_decisions(request.spec.source)
    except InputError:
        return {}
    return dict(Counter(decision.label for decision in log.decisions).most_common(_SHOWN))
