"""A small engineering typeface of round-ended strokes, so that the scene can be lettered without viser's white tags.

A glyph is a list of strokes, each a polyline in units of the digit height, baseline at y = 0. Strokes become triangles;
all of a text is one mesh, all equal digits of a team are one batch.
"""

from functools import cache
from itertools import pairwise
from typing import NamedTuple, TypeAlias

import numpy as np

from higvf_console.core.arrays import Floats, Ints, floats, ints
from higvf_console.core.numbers import SEPARATOR

Point: TypeAlias = tuple[float, float]
WEIGHT = 0.15  # stroke width [digit heights]
_GAP = 0.27  # between two glyphs, centre line to centre line
_ARC_STEP = 15.0  # [deg]
_ROUND = 8  # corners of a round end


class Triangles(NamedTuple):
    """A flat mesh.

    Attributes:
        vertices: (V, 2).
        faces: (F, 3) vertex indices.
    """

    vertices: Floats
    faces: Ints


def _arc(x: float, y: float, radius: float, start: float, stop: float, *, wide: float = 1.0) -> list[Point]:
    angles = np.deg2rad(np.linspace(start, stop, max(3, int(abs(stop - start) / _ARC_STEP) + 1)))
    return [(x + wide * radius * float(np.cos(a)), y + radius * float(np.sin(a))) for a in angles]


_SIX = [_arc(0.29, 0.3, 0.3, 0, 360, wide=0.97), [(0.44, 1.0), (0.22, 0.78), (0.07, 0.52), (0.0, 0.3)]]
_TWO = [[*_arc(0.28, 0.72, 0.28, 165, -30), (0.0, 0.0), (0.58, 0.0)]]
_M = [
    [(0.0, 0.0), (0.0, 0.66)],
    [*_arc(0.2, 0.45, 0.2, 180, 0), (0.4, 0.0)],
    [*_arc(0.6, 0.45, 0.2, 180, 0), (0.8, 0.0)],
]
_O = _arc(0.23, 0.33, 0.33, 0, 360, wide=0.7)
STROKES: dict[str, list[list[Point]]] = {
    "0": [[*_arc(0.29, 0.71, 0.29, 0, 180), *_arc(0.29, 0.29, 0.29, 180, 360), (0.58, 0.71)]],
    "1": [[(0.0, 0.76), (0.27, 1.0), (0.27, 0.0)]],
    "2": _TWO,
    "3": [[*_arc(0.27, 0.765, 0.235, 155, -90, wide=1.08), *_arc(0.27, 0.265, 0.265, 90, -155, wide=1.08)]],
    "4": [[(0.44, 0.0), (0.44, 1.0), (0.0, 0.26), (0.62, 0.26)]],
    "5": [[(0.5, 1.0), (0.1, 1.0), (0.06, 0.54), *_arc(0.27, 0.31, 0.31, 115, -150, wide=0.98)]],
    "6": _SIX,
    "7": [[(0.0, 1.0), (0.56, 1.0), (0.18, 0.0)]],
    "8": [_arc(0.29, 0.765, 0.235, 0, 360, wide=1.04), _arc(0.29, 0.265, 0.265, 0, 360, wide=1.1)],
    "9": [[(0.58 - x, 1.0 - y) for x, y in stroke] for stroke in _SIX],
    ".": [[(0.0, 0.0)]],
    "-": [[(0.0, 0.42), (0.36, 0.42)]],
    "a": [_O, [(0.46, 0.66), (0.46, 0.0)]],
    "b": [[(0.0, 1.0), (0.0, 0.0)], _O],
    "c": [_arc(0.23, 0.33, 0.33, 50, 310, wide=0.7)],
    "e": [[(0.0, 0.34), (0.45, 0.34), *_arc(0.23, 0.33, 0.33, 10, 305, wide=0.7)]],
    "g": [_O, [(0.46, 0.66), *_arc(0.23, -0.06, 0.23, 0, -140)]],
    "i": [[(0.0, 0.0), (0.0, 0.66)], [(0.0, 0.92)]],
    "l": [[(0.0, 0.0), (0.0, 1.0)]],
    "n": [[(0.0, 0.0), (0.0, 0.66)], [*_arc(0.21, 0.45, 0.21, 180, 0), (0.42, 0.0)]],
    "o": [_O],
    "p": [[(0.0, 0.66), (0.0, -0.3)], _O],
    "r": [[(0.0, 0.0), (0.0, 0.66)], _arc(0.26, 0.4, 0.26, 180, 65)],
    "m": _M,
    "²": [[(0.5 * x, 0.55 + 0.5 * y) for x, y in stroke] for stroke in _TWO],
    "x": [[(0.0, 0.0), (0.46, 0.66)], [(0.0, 0.66), (0.46, 0.0)]],
    "y": [[(0.0, 0.66), (0.23, 0.04)], [(0.46, 0.66), (0.14, -0.26)]],
    " ": [],
    SEPARATOR: [],
}
_SPACE = 0.1


