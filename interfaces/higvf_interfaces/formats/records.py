"""What every reader yields: one record for gaze and one for decoded commands, on one clock that starts near 0."""

from collections.abc import Iterable, Iterator
from itertools import islice
from typing import NamedTuple, TypeAlias

import numpy as np

from higvf_console.core.arrays import Bools, Floats, bools, floats

FRAMES = ("arena", "screen", "unit")
SCENE_FRAMES = {"scene": "screen", "scene-unit": "unit"}  # of a camera on the head, and what it is taken as on demand
TOP_LEFT, BOTTOM_LEFT = "top left", "bottom left"
ORIGINS = (TOP_LEFT, BOTTOM_LEFT)
MAX_HOLE = 10.0  # a longer hole between samples is shortened to this [s]
EPOCH_FROM = 3600.0  # a log that starts later counts from some epoch, not from the start of a run [s]
BLOCK = 256  # samples read at once: what is held of a long recording, and what one poll of its replay may cost

Row: TypeAlias = tuple[float, float, float, bool, float]  # time [s], x, y, vouched for, confidence


class GazeRecording(NamedTuple):
    """Gaze samples of one operator.

    Attributes:
        time: (n,) strictly increasing [s].
        points: (n, 2) in `frame`; NaN where missing.
        valid: (n,) whether the tracker vouches for the sample; implies finite points.
        confidence: (n,) in [0, 1]; None where the format has none.
        frame: arena [m], screen [px] or unit (0..1 of the screen); scene [px] or scene-unit where a camera on the head
            is the frame; None where the file does not say.
        screen: width and height of the recording's screen [px]; None where the file does not say.
        epoch: the device's own time at `time` = 0 [s].
        format: name of the format.
        notes: what was repaired or assumed, in words.
        origin: where 0, 0 of a screen or scene is; y runs away from it.
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
    """Neighbouring samples of a recording.

    Attributes:
        time: (n,) [s].
        points: (n, 2) as the file has them; NaN where missing.
        valid: (n,) whether the tracker vouches for the sample; implies finite points.
        confidence: (n,) in [0, 1]; NaN where unknown.
    """

    time: Floats
    points: Floats
    valid: Bools
    confidence: Floats


class StreamInfo(NamedTuple):
    """One stream of a file that holds several."""

    name: str
    type: str
    source_id: str
    channels: int
    rate: float


class GazeStream(NamedTuple):
    """A gaze recording being read, block by block: what a format module yields.

    Attributes:
        format: name of the format.
        columns: titles of the columns or channels used.
        frame: as in `GazeRecording`.
        blocks: the samples, once, on the device's clock [s]; NaN where the time is missing.
        notes: what was repaired or assumed; grows while the blocks are read.
        origin: as in `GazeRecording`.
        screen: as in `GazeRecording`.
        start: session time of the first sample [s]; None = its own time where that is below an hour, else 0.
        in_step: whether markers or signals on the same clock lie beside it, so that its holes stay as long as they are.
        has_confidence: whether the format gives one.
        epoch: device time that has been taken off the blocks' times already [s].
        streams: all streams of the file, where it holds several.
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


class Wanted(NamedTuple):
    """What the operator says of a file that may hold several streams: names or numbers from 1; None = unsaid."""

    stream: str | None = None
    x: str | None = None
    y: str | None = None


ANYTHING = Wanted()


def blocks_of(rows: Iterable[Row]) -> Iterator[GazeBlock]:
    """Rows, `BLOCK` at a time; a sample without finite coordinates is not valid."""
    rows = iter(rows)
    while batch := list(islice(rows, BLOCK)):
        table = floats(batch, -1, 5)
        yield block_of(table[:, 0], table[:, 1:3], bools(table[:, 3] > 0), table[:, 4])


def block_of(time: Floats, points: Floats, vouched: Bools, confidence: Floats | None = None) -> GazeBlock:
    """A block of which only samples with finite coordinates are valid."""
    known = np.full(len(time), np.nan) if confidence is None else floats(confidence)
    return GazeBlock(floats(time), floats(points), bools(vouched & np.isfinite(points).all(axis=1)), known)


class Decision(NamedTuple):
    """One decoded label; `confidence` in [0, 1], or None where the log has none."""

    time: float
    label: str
    confidence: float | None


class CommandLog(NamedTuple):
    """Decisions of one channel in order of time, as `GazeRecording` describes `epoch`, `format` and `notes`."""

    decisions: tuple[Decision, ...]
    epoch: float
    format: str
    notes: tuple[str, ...]


def log_start(first: float) -> float:
    """Device time that becomes 0 in a log whose first entry is at `first` [s]."""
    return first if first >= EPOCH_FROM or first < 0 else 0.0
