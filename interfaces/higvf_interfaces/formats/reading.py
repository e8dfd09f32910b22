"""Reading of gaze recordings: detects the format from the content, or uses the option `format`."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple, Protocol, TypeVar

import numpy as np

from higvf_console.core.arguments import one_of
from higvf_console.core.arrays import Floats, bools, floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.clock import LONGEST_STEP, DeviceClock
from higvf_interfaces.formats.gaze import bids as bids_gaze
from higvf_interfaces.formats.gaze import (
    eyelink_asc,
    gazepoint,
    neon_csv,
    neon_native,
    pupil_core,
    tobii_old,
    tobii_prolab,
    tobii_research,
    webgazer,
)
from higvf_interfaces.formats.gaze import plain as gaze_csv
from higvf_interfaces.formats.records import (
    ANYTHING,
    MAX_GAP,
    MIN_CONFIDENCE,
    GazeBlock,
    GazeRecording,
    GazeStream,
    Wanted,
    beyond,
    trusted,
)
from higvf_interfaces.formats.registry import GAZE, registered
from higvf_interfaces.formats.text import TextFile, look
from higvf_interfaces.formats.xdf import gaze as gaze_xdf


class GazeFormat(NamedTuple):
    """A gaze format: its name and title, and functions to recognise and open it."""

    name: str
    title: str
    matches: Callable[[TextFile], bool]
    begin: Callable[[TextFile, Wanted], GazeStream]

    def stream(self, file: TextFile, wanted: Wanted) -> GazeStream:
        """Open a file in this format.

        Raises:
            InputError: If the file lacks a required part, or a stream or channel is selected and the format is not XDF.
        """
        chosen = [f"{option}={value[:80]}" for option, value in wanted._asdict().items() if value is not None]
        if chosen and self.name != gaze_xdf.NAME:
            raise InputError(f"{file.path}: {', '.join(chosen)} is for XDF files; this is read as {self.name}")
        return self.begin(file, wanted)


# From the most specific to the most general: the first match is used.
GAZE_FORMATS: tuple[GazeFormat, ...] = (
    GazeFormat(gaze_xdf.NAME, gaze_xdf.TITLE, gaze_xdf.matches, gaze_xdf.stream),
    GazeFormat(neon_native.NAME, neon_native.TITLE, neon_native.matches, neon_native.stream),
    GazeFormat(eyelink_asc.NAME, eyelink_asc.TITLE, eyelink_asc.matches, eyelink_asc.stream),
    GazeFormat(tobii_prolab.NAME, tobii_prolab.TITLE, tobii_prolab.matches, tobii_prolab.stream),
    GazeFormat(tobii_old.NAME, tobii_old.TITLE, tobii_old.matches, tobii_old.stream),
    GazeFormat(tobii_research.NAME, tobii_research.TITLE, tobii_research.matches, tobii_research.stream),
    GazeFormat(pupil_core.SURFACE, pupil_core.SURFACE_TITLE, pupil_core.matches_surface, pupil_core.stream_surface),
    GazeFormat(pupil_core.CORE, pupil_core.CORE_TITLE, pupil_core.matches_core, pupil_core.stream_core),
    GazeFormat(neon_csv.NAME, neon_csv.TITLE, neon_csv.matches, neon_csv.stream),
    GazeFormat(gazepoint.NAME, gazepoint.TITLE, gazepoint.matches, gazepoint.stream),
    GazeFormat(bids_gaze.NAME, bids_gaze.TITLE, bids_gaze.matches, bids_gaze.stream),
    GazeFormat(webgazer.NAME, webgazer.TITLE, webgazer.matches, webgazer.stream),
    GazeFormat(gaze_csv.NAME, gaze_csv.TITLE, gaze_csv.matches, gaze_csv.stream),
)


def gaze_formats() -> tuple[GazeFormat, ...]:
    """Return the formats of other packages, then the console's own, in the order in which a file is asked.

    Raises:
        InputError: If another package's format cannot be used.
    """
    return registered(GAZE, GAZE_FORMATS)


class KnownFormat(Protocol):
    """Attributes common to all formats."""

    @property
    def name(self) -> str:
        """Name, as given to the option `format`."""
        ...

    @property
    def title(self) -> str:
        """Title, for messages."""
        ...

    @property
    def matches(self) -> Callable[..., bool]:
        """Function that returns whether a `TextFile` has this format."""
        ...


_Known = TypeVar("_Known", bound=KnownFormat)


class GazeFile:
    """A gaze recording that is read block by block: repaired times that start near 0, and only trusted samples valid.

    Attributes:
        stream: stream of the format.
        distrusted: number of samples with too low a confidence so far.
    """

    def __init__(self, path: Path, stream: GazeStream, least: float = MIN_CONFIDENCE) -> None:
        """Wrap the stream of a format; samples with a confidence below `least` are not valid."""
        self.stream = stream
        self.distrusted = 0
        self._path, self._least = path, least
        self._clock = DeviceClock(path, stream.start, LONGEST_STEP if stream.in_step else MAX_GAP)

    def blocks(self) -> Iterator[GazeBlock]:
        """Yield the samples once, at strictly increasing times; a file damaged later on yields its readable part.

        Raises:
            InputError: If no row has a time, a confidence exceeds 1, or not even the first block can be read.
        """
        readable = False
        try:
            for block in self.stream.blocks:
                time, kept = self._clock.repair(block.time)
                if len(time):
                    confidence = block.confidence[kept]
                    self._check(confidence)
                    sure = trusted(confidence, self._least)
                    self.distrusted += int(np.count_nonzero(block.valid[kept] & ~sure))
                    yield GazeBlock(time, block.points[kept], bools(block.valid[kept] & sure), confidence)
                    readable = True
        except InputError as problem:
            if not readable:
                raise
            self.stream.notes.append(f"only the readable part is used: {problem}")
        self._clock.check()

    @property
    def notes(self) -> tuple[str, ...]:
        """Repairs and assumptions so far, and the number of samples that are not trusted."""
        doubtful = (f"{self.distrusted} samples below min_confidence",) if self.distrusted else ()
        return tuple(dict.fromkeys((*self.stream.notes, *self._clock.repairs.notes, *doubtful)))

    def _check(self, confidence: Floats) -> None:
        """Refuse a confidence in another unit; as a share, every sample would be trusted."""
        if beyond(confidence).any():
            raise InputError(
                f"{self._path}: confidence {float(np.nanmax(confidence)):g} is not a share from 0 to 1; divide the "
                "column by its largest value"
            )

    @property
    def epoch(self) -> float:
        """Device time at time 0 [s]."""
        return self.stream.epoch + self._clock.epoch


def stream_gaze(
    source: str, format_name: str | None = None, wanted: Wanted = ANYTHING, least: float = MIN_CONFIDENCE
) -> GazeFile:
    """Open a gaze recording of any length; samples with a confidence below `least` are not valid.

    Raises:
        InputError: If the file is missing, empty or unrecognised, or lacks a required part of its format.
    """
    file = look(source)
    return GazeFile(file.path, choose_format(file, format_name, gaze_formats()).stream(file, wanted), least)


def read_gaze(source: str, format_name: str | None = None, wanted: Wanted = ANYTHING) -> GazeRecording:
    """Read a whole gaze recording.

    Raises:
        InputError: As `stream_gaze`, or if the recording has no times or no valid gaze.
    """
    file = stream_gaze(source, format_name, wanted)
    blocks = list(file.blocks())
    stream = file.stream
    recording = GazeRecording(
        time=floats(np.concatenate([block.time for block in blocks])),
        points=floats(np.concatenate([block.points for block in blocks])),
        valid=bools(np.concatenate([block.valid for block in blocks])),
        confidence=floats(np.concatenate([b.confidence for b in blocks])) if stream.has_confidence else None,
        frame=stream.frame,
        screen=stream.screen,
        epoch=file.epoch,
        format=stream.format,
        notes=file.notes,
        origin=stream.origin,
    )
    if not recording.valid.any():
        raise InputError(f"{source}: none of the {len(recording.time)} gaze samples is valid")
    return recording


def choose_format(file: TextFile, name: str | None, formats: Sequence[_Known]) -> _Known:
    """Return the format called `name`, or without a name the first one that matches the content.

    Raises:
        InputError: If there is none; the message lists the choices.
    """
    for known in formats:
        if known.name == name or (name is None and known.matches(file)):
            return known
    if name is not None:
        one_of("format", name, [known.name for known in formats], InputError)
    raise unknown_format(file, [(known.name, known.title) for known in formats])


def unknown_format(file: TextFile, sought: Sequence[tuple[str, str]]) -> InputError:
    """Return the error for an unrecognised file; `sought` lists name and title of the formats tried."""
    titles = "; ".join(f"{name}: {title}" for name, title in sought)
    held = f"its first line has: {file.titles}" if file.head else "it is a folder without a recording"
    return InputError(f"{file.path}: unrecognised format; {held}; formats tried: {titles}")
