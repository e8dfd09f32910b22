"""Gaze interface, replayed or live: gaze moves the cursor, and fixations draw a stroke while the clutch is closed.

    recording -> screen pixels -> fixations in chunks -> session clock -> Cursor, StrokeBegin, StrokePoints, StrokeEnd

An explicit clutch starts and stops drawing, so that looking at the arena alone draws nothing (the Midas touch problem):
a key or a decoded gesture, the pause, or a dwell button. A fixation adds its centroid when it ends; a fixation that is
unfinished when the clutch opens adds the centroid of its part so far. A replay detects fixations ahead of time but uses
none before its end, so a replay and a live stream give the same strokes.
"""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import Cursor, OperatorCommand, StrokeBegin, StrokeCancel, StrokeEnd, StrokePoints
from higvf_console.core.interface import Capabilities, ChannelHealth, ChannelState, InputSpec, OperatorContext
from higvf_console.core.reports import AttentionReport, CalibrationReport, CaptureReport, DwellReport
from higvf_console.core.viewport import Viewport
from higvf_interfaces.emulation import GAZE_ERRORS, idle_seed
from higvf_interfaces.fields import Fields, option_fields
from higvf_interfaces.formats.clock import clock_warnings
from higvf_interfaces.gaze.attention_counts import AttentionCounts
from higvf_interfaces.gaze.calibration import calibration_report
from higvf_interfaces.gaze.dwell_button import IDLE, step
from higvf_interfaces.gaze.fixations import THRESHOLDS, Fixation
from higvf_interfaces.gaze.live_calibration import LiveCalibration
from higvf_interfaces.gaze.playback import GazePlayback
from higvf_interfaces.gaze.screens import ground_length, to_ground
from higvf_interfaces.gaze.source import OPTIONS as SOURCE_OPTIONS
from higvf_interfaces.gaze.source import GazeSource
from higvf_interfaces.live import lsl
from higvf_interfaces.live.gaze import LiveGaze
from higvf_interfaces.streams import RunClock, Stamp

OPTIONS = (*SOURCE_OPTIONS, *lsl.OPTIONS, "clutch", "button", "viewport", "commit")
_RECORDED_ALONE = ("format", "stream", "start", *GAZE_ERRORS)  # options that do not apply to a live stream
CLUTCHES = ("held", "paused", "always", "dwell")
PEN_UP = 1.5  # a longer loss of gaze ends the stroke [s]
LOST = 0.5  # a longer gap hides the cursor [s]
SMOOTHING = 0.5  # typical gaze error [deg]
_FEWEST = 3  # minimum number of distinct points of a stroke


class Box(NamedTuple):
    """A rectangle on the screen, in fractions of its width and height from the top left corner."""

    left: float
    top: float
    right: float
    bottom: float


BUTTON = Box(0.0, 0.85, 0.1, 1.0)  # bottom left corner: outside a letterboxed arena, and seldom looked at


class DrawingOptions(NamedTuple):
    """Options of drawing.

    Attributes:
        clutch: one of `CLUTCHES`.
        box: dwell button.
        follows_browser: whether the recording's screen is stretched onto the browser's view.
        waits: whether a drawn path waits for the action `confirm`.
    """

    clutch: str
    box: Box
    follows_browser: bool
    waits: bool