@cache
def glyph(character: str) -> Triangles:
    """The triangles of one character of digit height 1, its left edge at x = 0.

    Raises:
        KeyError: the typeface does not have it.
    """
    meshes = [_ribbon(floats(stroke, -1, 2)) for stroke in STROKES[character]]
    return merged(meshes)


def advance(character: str) -> float:
    """Centre-line width of a character [digit heights]."""
    return max((x for stroke in STROKES[character] for x, _ in stroke), default=_SPACE)


def width(text: str) -> float:
    """Centre-line width of a text [digit heights]."""
    return sum(advance(character) + _GAP for character in text) - _GAP if text else 0.0


def lettering(text: str, x: float, y: float, height: float, anchor: float = 0.5) -> Triangles:
    """A text whose digits are `height` tall, centred vertically on y.

    Args:
        text: characters of the typeface.
        x: where the anchor lies [m].
        y: where the middle lies [m].
        height: of a digit [m].
        anchor: 0 = x is the left end of the text, 0.5 its middle, 1 its right end.
    """
    pen = x - anchor * width(text) * height
    meshes: list[Triangles] = []
    for character in text:
        shape = glyph(character)
        meshes.append(Triangles(shape.vertices * height + [pen, y - height / 2], shape.faces))
        pen += (advance(character) + _GAP) * height
    return merged(meshes)


class DigitPlaces(NamedTuple):
    """Where one digit stands in the numbers of a team.

    Attributes:
        digit: "0" to "9".
        robot: (k,) index of the robot whose number it belongs to.
        offset: (k,) its left edge from the middle of the number [digit heights].
    """

    digit: str
    robot: Ints
    offset: Floats


def numbering(robots: int, most: int) -> list[DigitPlaces]:
    """The digits that number robots from 1; none in a team of more than `most`."""
    places: dict[str, list[tuple[int, float]]] = {}
    for robot in range(robots if robots <= most else 0):
        number = str(robot + 1)
        pen = -width(number) / 2
        for digit in number:
            places.setdefault(digit, []).append((robot, pen))
            pen += advance(digit) + _GAP
    return [
        DigitPlaces(digit, ints([robot for robot, _ in found]), floats([pen for _, pen in found]))
        for digit, found in sorted(places.items())
    ]


def merged(meshes: list[Triangles]) -> Triangles:
    """Several flat meshes as one."""
    if not meshes:
        return Triangles(floats([], 0, 2), ints([], 0, 3))
    starts = np.cumsum([0, *[len(mesh.vertices) for mesh in meshes[:-1]]])
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)]
    return Triangles(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


def _ribbon(points: Floats) -> Triangles:
    """A polyline (n, 2) as wide as the pen, with round joints and ends."""
    turn = 2 * np.pi * np.arange(_ROUND) / _ROUND
    rim = WEIGHT / 2 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    fan = np.stack([np.zeros(_ROUND - 2), np.arange(1, _ROUND - 1), np.arange(2, _ROUND)], axis=1)
    meshes = [Triangles(point + rim, ints(fan)) for point in points]
    for start, stop in pairwise(points):
        along = stop - start
        side = WEIGHT / 2 * np.array([-along[1], along[0]]) / max(float(np.hypot(*along)), 1e-9)
        corners = np.stack([start - side, stop - side, stop + side, start + side])
        meshes.append(Triangles(corners, ints([[0, 1, 2], [0, 2, 3]])))
    return merged(meshes)
