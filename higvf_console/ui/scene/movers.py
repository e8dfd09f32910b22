"""Moving obstacles: each at its place of the tick, on its dashed course, with an arrow for its velocity."""

import numpy as np

from higvf_console.control.guidance.obstacles import ONWARD, world_at
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.state import SimState
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.ground import joined
from higvf_console.ui.scene.parts import Canvas, Group, Layer, Lines
from higvf_console.ui.scene.reasons import arrow
from higvf_console.ui.theme import NOMINAL
from higvf_console.world.obstacles import Course
from higvf_console.world.setup import Setup

AHEAD = 2.0  # [s]; an arrow is as long as the way that the obstacle goes in that time
_BARB, _LEAST = 9.0, 4.0  # of an arrow [px]
_DASH, _GAP = 4.0, 6.0  # of a course [px]
_FAR = 1e5  # drawn of a course that goes on for ever [m]


class Movers:
    """Shapes are sent once; each frame moves them, fill and outlines as one group."""

    def __init__(self, canvas: Canvas, setup: Setup) -> None:
        """Draws the courses, and each obstacle at the start of its own."""
        self._setup, self._px = setup, canvas.px
        ink, margins = canvas.palette, setup.params.boundaries
        self._movers = setup.layout.obstacles.movers()
        ways = [course_line(*mover, setup) for mover in self._movers]
        dash, gap = _DASH * canvas.px, _GAP * canvas.px
        course = canvas.lines(Layer.BOUNDARY, "/movers/course", ink.obstacle_edge, 1.0)
        course.draw(shapes.clipped(joined([shapes.dashed(way, dash, gap) for way in ways]), *setup.arena))
        self._arrows = canvas.lines(Layer.CHEVRON, "/movers/velocity", ink.text, 2.0)
        self._groups: list[Group] = []
        self._boundaries: list[Lines] = []
        for number, (row, _) in enumerate(self._movers):
            name, outline = f"/movers/{number}", _outline(row, setup, 0.0)
            self._groups.append(canvas.group(name))
            canvas.mesh(Layer.OBSTACLE, f"{name}/body", shapes.filled(outline), ink.obstacle)
            edge = canvas.lines(Layer.OBSTACLE, f"{name}/edge", ink.obstacle_edge, NOMINAL.outline)
            edge.draw(shapes.segments(outline))
            reactive = canvas.lines(Layer.BOUNDARY, f"{name}/reactive", ink.boundary, NOMINAL.boundary)
            dashes = 5 * canvas.px
            reactive.draw(shapes.dashed(_outline(row, setup, margins.reactive_margin), dashes, dashes))
            repulsive = canvas.lines(Layer.BOUNDARY, f"{name}/repulsive", ink.boundary, NOMINAL.boundary)
            repulsive.draw(shapes.segments(_outline(row, setup, margins.repulsive_margin)))
            self._boundaries += [reactive, repulsive]

    def update(self, state: SimState, boundaries: bool) -> None:
        """Puts every obstacle where it is; `boundaries` shows its reactive and repulsive ones."""
        if not self._movers:
            return
        tick = state.motion.tick
        for group, (_, course) in zip(self._groups, self._movers, strict=True):
            group.move(course.offset(self._time(tick)))
        for lines in self._boundaries:
            lines.show(boundaries)
        self._arrows.draw(velocity_arrows(self._setup, tick, self._px))

    def _time(self, tick: int) -> float:
        return tick * self._setup.params.safety.control_period


def course_line(row: int, course: Course, setup: Setup) -> Floats:
    """The course (n, 2) of the middle of a capsule of the world [m]; a straight one is drawn far beyond the arena."""
    points = course.points[:, :2]
    if course.ending == ONWARD:
        points = np.stack([points[0], _FAR * points[1]])
    return points + _middle(row, setup)


def velocity_arrows(setup: Setup, tick: int, px: float) -> Floats:
    """Arrows (s, 2, 2) from the surface of each moving obstacle, along the way that it goes in `AHEAD` [m]."""
    world = world_at(setup.world, tick, setup.params.safety.control_period)
    found: list[Floats] = []
    for row, _ in setup.layout.obstacles.movers():
        capsule, velocity = world.capsules[row], world.capsule_velocity[row]
        speed = float(np.hypot(*velocity))
        if speed == 0.0:
            continue
        along = velocity / speed
        ends = capsule[:4].reshape(2, 2)
        front = ends[int(np.argmax(ends @ along))] if abs(np.diff(ends @ along)[0]) > 1e-9 else ends.mean(axis=0)
        tail = front + capsule[4] * along
        found.append(arrow(tail, tail + AHEAD * velocity, _LEAST * px, _BARB * px))
    return joined(found)


def _outline(row: int, setup: Setup, margin: float) -> Floats:
    capsule = setup.world.capsules[row]
    return shapes.capsule(capsule[:2], capsule[2:4], capsule[4] + margin)


def _middle(row: int, setup: Setup) -> Floats:
    return floats(setup.world.capsules[row, :4].reshape(2, 2).mean(axis=0))
