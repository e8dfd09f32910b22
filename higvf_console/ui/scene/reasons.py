"""Why a robot moves, in the arena: its velocity as a chain of coloured arrows, and its lines of sight to the fires."""

import numpy as np
from numpy.typing import NDArray

from higvf_console.analysis.explain import Moved, Part, explain
from higvf_console.analysis.sight import Sight, sights
from higvf_console.control.guidance.obstacles import world_at
from higvf_console.control.parameters import controlled
from higvf_console.core.arrays import Floats, floats, ints
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.ground import joined
from higvf_console.ui.scene.parts import Canvas, Layer
from higvf_console.ui.theme import DARK, Palette, mixed, vertex_rgb
from higvf_console.world.setup import Setup

LONGEST = 150.0  # arrow of the speed limit [px]
READABLE = 70.0  # the longest arrow of a slow robot, at least [px]
_STILL = 1 / 900  # of the speed limit: slower robots have arrows of the usual length
_LEAST = 3.0  # shorter arrows are not drawn [px]
_BARB = 7.0  # [px]
_DASH = 6.0  # of the line of sight to a fire that is hidden [px]


def part_colours(palette: Palette) -> dict[Part, str]:
    """The colour of each part of a velocity."""
    return {
        Part.TARGET: palette.own_target,
        Part.HUMAN: palette.operator,
        Part.NEIGHBOURS: palette.neighbours,
        Part.CARRIED_OVER: palette.so_far,
        Part.FORMATION: palette.formation,
        Part.DETOUR: palette.way_round,
        Part.LIMIT: palette.hold,
        Part.SAFETY: palette.safety,
    }


class ReasonLayer:
    """A broad grey bar, the velocity, and on it the chain of its parts, each with a head."""

    def __init__(self, canvas: Canvas, setup: Setup) -> None:
        """Starts without arrows."""
        self._px, self._params, self._palette = canvas.px, setup.params, canvas.palette
        self._speed_limit = controlled(setup.params).safety.speed_limit
        self._whole = canvas.lines(Layer.VELOCITY, "/why/velocity", canvas.palette.velocity, 7.0)
        self._chain = canvas.lines(Layer.REASON, "/why/parts", None, 3.0)

    def update(self, moved: Moved, robot: int | None, px: float | None = None) -> None:
        """Shows why a robot moved in one control period; None = nobody is explained.

        Args:
            moved: the control period.
            robot: index.
            px: a pixel of the page [m]; None = as when the arena is fitted.
        """
        if robot is None:
            self._whole.draw(floats([], 0, 2, 2))
            self._chain.draw(floats([], 0, 2, 2))
            return
        parts = explain(moved, self._params, ints([robot])).parts[0]
        at, velocity = moved.after.position[robot], moved.after.velocity[robot]
        px = self._px if px is None else px
        scale = px * pixels_per_speed(floats([*parts, velocity]), self._speed_limit)
        segments, colours = chain(at, scale * parts, px, self._palette)
        self._chain.draw(segments, colours)
        self._whole.draw(arrow(at, at + scale * velocity, _LEAST * px, 0.0))


class SightLayer:
    """Lines from a robot to the burning fires, dashed to those that obstacles hide, whose outlines light up."""

    def __init__(self, canvas: Canvas, setup: Setup) -> None:
        """Starts without lines."""
        self._px, self._setup = canvas.px, setup
        calm = mixed(canvas.palette.fire_edge, canvas.palette.floor, 0.35)
        self._seen = canvas.lines(Layer.SIGHT, "/why/seen", calm, 1.5)
        self._unseen = canvas.lines(Layer.SIGHT, "/why/unseen", canvas.palette.scorched_text, 1.5)
        self._hiders = canvas.lines(Layer.SIGHT, "/why/hiders", calm, 2.5)

    def update(self, moved: Moved, robot: int | None) -> None:
        """Shows what a robot saw in one control period; None = nobody is explained."""
        found = [] if robot is None else sights(robot, moved, self._setup)
        at = np.zeros(2) if robot is None else moved.before.motion.position[robot]
        seen, unseen = sight_lines(at, found, moved, self._setup, _DASH * self._px)
        self._seen.draw(seen)
        self._unseen.draw(unseen)
        tick = moved.before.motion.tick
        hiders = sorted({part for sight in found for part in sight.hidden_by})
        self._hiders.draw(joined([shapes.segments(part_outline(part, self._setup, tick)) for part in hiders]))


def pixels_per_speed(vectors: Floats, speed_limit: float) -> float:
    """How long arrows of velocities (n, 2) [m/s] are drawn [px s/m]: the longest is long enough to be read."""
    longest = float(np.hypot(*vectors.T).max())
    usual = LONGEST / speed_limit
    return max(usual, READABLE / longest) if longest > _STILL * speed_limit else usual


def chain(at: Floats, vectors: Floats, px: float, palette: Palette = DARK) -> tuple[Floats, NDArray[np.uint8]]:
    """Vectors (8, 2) [m] by `Part` as arrows head to tail from a point (2,).

    Returns:
        Segments (s, 2, 2) [m] and the colours (s, 2, 3) of their ends.
    """
    segments: list[Floats] = []
    colours: list[NDArray[np.uint8]] = []
    paint = {part: vertex_rgb(colour) for part, colour in part_colours(palette).items()}
    for part, vector in zip(Part, vectors, strict=True):
        drawn = arrow(at, at + vector, _LEAST * px, _BARB * px)
        segments.append(drawn)
        colours.append(np.full((len(drawn), 2, 3), paint[part], np.uint8))
        at = at + vector
    return np.concatenate(segments), np.concatenate(colours)


def arrow(tail: Floats, tip: Floats, least: float, barb: float) -> Floats:
    """A shaft and two barbs (3, 2, 2), barbs at most 0.6 of the shaft; nothing of an arrow shorter than `least` [m]."""
    along = tip - tail
    length = float(np.hypot(*along))
    if not length >= least:
        return floats([], 0, 2, 2)
    reach = min(barb, 0.6 * length) / length
    back, side = -reach * along, 0.5 * reach * np.array([-along[1], along[0]])
    return floats([[tail, tip], [tip, tip + back + side], [tip, tip + back - side]])


def sight_lines(at: Floats, found: list[Sight], moved: Moved, setup: Setup, dash: float) -> tuple[Floats, Floats]:
    """Lines (s, 2, 2) from a robot (2,) to the rims of the fires that it sees, and of those that it does not.

    Drawn through to a fire that nothing hides, in dashes to others.
    """
    seen: list[Floats] = []
    unseen: list[Floats] = []
    for sight in found:
        fire, radius = setup.world.fire_position[sight.fire], moved.before.motion.fire_radius[sight.fire]
        distance = float(np.hypot(*(fire - at)))
        if distance <= radius:
            continue
        line = floats([at, fire + radius / distance * (at - fire)])
        clear = sight.value > 0.0 and not sight.hidden_by
        lines = shapes.segments(line) if clear else shapes.dashed(line, dash, dash)
        (seen if sight.value > 0.0 else unseen).append(lines)
    return joined(seen), joined(unseen)


def part_outline(part: int, setup: Setup, tick: int) -> Floats:
    """The closed outline (n, 2) of a part of an obstacle at a tick."""
    capsule = world_at(setup.world, tick, setup.params.safety.control_period).capsules[part]
    return shapes.capsule(capsule[:2], capsule[2:4], capsule[4])
