"""A gaze recording as an operator's options want it: read again as often as needed, in pixels, on the session clock."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from higvf_console.core.arrays import bools
from higvf_console.core.interface import InputSpec
from higvf_interfaces.emulation import GAZE_ERRORS, GazeErrors, describe, error_model
from higvf_interfaces.fields import Fields
from higvf_interfaces.formats.reading import GazeFile, stream_gaze
from higvf_interfaces.formats.records import GazeBlock, GazeStream, Wanted
from higvf_interfaces.formats.xdf import gaze as gaze_xdf
from higvf_interfaces.gaze.fixations import IVT, METHODS, PX_PER_DEG, Classified
from higvf_interfaces.gaze.chunked_fixations import Pixels, chunk_per_block
from higvf_interfaces.gaze.screens import UnusableError, choose_screen, on_screen, to_pixels

OPTIONS = (
    "format", "stream", "x", "y", "frame", "origin", "screen", "calibration", "px_per_deg", "method", "start",
    "min_confidence", *GAZE_ERRORS,
)  # fmt: skip


class GazeSource:
    """A recording, opened; reading it through counts what of it cannot be used.

    Attributes:
        screen: the recording's screen and what lies under it.
        px_per_deg: pixels in one degree of visual angle.
        method: how fixations are found.
        file: the recording as it was last opened, with what has been repaired so far.
        distrusted: samples of too low a confidence so far.
        away: samples off the screen so far.
    """

    def __init__(self, spec: InputSpec, options: Fields) -> None:
        """Opens `spec.source` and looks for gaze in it.

        Raises:
            InputError: the recording or an option cannot be used.
            UnusableError: its frame is unknown, or no sample is valid, trusted and on the screen.
        """
        self._spec, self._options = spec, options
        self._format = options.text("format") if options.has("format") else None
        self._wanted = Wanted(*(str(options.values[key]) if options.has(key) else None for key in ("stream", "x", "y")))
        self.px_per_deg = options.number("px_per_deg", PX_PER_DEG, 1.0, 1000.0, "px/deg")
        self.method = options.choice("method", IVT, METHODS)
        self._start = options.number("start", 0.0, -1e6, 1e6, "s")
        self._trusted_from = options.number("min_confidence", 0.6, 0.0, 1.0)
        self._errors = error_model(options)
        self.distrusted = self.away = 0
        self._loaded: tuple[GazeStream, list[GazeBlock]] | None = None
        self.file = self._open()
        self._unread = True  # what is open is read first
        self.screen = choose_screen(self.file.stream, options, spec.arena)
        self._look_for_gaze()

    def blocks(self) -> Iterator[tuple[GazeBlock, Pixels]]:
        """The samples from the start, as recorded and as they can be used."""
        self.file = self.file if self._unread else self._open()
        self._unread = False
        self.distrusted = self.away = 0
        worsen = GazeErrors(self._errors, self.px_per_deg) if self._errors is not None else None
        for block in self.file.blocks():
            pixels = to_pixels(block.points, self.screen)
            time, valid = block.time, block.valid
            if worsen is not None:
                time, pixels, valid = worsen(time, pixels, valid)
            trusted = valid & ~(block.confidence < self._trusted_from)
            usable = trusted & on_screen(pixels, self.screen)
            self.distrusted += int(np.count_nonzero(valid & ~trusted))
            self.away += int(np.count_nonzero(trusted & ~usable))
            yield block, Pixels(time + self._start, pixels, bools(usable))

    def chunks(self) -> Iterator[Classified | None]:
        """The samples from the start, with their fixations: an item for each block that is read."""
        return chunk_per_block((pixels for _, pixels in self.blocks()), self.px_per_deg, self.method)

    @property
    def format(self) -> str:
        """Name of the format."""
        return self.file.stream.format

    @property
    def notes(self) -> tuple[str, ...]:
        """What has been repaired, assumed or left out so far, in words."""
        away = (f"{self.away} samples off the screen",) if self.away else ()
        doubtful = (f"{self.distrusted} samples of too low a confidence",) if self.distrusted else ()
        made = (f"emulated: {describe(self._errors)}",) if self._errors is not None else ()
        return (*self.file.notes, *self.screen.notes, *away, *doubtful, *made)

    def _open(self) -> GazeFile:
        """Begins to read the recording; XDF, which is loaded whole, is loaded once."""
        if self._loaded is None:
            file = stream_gaze(self._spec.source, self._format, self._wanted)
            if file.stream.format != gaze_xdf.NAME:
                return file
            self._loaded = file.stream, list(file.stream.blocks)
        stream, blocks = self._loaded
        return GazeFile(Path(self._spec.source), stream._replace(blocks=iter(blocks)))

    def _look_for_gaze(self) -> None:
        samples, valid = 0, False
        for block, pixels in self.blocks():
            if pixels.valid.any():
                return
            samples += len(block.time)
            valid = valid or bool(block.valid.any())
        if not valid:
            self._options.fail(f"none of the {samples} gaze samples is valid", UnusableError)
        self._options.fail(
            "no gaze sample is trusted and on the screen; check frame, origin, screen and min_confidence", UnusableError
        )
