"""Where gaze falls on the ground: recorded frames -> pixels of the recording's screen -> metres of the arena."""

import numpy as np

from higvf_console.arrays import Bools, Floats, bools
from higvf_console.errors import InputError
from higvf_console.viewport import Arena, Viewport, fit
from higvf_interfaces.fields import Fields, shown
from higvf_interfaces.formats.records import FRAMES, GazeRecording

DEFAULT_SCREEN = (1920.0, 1080.0)  # [px]


def to_pixels(points: Floats, frame: str, screen: Viewport) -> Floats:
    """Recorded points (n, 2) in `frame` as pixels of the recording's screen (n, 2)."""
    if frame == "unit":
        return points * np.array([screen.width_px, screen.height_px])
    return screen.to_screen(points) if frame == "arena" else points


def on_screen(pixels: Floats, screen: Viewport) -> Bools:
    """Whether each of the points (n, 2) lies on the screen; NaN does not."""
    return bools(((pixels >= 0) & (pixels <= np.array([screen.width_px, screen.height_px]))).all(axis=1))


def to_ground(pixels: Floats, screen: Viewport, browser: Viewport | None) -> Floats:
    """Ground points (n, 2) [m] under pixels of the recording's screen.

    Args:
        pixels: (n, 2).
        screen: the recording's.
        browser: onto which the recording's screen is stretched; None = the arena as it lay on the recording's screen.
    """
    if browser is None:
        return screen.to_ground(pixels)
    return browser.to_ground(
        pixels * np.array([browser.width_px / screen.width_px, browser.height_px / screen.height_px])
    )


def choose_frame(recording: GazeRecording, options: Fields) -> str:
    """The option `frame`, else what the file says.

    Raises:
        InputError: neither says it.
    """
    if options.has("frame") or recording.frame is not None:
        return options.choice("frame", recording.frame or "", FRAMES)
    raise InputError(
        f"{options.place}: the file does not say what its x and y are; give frame=arena (metres), "
        "frame=screen (pixels from the top left corner) or frame=unit (0 to 1 of the screen)"
    )


def choose_screen(recording: GazeRecording, options: Fields, arena: Arena) -> tuple[Viewport, tuple[str, ...]]:
    """How the arena lay on the recording's screen, letterboxed; and what had to be assumed.

    The size is the option `screen` (1920x1080), else the file's, else a common one.
    """
    if options.has("screen"):
        text = str(options.values["screen"])
        parts = [part.strip() for part in text.lower().split("x")]
        if len(parts) != 2 or not all(part.isdecimal() and int(part[:6]) >= 1 for part in parts):
            options.fail(f"screen: {shown(text)} is not WIDTHxHEIGHT in pixels, such as 1920x1080")
        return fit(arena, float(parts[0]), float(parts[1])), ()
    if recording.screen is not None:
        return fit(arena, *recording.screen), ()
    return fit(arena, *DEFAULT_SCREEN), (f"screen taken as {DEFAULT_SCREEN[0]:.0f} x {DEFAULT_SCREEN[1]:.0f} px",)
