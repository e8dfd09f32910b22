"""What the engine must know of a real team: where it is, who counts as an obstacle, how uncertain it all is."""

import math

import numpy as np

from higvf_console.control.guidance.obstacles import world_at
from higvf_console.control.parameters import Parameters, packed
from higvf_console.core.arrays import Floats
from higvf_console.core.state import CAPSULE, Motion, SimState, Trace, World
from higvf_console.sim.guard import Guard, guarded
from higvf_console.sim.metrics import clearances
from higvf_console.sim.simulation import advance
from higvf_console.sim.unicycle import body_centres
from higvf_console.team.state import TeamState
from higvf_console.team.tracking import Rules, predicted

_STEPS = 50.0  # of the budget in a body's radius: it grows in steps, so that the parameters are packed rarely


def placed(motion: Motion, team: TeamState, rules: Rules) -> Motion:
    """The motion with the robots where they are by the time that a command reaches them.

    Args:
        motion: of the engine; robots that were never seen stay where it has them.
        team: with the believed poses.
        rules: look-ahead distance of the controlled points.
    """
    centre, heading = predicted(team.track, team.sent, team.latency, team.now + team.latency, rules)
    ahead = centre + rules.look_ahead * np.column_stack((np.cos(heading), np.sin(heading)))
    seen = team.track.seen
    return motion._replace(
        position=np.where(seen[:, None], ahead, motion.position),
        heading=np.where(seen, heading, motion.heading),
    )


def budgets(team: TeamState, rules: Rules) -> Floats:
    """By how much (N,) the clearance of each robot grows [m].

    error + drift x (age of the pose + latency): the error of a measurement, and how far poses may leave the prediction
    until the command acts, as measured lately. A robot that stands by command is no farther off than its measurement.
    """
    horizon = np.minimum(team.track.age(team.now), rules.stale_after) + team.latency
    return np.where(team.track.seen, rules.error + team.track.drift * horizon, 0.0)


def budget(team: TeamState, rules: Rules) -> float:
    """The largest budget of robots that may drive, rounded up [m]."""
    largest = float(np.max(budgets(team, rules), initial=0.0, where=~team.held))
    step = rules.body_radius / _STEPS
    return min(math.ceil(largest / step - 1e-9) * step, rules.body_radius)


def guard_of(team: TeamState, params: Parameters, rules: Rules) -> Guard:
    """What the safety filter must know of a team: its budget, and the robots that stand while others drive.

    Such a robot is an obstacle. One whose place is not known any more grows at its speed limit, for it may drive until
    it hears that it must not.
    """
    held = team.held & team.track.seen
    if not held.any():
        return Guard(budget(team, rules))
    safety = params.safety
    body = max(safety.robot_clearance - safety.obstacle_clearance, 0.0)
    age = np.where(team.stale | team.disobedient, team.track.age(team.now) + safety.control_period, 0.0)
    age = np.where(team.disobedient, np.maximum(age, rules.stale_after), age)
    rows = np.zeros((int(held.sum()), CAPSULE))
    rows[:, 0:2] = rows[:, 2:4] = team.track.position[held]
    rows[:, 4] = body + rules.error + rules.speed_limit * np.minimum(age, rules.lost_after)[held]
    return Guard(budget(team, rules), held.nonzero()[0], rows)


def advanced(
    state: SimState, team: TeamState, world: World, params: Parameters, rules: Rules
) -> tuple[SimState, SimState, Trace, Guard]:
    """One control period of a team that is not integrated here.

    Args:
        state: of the run.
        team: as it was last heard of.
        world: of the run.
        params: likewise.
        rules: what the robots can do.

    Returns:
        The state with the robots where they are; the state one control period later, in which robots that must not
        drive have not moved; why; and what the filter knew of the team. Clearances of the trace are those of the bodies
        in `world`, without the budget.
    """
    before = state._replace(motion=placed(state.motion, team, rules))
    halted = before if team.armed else before._replace(intent=before.intent._replace(stopped=True))
    guard = guard_of(team, params, rules)
    after, trace = advance(halted, guarded(world, guard), params, guard.budget)
    held = team.held
    motion = after.motion
    if held.any():
        motion = motion._replace(
            position=np.where(held[:, None], before.motion.position, motion.position),
            heading=np.where(held, before.motion.heading, motion.heading),
            velocity=np.where(held[:, None], 0.0, motion.velocity),
        )
        look_ahead, period = params.robots.look_ahead, params.safety.control_period
        clearance, barrier = clearances(
            body_centres(motion.position, motion.heading, look_ahead), motion.fire_radius, motion.fire_burning,
            world_at(world, motion.tick, period), packed(params)[0].body,
        )  # fmt: skip
        trace = trace._replace(clearance=clearance, barrier=barrier, infeasible=trace.infeasible & ~held)
    return before, after._replace(motion=motion, intent=state.intent), trace, guard