class GazeReplay:
    """Gaze interface on a recording or a live stream."""

    capabilities = Capabilities(stale_after=0.5)

    def __init__(self, spec: InputSpec) -> None:
        """Open `spec.source` and prefetch the first fixations.

        Raises:
            InputError: If the recording or an option is invalid.
        """
        options = option_fields(spec, OPTIONS)
        self._clutch, self._box, self._follows_browser, self._waits = drawing_options(options)
        self._warnings = idle_seed(options)
        self._live = LiveGaze(spec, options) if lsl.is_live(spec, _RECORDED_ALONE) else None
        self._source = self._live or GazeSource(spec, options)
        self._playback = GazePlayback(self._source.chunks) if isinstance(self._source, GazeSource) else self._source
        self._arena = spec.arena
        shown = self._source.screen.shown
        self._live_calibration = LiveCalibration(spec.arena, (shown.width_px, shown.height_px), self._source.px_per_deg)
        self._name = spec.channel
        self._stamp = Stamp(spec.channel)
        self._clock = RunClock()
        self._forget()

    @property
    def name(self) -> str:
        """Channel name, shown in the status line."""
        return self._name

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is doubtful about the recording's clock and the options."""
        return (*self._warnings, *clock_warnings(self._source.notes))

    def attention_report(self) -> AttentionReport | None:
        """Return the attention counts so far; None before the first sample."""
        return self._attention.report()

    def dwell_report(self) -> DwellReport | None:
        """Return progress and outline of the dwell button; None with another clutch."""
        if self._clutch != "dwell":
            return None
        shown, box = self._source.screen.shown, self._box
        around = [(box.left, box.top), (box.right, box.top), (box.right, box.bottom), (box.left, box.bottom)]
        corners = floats([*around, around[0]]) * [shown.width_px, shown.height_px]
        return DwellReport(self._dwell.progress, to_ground(corners, self._source.screen, self._browser))

    def calibration_report(self) -> CalibrationReport | None:
        """Return the calibration in use, if any."""
        calibration = self._source.screen.calibration
        return None if calibration is None else calibration_report(calibration)

    def capture_report(self) -> CaptureReport:
        """Return the state of the live calibration; a recording refuses one."""
        if self._live is None:
            return CaptureReport("Gaze is replayed: calibration needs a live eye tracker.")
        return self._live_calibration.report()

    def begin_capture(self) -> None:
        """Request a calibration; callable from any thread."""
        self._live_calibration.begin()

    def cancel_capture(self) -> None:
        """Cancel the running calibration; callable from any thread."""
        self._live_calibration.cancel()

    def poll(self, context: OperatorContext) -> list[OperatorCommand]:
        """Return the newest cursor and the changes of the stroke up to the session time."""
        if self._clock.was_reset(context.time):
            self._forget()
        self._browser = context.viewport if self._follows_browser else None
        new, ended = self._playback.advance(self._clock.now)
        self._calibrate()
        self._count(ended, context)
        self._press()
        commands = [*self._look(new), *self._draw(ended, context)]
        return [self._stamp(command, context.time, context) for command in commands]

    def health(self, now: float) -> ChannelHealth:
        """Never seen before the first sample; a recording is stale in a gap and ended after its last sample."""
        detail = "; ".join((self._remark, self._source.format, *self._source.notes))
        if self._live is not None:
            quiet = self._live.reader.quiet
            state = ChannelState.NEVER_SEEN if quiet is None else ChannelState.LIVE
            return ChannelHealth(state, detail, None if quiet is None else now - quiet)
        if not self._playback.started:
            return ChannelHealth(ChannelState.NEVER_SEEN, f"starts at {self._playback.first_time:.1f} s; {detail}")
        if self._playback.ended:
            return ChannelHealth(ChannelState.ENDED, f"replayed to its end; {detail}")
        gap = now - self._playback.time > LOST
        return ChannelHealth(ChannelState.STALE if gap else ChannelState.LIVE, detail)

    def close(self) -> None:
        """Stop reading a live stream; files are closed as soon as they are read."""
        if self._live is not None:
            self._live.close()

    def _forget(self) -> None:
        """Reset the state, because the run was reset."""
        self._dwell = IDLE
        self._attention = AttentionCounts(self._arena)
        self._browser: Viewport | None = None  # view onto which the recording's screen is stretched
        self._toggled = False  # state of the clutch set by the dwell button
        self._cursor_shown = False
        self._last_seen = -math.inf
        self._drawing = False
        self._lifted = False  # a loss of gaze ended the stroke; the clutch must open before a new one
        self._stroke: list[Floats] = []
        self._remark = "no stroke yet"

    def _calibrate(self) -> None:
        """Pass the samples of a live tracker to the calibration, and adopt a completed one."""
        if self._live is None:
            return
        made = self._live_calibration.take(self._live.newest)
        if made is not None:
            self._live.screen = self._live.screen._replace(calibration=made)

    def _count(self, ended: list[Fixation], context: OperatorContext) -> None:
        """Update the attention counts."""
        playback = self._playback
        fresh = playback.started and playback.seen and self._clock.now - playback.time <= THRESHOLDS.longest_filled
        self._attention.look(self._clock.now, self._ground(playback.point) if fresh else None, context.targets)
        self._fixate(ended)

    def _fixate(self, ended: list[Fixation]) -> None:
        degree = self._length(1.0) if ended else 0.0
        for fixation in ended:
            self._attention.fixate(fixation._replace(point=self._ground(fixation.point)), degree)

    def _press(self) -> None:
        """Update the dwell button."""
        if self._clutch != "dwell" or not self._playback.started:
            return
        fresh = self._playback.seen and self._clock.now - self._playback.time <= LOST
        self._dwell = step(self._dwell, self._clock.now, fresh and self._on_button(self._playback.point))
        self._toggled ^= self._dwell.pressed

    def _on_button(self, pixel: Floats) -> bool:
        shown, box = self._source.screen.shown, self._box
        x, y = float(pixel[0] / shown.width_px), float(pixel[1] / shown.height_px)
        return self._clutch == "dwell" and box.left <= x <= box.right and box.top <= y <= box.bottom

    def _look(self, new: bool) -> list[OperatorCommand]:
        """Return the cursor at the newest sample, or NaN once when gaze is lost."""
        if not self._playback.started:
            return []
        age = self._clock.now - self._playback.time
        if self._playback.seen and age <= LOST and not (self._playback.ended and not new):
            self._last_seen = self._playback.time
            if not new:
                return []
            self._cursor_shown = True
            return [Cursor(self._ground(self._playback.point))]
        if not self._cursor_shown:
            return []
        self._cursor_shown = False
        return [Cursor(np.full(2, np.nan))]

    def _draw(self, ended: list[Fixation], context: OperatorContext) -> list[OperatorCommand]:
        """Return the commands of the stroke: begin and end follow the clutch, completed fixations add points."""
        wanted = self._wanted(context)
        self._lifted = self._lifted and wanted
        commands: list[OperatorCommand] = []
        if wanted and not self._drawing and not self._lifted:
            self._drawing, self._stroke, self._last_seen = True, [], max(self._last_seen, self._clock.now)
            commands.append(StrokeBegin())
        if not self._drawing:
            return commands
        blind = self._clutch != "always" and self._clock.now - self._last_seen > PEN_UP
        if not wanted or blind:
            rest = self._playback.unfinished()
            ended = [*ended, *rest]
            if self._live is not None:  # a live stream does not return these fixations again
                self._fixate(rest)
        grown = [fixation.point for fixation in ended if not self._on_button(fixation.point)]
        if grown:
            self._stroke += [self._ground(point) for point in grown]
            commands.append(StrokePoints(floats(self._stroke[-len(grown) :])))
        if not wanted or blind:
            self._drawing, self._lifted, self._toggled = False, blind, False
            commands.append(self._end())
        return commands

    def _wanted(self, context: OperatorContext) -> bool:
        if self._clutch == "always":
            return self._playback.started and not self._playback.ended
        if self._clutch == "dwell":
            return self._toggled and not self._playback.ended
        return context.paused if self._clutch == "paused" else context.clutch

    def _end(self) -> OperatorCommand:
        distinct = len(np.unique(floats(self._stroke, -1, 2), axis=0))
        self._remark = f"last stroke: {distinct} fixations"
        if distinct < _FEWEST:
            self._remark += f", dropped: a path needs {_FEWEST}"
            return StrokeCancel()
        return StrokeEnd(smoothing=self._length(SMOOTHING), preview=self._waits)

    def _length(self, degrees: float) -> float:
        """Return the ground length [m] of a visual angle [deg]."""
        return ground_length(degrees * self._source.px_per_deg, self._source.screen, self._browser)

    def _ground(self, pixel: Floats) -> Floats:
        return to_ground(floats(pixel, 1, 2), self._source.screen, self._browser)[0]


def open_gaze(spec: InputSpec) -> GazeReplay:
    """Entry point `gaze`; the options are in interfaces/README.md."""
    return GazeReplay(spec)


def drawing_options(options: Fields) -> DrawingOptions:
    """Read the options of drawing.

    Raises:
        InputError: If an option is invalid.
    """
    return DrawingOptions(
        clutch=options.choice("clutch", "held", CLUTCHES),
        box=_button(options),
        follows_browser=options.choice("viewport", "fit", ("fit", "browser")) == "browser",
        waits=options.choice("commit", "at-once", ("at-once", "confirm")) == "confirm",
    )


def _button(options: Fields) -> Box:
    """Return the dwell button: the option `button`, or the default."""
    if not options.has("button"):
        return BUTTON
    box = Box(*options.numbers("button", 4))
    if not (0 <= box.left < box.right <= 1 and 0 <= box.top < box.bottom <= 1):
        options.fail(f"button: {list(box)!r} is not [left, top, right, bottom] in fractions of the screen, 0 to 1")
    return box
