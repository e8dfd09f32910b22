"""Trials of a labelled recording: spans between "0s" and "0e", or a given time behind each onset."""

import re
from collections.abc import Sequence

from higvf_console.errors import InputError
from higvf_interfaces.decoding.contract import Trial
from higvf_interfaces.formats.records import Decision

_SPAN = re.compile(r"(.*?)[\s_-]*(s|start|onset|e|end|offset)", re.IGNORECASE | re.DOTALL)


def trials_of(markers: Sequence[Decision], length: float | None) -> list[Trial]:
    """The trials that markers cut out, in order of time.

    Markers that come in pairs of start and end make spans; else each marker starts a trial of `length`.

    Args:
        markers: in order of time.
        length: of a trial without an end marker [s]; None = unknown.

    Raises:
        InputError: there are no pairs and `length` is not given.
    """
    spans = _spans(markers)
    if spans:
        return spans
    if length is None:
        raise InputError(
            f"the {len(markers)} markers are no pairs such as '1s' ... '1e'; give trial_s=SECONDS, which a trial lasts"
        )
    return [Trial(marker.label, marker.time, marker.time + length) for marker in markers]


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
