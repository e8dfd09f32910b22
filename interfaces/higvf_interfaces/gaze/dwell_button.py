"""A button that gaze presses by resting on it: the clutch of an operator whose hands are full."""

from typing import NamedTuple

DWELL = 0.8  # gaze must rest on the button for so long [s]
REFRACTORY = 0.6  # after a press, before the next may begin [s]
GLANCE = 0.1  # gaze may leave for so long, as it does in a blink, without losing its progress [s]


class DwellButton(NamedTuple):
    """Where a button stands.

    Attributes:
        pressed: whether it has just been pressed, in this step alone.
        progress: share of the dwell time that has passed, for the ring round the button.
        since: when gaze came to rest on it [s]; None = it does not.
        left: when gaze left it while its progress still counts [s]; None = it has not.
        free_from: end of the refractory time [s].
    """

    pressed: bool = False
    progress: float = 0.0
    since: float | None = None
    left: float | None = None
    free_from: float = 0.0


IDLE = DwellButton()


def step(button: DwellButton, time: float, on: bool, dwell: float = DWELL) -> DwellButton:
    """The button at session `time` [s].

    Args:
        button: as it was.
        time: not before the last step's.
        on: whether gaze is on the button now.
        dwell: how long it must rest there [s].
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
