"""The section `path` of a scenario file: the desired path that is in force from the start."""

import math

from higvf_console.control.guidance.paths import circle_path, ellipse_path, line_path, sketch_path
from higvf_console.control.parameters import PathParameters
from higvf_console.core.errors import PathError
from higvf_console.core.path_terms import ENDINGS, FASTEST, SLOWEST, USUAL_TERMS, PathTerms
from higvf_console.core.quantity import Quantity, quantities
from higvf_console.core.reading.node import Node
from higvf_console.core.scale import Scale
from higvf_console.core.state import Path
from higvf_console.operator.path_commands import with_terms
from higvf_console.scenario.sections import ANGLE, LENGTH

_PACE = Quantity("", SLOWEST, FASTEST, "", "Share of their velocity that those who are led take.")
_DURATION = Quantity("s", 0.0, 1e6, "", "How long a path is followed; 0 = as long as it takes.")
_SMOOTHING = quantities(PathParameters)["stroke_smoothing"]


def read_path(node: Node, smoothing: float, scale: Scale) -> Path:
    """The desired path that is in force from the start: a line, circle, ellipse or sketch.

    Args:
        node: the section `path`.
        smoothing: standard deviation by which a path may leave its sketch [m].
        scale: of the team.

    Raises:
        ScenarioError: not exactly one shape is given, or no path can be made of it.
    """
    kinds = ("line", "circle", "ellipse", "sketch")
    entries = node.section((*kinds, "direction", "ending", "pace", "duration_s"))
    backward = "direction" in entries and entries["direction"].choice(("forward", "backward")) == "backward"
    direction = -1.0 if backward else 1.0
    given = [name for name in kinds if name in entries]
    if len(given) != 1:
        raise node.error(f"give exactly one of: {', '.join(kinds)}")
    shape = entries[given[0]]
    try:
        path = _PATHS[given[0]](shape, direction, smoothing, scale)
    except PathError as error:
        raise shape.error(str(error)) from error
    terms = PathTerms(
        ending=entries["ending"].choice(tuple(ENDINGS)) if "ending" in entries else USUAL_TERMS.ending,
        pace=entries["pace"].number(_PACE) if "pace" in entries else USUAL_TERMS.pace,
        duration=entries["duration_s"].number(_DURATION) if "duration_s" in entries else USUAL_TERMS.duration,
    )
    return with_terms(path, terms)


def _line(node: Node, direction: float, *_: object) -> Path:
    entries = node.section(("at_m", "angle_deg"), ("at_m", "angle_deg"))
    return line_path(*entries["at_m"].point(), math.radians(entries["angle_deg"].number(ANGLE)), direction)


def _circle(node: Node, direction: float, *_: object) -> Path:
    entries = node.section(("at_m", "radius_m"), ("at_m", "radius_m"))
    return circle_path(*entries["at_m"].point(), entries["radius_m"].number(LENGTH), direction)


def _ellipse(node: Node, direction: float, *_: object) -> Path:
    entries = node.section(("at_m", "half_axes_m", "angle_deg"), ("at_m", "half_axes_m"))
    angle = math.radians(entries["angle_deg"].number(ANGLE)) if "angle_deg" in entries else 0.0
    return ellipse_path(*entries["at_m"].point(), *entries["half_axes_m"].point(), angle, direction)


def _sketch(node: Node, direction: float, smoothing: float, scale: Scale) -> Path:
    entries = node.section(("points_m", "closed", "smoothing_m"), ("points_m",))
    closed = entries["closed"].flag() if "closed" in entries else None
    smoothing = entries["smoothing_m"].number(_SMOOTHING.at(scale)) if "smoothing_m" in entries else smoothing
    return sketch_path(entries["points_m"].points(least=3), smoothing, closed, direction, scale)


_PATHS = {"line": _line, "circle": _circle, "ellipse": _ellipse, "sketch": _sketch}
