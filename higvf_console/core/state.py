"""Everything that changes in a run, and the world that does not: NamedTuples of arrays, one row per robot.

    SimState = motion         what physics advances each tick (the kernel reads and returns it)
             + intent         what the operator asks of the team (the kernel reads it, commands write it)
             + pointer_state  cursor, growing stroke, pending path (seen on screen, without effect on the robots)

Positions are in the world frame, x right, y up, in metres; times in seconds; angles in radians. Indices count from 0,
the numbers that people see from 1. Arrays are never written in place: a step returns new ones, so that any thread may
keep a state for as long as it likes.
"""

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Bools, Floats, Ints, floats

NOBODY = -1  # no robot, no fire
CAPSULE = 5  # columns of a capsule: ax, ay, bx, by, radius
# Columns of `World.mover`, and of `World.boundary` behind its capsule.
MOVER_PART, MOVER_AX, MOVER_AY, MOVER_BX, MOVER_BY, MOVER_SPEED, MOVER_START, MOVER_ENDING = range(8)
GRID_X, GRID_Y, GRID_CELL, GRID_COLUMNS = range(CAPSULE, CAPSULE + 4)


class PathKind(IntEnum):
    """Which implicit function describes the desired path."""

    NONE = 0
    LINE = 1
    CIRCLE = 2
    SPLINE = 3  # ellipses and sketches


class PathStatus(IntEnum):
    """How far the influenced robot has come along the desired path."""

    NONE = 0
    FOLLOWING = 1
    FINISHED = 2
    BLOCKED = 3  # no progress for a while: flagged, then released
    BREAK_AWAY = 4  # left for a fire that was found on the way; w is kept, the team returns when it is out
    HOLDING = 5  # at its end, where the team waits


# Statuses with which a human intention acts on the team, be it by holding it.
ACTING = (PathStatus.FOLLOWING, PathStatus.BREAK_AWAY, PathStatus.HOLDING)


class PathEnding(IntEnum):
    """What happens at the end of an open path, and when the time of a path is over."""

    RELEASE = 0  # the human intention ends; the team goes on with its own task
    HOLD = 1  # the team waits there
    LOOP = 2  # the path starts again; when its time is over, as RELEASE


class Path(NamedTuple):
    """A desired path, ready for the kernel; made by `control.guidance.paths`.

    Attributes:
        kind: a `PathKind`.
        shape: (4,) LINE x, y, cos, sin; CIRCLE x, y, R, 0; else zeros.
        spline: (S, 8) SPLINE: cubic coefficients in arc length, x0..x3 then y0..y3, of equal segments; else (0, 8).
        spacing: length of one segment [m].
        length: arc length of the path [m]; inf for a line.
        closed: whether the path returns to its start.
        direction: gamma, +1 along increasing arc length, -1 against it.
        ending: a `PathEnding`.
        pace: share of their velocity that those who are led along it take.
        duration: how long it is followed at most, pauses not counted [s]; inf = as long as it takes.
    """

    kind: int
    shape: Floats
    spline: Floats
    spacing: float
    length: float
    closed: bool
    direction: float
    ending: int
    pace: float
    duration: float


NO_PATH = Path(
    kind=int(PathKind.NONE),
    shape=np.zeros(4),
    spline=np.zeros((0, 8)),
    spacing=1.0,
    length=0.0,
    closed=False,
    direction=1.0,
    ending=int(PathEnding.RELEASE),
    pace=1.0,
    duration=math.inf,
)
NO_PRIORITY = np.zeros((0, 3))


