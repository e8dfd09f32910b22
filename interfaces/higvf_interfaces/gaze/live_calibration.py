"""Calibration with a live eye tracker: the operator fixates five targets in turn.

A browser thread requests or cancels a calibration; everything else runs in the session thread, in `poll`.
"""

import math
from datetime import datetime
from pathlib import Path
from threading import Thread

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_console.core.reports import CaptureReport
from higvf_console.core.viewport import Arena
from higvf_interfaces.gaze.calibration import Calibration, calibrate, calibration_text, residual_px, targets
from higvf_interfaces.gaze.chunked_fixations import NO_PIXELS, Pixels

COUNT = 5  # targets; with four, the residual is always 0
TRAVEL = 0.8  # time for the eye to find the next target; samples in it are ignored [s]
REST = 0.8  # minimum fixation of a target [s]
FEWEST = 20  # minimum number of samples of that fixation
SPREAD = 1.5  # a sample farther from the median restarts the fixation [deg]


class LiveCalibration:
    """State of the running calibration and outcome of the last one."""

    def __init__(self, arena: Arena, screen: tuple[float, float], px_per_deg: float) -> None:
        """Start idle.

        Args:
            arena: arena in which the targets lie.
            screen: width and height of the tracker's screen [px].
            px_per_deg: pixels per degree of visual angle.
        """
        self._targets = targets(arena, COUNT)
        self._screen, self._reach = screen, SPREAD * px_per_deg
        self._asked: bool | None = None  # request of a browser: begin (True) or cancel (False)
        self._outcome = ""
        self._running = False
        self._found: list[Floats] = []
        self._rest = NO_PIXELS
        self._shown_at = math.inf

    def begin(self) -> None:
        """Request a calibration; callable from any thread."""
        self._asked = True

    def cancel(self) -> None:
        """Request the end of the running calibration; callable from any thread."""
        self._asked = False

    def report(self) -> CaptureReport:
        """Return the current target, the progress and the last outcome."""
        if not self._running:
            return CaptureReport("", outcome=self._outcome)
        done = len(self._found)
        return CaptureReport("", self._targets[done], done + 1, COUNT, self._progress(), self._outcome)

    def take(self, samples: Pixels) -> Calibration | None:
        """Process the newest samples.

        Args:
            samples: samples since the last call, on the tracker's clock.

        Returns:
            The new calibration, once all targets are fixated and the fit succeeds.
        """
        asked, self._asked = self._asked, None
        if asked is not None:
            if self._running and not asked:
                self._outcome = "Cancelled; the previous calibration stays in use."
            self._running, self._found = asked, []
            self._next_target()
        if not self._running or not len(samples.time):
            return None
        if math.isinf(self._shown_at):
            self._shown_at = float(samples.time[0])
        used = samples.valid & (samples.time >= self._shown_at + TRAVEL)
        self._gather(samples.time[used], samples.points[used])
        if self._progress() < 1.0:
            return None
        self._found.append(floats(np.median(self._rest.points, axis=0)))
        self._next_target()
        return self._fitted() if len(self._found) == COUNT else None

    def _gather(self, time: Floats, points: Floats) -> None:
        """Extend the fixation of the current target; drop the samples up to the last one that moved away."""
        time = floats(np.concatenate([self._rest.time, time]))
        points = floats(np.concatenate([self._rest.points, points]))
        if len(points):
            middle = np.median(points[-FEWEST:], axis=0)
            away = np.flatnonzero(np.hypot(*(points - middle).T) > self._reach)
            since = int(away[-1]) + 1 if len(away) else 0
            time, points = time[since:], points[since:]
        self._rest = Pixels(time, points, np.ones(len(time), np.bool_))

    def _progress(self) -> float:
        if not len(self._rest.time):
            return 0.0
        return min(1.0, len(self._rest.time) / FEWEST, float(self._rest.time[-1] - self._rest.time[0]) / REST)

    def _next_target(self) -> None:
        self._rest = NO_PIXELS
        self._shown_at = math.inf

    def _fitted(self) -> Calibration | None:
        self._running = False
        try:
            fitted = calibrate(floats(self._found), self._targets, self._screen)
        except InputError as problem:
            self._outcome = f"Failed: {problem}"
            return None
        now = datetime.now().astimezone()
        file = Path(f"gaze-calibration-{now:%Y%m%d-%H%M%S}.yaml").absolute()
        made = fitted._replace(file=str(file), made=now.isoformat(timespec="seconds"))
        off = f"RMS error {residual_px(made):.0f} px, {made.residual:.1f} m"
        self._outcome = f"In use; {off}; writing {file}"
        Thread(target=self._store, args=(made, file, off), name="calibration", daemon=True).start()
        return made

    def _store(self, made: Calibration, file: Path, off: str) -> None:
        """Write the file on its own thread, so that a slow disk does not delay the session."""
        try:
            file.write_text(calibration_text(made), encoding="utf-8")
            self._outcome = f"In use; {off}; written to {file}"
        except OSError as error:
            self._outcome = f"In use; {off}; not written to {file}: {error.strerror}"
