"""The pure step of a team: from its state and a report to the next state, and what the operator must read.

Nothing drives before the team is armed, see `arming`. A robot whose pose is stale stands and counts as an obstacle that
grows as fast as the robot may drive. A robot that is lost, or a broken link, disarms the team, and nothing resumes by
itself.
"""

import math
from collections.abc import Iterable

import numpy as np

from higvf_console.core.arrays import Floats
from higvf_console.core.events import Severity
from higvf_console.core.state import Motion
from higvf_console.core.team import Drive, standing
from higvf_console.sim.unicycle import drive as unicycle
from higvf_console.team.arming import MOVE_S, arming_after
from higvf_console.team.state import Arming, TeamReport, TeamState, Told
from higvf_console.team.tracking import PoseFault, Rules, follow, predicted, remembered

OBEYS_WITHIN = 0.8  # after it was told to stand, a robot that does not is disobedient [s]
_CHECK_TURN = 0.5  # share of the turn rate at full speed
_CHECK_SPEED = 0.25  # share of the speed limit, of robots without a heading
_LATENCY_FADES = 5.0  # [s]


def supervised(state: TeamState, report: TeamReport, rules: Rules) -> tuple[TeamState, list[Told]]:
    """The state after a report; and what to tell: severity, sentence, robot (index from 0; None = the team)."""
    carried = state.arming is Arming.DISARMED
    track, refused = follow(state.track, report.poses, report.now, state.sent, state.latency, rules, carried=carried)
    stale = track.age(report.now) > rules.stale_after
    unseen_at = np.where(stale, report.now, state.unseen_at)  # nobody can see then whether a robot obeys
    obeys_late = report.now - np.maximum(state.told_at, unseen_at) > OBEYS_WITHIN + state.latency
    stands = track.stands()
    stood = (state.stood | stands) & ~np.isinf(state.told_at)
    disobedient = obeys_late & track.seen & ~stale & ~stands & ~(stood & carried)
    faults = np.zeros(len(stale), np.bool_)
    faults[[robot for robot, _ in refused]] = True
    now = state._replace(
        now=report.now, track=track, links=report.links, latency=_latency(state, report), stale=stale, stood=stood,
        unseen_at=unseen_at, disobedient=disobedient, failure=report.failure,
        faults=faults | (state.faults & (track.looked_at <= state.track.looked_at)),
    )  # fmt: skip
    told = [*_about_robots(state, now, refused)]
    now, more = arming_after(now, rules)
    return now, told + more


def _latency(state: TeamState, report: TeamReport) -> float:
    """From sending the newest command that was confirmed just now until then; less after a while without any."""
    at = {one.command.number: one.at for one in state.sent}
    fresh = [
        report.now - at[link.acknowledged]
        for link, before in zip(report.links, state.links, strict=True)
        if link.acknowledged > before.acknowledged and link.acknowledged in at
    ]
    faded = state.latency * math.exp(-max(report.now - state.now, 0.0) / _LATENCY_FADES)
    return max([faded, *fresh])


def _about_robots(before: TeamState, now: TeamState, refused: Iterable[tuple[int, PoseFault]]) -> list[Told]:
    told: list[Told] = []
    for robot, fault in refused:
        if not before.faults[robot]:
            told.append((Severity.WARNING, f"A pose of robot {robot + 1} is {fault.value}: refused.", robot))
    for robot in range(len(now.stale)):
        name, drives = f"Robot {robot + 1}", before.arming is not Arming.DISARMED
        if now.stale[robot] and not before.stale[robot] and drives:
            told.append((Severity.WARNING, f"{name} has not been seen for {_age(now, robot)}: it must stand.", robot))
        if before.stale[robot] and not now.stale[robot] and drives:
            told.append((Severity.INFO, f"{name} is seen again.", robot))
        if now.disobedient[robot] and not before.disobedient[robot]:
            told.append((Severity.ALARM, f"{name} drives on, though it was told to stand.", robot))
        if before.links[robot].connected and not now.links[robot].connected:
            detail = f": {now.links[robot].detail}" if now.links[robot].detail else ""
            told.append((Severity.WARNING, f"The link to robot {robot + 1} is broken{detail}.", robot))
    return told


def _age(state: TeamState, robot: int) -> str:
    age = float(state.track.age(state.now)[robot])
    return f"{age:.2f} s" if math.isfinite(age) else "all the time"


def with_robot_stopped(state: TeamState, robot: int, *, stopped: bool) -> TeamState:
    """One robot stands until it is released."""
    changed = state.stopped.copy()
    changed[robot] = stopped
    return state._replace(stopped=changed)


def commanded(
    state: TeamState, motion: Motion, rules: Rules, period: float, *, drives: bool
) -> tuple[TeamState, Drive | None]:
    """What the robots are told now; None = nothing, so that silence stops them.

    Args:
        state: of the team.
        motion: its `velocity` is what the safety filter answered, for the headings before the control period.
        rules: whether robots have a heading.
        period: control period [s].
        drives: whether the clock of the run goes on and no STOP is active.
    """
    robots = len(state.stopped)
    number = state.number + 1
    command = standing(robots, number)
    if state.arming is Arming.CHECKING:
        if state.now - state.since > MOVE_S:
            return state, None
        command = _check_motion(robots, number, rules)
    elif state.armed and drives:
        _, heading = predicted(state.track, state.sent, state.latency, state.now + state.latency, rules)
        command = _driven(number, motion.velocity * ~state.held[:, None], heading, rules, period)
    moving = (np.abs(command.velocity).sum(axis=1) + np.abs(command.forward) + np.abs(command.turn)) > 0.0
    told_at = np.where(moving, np.inf, np.where(np.isinf(state.told_at), state.now, state.told_at))
    sent = remembered(state.sent, command, state.now)
    return state._replace(number=number, sent=sent, told_at=told_at), command


def _check_motion(robots: int, number: int, rules: Rules) -> Drive:
    """Robots with a heading turn on the spot; others move a little, along x."""
    still = np.zeros(robots)
    if rules.look_ahead > 0.0:
        turn = np.full(robots, _CHECK_TURN * rules.speed_limit / rules.look_ahead)
        return Drive(number, np.zeros((robots, 2)), still, turn)
    velocity = np.zeros((robots, 2))
    velocity[:, 0] = _CHECK_SPEED * rules.speed_limit
    return Drive(number, velocity, still, still)


def _driven(number: int, velocity: Floats, heading: Floats, rules: Rules, period: float) -> Drive:
    forward, turn = np.zeros(len(velocity)), np.zeros(len(velocity))
    if rules.look_ahead > 0.0:
        for i, (ux, uy) in enumerate(velocity):
            forward[i], turn[i] = unicycle(ux, uy, heading[i], rules.look_ahead, period)
    return Drive(number, velocity, forward, turn)
