"""Where gaze falls on the ground: recorded frames -> pixels of the recording's screen -> metres of the arena."""

from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Bools, Floats, bools, floats
from higvf_console.core.errors import InputError
from higvf_console.core.viewport import Arena, Viewport, fit
from higvf_interfaces.fields import Fields, shown
from higvf_interfaces.formats.records import BOTTOM_LEFT, FRAMES, ORIGINS, SCENE_FRAMES, GazeStream
from higvf_interfaces.gaze.calibration import Calibration, read_calibration, to_arena
from higvf_interfaces.paths import named

DEFAULT_SCREEN = (1920.0, 1080.0)  # [px]


class UnusableError(InputError):
    """A recording can be read, and its gaze cannot be used: its frame is unknown, or no sample is on the screen."""


class Screen(NamedTuple):
    """The screen of a recording and how the arena lies under it.

    Attributes:
        frame: what the recording's points are: arena, screen or unit.
        origin: where their 0, 0 is.
        shown: size in pixels, and the arena as it lay on it where nothing else is known.
        calibration: the map to the arena; None = by `shown`.
        notes: what had to be assumed.
    """

    frame: str
    origin: str
    shown: Viewport
    calibration: Calibration | None
    notes: tuple[str, ...]


def choose_screen(stream: GazeStream, options: Fields, arena: Arena) -> Screen:
    """What the options say of the screen, else what the file says, else what is usual.

    Raises:
        InputError: an option cannot be used.
        UnusableError: nobody says what the points are.
    """
    text = options.text("calibration") if options.has("calibration") else ""
    calibration = read_calibration(named(text)) if text else None
    origin = options.choice("origin", stream.origin.replace(" ", "-"), [name.replace(" ", "-") for name in ORIGINS])
    size, notes = _choose_size(stream, options, calibration)
    frame = _choose_frame(stream, options, calibration is not None)
    return Screen(frame, origin.replace("-", " "), fit(arena, *size), calibration, notes)


def to_pixels(points: Floats, screen: Screen) -> Floats:
    """Recorded points (n, 2) as pixels of the recording's screen (n, 2), from its top left corner."""
    if screen.frame == "arena":
        return screen.shown.to_screen(points)
    size = np.array([screen.shown.width_px, screen.shown.height_px])
    pixels = points * size if screen.frame == "unit" else floats(points)
    if screen.origin == BOTTOM_LEFT:
        pixels[:, 1] = size[1] - pixels[:, 1]
    return pixels


def on_screen(pixels: Floats, screen: Screen) -> Bools:
    """Whether each of the points (n, 2) lies on the screen; NaN does not."""
    size = np.array([screen.shown.width_px, screen.shown.height_px])
    return bools(((pixels >= 0) & (pixels <= size)).all(axis=1))


def to_ground(pixels: Floats, screen: Screen, browser: Viewport | None = None) -> Floats:
    """Ground points (n, 2) [m] under pixels of the recording's screen.

    Args:
        pixels: (n, 2).
        screen: the recording's.
        browser: onto which the recording's screen is stretched; None = the arena as it lay on the recording's screen.
            A calibration goes over both.
    """
    if screen.calibration is not None:
        return to_arena(screen.calibration, pixels)
    if browser is None:
        return screen.shown.to_ground(pixels)
    stretch = np.array([browser.width_px / screen.shown.width_px, browser.height_px / screen.shown.height_px])
    return browser.to_ground(pixels * stretch)


def ground_length(pixels: float, screen: Screen, browser: Viewport | None = None) -> float:
    """What a length on the screen's middle [px] is on the ground [m]."""
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
            "gaze is in the image of a camera on the head, which moves over the screen; map it onto the screen in the "
            "maker's software (a surface with markers) and give that table, or give calibration=FILE, or, if the head "
            f"was still and the camera saw just the screen, frame={SCENE_FRAMES[recorded]}",
            UnusableError,
        )
    if recorded is None:
        options.fail(
            "the file does not say what its x and y are; give frame=arena (metres), frame=screen (pixels from the top "
            "left corner, or origin=bottom-left) or frame=unit (0 to 1 of the screen, likewise)",
            UnusableError,
        )
    return recorded


def _choose_size(
    stream: GazeStream, options: Fields, calibration: Calibration | None
) -> tuple[tuple[float, float], tuple[str, ...]]:
    """Width and height [px]: the option `screen` (1920x1080), else the calibration's, the file's, or a common one."""
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
    return DEFAULT_SCREEN, (f"screen taken as {DEFAULT_SCREEN[0]:.0f} x {DEFAULT_SCREEN[1]:.0f} px",)
