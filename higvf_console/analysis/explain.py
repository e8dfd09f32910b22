"""Why a robot moved as it did: its commanded velocity as a sum of parts, and the authority shares.

    velocity = own target + human + neighbours + carried over  lambda C/|v_s| times the shares of v_s    [15]-[19]
             + formation                                       (1 - lambda) v_f                          [14], [18]
             + detour                                          composite step                            [7], [8]
             + limit                                           speed limit; or a pause, the end of a path, STOP
             + safety                                          what the filter corrects                  [25], [28]

The shares of v_s are those of the semi-implicit update: with W = w0 + w1 + w3 psi + sum w2 g, the new v_s is
dt / (1 + dt W) times the pulls w1 v_t, w3 psi v_h and sum w2 g v_j, plus 1 / (1 + dt W) times the v_s so far.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from higvf_console.control.forms import PRINTED
from higvf_console.control.guidance.following import following
from higvf_console.control.intention.packet_loss import SENDING, chance
from higvf_console.control.parameters import Parameters, controlled
from higvf_console.core.arrays import Bools, Floats, Ints, floats
from higvf_console.core.state import Motion, PathKind, PathStatus, SimState, Trace
from higvf_console.sim.guard import NO_GUARD, Guard


class Part(IntEnum):
    """What a commanded velocity is made of."""

    TARGET = 0
    HUMAN = 1
    NEIGHBOURS = 2
    CARRIED_OVER = 3
    FORMATION = 4
    DETOUR = 5
    LIMIT = 6
    SAFETY = 7


class Authority(IntEnum):
    """Who shapes a robot's velocity."""

    HUMAN = 0
    ROBOT = 1
    NEIGHBOURS = 2
    SAFETY = 3


class Moved(NamedTuple):
    """One control period.

    Attributes:
        before: the state that it started from.
        after: what physics made of it.
        trace: why.
        guard: what a team that is not integrated here added to the safety problem.
    """

    before: SimState
    after: Motion
    trace: Trace
    guard: Guard = NO_GUARD


class Explanation(NamedTuple):
    """Why R robots moved.

    Attributes:
        parts: (R, 8, 2) by `Part` [m/s]; they sum to the commanded velocity.
        authority: (R, 4) by `Authority`, authority shares that sum to 1; all 0 for a robot that nothing acts on.
    """

    parts: Floats
    authority: Floats


class _Pulls(NamedTuple):
    """What draws at the shared intentions of R robots, [15].

    Attributes:
        pull: (R, 3, 2) w1 v_t, w3 psi v_h and sum w2 g v_j [1/s].
        weight: (R,) W, the sum of all weights [1/s].
    """

    pull: Floats
    weight: Floats


def explain(moved: Moved, params: Parameters, robots: Ints) -> Explanation:
    """Takes the velocities of robots (R,) apart.

    Speed limit and composite step do not say in which order they shortened a vector: what the limit takes is counted
    as if it came first.
    """
    trace, intent = moved.trace, moved.before.intent
    v_s, weight = moved.after.intention[robots], trace.blending[robots]
    floor = 0.0 if params.forms.speed == PRINTED else params.blending.intention_floor
    parts = np.zeros((len(robots), len(Part), 2))
    with np.errstate(invalid="ignore", divide="ignore"):
        led, held = _component(moved, robots, PathStatus.FOLLOWING), _component(moved, robots, PathStatus.HOLDING)
        pace = np.where(led, intent.path.pace, 1.0)
        drive = pace * weight * params.blending.cruise_speed / np.maximum(np.hypot(v_s[:, 0], v_s[:, 1]), floor)
        drive = drive[:, None]
        pulls = _pulls(moved, params, robots)
        authority = _authority_shares(moved, params, robots, pulls)
        settled = drive[..., None] * pulls.pull / pulls.weight[:, None, None]
        parts[:, : Part.FORMATION] = drive[..., None] * authority
        parts[:, Part.FORMATION] = (pace * (1.0 - weight))[:, None] * trace.formation[robots]
        blended, nominal = trace.blended[robots], trace.nominal[robots]
        if intent.paused or intent.stopped:
            parts[:, Part.LIMIT] = nominal - blended
        else:
            parts[:, Part.LIMIT] = _taken_by_the_limit(blended, nominal, controlled(params).safety.speed_limit)
            parts[held, Part.LIMIT] = (nominal - blended)[held]
            parts[:, Part.DETOUR] = nominal - blended - parts[:, Part.LIMIT]
        parts[:, Part.SAFETY] = moved.after.velocity[robots] - nominal
    return Explanation(_finite(parts), _authority(_finite(parts), _finite(settled)))


def _component(moved: Moved, robots: Ints, status: PathStatus) -> Bools:
    """Which of robots (R,) are of the influenced robot's component while the path has that status."""
    intent, component = moved.before.intent, moved.trace.component
    on_path = intent.path.kind != PathKind.NONE and moved.after.path_status == status
    return (component[robots] == component[intent.influenced]) & on_path