class Motion(NamedTuple):
    """What physics advances: N robots, M fires, K = G + M + V boundaries (of groups, fires and moving obstacles).

    Attributes:
        tick: control periods since the start.
        position: (N, 2) controlled points [m]: the robots' centres, or the look-ahead points of unicycles.
        heading: (N,) of unicycles, not wrapped [rad].
        velocity: (N, 2) velocity of the controlled point commanded by the safety filter in the last tick [m/s].
        intention: (N, 2) shared intention v_s, [15].
        target: (N,) fire index that the robot wants, or NOBODY.
        target_value: (N,) largest observed fire value of the target since it was chosen [rad].
        circulation: (N, K) circulation direction round each boundary as this robot's component agreed: 0 open, +-1 set
            by any robot, +-2 set by the influenced robot, +-3 turned over on the way out of a deadlock.
        stalled: (N,) how long the robot has been stalled against active constraints [s].
        recovery_stage: (N,) how many ways out of a deadlock have been tried, see `control.guidance.recovery`.
        fire_radius: (M,) [m]; an extinguished fire keeps its last radius.
        fire_progress: (M,) time that enough robots have spent extinguishing it [s].
        fire_burning: (M,).
        path_parameter: arc length w of the influenced robot on the desired path [m].
        path_status: a `PathStatus`.
        path_idle: how long the influenced robot has made no progress along it [s].
        path_gap: least travel that was ever left to the path's end [m].
        path_left: time that is left of the path's duration [s].
        robot_peak: largest |v_t| so far.
        human_peak: largest |v_h| so far.
    """

    tick: int
    position: Floats
    heading: Floats
    velocity: Floats
    intention: Floats
    target: Ints
    target_value: Floats
    circulation: Ints
    stalled: Floats
    recovery_stage: Ints
    fire_radius: Floats
    fire_progress: Floats
    fire_burning: Bools
    path_parameter: float
    path_status: int
    path_idle: float
    path_gap: float
    path_left: float
    robot_peak: float
    human_peak: float


class Intent(NamedTuple):
    """What the operator asks of the team.

    Attributes:
        path: the desired path; NO_PATH when there is none.
        influenced: index of the robot that receives it.
        paused: nominal velocities are zero, the filter still yields.
        stopped: all velocities are zero, latched.
        priority: (P, 3) rows of robot, fire and the factor by which that robot values that fire more.
    """

    path: Path
    influenced: int
    paused: bool
    stopped: bool
    priority: Floats


class PointerState(NamedTuple):
    """Pointer and pending path of the operator, seen on screen.

    Attributes:
        cursor: (2,) where gaze or pointer is [m]; NaN when unseen.
        stroke: (n, 2) points of the growing stroke [m].
        stroke_source: interface that draws it; empty when nobody does.
        clutch: whether the operator holds the clutch that lets gaze draw.
        ask_reset: whether a latched STOP has been asked to reset and waits for the second step.
        pending: a drawn path that waits to be committed; NO_PATH when none does.
        pending_robot: index of the robot that it was drawn for; NOBODY = the one that is influenced then.
        proposed: index of the robot that a decoder is unsure to have been asked for; NOBODY when none is.
        proposed_until: when that proposal lapses [s of session time].
        pending_repairs: whether it is the path in force, repaired: it goes on where that is, and takes its place.
        paths: drawn so far, to be taken up again; the oldest first.
    """

    cursor: Floats
    stroke: Floats
    stroke_source: str
    clutch: bool
    ask_reset: bool
    pending: Path = NO_PATH
    pending_robot: int = NOBODY
    pending_repairs: bool = False
    proposed: int = NOBODY
    proposed_until: float = math.inf
    paths: tuple[Path, ...] = ()


class SimState(NamedTuple):
    """The whole state of a run."""

    motion: Motion
    intent: Intent
    pointer_state: PointerState


