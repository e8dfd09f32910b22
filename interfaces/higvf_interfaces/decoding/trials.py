"""Trials of a labelled recording: intervals between markers such as "0s" and "0e", or of fixed length."""

import re
from collections.abc import Sequence

from higvf_console.core.errors import InputError
from higvf_interfaces.decoding.contract import Trial
from higvf_interfaces.formats.records import CommandLog, Decision
from higvf_interfaces.formats.signals import bids_events, brainvision, edf
from higvf_interfaces.formats.signals.records import SignalRecord

_SPAN = re.compile(r"(.*?)[\s_-]*(s|start|onset|e|end|offset)", re.IGNORECASE | re.DOTALL)
_FROM_START = (bids_events.NAME, brainvision.NAME, edf.MARKED_NAME)  # formats with times from the recording's start


def trials_of(markers: Sequence[Decision], length: float | None) -> list[Trial]:
    """Return the trials that markers define, in order of time.

    Pairs of start and end markers define intervals. Without pairs, each marker starts a trial of `length`.

    Args:
        markers: in order of time.
        length: duration of a trial without end marker [s]; None if unknown.

    Raises:
        InputError: If there are no pairs and `length` is None.
    """
    spans = _spans(markers)
    if spans:
        return spans
    if length is None:
        raise InputError(
            f"the {len(markers)} markers are not pairs such as '1s' ... '1e'; give the duration of a trial: "
            "trial_s=SECONDS"
        )
    return [Trial(marker.label, marker.time, marker.time + length) for marker in markers]


def shift_to(record: SignalRecord, log: CommandLog, place: str) -> float:
    """Return the shift that aligns the markers of another file with the clock of a signal [s].

    Both files give the device time of their time 0. A log that starts below one hour may use device time or count from
    the start of the signal; the shift with more markers within the signal is chosen, device time on a tie.

    Args:
        record: the signal.
        log: the markers.
        place: file of the markers, for error messages.

    Raises:
        InputError: If no marker lies within the signal.
    """
    ends = [(float(chunk.times[0]), float(chunk.times[-1])) for chunk in record.chunks() if len(chunk.times)]
    first, last = (ends[0][0], ends[-1][1]) if ends else (0.0, 0.0)
    by_device = log.epoch - record.epoch
    shifts = (0.0,) if log.format in _FROM_START else (by_device,) if log.epoch else (by_device, 0.0)
    inside = [sum(first <= marker.time + shift <= last for marker in log.decisions) for shift in shifts]
    if not any(inside):
        begin, end = log.decisions[0].time + log.epoch, log.decisions[-1].time + log.epoch
        raise InputError(
            f"{place}: none of its {len(log.decisions)} markers lies within the recording: they are from {begin:.3f} "
            f"to {end:.3f} s, the recording from {first + record.epoch:.3f} to {last + record.epoch:.3f} s; both files "
            "must use the same clock"
        )
    return shifts[inside.index(max(inside))]


def _spans(markers: Sequence[Decision]) -> list[Trial]:
    began: dict[str, float] = {}
    spans: list[Trial] = []
    for marker in markers:
        match = _SPAN.fullmatch(marker.label.strip())
        if match is None or not match[1]:
            continue
        if match[2].casefold() in ("s", "start", "onset"):
            began[match[1]] = marker.time
        elif match[1] in began:
            spans.append(Trial(match[1], began.pop(match[1]), marker.time))
    return spans
