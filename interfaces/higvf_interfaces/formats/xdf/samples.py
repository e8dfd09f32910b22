"""The samples of an XDF file's streams, by pyxdf, which loads them whole and puts their clocks on the recorder's."""

import logging
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError, MissingExtraError
from higvf_console.core.optional import optional
from higvf_interfaces.formats.xdf.file import XdfStream

if TYPE_CHECKING:
    import pyxdf
else:
    pyxdf = optional("pyxdf", "devices")


class XdfSamples(NamedTuple):
    """A loaded stream.

    Attributes:
        time: (n,) of the recording computer [s].
        values: n rows of the stream's channels: numbers (n, channels), or texts as lists.
        earliest: finite time of any stream that was loaded [s]; 0 where there is none.
    """

    time: Floats
    values: Any
    earliest: float


def load(path: Path, chosen: XdfStream, beside: Sequence[XdfStream] = ()) -> XdfSamples:
    """Loads a stream.

    Args:
        path: of the file.
        chosen: the stream.
        beside: others whose times count for the earliest one, so that streams of one file keep step.

    Raises:
        InputError: pyxdf cannot read the file, or the samples are no numbers where they should be.
    """
    numbers = sorted({chosen.number, *(stream.number for stream in beside)})
    try:
        with _quiet(), np.errstate(all="ignore"):
            loaded = cast(Sequence[Mapping[str, Any]], pyxdf.load_xdf(str(path), numbers)[0])
            times = {int(entry["info"]["stream_id"]): floats(entry["time_stamps"], -1) for entry in loaded}
            (series,) = (e["time_series"] for e in loaded if int(e["info"]["stream_id"]) == chosen.number)
            values = series if chosen.texts else floats(series, -1, chosen.info.channels)
    except MissingExtraError:
        raise
    except Exception as problem:  # a damaged file makes pyxdf raise whatever there is
        reason = f"{type(problem).__name__}: {str(problem)[:200]}"
        raise InputError(f"{path}: the XDF file cannot be read: {reason}") from problem
    starts = [float(np.nanmin(time)) for time in times.values() if np.isfinite(time).any()]
    time = times[chosen.number]
    return XdfSamples(time[: len(values)], values[: len(time)], min(starts, default=0.0))


def cut_off(stream: XdfStream, readable: int) -> list[str]:
    """A note where a stream was not closed properly and has so many readable samples."""
    return [] if stream.closed else [f"the recording was cut off; its readable part has {readable} samples"]


@contextmanager
def _quiet() -> Generator[None]:
    """pyxdf logs what it repairs; the readers say in their own notes what matters to the operator."""
    logger = logging.getLogger(pyxdf.load_xdf.__module__)
    before, logger.disabled = logger.disabled, True
    try:
        yield
    finally:
        logger.disabled = before
