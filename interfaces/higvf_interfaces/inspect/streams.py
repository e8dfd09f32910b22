"""Inspection of XDF files without a recognised gaze stream: lists the streams and how to choose one."""

from collections.abc import Mapping

from higvf_interfaces.formats.xdf import gaze as gaze_xdf
from higvf_interfaces.formats.xdf.file import survey
from higvf_interfaces.inspect.description import Request, description


def knows(request: Request) -> bool:
    """Return whether the file is an XDF file."""
    return gaze_xdf.matches(request.file)


def describe(request: Request, reason: str = "") -> Mapping[str, object]:
    """List the streams; `reason` explains why no single stream is described.

    Raises:
        InputError: If the file is damaged.
    """
    found = survey(request.file.path)
    truncated = ("the file is truncated: only its readable part is counted",) if found.truncated else ()
    return description(
        format_name=gaze_xdf.NAME,
        kind="streams",
        streams=[stream.info for stream in found.streams],
        samples=sum(stream.samples for stream in found.streams),
        duration=None,
        warnings=(
            *truncated,
            *([reason] if reason else []),
            f"no stream is of type {' or '.join(gaze_xdf.TYPES)}; to read another stream as gaze, give stream= "
            "(name, type, source id or number) with x= and y= (labels or numbers of its channels)",
        ),
    )
