"""`--team NAME=ADDRESS:option=value,option=value` and `--poses` likewise: the robots that a run drives."""

import re
from collections.abc import Callable
from typing import Annotated as A  # noqa: N817 (a table needs narrow columns)
from typing import NamedTuple

from higvf_console.control.parameters import controlled
from higvf_console.core.errors import InputError
from higvf_console.core.quantity import Quantity as Q  # noqa: N817
from higvf_console.core.team import TeamSpec, options_of
from higvf_console.runtime.inputs import options_behind, split_source
from higvf_console.scenario.scenario import Scenario
from higvf_console.scenario.sections import FilterKind
from higvf_console.sim.unicycle import body_centres
from higvf_console.team.driver import TeamDriver
from higvf_console.team.opening import open_poses, open_team, team_names
from higvf_console.team.simulated import SimulatedTeam
from higvf_console.team.tracking import Rules
from higvf_console.world.setup import Setup

_NAME = re.compile(r"[A-Za-z][\w-]*")


class RuleOptions(NamedTuple):
    """Options of every team, and of every source of poses."""

    error_m: A[float, Q("m", 0.0, 10.0, "", "Largest error of a measured position.")] = 0.0
    stale_s: A[float, Q("s", 0.02, 10.0, "", "Age of a pose from which on its robot must stand.")] = 0.25
    lost_s: A[float, Q("s", 0.05, 60.0, "", "Age from which on the team is disarmed.")] = 1.0


def team_spec(text: str, flag: str, scenario: Scenario, setup: Setup) -> tuple[TeamSpec, RuleOptions]:
    """What a team, or a source of poses, is opened with; and what holds for all. Options of the scenario come first.

    Args:
        text: `mqtt=mqtt://127.0.0.1:1883:prefix=lab`, or just `simulated`.
        flag: `--team` or `--poses`, for errors.
        scenario: what is run.
        setup: its world and start.

    Raises:
        InputError: it is not of that form, or an option cannot be used.
    """
    name, _, rest = text.partition("=")
    if not _NAME.fullmatch(name):
        raise InputError(f"{flag} {text}: give NAME, NAME=ADDRESS or NAME=ADDRESS:option=value,option=value")
    address, options = split_source(rest)
    given = {**scenario.teams.get(name, {}), **options_behind(options, f"{flag} {text}")}
    motion, params = setup.start.motion, setup.params
    look_ahead = params.robots.look_ahead
    spec = TeamSpec(
        name,
        address,
        {key: value for key, value in given.items() if key not in RuleOptions._fields},
        len(motion.position),
        scenario.arena,
        body_centres(motion.position, motion.heading, look_ahead),
        motion.heading,
        look_ahead,
        controlled(params).safety.speed_limit,
        params.scale.body_radius,
        params.safety.control_period,
    )
    own = {key: value for key, value in given.items() if key in RuleOptions._fields}
    if name == SimulatedTeam.name and "noise_m" in given:
        own = {"error_m": given["noise_m"], **own}
    rules = options_of(TeamSpec(name, address, own), RuleOptions)
    if rules.stale_s >= rules.lost_s:
        raise InputError(f"{flag} {text}: stale_s {rules.stale_s:g} must be less than lost_s {rules.lost_s:g}")
    return spec, rules


def rules_of(spec: TeamSpec, options: RuleOptions) -> Rules:
    """What the robots of a team can do, and what their poses are worth."""
    return Rules(spec.speed_limit, spec.look_ahead, spec.body_radius, options.error_m, options.stale_s, options.lost_s)


def open_driver(
    team: str, poses: str | None, scenario: Scenario, setup: Setup, clock: Callable[[], float] | None
) -> TeamDriver:
    """Opens a team, and what tells its poses.

    Args:
        team: value of `--team`.
        poses: value of `--poses`; None = the team knows them.
        scenario: what is run.
        setup: its world and start.
        clock: time [s] that never goes back; None = that of the control periods, for a team that is simulated.

    Raises:
        InputError: one of them cannot be used, or the scenario cannot be driven.
    """
    if scenario.filter is not FilterKind.DISTRIBUTED:
        raise InputError(f"--team {team}: the scenario has filter '{scenario.filter}'; a team needs 'distributed'")
    if setup.params.robots.position_noise > 0.0:
        raise InputError(
            f"--team {team}: the scenario has robots.position_noise {setup.params.robots.position_noise:g} m, which is "
            "simulated; remove it, and give the error of measured poses as error_m"
        )
    spec, options = team_spec(team, "--team", scenario, setup)
    source_spec = None
    if poses is not None:
        source_spec, options = team_spec(poses, "--poses", scenario, setup)
    rules = rules_of(spec, options)
    if clock is None and spec.name in team_names() and spec.name != SimulatedTeam.name:
        raise InputError(f"--team {team}: drives in real time; only '{SimulatedTeam.name}' drives in a headless run")
    opened = open_team(spec)
    try:
        source = None if source_spec is None else open_poses(source_spec)
    except InputError:
        opened.close()
        raise
    return TeamDriver(opened, spec.robots, rules, clock, spec.period, source)
