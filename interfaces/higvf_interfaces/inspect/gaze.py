"""Inspection of gaze recordings in one pass and bounded memory."""

from collections.abc import Iterator, Mapping

import numpy as np

from higvf_interfaces.formats.reading import GazeFile, choose_format, gaze_formats
from higvf_interfaces.formats.records import MIN_CONFIDENCE, GazeBlock, GazeStream, Wanted
from higvf_interfaces.formats.xdf import gaze as gaze_xdf
from higvf_interfaces.gaze.chunked_fixations import Pixels, classify_blocks
from higvf_interfaces.gaze.conversion_preview import ConversionPreview
from higvf_interfaces.gaze.screens import UnusableError
from higvf_interfaces.gaze.source import GazeSource
from higvf_interfaces.inspect.description import Request, description, write_picture


def knows(request: Request) -> bool:
    """Return whether the file is a gaze recording; an XDF file is one only if it has a gaze stream or `x` is set."""
    options = request.options
    if request.format is not None:
        return request.format in [known.name for known in gaze_formats()]
    if gaze_xdf.matches(request.file):
        return options.has("x") or gaze_xdf.has_gaze(request.file)
    return any(known.matches(request.file) for known in gaze_formats())


def describe(request: Request) -> Mapping[str, object]:
    """Read and describe the recording.

    Raises:
        InputError: If the recording cannot be read or an option is invalid. If only the frame is unknown, or no sample
            is usable, the description gives the known values and the reason as a warning.
    """
    counts = SampleCounts()
    try:
        source = GazeSource(request.spec, request.options)
    except UnusableError as problem:
        return _unusable(request, counts, str(problem))
    preview = ConversionPreview(source.screen, source.px_per_deg, request.spec.arena)
    for chunk in classify_blocks(_counted(source, counts), source.px_per_deg, source.method):
        preview.add(chunk)
    preview.finish()
    if request.plot is not None:
        write_picture(request.plot, preview.picture())
    recorded = {"recorded": counts.samples, "valid": counts.valid, "trusted and on the screen": counts.usable}
    steps: dict[str, object] = {"steps": {**recorded, **preview.steps()}} if request.steps else {}
    stream = source.file.stream
    return description(
        format_name=stream.format,
        kind="gaze",
        streams=stream.streams,
        columns=stream.columns,
        samples=counts.samples,
        duration=counts.duration,
        rate=counts.rate,
        frame=source.screen.frame,
        origin=source.screen.origin,
        valid_share=counts.valid / max(counts.samples, 1),
        gaps=preview.gaps,
        blinks=preview.blinks,
        screen_px=[source.screen.shown.width_px, source.screen.shown.height_px],
        epoch_s=source.file.epoch,
        becomes=preview.summary,
        **steps,
        warnings=source.notes,
    )


class SampleCounts:
    """Sample counts that do not depend on the frame."""

    def __init__(self) -> None:
        """Start at zero."""
        self.samples = self.valid = self.usable = 0
        self.first: float | None = None
        self.last = 0.0
        self._steps: list[float] = []

    def add(self, block: GazeBlock) -> None:
        """Add the counts of a block."""
        self.samples += len(block.time)
        self.valid += int(np.count_nonzero(block.valid))
        self.first = float(block.time[0]) if self.first is None else self.first
        self.last = float(block.time[-1])
        if len(block.time) > 1:
            self._steps.append(float(np.median(np.diff(block.time))))

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return 0.0 if self.first is None else self.last - self.first

    @property
    def rate(self) -> float | None:
        """Sampling rate [Hz] by the median time step; None if unknown."""
        return 1 / float(np.median(self._steps)) if self._steps else None


def _counted(source: GazeSource, counts: SampleCounts) -> Iterator[Pixels]:
    """Yield the recording's samples as pixels and count them."""
    for block, pixels in source.blocks():
        counts.add(block)
        counts.usable += int(np.count_nonzero(pixels.valid))
        yield pixels


def _unusable(request: Request, counts: SampleCounts, reason: str) -> Mapping[str, object]:
    """Describe a recording whose samples are unusable."""
    options = request.options
    wanted = Wanted(*(str(options.values[key]) if options.has(key) else None for key in ("stream", "x", "y")))
    gaze = GazeFile(
        request.file.path,
        choose_format(request.file, request.format, gaze_formats()).stream(request.file, wanted),
        options.number("min_confidence", MIN_CONFIDENCE, 0.0, 1.0),
    )
    for block in gaze.blocks():
        counts.add(block)
    picture = ("no picture: the frame is unknown or no sample is usable",) if request.plot is not None else ()
    return description(
        format_name=gaze.stream.format,
        kind="gaze",
        streams=gaze.stream.streams,
        columns=gaze.stream.columns,
        samples=counts.samples,
        duration=counts.duration,
        rate=counts.rate,
        frame=gaze.stream.frame,
        origin=_stated_origin(gaze.stream),
        valid_share=counts.valid / max(counts.samples, 1),
        screen_px=gaze.stream.screen and list(gaze.stream.screen),
        epoch_s=gaze.epoch,
        becomes={},
        warnings=(f"unusable: {reason}", *picture, *gaze.notes),
    )


def _stated_origin(stream: GazeStream) -> str | None:
    """Return the origin of the coordinates; None if it is in doubt, or their frame is unknown."""
    doubted = any(doubt.option == "origin" for doubt in stream.doubts)
    return None if doubted or stream.frame is None else stream.origin
