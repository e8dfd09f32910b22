"""Replayed gaze as operator input: where the operator looks is the cursor, and under the clutch fixations draw.

    recording -> screen pixels -> fixations (once, at loading) -> session clock -> Cursor, StrokeBegin / Points / End

Drawing starts and stops by an explicit clutch, never because gaze is in the arena (the Midas touch). A fixation adds
its centroid when it is complete; the one that lasts when the clutch opens adds what there is of it. Finding fixations
ahead of time gives the same ones as finding them live would: no centroid is handed out before its fixation has ended.
"""

import math

import numpy as np

from higvf_console.arrays import Floats, floats
from higvf_console.commands import (
    ChannelHealth,
    ChannelState,
    Cursor,
    InputSpec,
    OperatorCommand,
    OperatorContext,
    StrokeBegin,
    StrokeCancel,
    StrokeEnd,
    StrokePoints,
)
from higvf_console.viewport import Viewport
from higvf_interfaces.emulation import GAZE_ERRORS, describe, emulate_gaze, error_model
from higvf_interfaces.fields import Fields, option_fields
from higvf_interfaces.fixations import PX_PER_DEG, THRESHOLDS, Classified, centroid, classify
from higvf_interfaces.formats.reading import read_gaze
from higvf_interfaces.formats.records import GazeRecording
from higvf_interfaces.screens import choose_frame, choose_screen, on_screen, to_ground, to_pixels
from higvf_interfaces.streams import Playhead, Stamp

OPTIONS = ("format", "frame", "screen", "px_per_deg", "clutch", "viewport", "start", "min_confidence", *GAZE_ERRORS)
CLUTCHES = ("held", "paused", "always")
PEN_UP = 1.5  # without valid gaze for so long, the pen lifts itself [s]
LOST = 0.5  # a hole in the log that long loses the cursor [s]
SMOOTHING = 0.5  # what gaze can be off by [deg]
_FEWEST = 3  # distinct points that make a stroke


