"""How often the view is shown: less often while the control loop is late, for that comes first."""

FRAME = 1 / 30  # [s]
SLOWEST = 8.0  # factor of it
_DOUBLE_AFTER, _HALVE_AFTER = 1.0, 5.0  # [s] between two changes, when late and when in time again


class FramePace:
    """The time between two frames, from the time that the run has lost so far."""

    def __init__(self) -> None:
        """Starts at full rate."""
        self._factor, self._lost, self._changed = 1.0, 0.0, float("-inf")

    def frame(self, lost: float, now: float) -> float:
        """The time from this frame to the next [s].

        Args:
            lost: by which the run lags behind real time [s].
            now: any clock that runs on [s].
        """
        late, self._lost = lost > self._lost, lost
        if late and now - self._changed >= _DOUBLE_AFTER:
            self._factor, self._changed = min(2.0 * self._factor, SLOWEST), now
        elif not late and now - self._changed >= _HALVE_AFTER and self._factor > 1.0:
            self._factor, self._changed = self._factor / 2.0, now
        return FRAME * self._factor
