"""A calibration made live: the operator looks at five targets, one after the other, until gaze has rested on each.

A page asks for it and gives it up from its own thread; everything else happens where gaze is polled.
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

COUNT = 5  # targets: with four, the residual would say nothing
TRAVEL = 0.8  # in which the eye finds the next target; not counted [s]
REST = 0.8  # for so long gaze must rest on a target [s] ...
FEWEST = 20  # ... and with so many samples
SPREAD = 1.5  # samples farther from their middle begin the rest anew [deg]


class LiveCalibration:
    """The state of the procedure, and what came of the last one."""

    def __init__(self, arena: Arena, screen: tuple[float, float], px_per_deg: float) -> None:
        """Stands still.

        Args:
            arena: where the targets are.
            screen: width and height of the tracker's screen [px].
            px_per_deg: pixels in one degree of visual angle.
        """
        self._targets = targets(arena, COUNT)
        self._screen, self._reach = screen, SPREAD * px_per_deg
        self._asked: bool | None = None  # by a page: begin, or give up
        self._outcome = ""
        self._running = False
        self._found: list[Floats] = []
        self._rest = NO_PIXELS
        self._shown_at = math.inf

    def begin(self) -> None:
        """Asks for a calibration; callable from any thread."""
        self._asked = True

    def cancel(self) -> None:
        """Asks to give it up; callable from any thread."""
        self._asked = False

    def report(self) -> CaptureReport:
        """How it stands."""
        if not self._running:
            return CaptureReport("", outcome=self._outcome)
        done = len(self._found)
        return CaptureReport("", self._targets[done], done + 1, COUNT, self._progress(), self._outcome)

    def take(self, samples: Pixels) -> Calibration | None:
        """Takes in the newest samples, on the tracker's own clock.

        Returns:
            The new map, once gaze has rested on all targets and a map goes through them.
        """
        asked, self._asked = self._asked, None
        if asked is not None:
            if self._running and not asked:
                self._outcome = "Given up; the map in use stays."
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
        """Adds to the rest on the present target; what lies before gaze last moved away is dropped."""
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
        off = f"off by {residual_px(made):.0f} px, {made.residual:.1f} m (root mean square)"
        self._outcome = f"In use; {off}; being written to {file}"
        Thread(target=self._store, args=(made, file, off), name="calibration", daemon=True).start()
        return made

    def _store(self, made: Calibration, file: Path, off: str) -> None:
        """Writes the file, on a thread of its own: a slow disk must not hold up the team."""
        try:
            file.write_text(calibration_text(made), encoding="utf-8")
            self._outcome = f"In use; {off}; written to {file}"
        except OSError as error:
            self._outcome = f"In use; {off}; not written to {file}: {error.strerror}"
