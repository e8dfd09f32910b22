"""Inspection of command logs: counts and confidence of the labels, and their actions by channel.

For the channel of a run, the log is also played as the run would, with the settings of the scenario.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.errors import InputError
from higvf_console.core.interface import OperatorContext
from higvf_console.core.optional import optional
from higvf_interfaces.decisions.bci import CLASSES
from higvf_interfaces.decisions.emg import GESTURES
from higvf_interfaces.decisions.interface import DecisionReplay
from higvf_interfaces.decisions.interpretation import label_map, plain_label
from higvf_interfaces.decisions.options import signal_request
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.formats.signals.reading import decision_formats, read_decisions
from higvf_interfaces.formats.xdf.file import survey
from higvf_interfaces.inspect import streams as inspect_streams
from higvf_interfaces.inspect.description import Request, description, write_picture

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "devices")

CHANNELS: Mapping[str, Mapping[str, str]] = {"emg": GESTURES, "bci": CLASSES}
_MANY = 1_000_000  # robots of a team whose number is unknown
_SHOWN = 30  # labels
_UNKNOWN = "unknown"
_ROW, _LEFT, _WIDTH = 22, 150, 900  # [px]
_INK, _PAPER = (40, 60, 110), 255


def knows(request: Request) -> bool:
    """Return whether the file is a command log, by the option `format` or by its content."""
    names = [known.name for known in decision_formats()]
    if request.format is not None:
        return request.format in names
    return any(known.matches(request.file) for known in decision_formats())


def describe(request: Request) -> Mapping[str, object]:
    """Read and describe the log.

    Raises:
        InputError: If the log has no times or no labels. Of an XDF file with several event streams and none chosen,
            the streams are described.
    """
    try:
        log = read_decisions(request.spec.source, signal_request(request.options))
    except InputError as refusal:
        if inspect_streams.knows(request) and request.format is None:
            return inspect_streams.describe(request, str(refusal))
        raise
    labels = Counter(decision.label for decision in log.decisions)
    sure = [decision.confidence for decision in log.decisions if decision.confidence is not None]
    if request.plot is not None:
        write_picture(request.plot, timeline(log.decisions))
    channels = _channels(request)
    becomes: dict[str, object] = {channel: _actions(labels, known) for channel, known in channels.items()}
    unknown = [label for label in labels if all(_action(label, known) == _UNKNOWN for known in channels.values())]
    who = f"channel {request.spec.channel}" if request.spec.channel in CHANNELS else "all channels"
    hint = (f"labels unknown to {who}: {', '.join(unknown[:_SHOWN])}; map them in the scenario's inputs",)
    if request.spec.channel in CHANNELS:
        becomes["commands"] = commands_given(request)
    streams = [stream.info for stream in survey(request.file.path).streams] if inspect_streams.knows(request) else []
    return description(
        format_name=log.format,
        kind="commands",
        streams=streams,
        samples=len(log.decisions),
        duration=log.decisions[-1].time - log.decisions[0].time,
        warnings=(*log.notes, *(hint if unknown else ())),
        labels=dict(labels.most_common(_SHOWN)),
        confidence={"known": len(sure), "mean": round(float(np.mean(sure)), 3) if sure else None},
        becomes=becomes,
    )


def timeline(decisions: Sequence[Decision]) -> NDArray[np.uint8]:
    """Draw a timeline (height, width, 3) with a row per label and a tick per decision."""
    labels = [label for label, _ in Counter(decision.label for decision in decisions).most_common(_SHOWN)]
    picture = np.full((_ROW * (len(labels) + 1), _WIDTH, 3), _PAPER, dtype=np.uint8)
    begin, length = decisions[0].time, max(decisions[-1].time - decisions[0].time, 1e-9)
    for row, label in enumerate(labels):
        low = _ROW * (row + 1) - 6
        ascii_label = label[:20].encode("ascii", "replace").decode()
        cv2.putText(picture, ascii_label, (4, low), cv2.FONT_HERSHEY_SIMPLEX, 0.45, _INK, 1, cv2.LINE_AA)
        for decision in decisions:
            if decision.label == label:
                x = _LEFT + round((_WIDTH - _LEFT - 8) * (decision.time - begin) / length)
                cv2.line(picture, (x, low - 12), (x, low), _INK, 1)
    caption = f"{begin:.1f} s to {begin + length:.1f} s"
    cv2.putText(picture, caption, (_LEFT, _ROW * len(labels) + 14), cv2.FONT_HERSHEY_SIMPLEX, 0.4, _INK, 1, cv2.LINE_AA)
    return picture


def _channels(request: Request) -> dict[str, Mapping[str, str]]:
    """Return the actions by label of the channel of the request, with its label map; or of all channels."""
    asked = request.spec.channel
    return {
        channel: label_map(defaults, request.options)
        for channel, defaults in CHANNELS.items()
        if channel == asked or asked not in CHANNELS
    }


def _actions(labels: Counter[str], known: Mapping[str, str]) -> Mapping[str, str]:
    """Return the action of each label in a channel."""
    return {label: _action(label, known) for label, _ in labels.most_common(_SHOWN)}


def _action(label: str, known: Mapping[str, str]) -> str:
    return known.get(plain_label(label), _UNKNOWN)


def commands_given(request: Request) -> Mapping[str, int]:
    """Return how often each command is given when a run plays the whole recording on the request's channel."""
    spec = request.spec
    replay = DecisionReplay(spec, CHANNELS[spec.channel])
    try:
        context = OperatorContext(
            time=math.inf,
            operator="",
            viewport=None,
            clutch=False,
            paused=False,
            influenced=0,
            extinguished=(),
            robots=spec.robots or _MANY,
        )
        return dict(Counter(type(command).__name__ for command in replay.poll(context)).most_common())
    finally:
        replay.close()
