"""Records of all readers: gaze readers yield `GazeStream`s, readers of decoded labels return `CommandLog`s.

Times start near 0.
"""

from collections.abc import Iterable, Iterator
from itertools import islice
from typing import NamedTuple, TypeAlias

import numpy as np

from higvf_console.core.arrays import Bools, Floats, bools, floats

FRAMES = ("arena", "screen", "unit")
SCENE_FRAMES = {"scene": "screen", "scene-unit": "unit"}  # frame of a head-mounted camera -> frame it may be read as
TOP_LEFT, BOTTOM_LEFT = "top left", "bottom left"
CENTER, CENTER_UP = "center", "center up"
ORIGINS = (TOP_LEFT, BOTTOM_LEFT, CENTER, CENTER_UP)
MIN_CONFIDENCE = 0.6  # samples of lower confidence are not valid, unless the option min_confidence says otherwise
_ROUNDING = 1e-6  # by which a confidence may exceed 1
MAX_GAP = 10.0  # longer gaps between samples are shortened to this [s]
EPOCH_FROM = 3600.0  # a log that starts later counts from an epoch, not from the start of a run [s]
BLOCK = 256  # samples read at once; bounds the memory and the time of one poll

Row: TypeAlias = tuple[float, float, float, bool, float]  # time [s], x, y, valid, confidence


class GazeRecording(NamedTuple):
    """Gaze samples of one operator.

    Attributes:
        time: (n,) strictly increasing [s].
        points: (n, 2) in `frame`; NaN where missing.
        valid: (n,) whether the sample is valid; implies finite points.
        confidence: (n,) in [0, 1]; None if the format has none.
        frame: arena [m], screen [px] or unit (0..1 of the screen); scene [px] or scene-unit for a head-mounted camera;
            None if the file does not specify it.
        screen: width and height of the recording's screen [px]; None if unknown.
        epoch: device time at `time` = 0 [s].
        format: name of the format.
        notes: repairs and assumptions.
        origin: corner of the screen or scene at coordinates 0, 0, from which y increases; or its center, with y
            increasing downwards (center) or upwards (center up).
    """

    time: Floats
    points: Floats
    valid: Bools
    confidence: Floats | None
    frame: str | None
    screen: tuple[float, float] | None
    epoch: float
    format: str
    notes: tuple[str, ...]
    origin: str = TOP_LEFT


class GazeBlock(NamedTuple):
    """Consecutive samples of a recording.

    Attributes:
        time: (n,) [s].
        points: (n, 2) as in the file; NaN where missing.
        valid: (n,) whether the sample is valid; implies finite points.
        confidence: (n,) in [0, 1]; NaN where unknown.
    """

    time: Floats
    points: Floats
    valid: Bools
    confidence: Floats


class StreamInfo(NamedTuple):
    """Metadata of one stream in a file with several streams; `rate` [Hz]."""

    name: str
    type: str
    source_id: str
    channels: int
    rate: float


class Doubt(NamedTuple):
    """A statement that is not understood, and the option that replaces it: frame, origin or screen."""

    option: str
    statement: str


class GazeStream(NamedTuple):
    """An open gaze recording, as returned by a format's module.

    Attributes:
        format: name of the format.
        columns: titles of the columns or channels used.
        frame: as in `GazeRecording`.
        blocks: iterator over the samples, on the device's clock [s]; NaN where the time is missing.
        notes: repairs and assumptions; grows while the blocks are read.
        origin: as in `GazeRecording`.
        screen: as in `GazeRecording`.
        start: session time of the first sample [s]; None means its own time if below one hour, otherwise 0.
        in_step: whether the clock is shared with markers or signals, so that gaps must not be shortened.
        has_confidence: whether the file has confidences.
        epoch: device time already subtracted from the times of the blocks [s].
        streams: all streams of the file, if it holds several.
        doubts: statements about the coordinates that are not understood.
    """

    format: str
    columns: tuple[str, ...]
    frame: str | None
    blocks: Iterator[GazeBlock]
    notes: list[str]
    origin: str = TOP_LEFT
    screen: tuple[float, float] | None = None
    start: float | None = 0.0
    in_step: bool = False
    has_confidence: bool = False
    epoch: float = 0.0
    streams: tuple[StreamInfo, ...] = ()
    doubts: tuple[Doubt, ...] = ()


class Wanted(NamedTuple):
    """Selection of a stream and its channels in an XDF file, by name or number from 1; None if not selected."""

    stream: str | None = None
    x: str | None = None
    y: str | None = None


ANYTHING = Wanted()


def trusted(confidence: Floats, least: float) -> Bools:
    """Return whether each confidence (n,) is sufficient; unknown ones (NaN) are, those above 1 are not."""
    return bools(~(confidence < least) & ~beyond(confidence))


def beyond(confidence: Floats) -> Bools:
    """Return whether each confidence (n,) exceeds 1, so that it is counted in another unit."""
    return bools(confidence > 1 + _ROUNDING)


def blocks_of(rows: Iterable[Row]) -> Iterator[GazeBlock]:
    """Group rows into blocks of `BLOCK` samples; a sample without finite coordinates is invalid."""
    rows = iter(rows)
    while batch := list(islice(rows, BLOCK)):
        table = floats(batch, -1, 5)
        yield block_of(table[:, 0], table[:, 1:3], bools(table[:, 3] > 0), table[:, 4])


def block_of(time: Floats, points: Floats, valid: Bools, confidence: Floats | None = None) -> GazeBlock:
    """Make a block; a sample without finite coordinates is invalid."""
    known = np.full(len(time), np.nan) if confidence is None else floats(confidence)
    return GazeBlock(floats(time), floats(points), bools(valid & np.isfinite(points).all(axis=1)), known)


class Decision(NamedTuple):
    """One decoded label at `time` [s]; `confidence` in [0, 1], or None if unknown."""

    time: float
    label: str
    confidence: float | None


class CommandLog(NamedTuple):
    """Decisions of one channel in order of time; see `GazeRecording` for the other attributes."""

    decisions: tuple[Decision, ...]
    epoch: float
    format: str
    notes: tuple[str, ...]


def log_start(first: float) -> float:
    """Return the device time that becomes time 0 in a log whose first entry is at `first` [s]."""
    return first if first >= EPOCH_FROM or first < 0 else 0.0
