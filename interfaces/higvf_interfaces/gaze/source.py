"""Source of a gaze recording: applies the options and yields samples in screen pixels on the session clock."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from higvf_console.core.arrays import bools
from higvf_console.core.interface import InputSpec
from higvf_interfaces.emulation import GAZE_ERRORS, GazeErrors, describe, error_model
from higvf_interfaces.fields import Fields
from higvf_interfaces.formats.reading import GazeFile, stream_gaze
from higvf_interfaces.formats.records import MIN_CONFIDENCE, GazeBlock, GazeStream, Wanted
from higvf_interfaces.formats.xdf import gaze as gaze_xdf
from higvf_interfaces.gaze.chunked_fixations import Pixels, chunk_per_block
from higvf_interfaces.gaze.fixations import IVT, METHODS, PX_PER_DEG, Classified
from higvf_interfaces.gaze.screens import NO_PIXELS_HINT, UnusableError, are_shares, choose_screen, on_screen, to_pixels

OPTIONS = (
    "format", "stream", "x", "y", "frame", "origin", "screen", "calibration", "px_per_deg", "method", "start",
    "min_confidence", *GAZE_ERRORS,
)  # fmt: skip
_MOST_AWAY = 0.25  # larger shares of gaze off the screen hint at wrong coordinates


class GazeSource:
    """An open gaze recording that can be read several times and counts its unusable samples.

    Attributes:
        screen: the recording's screen and its mapping to the arena.
        px_per_deg: pixels per degree of visual angle.
        method: method of fixation detection.
        file: the recording as last opened, with the notes so far.
        away: number of samples off the screen so far.
    """

    def __init__(self, spec: InputSpec, options: Fields) -> None:
        """Open `spec.source` and search for a usable sample.

        Raises:
            InputError: If the recording or an option is invalid.
            UnusableError: If the frame is unknown, or no sample is valid, of sufficient confidence and on the screen.
        """
        self._spec, self._options = spec, options
        self._format = options.text("format") if options.has("format") else None
        self._wanted = Wanted(*(str(options.values[key]) if options.has(key) else None for key in ("stream", "x", "y")))
        self.px_per_deg = options.number("px_per_deg", PX_PER_DEG, 1.0, 1000.0, "px/deg")
        self.method = options.choice("method", IVT, METHODS)
        self._start = options.number("start", 0.0, -1e6, 1e6, "s")
        self._trusted_from = options.number("min_confidence", MIN_CONFIDENCE, 0.0, 1.0)
        self._errors = error_model(options, spec.seed)
        self.away = self._seen = 0
        self._loaded: tuple[GazeStream, list[GazeBlock]] | None = None
        self.file = self._open()
        self._unread = True  # the open file serves the first read
        self.screen = choose_screen(self.file.stream, options, spec.arena)
        self._look_for_gaze()

    def blocks(self) -> Iterator[tuple[GazeBlock, Pixels]]:
        """Yield the samples from the start, block by block, as recorded and as screen pixels."""
        self.file = self.file if self._unread else self._open()
        self._unread = False
        self.away = self._seen = 0
        worsen = GazeErrors(self._errors, self.px_per_deg) if self._errors is not None else None
        for block in self.file.blocks():
            pixels = to_pixels(block.points, self.screen)
            if worsen is not None:
                pixels = worsen(block.time, pixels)
            usable = block.valid & on_screen(pixels, self.screen)
            self._seen += int(np.count_nonzero(block.valid))
            self.away += int(np.count_nonzero(block.valid & ~usable))
            yield block, Pixels(block.time + self._start, pixels, bools(usable))

    def chunks(self) -> Iterator[Classified | None]:
        """Yield the classified samples from the start; one item per block, see `chunk_per_block`."""
        return chunk_per_block((pixels for _, pixels in self.blocks()), self.px_per_deg, self.method)

    @property
    def format(self) -> str:
        """Name of the format."""
        return self.file.stream.format

    @property
    def notes(self) -> tuple[str, ...]:
        """Repairs, assumptions and omissions so far."""
        hint = "; check frame, origin and screen" if self.away > _MOST_AWAY * self._seen else ""
        away = (f"{self.away} samples off the screen{hint}",) if self.away else ()
        made = (f"emulated: {describe(self._errors)}",) if self._errors is not None else ()
        return (*self.file.notes, *self.screen.notes, *away, *made)

    def _open(self) -> GazeFile:
        """Open the recording; an XDF file is loaded whole, so it is loaded only once."""
        if self._loaded is None:
            file = stream_gaze(self._spec.source, self._format, self._wanted, self._trusted_from)
            if file.stream.format != gaze_xdf.NAME:
                return file
            self._loaded = file.stream, list(file.stream.blocks)
        stream, blocks = self._loaded
        return GazeFile(Path(self._spec.source), stream._replace(blocks=iter(blocks)), self._trusted_from)

    def _look_for_gaze(self) -> None:
        samples, valid = 0, False
        for block, pixels in self.blocks():
            if are_shares(block.points, self.screen):
                self._options.fail(NO_PIXELS_HINT, UnusableError)
            if pixels.valid.any():
                return
            samples += len(block.time)
            valid = valid or bool(block.valid.any())
        if not valid and not self.file.distrusted:
            self._options.fail(f"none of the {samples} gaze samples is valid", UnusableError)
        self._options.fail(
            "no gaze sample is confident and on the screen; check frame, origin, screen and min_confidence",
            UnusableError,
        )