class GazeReplay:
    """A gaze recording, played on the session clock."""

    def __init__(self, spec: InputSpec) -> None:
        """Reads and classifies `spec.source`.

        Raises:
            InputError: the recording or an option cannot be used.
        """
        options = option_fields(spec, OPTIONS)
        self._clutch = options.choice("clutch", "held", CLUTCHES)
        self._follows_browser = options.choice("viewport", "fit", ("fit", "browser")) == "browser"
        recording = read_gaze(spec.source, options.text("format") if options.has("format") else None)
        self._screen, assumed = choose_screen(recording, options, spec.arena)
        px_per_deg = options.number("px_per_deg", PX_PER_DEG, 1.0, 1000.0, "px/deg")
        self._gaze, unusable = _prepare(recording, self._screen, options, px_per_deg)
        self._smoothing_px = SMOOTHING * px_per_deg
        self._name = spec.channel
        self._detail = _describe(recording, self._gaze, (*recording.notes, *assumed, *unusable))
        self._samples = Playhead(self._gaze.time)
        self._fixations = Playhead(self._gaze.time[self._gaze.last])
        self._stamp = Stamp(spec.channel)
        self._now = -math.inf
        self._forget()

    @property
    def name(self) -> str:
        """Channel name, shown in the status line."""
        return self._name

    def poll(self, context: OperatorContext) -> list[OperatorCommand]:
        """The newest cursor, and what the stroke has become, by session time."""
        if context.time < self._now:
            self._forget()
        self._now = context.time
        samples, fixations = self._samples.advance(self._now), self._fixations.advance(self._now)
        if samples:
            self._newest = samples[-1]
        commands = [*self._look(samples, context), *self._draw(fixations, context)]
        return [self._stamp(command, context.time, context) for command in commands]

    def health(self, now: float) -> ChannelHealth:
        """Never seen before the first sample, stale in a hole, ended behind the last."""
        detail = f"{self._remark}; {self._detail}"
        if not self._samples.started:
            return ChannelHealth(ChannelState.NEVER_SEEN, f"starts at {self._gaze.time[0]:.1f} s; {detail}")
        if self._samples.ended:
            return ChannelHealth(ChannelState.ENDED, f"replayed to its end; {detail}")
        hole = now - self._gaze.time[self._newest] > LOST
        return ChannelHealth(ChannelState.STALE if hole else ChannelState.LIVE, detail)

    def close(self) -> None:
        """Has nothing to let go of: the file was closed after reading."""

    def _forget(self) -> None:
        """Starts like new, because the run has."""
        self._newest = -1
        self._cursor_shown = False
        self._last_seen = -math.inf
        self._drawing = False
        self._lifted = False  # the pen lifted itself; the clutch must open before it draws again
        self._stroke: list[Floats] = []
        self._remark = "no stroke yet"

    def _look(self, samples: range, context: OperatorContext) -> list[OperatorCommand]:
        """The cursor: at the newest sample, or NaN once when gaze is lost."""
        if self._newest < 0:
            return []
        age = self._now - self._gaze.time[self._newest]
        if self._gaze.seen[self._newest] and age <= LOST and not (self._samples.ended and not samples):
            self._last_seen = float(self._gaze.time[self._newest])
            if not samples:
                return []
            self._cursor_shown = True
            return [Cursor(self._ground(self._gaze.points[self._newest], context))]
        if not self._cursor_shown:
            return []
        self._cursor_shown = False
        return [Cursor(np.full(2, np.nan))]

    def _draw(self, fixations: range, context: OperatorContext) -> list[OperatorCommand]:
        """The stroke: begins and ends by the clutch, grows by the centroids of fixations that have ended."""
        wanted = self._wanted(context)
        self._lifted = self._lifted and wanted
        commands: list[OperatorCommand] = []
        if wanted and not self._drawing and not self._lifted:
            self._drawing, self._stroke, self._last_seen = True, [], max(self._last_seen, self._now)
            commands.append(StrokeBegin())
        if not self._drawing:
            return commands
        grown = [centroid(self._gaze, self._gaze.first[f], self._gaze.last[f]) for f in fixations]
        blind = self._clutch != "always" and self._now - self._last_seen > PEN_UP
        if not wanted or blind:
            grown += self._unfinished()
        if grown:
            self._stroke += [self._ground(point, context) for point in grown]
            commands.append(StrokePoints(floats(self._stroke[-len(grown) :])))
        if not wanted or blind:
            self._drawing, self._lifted = False, blind
            commands.append(self._end(context))
        return commands

    def _wanted(self, context: OperatorContext) -> bool:
        if self._clutch == "always":
            return self._samples.started and not self._samples.ended
        return context.paused if self._clutch == "paused" else context.clutch

    def _unfinished(self) -> list[Floats]:
        """The centroid so far of the fixation that lasts now, if it is long enough to be one."""
        time, first = self._gaze.time, self._gaze.first
        current = int(np.searchsorted(first, self._newest, side="right")) - 1
        if current < 0 or self._gaze.last[current] <= self._newest:
            return []
        if time[self._newest] - time[first[current]] < THRESHOLDS.shortest:
            return []
        return [centroid(self._gaze, int(first[current]), self._newest)]

    def _end(self, context: OperatorContext) -> OperatorCommand:
        distinct = len(np.unique(floats(self._stroke, -1, 2), axis=0))
        self._remark = f"last stroke: {distinct} fixations"
        if distinct < _FEWEST:
            self._remark += f", dropped: {_FEWEST} make a path"
            return StrokeCancel()
        corner = floats([[0.0, 0.0], [self._smoothing_px, 0.0]])
        ground = to_ground(corner, self._screen, self._viewport(context))
        return StrokeEnd(smoothing=float(ground[1, 0] - ground[0, 0]))

    def _viewport(self, context: OperatorContext) -> Viewport | None:
        return context.viewport if self._follows_browser else None

    def _ground(self, pixel: Floats, context: OperatorContext) -> Floats:
        return to_ground(pixel, self._screen, self._viewport(context))


def open_gaze(spec: InputSpec) -> GazeReplay:
    """Entry point `gaze`; the options are in interfaces/README.md."""
    return GazeReplay(spec)


def _prepare(
    recording: GazeRecording, screen: Viewport, options: Fields, px_per_deg: float
) -> tuple[Classified, tuple[str, ...]]:
    """The recording in screen pixels on the session clock, classified, and what of it cannot be used."""
    pixels = to_pixels(recording.points, choose_frame(recording, options), screen)
    errors = error_model(options)
    if errors is not None:
        recording = emulate_gaze(recording._replace(points=pixels), errors, px_per_deg)
        pixels = recording.points
    valid = recording.valid
    if recording.confidence is not None:
        trusted = ~(recording.confidence < options.number("min_confidence", 0.6, 0.0, 1.0))
        valid = valid & trusted
    inside = on_screen(pixels, screen)
    away = np.count_nonzero(valid & ~inside)
    valid = valid & inside
    if not valid.any():
        options.fail("no gaze sample is trusted and on the screen; check frame, screen and min_confidence")
    time = recording.time + options.number("start", 0.0, -1e6, 1e6, "s")
    notes = [f"{away} samples off the screen"] if away else []
    if errors is not None:
        notes.append(f"emulated: {describe(errors)}")
    return classify(time, pixels, valid, px_per_deg), tuple(notes)


def _describe(recording: GazeRecording, gaze: Classified, notes: tuple[str, ...]) -> str:
    rate = 1 / float(np.median(np.diff(gaze.time))) if len(gaze.time) > 1 else 0.0
    facts = f"{recording.format}, {rate:.0f} Hz, {100 * np.mean(gaze.seen):.0f} % seen, {len(gaze.first)} fixations"
    return "; ".join((facts, *notes))
