"""The team: arrow marks with numbers, who is influenced, who is in trouble, links, trails, clearances."""

import time as clock
from collections import deque

import numpy as np
from numpy.typing import NDArray

from higvf_console.control.parameters import controlled
from higvf_console.core.arrays import Bools, Floats, Ints, floats
from higvf_console.core.state import SimState, Trace
from higvf_console.sim.events import too_near
from higvf_console.sim.unicycle import body_centres
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.glyphs import DigitPlaces, Triangles, glyph, merged, numbering
from higvf_console.ui.scene.parts import Canvas, Layer, Marks
from higvf_console.ui.theme import DARK, NOMINAL, Palette, cap_height, mixed, vertex_rgb
from higvf_console.world.setup import Setup

MOST_LABELS = 50  # robots of a larger team are not numbered
TRAIL_POINTS = 20
TRAIL_ROBOTS = 200
TRAIL_PERIOD = 0.3  # [s] of session time
MOST_LINKS = 3000
# Positions are sent each frame. Headings, links and rings of a larger team, which need several times the bytes, lag.
ALL_AT_ONCE = 30  # robots
LAG = 0.2  # [s] of real time, at most
_HALO = 0.16  # width of the halo of a number [digit heights]
_CHOSEN = 1.3  # size of the influenced robot's mark


class Team:
    """Everything that moves with the robots: a handful of nodes, whatever the size of the team."""

    def __init__(self, canvas: Canvas, setup: Setup) -> None:
        """One instance a robot."""
        self._canvas, self._setup, ink = canvas, setup, canvas.palette
        self._count = count = len(setup.start.motion.position)
        clearance = setup.params.safety.robot_clearance
        self._length = max(0.55 * NOMINAL.robot * canvas.px, min(NOMINAL.robot * canvas.px, 1.1 * clearance))
        self._heading = np.zeros(count)
        self._influenced: int | None = None
        self._robots = canvas.marks(
            Layer.ROBOT, "/team/robots", shapes.dart(self._length), count=count, colour=ink.robot
        )
        self._halo = canvas.marks(Layer.HALO, "/team/influenced", self._halo_shape(), count=1, colour=ink.operator)
        ring = shapes.annulus(clearance / 2 - 1.2 * canvas.px, clearance / 2, 40)
        self._clearance = canvas.marks(Layer.CLEARANCE, "/team/clearance", ring, count=count, colour=ink.clearance)
        self._points = ControlledPoints(canvas, setup)
        self._links = canvas.lines(Layer.LINK, "/team/links", ink.link, NOMINAL.link)
        self._next = 0.0  # [s]
        self._unsafe = canvas.lines(Layer.HALO, "/team/unsafe", ink.trouble, 2.5)
        self._deadlocked = canvas.lines(Layer.HALO, "/team/deadlocked", ink.trouble, 2.5)
        self._numbers = Numbers(canvas, count, self._length)
        self._trails = Trails(canvas, count)

    def _halo_shape(self) -> Triangles:
        return shapes.annulus(0.95 * self._length, 0.95 * self._length + 2.2 * self._canvas.px)

    def update(self, state: SimState, trace: Trace, time: float) -> None:
        """Shows the team of a snapshot."""
        motion, params = state.motion, self._setup.params
        at = body_centres(motion.position, motion.heading, params.robots.look_ahead)
        if params.robots.look_ahead > 0.0:
            self._heading = motion.heading
        else:
            self._heading = shapes.headings(motion.velocity, self._heading, params.blending.cruise_speed)
        due = self._due()
        self._robots.place(at, self._heading if due else None)
        self._clearance.place(at)
        self._points.place(at, motion.position)
        unsafe = trace.infeasible | too_near(trace)
        apart = unsafe | trace.deadlocked
        if 0 <= state.intent.influenced < self._count:
            apart[state.intent.influenced] = True
        self._numbers.place(at, apart)
        self._trails.follow(at, time)
        if due:
            self._links.draw(link_segments(at, trace.links))
            self._unsafe.draw(rings(at, unsafe, 0.8 * self._length, 24))
            self._deadlocked.draw(rings(at, trace.deadlocked, 1.1 * self._length, 4))
        self._choose(state.intent.influenced, at)

    def _due(self) -> bool:
        """Whether all of the team is to be drawn, and not only where the robots are."""
        now = clock.monotonic()
        if self._count > ALL_AT_ONCE and now < self._next:
            return False
        self._next = now + LAG
        return True

    def _choose(self, influenced: int, at: Floats) -> None:
        known = 0 <= influenced < self._count
        if known:
            self._halo.place(at[influenced : influenced + 1])
        if influenced != self._influenced:
            self._influenced = influenced
            self._halo.show(known)
            chosen = np.arange(self._count) == influenced
            ink = self._canvas.palette
            self._robots.highlight(ink.robot, chosen, ink.operator)
            self._robots.resize(np.where(chosen, _CHOSEN, 1.0))
            self._numbers.highlight(influenced)

    def show(self, *, links: bool, trails: bool, labels: bool, clearance: bool) -> None:
        """Shows or hides what the operator may switch."""
        self._links.show(links)
        self._trails.show(trails)
        self._numbers.show(labels)
        self._clearance.show(clearance)
        self._points.show_clearance(clearance)