class World(NamedTuple):
    """What is the same all through a run: N robots, M fires, P circles, Q bars, V moving obstacles, W walls.

    Obstacles count twice: as parts, for barrier constraints and sight, and as G groups (of those that stand still),
    which the field goes round. The places of moving obstacles are a function of time, see `obstacles.world_at`.

    Attributes:
        capsules: (P + Q, 5) parts: spine ax, ay, bx, by and radius [m]. Circles come first, their spine is a point;
            then bars. An irregular obstacle is a closed chain of bars without width.
        circle_count: P.
        capsule_velocity: (P + Q, 2) over the coming control period [m/s]; zero but in a world of `world_at`.
        mover: (V, 8), columns `MOVER_...`: part, its spine ax, ay, bx, by at the start of its course [m], speed [m/s],
            arc length at time 0 [m], and what happens at the end of the course: `obstacles.STOP`, `LOOP` or `ONWARD`.
        course: (C, 3) points of courses, relative to their first [m], and the arc length up to each [m].
        course_start: (V + 1,) mover v's rows in `course`.
        walls: (W, 3) unit inward normal nx, ny and offset w [m]: inside means n.p >= w.
        fire_position: (M, 2) [m].
        fire_growth: (M,) [m/s].
        fire_needs: (M,) robots that it takes to extinguish it.
        formation: (N, 2) shape whose pairwise distances the team keeps [m].
        link_start: (N + 1,) row i's links are link_to[link_start[i]:link_start[i + 1]]; (0,) when the communication
            range decides.
        link_to: (E,) neighbour index, each link twice.
        boundary: (G, 9) capsule ax, ay, bx, by, radius [m] of a lone part, or the circle round a hull; then, in the
            columns `GRID_...`, the grid of its pocket: x, y of the first node, cell width [m], columns (0 = no pocket).
        boundary_start: (3, G + 1) group g's rows in `hull`, `part` and `pocket`.
        hull: (H, 2) corners of convex hulls, counter-clockwise [m]; a lone part has none.
        part: (P + Q - V,) rows of `capsules`, by group.
        pocket: (C, 3) grids of hulls, row by row: unit vector of the shortest way out, distance to the parts [m].
    """

    capsules: Floats
    circle_count: int
    capsule_velocity: Floats
    mover: Floats
    course: Floats
    course_start: Ints
    walls: Floats
    fire_position: Floats
    fire_growth: Floats
    fire_needs: Ints
    formation: Floats
    link_start: Ints
    link_to: Ints
    boundary: Floats
    boundary_start: Ints
    hull: Floats
    part: Ints
    pocket: Floats

    @property
    def circles(self) -> Floats:
        """(P, 3) x, y, radius [m]."""
        return floats(self.capsules[: self.circle_count, [0, 1, 4]])

    @property
    def bars(self) -> Floats:
        """(Q, 5) ax, ay, bx, by, half width [m]."""
        return self.capsules[self.circle_count :]


class Trace(NamedTuple):
    """Why the team moved as it did in one tick: every term, for the inspector and the metrics.

    Attributes:
        fire_value: (N, M) observed fire values theta [rad], [10].
        terms: (N, 5, 2) the vectors that the five properties below name, in their order.
        blending: (N,) lambda, [19].
        active_constraints: (N,) barrier constraints that shaped the robot's velocity.
        infeasible: (N,) no velocity met all constraints: the least violation was taken.
        deadlocked: (N,) the detector of stalls holds.
        clearance: (N,) smallest of |p_i - p_j| - R_r and |p - o| - R_k of the bodies [m]; negative = violation.
        barrier: (N,) smallest h of [20] and [26], dimensionless; negative = violation.
        links: (E, 2) communication links i < j.
        component: (N,) connected component, named by its smallest robot index.
        crew: (M,) robots that count towards extinguishing each fire.
    """

    fire_value: Floats
    terms: Floats
    blending: Floats
    active_constraints: Ints
    infeasible: Bools
    deadlocked: Bools
    clearance: Floats
    barrier: Floats
    links: Ints
    component: Ints
    crew: Ints

    @property
    def robot_intention(self) -> Floats:
        """(N, 2) v_t, [13]."""
        return self.terms[:, 0]

    @property
    def human_intention(self) -> Floats:
        """(N, 2) v_h, zero but for the influenced robot, [9]."""
        return self.terms[:, 1]

    @property
    def formation(self) -> Floats:
        """(N, 2) v_f [m/s], [14]."""
        return self.terms[:, 2]

    @property
    def blended(self) -> Floats:
        """(N, 2) lambda v_s + (1 - lambda) v_f [m/s], [18]."""
        return self.terms[:, 3]

    @property
    def nominal(self) -> Floats:
        """(N, 2) after the composite step and the speed clip: what the filter was given [m/s]."""
        return self.terms[:, 4]
