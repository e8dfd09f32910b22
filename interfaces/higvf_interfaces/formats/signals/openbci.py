"""OpenBCI GUI text recordings, in the old format (no header row) and the new (`Sample Index, EXG Channel 0, ...`).

Lines that start with % describe the recording. The old format has the columns counter, channels, three auxiliary
channels, time of day and, in later versions, milliseconds since 1970. The new format has duplicate titles (`Not Used`,
`Other`) and a `Timestamp` in seconds or milliseconds. Samples arrive in bursts, so their times are smoothed; the
counter, modulo 256, reveals lost samples.
"""

import csv
import re
from collections.abc import Iterator
from itertools import islice

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.records import CommandLog
from higvf_interfaces.formats.signals.records import SignalRecord, SignalRequest
from higvf_interfaces.formats.signals.table import SampleTable, table_markers, table_signals
from higvf_interfaces.formats.text import TextFile, epoch_seconds

NAME = "openbci-txt"
TITLE = "OpenBCI GUI text (% lines, then Sample Index, channels in uV)"
_HEAD_LINES = 200
_CLOCK_TIME = re.compile(r"(\d{1,2}):(\d{2}):(\d{2}(?:\.\d+)?)")
_CHANNELS = re.compile(r"%\s*number of channels\s*=\s*(\d{1,3})", re.IGNORECASE)
_RATE = re.compile(r"%\s*sample rate\s*=\s*([\d.]+)", re.IGNORECASE)


def matches(file: TextFile) -> bool:
    """Return whether the first line names OpenBCI."""
    return file.first_line.startswith("%") and "openbci" in file.first_line.casefold()


def read_signals(file: TextFile, request: SignalRequest) -> SignalRecord:
    """Read the EXG channels [uV].

    Raises:
        InputError: If there are no samples, no channels, or neither times nor a rate.
    """
    return table_signals(_table(file), request)


def read_markers(file: TextFile, request: SignalRequest) -> CommandLog:
    """Read the events of the column `Marker Channel`.

    Raises:
        InputError: If there is no such column, no event, no samples, or neither times nor a rate.
    """
    return table_markers(_table(file), request)


def _table(file: TextFile) -> SampleTable:
    head = list(islice(file.lines(), _HEAD_LINES))
    about = "\n".join(line for line in head if line.startswith("%"))
    table = [line for line in head if not line.startswith("%")]
    if not table:
        raise InputError(f"{file.path}: the OpenBCI recording has no samples")
    first = [cell.strip() for cell in _cells(table[0])]
    rate = _RATE.search(about)
    titled = first[0].casefold() == "sample index"
    channels = _named(first) if titled else _counted(file, about, first)
    names = [first[k] if titled else f"EXG Channel {k - 1}" for k in channels]
    time = _titled(first, "timestamp") if titled else _old_time(first)

    def rows(notes: list[str]) -> Iterator[list[str]]:
        return _rows(file, titled, len(first), notes)

    return SampleTable(
        path=file.path,
        format=NAME,
        rows=rows,
        channels=channels,
        names=tuple(names),
        units=("uV",) * len(channels),
        time=time,
        seconds=epoch_seconds if titled else _old_seconds,
        counter=0,
        marker=_titled(first, "marker channel") if titled else None,
        rate=float(rate[1]) if rate and rate[1].count(".") < 2 and float(f"0{rate[1]}") > 0 else None,
    )


def _rows(file: TextFile, titled: bool, width: int, notes: list[str]) -> Iterator[list[str]]:
    dropped = 0
    samples = (line for line in file.lines() if not line.startswith("%"))
    for line in islice(samples, int(titled), None):
        row = _cells(line)
        if len(row) == width:
            yield row
        else:
            dropped += 1
    if dropped:
        notes.append(f"{dropped} truncated rows dropped")


def _cells(line: str) -> list[str]:
    try:
        return next(csv.reader([line], skipinitialspace=True))
    except (csv.Error, StopIteration):
        return [""]


def _named(titles: list[str]) -> tuple[int, ...]:
    return tuple(k for k, title in enumerate(titles) if re.match(r"(exg|eeg|emg|ecg) channel", title.casefold()))


def _counted(file: TextFile, about: str, first: list[str]) -> tuple[int, ...]:
    count = _CHANNELS.search(about)
    if count is None or not 0 < int(count[1]) < len(first):
        raise InputError(f"{file.path}: the OpenBCI recording lacks a valid line '%Number of channels = N'")
    return tuple(range(1, int(count[1]) + 1))


def _titled(titles: list[str], name: str) -> int | None:
    return next((k for k, title in enumerate(titles) if title.casefold() == name), None)


def _old_time(row: list[str]) -> int | None:
    """Return the time column of the old format: the last column that can be parsed as a time."""
    times = [k for k, text in enumerate(row) if epoch_seconds(text) > 1e8 or _CLOCK_TIME.fullmatch(text)]
    return times[-1] if times else None


def _old_seconds(text: str) -> float:
    clock = _CLOCK_TIME.fullmatch(text.strip())
    if clock is None:
        return epoch_seconds(text)
    return 3600 * int(clock[1]) + 60 * int(clock[2]) + float(clock[3])