class ControlledPoints:
    """The look-ahead points of unicycles, tied to their robots, and the enlarged clearance that the filter keeps.

    A robot whose controlled point is its centre has none; noise alone still enlarges the clearance.
    """

    def __init__(self, canvas: Canvas, setup: Setup) -> None:
        """One point a robot, where there are unicycles."""
        ink = canvas.palette
        body, point = setup.params.safety.robot_clearance, controlled(setup.params).safety.robot_clearance
        robots = len(setup.start.motion.position)
        ahead, apart = setup.params.robots.look_ahead > 0.0, point > body
        dot = shapes.filled(shapes.circle(0.0, 0.0, 2.2 * canvas.px, 16))
        ring = shapes.annulus(point / 2 - 0.8 * canvas.px, point / 2, 40)
        self._ties = canvas.lines(Layer.CLEARANCE, "/team/look_ahead_ties", ink.robot_text, NOMINAL.link)
        self._dots = canvas.marks(
            Layer.ROBOT_TEXT, "/team/look_ahead", dot, count=robots * ahead, colour=ink.robot_text
        )
        self._rings = canvas.marks(
            Layer.CLEARANCE, "/team/enlarged", ring, count=robots * apart, colour=ink.clearance, opacity=0.5
        )

    def place(self, centres: Floats, points: Floats) -> None:
        """Moves them to the robots' centres (N, 2) and controlled points (N, 2) [m]."""
        if self._dots.count:
            self._ties.draw(np.stack([centres, points], axis=1))
        self._dots.place(points)
        self._rings.place(points)

    def show_clearance(self, visible: bool) -> None:
        """Shows or hides the enlarged clearance."""
        self._rings.show(visible)


