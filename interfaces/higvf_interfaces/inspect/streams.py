"""Describes an XDF file of which no stream is said to be gaze: its streams, and how to choose one."""

from collections.abc import Mapping

from higvf_interfaces.formats.xdf import gaze as gaze_xdf
from higvf_interfaces.formats.xdf.file import survey
from higvf_interfaces.inspect.description import Request, description


def knows(request: Request) -> bool:
    """Whether it is an XDF file."""
    return gaze_xdf.matches(request.file)


def describe(request: Request, reason: str = "") -> Mapping[str, object]:
    """Its streams, and the reason why none of them is described alone.

    Raises:
        InputError: it is damaged.
    """
    found = survey(request.file.path)
    torn = ("the file is cut off: its readable part counts",) if found.torn else ()
    return description(
        format_name=gaze_xdf.NAME,
        kind="streams",
        streams=[stream.info for stream in found.streams],
        samples=sum(stream.samples for stream in found.streams),
        duration=None,
        warnings=(
            *torn,
            *([reason] if reason else []),
            f"no stream is of type {' or '.join(gaze_xdf.TYPES)}; one that is gaze nonetheless is told by stream= "
            "(name, type, source id or number) with x= and y= (labels or numbers of its channels)",
        ),
    )
