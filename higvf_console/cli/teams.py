"""`higvf teams` and `higvf check-team`: which robots could be driven, and whether their adapter keeps the contract."""
# ruff: noqa: PLC0415 (as in `main`)

import argparse
import json
from collections.abc import Sequence
from typing import TYPE_CHECKING

from higvf_console.core.errors import HigvfError

if TYPE_CHECKING:
    from higvf_console.team.check import Finding
    from higvf_console.team.listing import Installed, OptionDescription

LISTEN_S = 2.0  # to a network [s]
_VERDICTS = {True: "ok", False: "FAILED", None: "not tried"}


def teams(given: argparse.Namespace) -> int:
    """Lists what is installed, or what a network shows."""
    if given.network is not None:
        return _network(given)
    from higvf_console.runtime.teams import RuleOptions
    from higvf_console.team.listing import installed_pose_sources, installed_teams, options_described

    found = {"teams": installed_teams(), "pose_sources": installed_pose_sources()}
    common = options_described(RuleOptions)
    if given.json:
        plain = {group: [_plain(one) for one in members] for group, members in found.items()}
        print(json.dumps({**plain, "options_of_all": [one._asdict() for one in common]}, indent=2))
        return 0
    for title, members in (("Teams", found["teams"]), ("Sources of poses", found["pose_sources"])):
        print(f"{title}:")
        for one in members:
            print(f"  {one.name}  ({one.package})" + (f"  {one.problem}" if one.problem else ""))
            _print_options(one.options or ())
        if not members:
            print("  none")
    print("Options of all:")
    _print_options(common)
    return 0


def check_team(given: argparse.Namespace) -> int:
    """Holds a team to its contract; 1 where it breaks a rule."""
    from higvf_console.runtime.teams import checked_team

    findings = checked_team(given.team, given.poses, given.scenario, drive=given.drive)
    if given.json:
        print(json.dumps([finding._asdict() for finding in findings], indent=2))
    else:
        _print_findings(findings)
    return 1 if any(finding.kept is False for finding in findings) else 0


def _network(given: argparse.Namespace) -> int:
    from higvf_console.runtime.teams import heard_by

    heard = heard_by(given.network, given.scenario, LISTEN_S)
    if given.json:
        print(json.dumps([robot._asdict() for robot in heard], indent=2))
        return 0
    if not heard:
        raise HigvfError(f"{given.network}: no robot was heard in {LISTEN_S:g} s")
    width = max(len(robot.name) for robot in heard)
    for robot in heard:
        print(f"{robot.name:{width}}  {robot.detail}")
    return 0


def _print_findings(findings: "Sequence[Finding]") -> None:
    width = max(len(finding.rule) for finding in findings)
    for finding in findings:
        print(f"{_VERDICTS[finding.kept]:9}  {finding.rule:{width}}  {finding.detail}")


def _print_options(options: "Sequence[OptionDescription]") -> None:
    for one in options:
        default = f"default {one.default}" if one.default else "no default"
        print(f"    {one.name:10} {one.choices}, {default}: {one.text}")


def _plain(one: "Installed") -> dict[str, object]:
    options = None if one.options is None else [option._asdict() for option in one.options]
    return {**one._asdict(), "options": options}
