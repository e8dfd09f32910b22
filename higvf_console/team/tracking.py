"""Which measured poses are believed, and where a robot is by the time that a command reaches it.

A pose that is no number, from the future, or farther from the last one than a robot can drive is refused and counted.
Between poses a robot is where its commands have taken it since: it is predicted ahead by them. How fast poses leave
that prediction is measured, and bounds the error of the next one.
"""

import math
from enum import StrEnum
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Bools, Floats, Ints
from higvf_console.core.team import Drive, Poses

MEMORY = 2.0  # for which commands are remembered [s]
_EARLY = 0.05  # by which a pose may be ahead of the clock [s]
_LEAST_HORIZON = 0.05  # over which the error of a prediction is taken [s]
_SMOOTHING = 0.4  # of the measured velocity [s]
_FADING = 3.0  # in which a measured drift falls to a third [s]
_JUMP = 0.5  # of a body's radius by which poses may differ beyond what a robot can drive
_STILL = 0.02  # of a body's radius within which a robot stands
_STILL_TURN = 0.03  # [rad]
STANDS_AFTER = 0.2  # at one place [s]


class Rules(NamedTuple):
    """What is known of the robots beforehand.

    Attributes:
        speed_limit: of the controlled points [m/s].
        look_ahead: distance of the controlled point from the centre [m]; 0 = robots that move any way.
        body_radius: of a robot [m].
        error: largest error of a measured position [m].
        stale_after: age of a pose from which on its robot must stand [s].
        lost_after: age from which on the team must stand [s].
    """

    speed_limit: float
    look_ahead: float
    body_radius: float
    error: float = 0.0
    stale_after: float = 0.25
    lost_after: float = 1.0


class Sent(NamedTuple):
    """A command and when it was sent [s]."""

    at: float
    command: Drive


class PoseFault(StrEnum):
    """Why a pose was refused."""

    NUMBER = "not a number"
    FUTURE = "from the future"
    JUMP = "farther away than it can drive"


class Track(NamedTuple):
    """What is believed of N robots.

    Attributes:
        position: (N, 2) last believed centres [m]; NaN = never seen.
        heading: (N,) then [rad].
        measured_at: (N,) when [s]; -inf = never.
        velocity: (N, 2) from the believed poses of the last `_SMOOTHING` seconds or so [m/s].
        drift: (N,) how fast poses have left the prediction lately, at most [m/s].
        anchor: (N, 3) place and heading that the robot has not left since `anchored_at`.
        anchored_at: (N,) [s].
        refused: (N,) poses refused so far.
        looked_at: (N,) time of the last pose that was looked at, believed or not [s].
    """

    position: Floats
    heading: Floats
    measured_at: Floats
    velocity: Floats
    drift: Floats
    anchor: Floats
    anchored_at: Floats
    refused: Ints
    looked_at: Floats

    @property
    def seen(self) -> Bools:
        """(N,) which robots have been seen."""
        return np.isfinite(self.measured_at)

    def age(self, now: float) -> Floats:
        """(N,) of the believed poses at `now` [s]."""
        return np.maximum(now - self.measured_at, 0.0)

    def stands(self) -> Bools:
        """(N,) which robots are measured to stand."""
        since = np.where(self.seen, self.anchored_at, np.inf)
        return self.measured_at - since >= STANDS_AFTER


def nowhere(robots: int) -> Track:
    """Nothing is known of the robots."""
    nan, never = np.full(robots, np.nan), np.full(robots, -np.inf)
    return Track(
        np.full((robots, 2), np.nan), nan, never, np.zeros((robots, 2)), np.zeros(robots), np.full((robots, 3), np.nan),
        never, np.zeros(robots, np.int64), never,
    )  # fmt: skip


def follow(
    track: Track, poses: Poses, now: float, sent: tuple[Sent, ...], latency: float, rules: Rules, *, carried: bool
) -> tuple[Track, tuple[tuple[int, PoseFault], ...]]:
    """The track after a report.

    Args:
        track: before.
        poses: newest of each robot.
        now: time of the report [s].
        sent: commands on their way or in force, oldest first.
        latency: from a command to its effect [s].
        rules: what the robots can do.
        carried: whether people may carry the robots, so that no jump is refused.

    Returns:
        The track, and for each refused pose the robot (index from 0) and why.
    """
    fresh = ~(poses.measured_at <= track.looked_at) & ~_all_nan(poses)
    if not fresh.any():
        return track, ()
    finite = np.isfinite(poses.position).all(axis=1) & np.isfinite(poses.measured_at)
    if rules.look_ahead > 0.0:
        finite &= np.isfinite(poses.heading)
    early = finite & (poses.measured_at > now + _EARLY)
    usable = fresh & finite & ~early
    passed = np.where(usable & track.seen, poses.measured_at - track.measured_at, 0.0)
    moved = np.where(usable & track.seen, _lengths(poses.position - track.position), 0.0)
    reach = rules.speed_limit * passed + 2.0 * rules.error + _JUMP * rules.body_radius
    jumps = usable & (moved > reach) & (not carried)
    believed = usable & ~jumps
    faults = [
        *((int(i), PoseFault.NUMBER) for i in (fresh & ~finite).nonzero()[0]),
        *((int(i), PoseFault.FUTURE) for i in (fresh & early).nonzero()[0]),
        *((int(i), PoseFault.JUMP) for i in jumps.nonzero()[0]),
    ]
    refused = track.refused.copy()
    for robot, _ in faults:
        refused[robot] += 1
    looked_at = np.where(fresh & finite & ~early, poses.measured_at, track.looked_at)
    track = track._replace(refused=refused, looked_at=looked_at)
    return _believe(track, poses, believed, passed, sent, latency, rules), tuple(sorted(faults))