def _pulls(moved: Moved, params: Parameters, robots: Ints) -> _Pulls:
    """The pulls, with the psi of the leader that explains its new intention better: 1, or boosted in a deadlock."""
    weights, trace = params.intention, moved.trace
    leads = following(moved.after, moved.before.intent) & (robots == moved.before.intent.influenced)
    neighbours, delivered = _neighbours(moved, params, robots)
    found: list[_Pulls] = []
    for psi in (1.0, params.stall.human_boost):
        human = np.where(leads, weights.human_weight * psi, 0.0)
        pull = np.stack(
            [weights.robot_weight * trace.robot_intention[robots], human[:, None] * trace.human_intention[robots],
             neighbours], axis=1,
        )  # fmt: skip
        found.append(_Pulls(pull, weights.decay + weights.robot_weight + human + delivered))
    now = moved.after.intention[robots]
    plain, boosted = (
        np.abs(_authority_shares(moved, params, robots, pulls).sum(axis=1) - now).max(initial=0.0) for pulls in found
    )
    return found[int(boosted < plain)]


def _authority_shares(moved: Moved, params: Parameters, robots: Ints, pulls: _Pulls) -> Floats:
    """(R, 4, 2) what makes up the new v_s: own target, human, neighbours, v_s so far."""
    before, dt = moved.before.motion.intention[robots], params.safety.control_period
    if moved.before.intent.paused:
        return np.concatenate([np.zeros((len(robots), 3, 2)), before[:, None]], axis=1)
    weight = pulls.weight[:, None]
    if params.forms.intention == PRINTED:
        return np.concatenate([pulls.pull, (-weight * before)[:, None]], axis=1)
    shrink = 1.0 / (1.0 + dt * weight)
    return np.concatenate([dt * shrink[..., None] * pulls.pull, (shrink * before)[:, None]], axis=1)


def _neighbours(moved: Moved, params: Parameters, robots: Ints) -> tuple[Floats, Floats]:
    """Pulls sum w2 g v_j (R, 2) of the neighbours whose messages arrived, and their weights sum w2 g (R,), [16]."""
    before, links = moved.before.motion.intention, moved.trace.links
    place = np.full(len(before), -1, np.int64)
    place[robots] = np.arange(len(robots))
    to, of = np.concatenate([links, links[:, ::-1]]).T
    wanted = place[to] >= 0
    to, of = to[wanted], of[wanted]
    if params.robots.packet_loss > 0.0:
        came = _arrived(to, of, moved.before.motion.tick, params)
        to, of = to[came], of[came]
    gap = np.hypot(*(before[of] - before[to]).T)
    share = np.zeros(len(gap))
    apart = gap > params.intention.dead_zone
    share[apart] = params.intention.neighbour_weight * (gap[apart] - params.intention.dead_zone) / gap[apart]
    row, count = place[to], len(robots)
    pull = np.stack([floats(np.bincount(row, share * before[of, axis], count)) for axis in (0, 1)], axis=1)
    return pull, floats(np.bincount(row, share, count))


def _arrived(to: Ints, of: Ints, tick: int, params: Parameters) -> Ints:
    """Which of the messages over links to-of (E,) arrived in this tick: the draws of `packet_loss.delivered`."""
    robots = params.robots
    return np.flatnonzero([
        chance(robots.seed, tick, SENDING, min(i, j), max(i, j)) >= robots.packet_loss
        for i, j in zip(to.tolist(), of.tolist(), strict=True)
    ])  # fmt: skip


def _taken_by_the_limit(blended: Floats, nominal: Floats, limit: float) -> Floats:
    """What the speed limit takes off blended velocities (R, 2) [m/s]; nothing from a nominal one that is below it."""
    speed = np.hypot(blended[:, 0], blended[:, 1])
    clipped = (np.hypot(nominal[:, 0], nominal[:, 1]) >= limit * (1.0 - 1e-9)) & (speed > limit)
    return np.where(clipped, limit / np.maximum(speed, limit) - 1.0, 0.0)[:, None] * blended


def _authority(parts: Floats, settled: Floats) -> Floats:
    """Shares (R, 4) by `Authority`, by length: of what each would settle to (R, 3, 2), formation and corrections [m/s].

    The formation counts with the neighbours, the detour with safety. The value of v_s from the last control period has
    no share of its own: the same sources made it.
    """
    own, human, neighbours = np.hypot(settled[..., 0], settled[..., 1]).T
    length = np.hypot(parts[..., 0], parts[..., 1])
    shares = np.stack(
        [human, own, neighbours + length[:, Part.FORMATION], length[:, Part.DETOUR] + length[:, Part.SAFETY]], axis=1
    )
    total = shares.sum(axis=1, keepdims=True)
    return np.divide(shares, total, out=np.zeros_like(shares), where=total > 0.0)


def _finite(vectors: Floats) -> Floats:
    """Zero for what is not a number, as the filter gives a robot whose data are none."""
    return np.nan_to_num(vectors, nan=0.0, posinf=0.0, neginf=0.0)