class Numbers:
    """The robots' numbers, one batch for each digit, beside the marks; a halo sets them off from what they lie on."""

    def __init__(self, canvas: Canvas, count: int, length: float) -> None:
        """Letters a team of at most `MOST_LABELS`."""
        self._palette = canvas.palette
        self._height = cap_height(canvas.sizes.text) * canvas.px
        self._below = 0.62 * length + 1.1 * self._height
        self._below_ring = 1.1 * length + 1.2 * self._height
        self._digits = [(places, *self._marks(canvas, places)) for places in numbering(count, MOST_LABELS)]

    def _marks(self, canvas: Canvas, places: DigitPlaces) -> tuple[Marks, Marks]:
        """A digit and its halo."""
        shape, count, ink = glyph(places.digit), len(places.robot), self._palette
        text, halo = f"/team/digit_{places.digit}", f"/team/halo_{places.digit}"
        return (
            canvas.marks(Layer.ROBOT_TEXT, text, shape, count=count, colour=ink.robot_text),
            canvas.marks(Layer.ROBOT_TEXT_HALO, halo, spread(shape, _HALO), count=count, colour=ink.floor),
        )

    def place(self, at: Floats, ringed: Bools) -> None:
        """Moves the numbers along with the robots (N, 2) [m], farther from those that wear a ring (N,)."""
        below = np.where(ringed, self._below_ring, self._below)
        for places, digit, halo in self._digits:
            corner = at[places.robot]
            corner[:, 0] += places.offset * self._height
            corner[:, 1] -= below[places.robot]
            for marks in (digit, halo):
                marks.place(corner, scale=np.full(len(corner), self._height))

    def highlight(self, robot: int) -> None:
        """Letters one robot in the operator's colour."""
        for places, digit, _ in self._digits:
            digit.highlight(self._palette.robot_text, places.robot == robot, self._palette.operator)

    def show(self, visible: bool) -> None:
        """Shows or hides them."""
        for _, digit, halo in self._digits:
            digit.show(visible)
            halo.show(visible)


def spread(shape: Triangles, margin: float) -> Triangles:
    """A flat mesh that covers another and a margin round it [both in its own unit]."""
    turn = 2 * np.pi * np.arange(8) / 8
    shifts = margin * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    return merged([Triangles(shape.vertices + shift, shape.faces) for shift in shifts])


class Trails:
    """Where the robots of a team of at most `TRAIL_ROBOTS` were in the last seconds, fading."""

    def __init__(self, canvas: Canvas, robots: int) -> None:
        """Starts without a past."""
        self._palette = canvas.palette
        self._lines = canvas.lines(Layer.TRAIL, "/team/trails", None, NOMINAL.trail)
        self._drawn = 0 < robots <= TRAIL_ROBOTS
        self._past: deque[Floats] = deque(maxlen=TRAIL_POINTS)
        self._time = -np.inf

    def follow(self, at: Floats, time: float) -> None:
        """Adds the robots' positions (N, 2) [m], one in each `TRAIL_PERIOD`; a reset run starts anew."""
        if not self._drawn or self._time <= time < self._time + TRAIL_PERIOD:
            return
        if time < self._time:
            self._past.clear()
        self._time = time
        self._past.append(at)
        track = np.stack(self._past)
        steps = np.stack([track[:-1], track[1:]], axis=2)
        self._lines.draw(steps.reshape(-1, 2, 2), faded(len(steps), len(at), self._palette))

    def show(self, visible: bool) -> None:
        """Shows or hides them."""
        self._lines.show(visible)


def faded(steps: int, robots: int, palette: Palette = DARK) -> NDArray[np.uint8]:
    """Colours (steps * robots, 2, 3) from the floor's (oldest) to the trail's (newest)."""
    authority = np.linspace(0.0, 1.0, TRAIL_POINTS)[-steps - 1 :]
    shades = np.array([vertex_rgb(mixed(palette.floor, palette.trail, share)) for share in authority], np.uint8)
    return np.repeat(np.stack([shades[:-1], shades[1:]], axis=1), robots, axis=0)


def link_segments(at: Floats, links: Ints) -> Floats:
    """Communication links (E, 2) as segments (e, 2, 2); of a dense team at most `MOST_LINKS`, evenly chosen."""
    if len(links) > MOST_LINKS:
        links = links[np.linspace(0, len(links) - 1, MOST_LINKS).astype(np.int64)]
    return at[links] if len(links) else floats([], 0, 2, 2)


def rings(at: Floats, marked: Bools, radius: float, corners: int) -> Floats:
    """Outlines (s, 2, 2) round the marked robots; four corners make a diamond."""
    ring = shapes.segments(shapes.circle(0.0, 0.0, radius, corners))
    return (at[marked][:, None, None] + ring).reshape(-1, 2, 2)
