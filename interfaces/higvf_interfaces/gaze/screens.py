"""Coordinate frames of gaze: recorded points -> pixels of the recording's screen -> metres in the arena."""

from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Bools, Floats, bools, floats
from higvf_console.core.errors import InputError
from higvf_console.core.viewport import Arena, Viewport, fit
from higvf_interfaces.fields import Fields, shown
from higvf_interfaces.formats.records import BOTTOM_LEFT, CENTER, CENTER_UP, FRAMES, ORIGINS, SCENE_FRAMES, GazeStream
from higvf_interfaces.gaze.calibration import Calibration, read_calibration, to_arena
from higvf_interfaces.paths import named

DEFAULT_SCREEN = (1920.0, 1080.0)  # [px]
_LARGEST_SHARE = 1.5  # of the screen; gaze may leave it
TELLING = 20  # points
NO_PIXELS_HINT = "x and y lie between 0 and 1, so they are no pixels; give frame=unit (0 to 1 of the screen)"
_WAYS_OUT = {  # by the option that replaces a statement
    "frame": "frame=arena (metres), frame=screen (pixels) or frame=unit (0 to 1 of the screen)",
    "origin": "origin=top-left, origin=bottom-left, origin=center (y downwards) or origin=center-up",
    "screen": "screen=WIDTHxHEIGHT in pixels",
}


class UnusableError(InputError):
    """The recording is readable but its gaze is unusable: unknown frame, or no usable sample on the screen."""


class Screen(NamedTuple):
    """The screen of a recording and the position of the arena on it.

    Attributes:
        frame: frame of the recorded points: arena, screen or unit.
        origin: corner of the screen at coordinates 0, 0, or its center; see `GazeRecording`.
        shown: size of the screen [px] and default position of the arena on it.
        calibration: mapping to the arena; None means the mapping of `shown`.
        notes: assumptions made.
    """

    frame: str
    origin: str
    shown: Viewport
    calibration: Calibration | None
    notes: tuple[str, ...]


def choose_screen(stream: GazeStream, options: Fields, arena: Arena) -> Screen:
    """Determine the screen of a recording or a live stream from the options, then the file, then the defaults.

    Raises:
        InputError: If an option is invalid.
        UnusableError: If neither the options nor the file give the frame, or the file states something about its
            coordinates that is not understood and no option replaces it.
    """
    for doubt in stream.doubts:
        if not options.has(doubt.option):
            options.fail(f"{doubt.statement} is not understood; give {_WAYS_OUT[doubt.option]}", UnusableError)
    text = options.text("calibration") if options.has("calibration") else ""
    calibration = read_calibration(named(text)) if text else None
    origin = options.choice("origin", stream.origin.replace(" ", "-"), [name.replace(" ", "-") for name in ORIGINS])
    size, notes = _choose_size(stream, options, calibration)
    frame = _choose_frame(stream, options, calibration is not None)
    if origin == CENTER and not options.has("origin"):
        notes += ("origin at the center, y assumed to count downwards; if it counts upwards, give origin=center-up",)
    return Screen(frame, origin.replace("-", " "), fit(arena, *size), calibration, notes)


def to_pixels(points: Floats, screen: Screen) -> Floats:
    """Convert recorded points (n, 2) to pixels (n, 2) from the top left corner of the recording's screen."""
    if screen.frame == "arena":
        return screen.shown.to_screen(points)
    size = np.array([screen.shown.width_px, screen.shown.height_px])
    pixels = points * size if screen.frame == "unit" else floats(points)
    if screen.origin in (CENTER, CENTER_UP):
        pixels[:, 0] += size[0] / 2
    if screen.origin == CENTER:
        pixels[:, 1] += size[1] / 2
    elif screen.origin == CENTER_UP:
        pixels[:, 1] = size[1] / 2 - pixels[:, 1]
    elif screen.origin == BOTTOM_LEFT:
        pixels[:, 1] = size[1] - pixels[:, 1]
    return pixels


def on_screen(pixels: Floats, screen: Screen) -> Bools:
    """Return whether each point (n, 2) [px] lies on the screen; False for NaN."""
    size = np.array([screen.shown.width_px, screen.shown.height_px])
    return bools(((pixels >= 0) & (pixels <= size)).all(axis=1))


def are_shares(points: Floats, screen: Screen) -> bool:
    """Return whether recorded points (n, 2) that are said to be pixels lie between 0 and 1, too close for any gaze."""
    known = points[np.isfinite(points).all(axis=1)]
    return screen.frame == "screen" and len(known) >= TELLING and bool(np.abs(known).max() <= _LARGEST_SHARE)


def to_ground(pixels: Floats, screen: Screen, browser: Viewport | None = None) -> Floats:
    """Map pixels of the recording's screen to ground points (n, 2) [m].

    Args:
        pixels: (n, 2) gaze [px].
        screen: the recording's screen.
        browser: browser view onto which the recording's screen is stretched; None uses the position of the arena on
            the recording's screen. A calibration takes precedence over both.
    """
    if screen.calibration is not None:
        return to_arena(screen.calibration, pixels)
    if browser is None:
        return screen.shown.to_ground(pixels)
    stretch = np.array([browser.width_px / screen.shown.width_px, browser.height_px / screen.shown.height_px])
    return browser.to_ground(pixels * stretch)


def ground_length(pixels: float, screen: Screen, browser: Viewport | None = None) -> float:
    """Return the ground length [m] of a length at the centre of the screen [px]."""
    middle = np.array([screen.shown.width_px, screen.shown.height_px]) / 2
    half = np.array([pixels / 2, 0.0])
    ends = to_ground(floats([middle - half, middle + half]), screen, browser)
    return float(np.hypot(*(ends[1] - ends[0])))


def _choose_frame(stream: GazeStream, options: Fields, calibrated: bool) -> str:
    recorded = stream.frame
    if options.has("frame"):
        return options.choice("frame", "", FRAMES)
    if recorded in SCENE_FRAMES:
        if calibrated:
            return SCENE_FRAMES[recorded]
        options.fail(
            "gaze is in the image of a camera on the head, which moves relative to the screen; map gaze onto the "
            "screen in the vendor's software (a surface with markers) and use that table, or give calibration=FILE, "
            f"or, if the head was still and the camera showed only the screen, frame={SCENE_FRAMES[recorded]}",
            UnusableError,
        )
    if recorded is None:
        options.fail(
            "the file does not specify the frame of x and y; give frame=arena (metres), frame=screen (pixels) or "
            "frame=unit (0 to 1 of the screen); add origin=bottom-left if y counts from the bottom",
            UnusableError,
        )
    return recorded


def _choose_size(
    stream: GazeStream, options: Fields, calibration: Calibration | None
) -> tuple[tuple[float, float], tuple[str, ...]]:
    """Return the size of the screen [px] from the option `screen`, the calibration, the file, or the default."""
    if options.has("screen"):
        text = str(options.values["screen"])
        parts = [part.strip() for part in text.lower().split("x")]
        if len(parts) != 2 or not all(part.isdecimal() and int(part[:6]) >= 1 for part in parts):
            options.fail(f"screen: {shown(text)} is not WIDTHxHEIGHT in pixels, such as 1920x1080")
        return (float(parts[0]), float(parts[1])), ()
    if calibration is not None:
        return calibration.screen, ()
    if stream.screen is not None:
        return stream.screen, ()
    return DEFAULT_SCREEN, (f"screen size unknown, assumed {DEFAULT_SCREEN[0]:.0f} x {DEFAULT_SCREEN[1]:.0f} px",)
