"""Dwell button: an on-screen button that the operator presses by looking at it."""

from typing import NamedTuple

DWELL = 0.8  # dwell time of a press [s]
REFRACTORY = 0.6  # pause after a press [s]
GLANCE = 0.1  # gaze may leave the button this long, for example in a blink, without resetting the progress [s]


class DwellButton(NamedTuple):
    """State of a button.

    Attributes:
        pressed: whether this step completed a press.
        progress: elapsed share of the dwell time, shown as a ring.
        since: session time at which gaze entered the button [s]; None if gaze is elsewhere.
        left: session time at which gaze left the button [s]; None if gaze is on it or the progress is lost.
        free_from: end of the refractory time [s].
    """

    pressed: bool = False
    progress: float = 0.0
    since: float | None = None
    left: float | None = None
    free_from: float = 0.0


IDLE = DwellButton()


def step(button: DwellButton, time: float, on: bool, dwell: float = DWELL) -> DwellButton:
    """Advance the button to session `time`.

    Args:
        button: previous state.
        time: session time, non-decreasing [s].
        on: whether gaze is on the button.
        dwell: dwell time of a press [s].
    """
    if time < button.free_from:
        return DwellButton(free_from=button.free_from)
    if not on:
        left = time if button.left is None else button.left
        if button.since is None or time - left > GLANCE:
            return DwellButton(free_from=button.free_from)
        return button._replace(pressed=False, left=left)
    since = time if button.since is None else button.since
    if time - since >= dwell:
        return DwellButton(pressed=True, progress=1.0, free_from=time + REFRACTORY)
    return DwellButton(False, (time - since) / dwell, since, None, button.free_from)
