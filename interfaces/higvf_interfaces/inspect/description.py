"""Description of a file: the request, the keys of every description, and the output of pictures."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_console.core.optional import optional
from higvf_interfaces.fields import Fields
from higvf_interfaces.formats.records import StreamInfo
from higvf_interfaces.formats.text import TextFile

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "devices")


class Request(NamedTuple):
    """A request for a description.

    Attributes:
        spec: the input.
        file: its file, opened.
        options: its options.
        plot: path of the picture; None for no picture.
        steps: whether to report the processing steps.
    """

    spec: InputSpec
    file: TextFile
    options: Fields
    plot: Path | None
    steps: bool

    @property
    def format(self) -> str | None:
        """Value of the option `format`, if set."""
        return self.options.text("format") if self.options.has("format") else None


def description(
    *,
    format_name: str,
    kind: str,
    streams: Sequence[StreamInfo] = (),
    columns: Sequence[str] = (),
    samples: int,
    duration: float | None,
    rate: float | None = None,
    frame: str | None = None,
    origin: str | None = None,
    valid_share: float | None = None,
    gaps: Mapping[str, object] | None = None,
    warnings: Sequence[str] = (),
    **more: object,
) -> dict[str, object]:
    """Return a description as plain values: times [s], rates [Hz], shares 0 to 1; None if unknown or not applicable."""
    return {
        "format": format_name,
        "kind": kind,
        "streams": [
            {"name": s.name, "type": s.type, "source_id": s.source_id, "channels": s.channels, "rate_hz": s.rate}
            for s in streams
        ],
        "columns": list(columns),
        "samples": samples,
        "duration_s": None if duration is None else round(duration, 6),
        "rate_hz": None if rate is None else round(rate, 3),
        "frame": frame,
        "origin": origin,
        "valid_share": None if valid_share is None else round(valid_share, 6),
        "gaps": dict(gaps or {}),
        **more,
        "warnings": list(warnings),
    }


def write_picture(path: Path, picture: NDArray[np.uint8]) -> None:
    """Write a picture (height, width, 3) of red, green, blue as PNG.

    Raises:
        InputError: If the file cannot be written.
    """
    try:
        done, content = cv2.imencode(".png", picture[:, :, ::-1])
        if not done:
            raise InputError(f"{path}: the picture cannot be encoded as PNG")
        path.write_bytes(np.asarray(content).tobytes())
    except OSError as problem:
        raise InputError(f"{path}: cannot be written: {problem.strerror}") from problem
