"""Gaze, replayed or live, as operator input: where the operator looks is the cursor, under the clutch fixations draw.

    recording -> screen pixels -> fixations, piece by piece -> session clock -> Cursor, StrokeBegin / Points / End

Drawing starts and stops by an explicit clutch, never because gaze is in the arena (the Midas touch): a key or a
decoded gesture that holds it, the pause, or a button that gaze rests on. A fixation adds its centroid when it is
complete; the one that lasts when the clutch opens adds what there is of it. Finding fixations ahead of time gives the
same ones as finding them live would: no centroid is handed out before its fixation has ended.
"""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import Cursor, OperatorCommand, StrokeBegin, StrokeCancel, StrokeEnd, StrokePoints
from higvf_console.core.interface import Capabilities, ChannelHealth, ChannelState, InputSpec, OperatorContext
from higvf_console.core.reports import AttentionReport, CalibrationReport, CaptureReport, DwellReport
from higvf_console.core.viewport import Viewport
from higvf_interfaces.emulation import GAZE_ERRORS
from higvf_interfaces.fields import Fields, option_fields
from higvf_interfaces.gaze.calibration import calibration_report
from higvf_interfaces.gaze.capture import Capture
from higvf_interfaces.gaze.dwell_button import IDLE, step
from higvf_interfaces.gaze.fixations import THRESHOLDS, Fixation
from higvf_interfaces.gaze.playback import GazePlayback
from higvf_interfaces.gaze.screens import ground_length, to_ground
from higvf_interfaces.gaze.source import OPTIONS as SOURCE_OPTIONS
from higvf_interfaces.gaze.source import GazeSource
from higvf_interfaces.gaze.tally import GazeTally
from higvf_interfaces.live import lsl
from higvf_interfaces.live.gaze import LiveGaze
from higvf_interfaces.streams import Stamp

OPTIONS = (*SOURCE_OPTIONS, *lsl.OPTIONS, "clutch", "button", "viewport", "commit")
_RECORDED_ALONE = ("format", "stream", "start", *GAZE_ERRORS)  # options that mean nothing live
CLUTCHES = ("held", "paused", "always", "dwell")
PEN_UP = 1.5  # without valid gaze for so long, the pen lifts itself [s]
LOST = 0.5  # a hole in the log that long loses the cursor [s]
SMOOTHING = 0.5  # what gaze can be off by [deg]
_FEWEST = 3  # distinct points that make a stroke


class Box(NamedTuple):
    """A rectangle of the screen, in shares of its width and height from the top left corner."""

    left: float
    top: float
    right: float
    bottom: float


BUTTON = Box(0.0, 0.85, 0.1, 1.0)  # the bottom left corner: the arena is letterboxed, and the eye seldom there


class Manner(NamedTuple):
    """How gaze draws: its clutch and button, whether the browser's view counts, whether a path waits for `confirm`."""

    clutch: str
    box: Box
    follows_browser: bool
    waits: bool