def _believe(
    track: Track, poses: Poses, believed: Bools, passed: Floats, sent: tuple[Sent, ...], latency: float,
    rules: Rules,
) -> Track:  # fmt: skip
    """The track with the believed poses."""
    heading = np.where(np.isfinite(poses.heading), poses.heading, 0.0)
    known = believed & track.seen & (passed > 0.0)
    drift = track.drift
    if known.any():
        expected, _ = predicted(track, sent, latency, np.where(known, poses.measured_at, track.measured_at), rules)
        error = np.where(known, _lengths(poses.position - expected) - 2.0 * rules.error, 0.0)
        sample = np.maximum(error, 0.0) / np.maximum(passed, _LEAST_HORIZON)
        drift = np.where(known, np.maximum(sample, drift * np.exp(-passed / _FADING)), drift)
    here = np.column_stack((poses.position, heading))
    away = _lengths(here[:, :2] - track.anchor[:, :2]) > _STILL * rules.body_radius + 2.0 * rules.error
    turned = np.abs(_wrapped(heading - track.anchor[:, 2])) > _STILL_TURN
    left = believed & (~track.seen | away | (turned & (rules.look_ahead > 0.0)))
    return track._replace(
        position=np.where(believed[:, None], poses.position, track.position),
        heading=np.where(believed, heading, track.heading),
        measured_at=np.where(believed, poses.measured_at, track.measured_at),
        velocity=_smoothed(track, poses, passed, known),
        drift=drift,
        anchor=np.where(left[:, None], here, track.anchor),
        anchored_at=np.where(left, poses.measured_at, track.anchored_at),
    )


def _smoothed(track: Track, poses: Poses, passed: Floats, known: Bools) -> Floats:
    """The velocities (N, 2) with those since the last believed poses taken in, of the robots (N,) that are known."""
    step = track.velocity.copy()
    step[known] = (poses.position - track.position)[known] / np.maximum(passed, 1e-3)[known, None]
    return track.velocity + (1.0 - np.exp(-passed / _SMOOTHING))[:, None] * (step - track.velocity)


def predicted(
    track: Track, sent: tuple[Sent, ...], latency: float, until: Floats | float, rules: Rules
) -> tuple[Floats, Floats]:
    """Where the commands have taken the robots since their poses were measured.

    Args:
        track: the believed poses.
        sent: commands, oldest first; each acts from `latency` after it was sent until the next one does, or it expires.
        latency: [s].
        until: (N,) or one for all [s].
        rules: whether robots have a heading.

    Returns:
        Centres (N, 2) [m] and headings (N,) [rad]; those of robots never seen are NaN.
    """
    until = np.broadcast_to(np.asarray(until, np.float64), track.measured_at.shape)
    first, last = float(track.measured_at.min(initial=np.inf, where=track.seen)), float(np.max(until))
    acting = [  # those that can matter; a team sends a hundred in the time for which they are remembered
        (at + latency, end + latency, command)
        for (at, command), end in zip(sent, _ends(sent), strict=True)
        if at + latency < last and end + latency > first
    ]
    if not acting:
        return track.position.copy(), track.heading.copy()
    begin, end = (np.array([row[k] for row in acting], np.float64)[:, None] for k in (0, 1))
    held = np.maximum(np.minimum(until, end) - np.maximum(track.measured_at, begin), 0.0)
    held[~np.isfinite(held)] = 0.0
    if rules.look_ahead == 0.0:
        velocity = np.array([command.velocity for _, _, command in acting])
        return track.position + (velocity * held[:, :, None]).sum(axis=0), track.heading.copy()
    half = 0.5 * held * np.array([command.turn for _, _, command in acting])
    chord = held * np.array([command.forward for _, _, command in acting]) * np.sinc(half / math.pi)
    turned = 2.0 * np.cumsum(half, axis=0)
    course = track.heading + turned - half  # that of each chord
    moved = np.stack(((chord * np.cos(course)).sum(axis=0), (chord * np.sin(course)).sum(axis=0)), axis=1)
    return track.position + moved, track.heading + turned[-1]


def _ends(sent: tuple[Sent, ...]) -> list[float]:
    """When each command ends: with the next one, or when it expires [s]."""
    following = [*(one.at for one in sent[1:]), math.inf][: len(sent)]
    return [min(one.at + one.command.valid_for, end) for one, end in zip(sent, following, strict=True)]


def remembered(sent: tuple[Sent, ...], command: Drive, now: float) -> tuple[Sent, ...]:
    """The commands with one more; those that cannot matter any more are forgotten."""
    return (*(one for one in sent if now - one.at < MEMORY), Sent(now, command))


def _all_nan(poses: Poses) -> Bools:
    """(N,) which robots the poses say nothing of."""
    return np.isnan(poses.position).all(axis=1) & np.isnan(poses.measured_at)


def _lengths(vectors: Floats) -> Floats:
    return np.hypot(vectors[:, 0], vectors[:, 1])


def _wrapped(angle: Floats) -> Floats:
    return np.arctan2(np.sin(angle), np.cos(angle))
