"""Robots of a disarmed team may be carried, or shown by a video; one that has not stood since it was told to is not."""

import numpy as np

from higvf_console.core.events import Severity
from higvf_console.core.team import Poses, RobotLink
from higvf_console.team.state import Arming, TeamReport, TeamState, opened
from higvf_console.team.supervision import supervised
from higvf_console.team.tracking import Rules

RULES = Rules(speed_limit=0.12, look_ahead=0.0, body_radius=0.04)


def moving(team: TeamState, seconds: float) -> tuple[TeamState, list[str]]:
    """The team after robot 1 has been seen to move, and the alarms."""
    alarms: list[str] = []
    begun = team.now
    for now in np.arange(begun + 0.05, begun + seconds, 0.05):
        poses = Poses(np.array([[0.1 * now, 1.0]]), np.zeros(1), np.array([now]))
        team, told = supervised(team, TeamReport(now, poses, (RobotLink(),)), RULES)
        alarms += [text for severity, text, _ in told if severity is Severity.ALARM]
    return team, alarms


def test_a_robot_that_nobody_has_told_to_drive_may_be_carried() -> None:
    team, alarms = moving(opened(1), 5.0)
    assert not alarms and not team.disobedient.any()
    assert np.isfinite(team.track.position).all()


def test_a_robot_that_drives_on_when_the_team_is_disarmed_is_told() -> None:
    team, _ = moving(opened(1)._replace(arming=Arming.ARMED, told_at=np.array([np.inf])), 1.0)
    team = team._replace(arming=Arming.DISARMED, told_at=np.array([team.now]))
    team, alarms = moving(team, 2.0)
    assert alarms == ["Robot 1 drives on, though it was told to stand."] and team.disobedient.all()