class GazeReplay:
    """A gaze recording on the session clock, or a live stream."""

    capabilities = Capabilities(stale_after=0.5)

    def __init__(self, spec: InputSpec) -> None:
        """Opens `spec.source` and finds the first fixations.

        Raises:
            InputError: the recording or an option cannot be used.
        """
        options = option_fields(spec, OPTIONS)
        self._clutch, self._box, self._follows_browser, self._waits = manner(options)
        self._live = LiveGaze(spec, options) if lsl.is_live(spec, _RECORDED_ALONE) else None
        self._source = self._live or GazeSource(spec, options)
        self._playback = GazePlayback(self._source.pieces) if isinstance(self._source, GazeSource) else self._source
        self._arena = spec.arena
        shown = self._source.screen.shown
        self._capture = Capture(spec.arena, (shown.width_px, shown.height_px), self._source.px_per_deg)
        self._name = spec.channel
        self._stamp = Stamp(spec.channel)
        self._now = -math.inf
        self._forget()

    @property
    def name(self) -> str:
        """Channel name, shown in the status line."""
        return self._name

    def attention_report(self) -> AttentionReport | None:
        """What has been looked at so far; None before the first sample."""
        return self._tally.report()

    def dwell_report(self) -> DwellReport | None:
        """The button; None with another clutch."""
        if self._clutch != "dwell":
            return None
        shown, box = self._source.screen.shown, self._box
        around = [(box.left, box.top), (box.right, box.top), (box.right, box.bottom), (box.left, box.bottom)]
        corners = floats([*around, around[0]]) * [shown.width_px, shown.height_px]
        return DwellReport(self._dwell.progress, to_ground(corners, self._source.screen, self._browser))

    def calibration_report(self) -> CalibrationReport | None:
        """The calibration in use."""
        calibration = self._source.screen.calibration
        return None if calibration is None else calibration_report(calibration)

    def capture_report(self) -> CaptureReport:
        """How the making of a calibration stands; a recording can have none."""
        if self._live is None:
            return CaptureReport("Gaze is replayed: a calibration is made with a live eye tracker.")
        return self._capture.report()

    def begin_capture(self) -> None:
        """Begins to make a calibration; callable from any thread."""
        self._capture.begin()

    def cancel_capture(self) -> None:
        """Gives it up; callable from any thread."""
        self._capture.cancel()

    def poll(self, context: OperatorContext) -> list[OperatorCommand]:
        """The newest cursor, and what the stroke has become, by session time."""
        if context.time < self._now:
            self._forget()
        self._now = context.time
        self._browser = context.viewport if self._follows_browser else None
        new, ended = self._playback.advance(self._now)
        self._calibrate()
        self._count(ended, context)
        self._press()
        commands = [*self._look(new), *self._draw(ended, context)]
        return [self._stamp(command, context.time, context) for command in commands]

    def health(self, now: float) -> ChannelHealth:
        """Never seen before the first sample; a recording is stale in a hole and ended behind its last sample."""
        detail = "; ".join((self._remark, self._source.format, *self._source.notes))
        if self._live is not None:
            quiet = self._live.reader.quiet
            state = ChannelState.NEVER_SEEN if quiet is None else ChannelState.LIVE
            return ChannelHealth(state, detail, None if quiet is None else now - quiet)
        if not self._playback.started:
            return ChannelHealth(ChannelState.NEVER_SEEN, f"starts at {self._playback.first_time:.1f} s; {detail}")
        if self._playback.ended:
            return ChannelHealth(ChannelState.ENDED, f"replayed to its end; {detail}")
        hole = now - self._playback.time > LOST
        return ChannelHealth(ChannelState.STALE if hole else ChannelState.LIVE, detail)

    def close(self) -> None:
        """Ends the reading of a live stream; a file was closed after reading."""
        if self._live is not None:
            self._live.close()

    def _forget(self) -> None:
        """Starts like new, because the run has."""
        self._dwell = IDLE
        self._tally = GazeTally(self._arena)
        self._browser: Viewport | None = None  # onto which the recording's screen is stretched
        self._toggled = False  # by the button: drawing is wanted
        self._cursor_shown = False
        self._last_seen = -math.inf
        self._pointer_state = False
        self._lifted = False  # the pen lifted itself; the clutch must open before it draws again
        self._stroke: list[Floats] = []
        self._remark = "no stroke yet"

    def _calibrate(self) -> None:
        """Hands a live tracker's samples to the making of a calibration, and uses the one that is made."""
        if self._live is None:
            return
        made = self._capture.take(self._live.newest)
        if made is not None:
            self._live.screen = self._live.screen._replace(calibration=made)

    def _count(self, ended: list[Fixation], context: OperatorContext) -> None:
        """Adds to what has been looked at."""
        playback = self._playback
        fresh = playback.started and playback.seen and self._now - playback.time <= THRESHOLDS.longest_filled
        self._tally.look(self._now, self._ground(playback.point) if fresh else None, context.targets)
        self._fixate(ended)

    def _fixate(self, ended: list[Fixation]) -> None:
        degree = self._length(1.0) if ended else 0.0
        for fixation in ended:
            self._tally.fixate(fixation._replace(point=self._ground(fixation.point)), degree)

    def _press(self) -> None:
        """Lets gaze work the button."""
        if self._clutch != "dwell" or not self._playback.started:
            return
        fresh = self._playback.seen and self._now - self._playback.time <= LOST
        self._dwell = step(self._dwell, self._now, fresh and self._on_button(self._playback.point))
        self._toggled ^= self._dwell.pressed

    def _on_button(self, pixel: Floats) -> bool:
        shown, box = self._source.screen.shown, self._box
        x, y = float(pixel[0] / shown.width_px), float(pixel[1] / shown.height_px)
        return self._clutch == "dwell" and box.left <= x <= box.right and box.top <= y <= box.bottom

    def _look(self, new: bool) -> list[OperatorCommand]:
        """The cursor: at the newest sample, or NaN once when gaze is lost."""
        if not self._playback.started:
            return []
        age = self._now - self._playback.time
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
        """The stroke: begins and ends by the clutch, grows by the centroids of fixations that have ended."""
        wanted = self._wanted(context)
        self._lifted = self._lifted and wanted
        commands: list[OperatorCommand] = []
        if wanted and not self._pointer_state and not self._lifted:
            self._pointer_state, self._stroke, self._last_seen = True, [], max(self._last_seen, self._now)
            commands.append(StrokeBegin())
        if not self._pointer_state:
            return commands
        blind = self._clutch != "always" and self._now - self._last_seen > PEN_UP
        if not wanted or blind:
            rest = self._playback.unfinished()
            ended = [*ended, *rest]
            if self._live is not None:  # it does not hand them out again
                self._fixate(rest)
        grown = [fixation.point for fixation in ended if not self._on_button(fixation.point)]
        if grown:
            self._stroke += [self._ground(point) for point in grown]
            commands.append(StrokePoints(floats(self._stroke[-len(grown) :])))
        if not wanted or blind:
            self._pointer_state, self._lifted, self._toggled = False, blind, False
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
            self._remark += f", dropped: {_FEWEST} make a path"
            return StrokeCancel()
        return StrokeEnd(smoothing=self._length(SMOOTHING), preview=self._waits)

    def _length(self, degrees: float) -> float:
        """What an angle at the eye is on the ground [m]."""
        return ground_length(degrees * self._source.px_per_deg, self._source.screen, self._browser)

    def _ground(self, pixel: Floats) -> Floats:
        return to_ground(floats(pixel, 1, 2), self._source.screen, self._browser)[0]


def open_gaze(spec: InputSpec) -> GazeReplay:
    """Entry point `gaze`; the options are in interfaces/README.md."""
    return GazeReplay(spec)


def manner(options: Fields) -> Manner:
    """What the options say of drawing.

    Raises:
        InputError: one cannot be used.
    """
    return Manner(
        clutch=options.choice("clutch", "held", CLUTCHES),
        box=_button(options),
        follows_browser=options.choice("viewport", "fit", ("fit", "browser")) == "browser",
        waits=options.choice("commit", "at-once", ("at-once", "confirm")) == "confirm",
    )


def _button(options: Fields) -> Box:
    """The button's place: the option `button`, [left, top, right, bottom] in shares of the screen."""
    if not options.has("button"):
        return BUTTON
    box = Box(*options.numbers("button", 4))
    if not (0 <= box.left < box.right <= 1 and 0 <= box.top < box.bottom <= 1):
        options.fail(f"button: {list(box)!r} is not [left, top, right, bottom] in shares of the screen, 0 to 1")
    return box
