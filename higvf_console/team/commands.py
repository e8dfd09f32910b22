"""What the operator's commands about a team mean: armed in two steps, disarmed, robots stopped one by one."""

from higvf_console.core.commands import Arm, AskArm, Disarm, ReleaseRobot, StopRobot, TeamCommand
from higvf_console.core.errors import ScenarioError
from higvf_console.team.arming import armed, asked_to_arm, disarmed
from higvf_console.team.state import Arming, TeamState
from higvf_console.team.supervision import with_robot_stopped
from higvf_console.team.tracking import Rules

NO_TEAM = "this run has no team that could be armed or stopped: its robots are simulated here; start it with --team"


def commanded_by_hand(team: TeamState, command: TeamCommand, rules: Rules) -> tuple[TeamState, str]:
    """The team after a command, and a sentence that reports it.

    Raises:
        ScenarioError: the command is refused; nothing has changed.
    """
    match command:
        case AskArm():
            team, refusal = asked_to_arm(team, rules)
            text = "Each robot moves a little now, then hears nothing: it must stand by itself."
        case Arm():
            team, refusal = armed(team)
            text = "The team is armed: it may drive."
        case Disarm():
            refusal = "the team is disarmed already" if team.arming is Arming.DISARMED else ""
            team, text = disarmed(team), "The team is disarmed: nobody drives."
        case StopRobot(robot=robot) | ReleaseRobot(robot=robot):
            robots, stopped = len(team.stopped), isinstance(command, StopRobot)
            if not 0 <= robot < robots:
                raise ScenarioError(f"there is no robot {robot + 1}: the team has robots 1 to {robots}")
            same = bool(team.stopped[robot]) is stopped
            refusal = (
                f"robot {robot + 1} is {'' if stopped else 'not '}stopped{' already' if stopped else ''}"
                if same
                else ""
            )
            team = with_robot_stopped(team, robot, stopped=stopped)
            if stopped and team.arming is Arming.CHECKING:  # which would move it
                team = disarmed(team)
            text = f"Robot {robot + 1} {'stands until it is released' if stopped else 'may drive again'}."
    if refusal:
        raise ScenarioError(refusal)
    return team, text
