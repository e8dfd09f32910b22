"""What a file or a live stream states about its coordinates, in one vocabulary for all formats.

A statement that is not understood becomes a `Doubt`. `gaze.screens.choose_screen` refuses it, for recordings and live
streams alike, unless the option of that name replaces it; a default never does.
"""

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from higvf_interfaces.formats.records import BOTTOM_LEFT, CENTER, SCENE_FRAMES, TOP_LEFT, Doubt

_PIXELS = ("px", "pixel", "pixels", "dacs px", "dacspx", "adcs px", "adcspx", "screen px", "screen pixels")
_SHARES = ("normalized", "normalised", "norm", "fraction", "fractions", "unit", "0 1", "0..1")
_SCREENS = (
    "screen", "screen space", "display", "display area", "active display", "monitor", "gaze on screen", "on screen",
    "adcs", "dacs", "surface",
)  # fmt: skip
_SCENES = (
    "world", "world space", "world camera", "gaze in world", "scene", "scene camera", "head", "head camera",
    "front camera", "field camera", "egocentric", "hucs",
)  # fmt: skip
_ON_SCENE = {screen: scene for scene, screen in SCENE_FRAMES.items()}
_SIDES = {
    "top": "top", "upper": "top", "bottom": "bottom", "lower": "bottom", "left": "left", "right": "right",
    "center": "center", "centre": "center", "middle": "center",
}  # fmt: skip
_ORIGINS: Mapping[frozenset[str], str] = {
    frozenset(("top", "left")): TOP_LEFT,
    frozenset(("bottom", "left")): BOTTOM_LEFT,
    frozenset(("center",)): CENTER,
}


class Coordinates(NamedTuple):
    """Frame, as in `GazeRecording`, and the statements about it that are not understood."""

    frame: str | None
    doubts: tuple[Doubt, ...] = ()


def stated_frame(units: Sequence[str], systems: Sequence[str] = ()) -> Coordinates:
    """Return the frame that the units and coordinate systems of x and y state; None if they state none.

    Args:
        units: unit of each axis, such as "px" or "normalized"; empty where missing.
        systems: coordinate system of each axis, such as "screen" or "world"; empty where missing.
    """
    doubts: list[Doubt] = []
    unit, system = _agreed(units, "unit", doubts), _agreed(systems, "coordinate system", doubts)
    frame = "screen" if unit in _PIXELS else "unit" if unit in _SHARES else None
    if unit and frame is None:
        doubts.append(Doubt("frame", f"the unit {unit[:40]!r} of x and y"))
    if system in _SCENES:
        frame = None if frame is None else _ON_SCENE[frame]
        if frame is None and not doubts:
            doubts.append(Doubt("frame", f"the coordinate system {system[:40]!r} without a known unit"))
    elif system and system not in _SCREENS:
        doubts.append(Doubt("frame", f"the coordinate system {system[:40]!r}"))
    return Coordinates(None, tuple(doubts)) if doubts else Coordinates(frame)


def stated_origin(words: str, place: str) -> tuple[str, tuple[Doubt, ...]]:
    """Return the origin that a text such as "top left" or "center, center" states, and a doubt if it is not understood.

    Args:
        words: the text.
        place: how a message calls the statement, such as "ScreenOrigin".
    """
    sides = [_SIDES.get(word, "") for word in re.findall(r"[a-z]+", words.casefold())]
    origin = _ORIGINS.get(frozenset(sides))
    return (TOP_LEFT, (Doubt("origin", f"{place} {words[:60]!r}"),)) if origin is None else (origin, ())


def _agreed(statements: Sequence[str], what: str, doubts: list[Doubt]) -> str:
    """Return the statement that the axes share, or that one alone makes; a doubt if they differ."""
    plain = {" ".join(re.sub(r"[-_]", " ", text.casefold()).split()) for text in statements if text.strip()}
    if len(plain) > 1:
        doubts.append(Doubt("frame", f"the {what} of x and y, {' and '.join(map(repr, sorted(plain)))[:80]},"))
        return ""
    return next(iter(plain), "")
