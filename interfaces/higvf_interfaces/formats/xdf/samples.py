"""Samples of XDF streams, loaded by pyxdf, which converts all clocks to the recorder's clock."""

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
        time: (n,) times on the recorder's clock [s].
        values: numbers (n, channels), or n lists of text.
        earliest: earliest finite time of all loaded streams [s]; 0 without one.
    """

    time: Floats
    values: Any
    earliest: float


def load(path: Path, chosen: XdfStream, beside: Sequence[XdfStream] = ()) -> XdfSamples:
    """Load a stream.

    Args:
        path: path of the file.
        chosen: the stream.
        beside: further streams included in `earliest`, so that all streams of a file share one time 0.

    Raises:
        InputError: If pyxdf cannot read the file, or samples are not numbers as declared.
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
    except Exception as problem:  # pyxdf raises arbitrary exceptions on a damaged file
        reason = f"{type(problem).__name__}: {str(problem)[:200]}"
        raise InputError(f"{path}: the XDF file cannot be read: {reason}") from problem
    starts = [float(np.nanmin(time)) for time in times.values() if np.isfinite(time).any()]
    time = times[chosen.number]
    return XdfSamples(time[: len(values)], values[: len(time)], min(starts, default=0.0))


def cut_off(stream: XdfStream, readable: int) -> list[str]:
    """Return a note if the stream has no footer; `readable` is its number of readable samples."""
    return [] if stream.closed else [f"the recording was cut off: only its {readable} readable samples are used"]


@contextmanager
def _quiet() -> Generator[None]:
    """Disable the log of pyxdf; the readers report repairs in their notes."""
    logger = logging.getLogger(pyxdf.load_xdf.__module__)
    before, logger.disabled = logger.disabled, True
    try:
        yield
    finally:
        logger.disabled = before
