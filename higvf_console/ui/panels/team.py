"""A team that is not integrated here: armed in two steps, each robot with its link, one robot stopped, the latency."""

from collections import deque
from typing import TYPE_CHECKING

import numpy as np
import viser

from higvf_console.core.commands import Arm, AskArm, Disarm, ReleaseRobot, StopRobot
from higvf_console.core.interface import PointerSink
from higvf_console.team.state import Arming, TeamState
from higvf_console.ui.theme import CSS
from higvf_console.ui.widgets.callbacks import reaction
from higvf_console.ui.widgets.chart import Curve, chart_svg
from higvf_console.ui.widgets.html import block
from higvf_console.ui.widgets.picker import RobotPicker
from higvf_console.ui.widgets.team_tables import arming_html, lamps_html, robots_html

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

MOST_DIGITS = 3  # of a measured speed
SPAN = 60.0  # of the plots [s]
_CHECK = "Each robot moves a little, then hears nothing: one that does not stand by itself is found out"
_ONE = "It stands until it is released, whatever the team does; the others keep clear of it"


class TeamPanel:
    """Tables that are renewed, two buttons that arm and disarm, and one that stops a single robot."""

    def __init__(self, gui: viser.GuiApi, robots: int, sink: PointerSink) -> None:
        """Builds the widgets.

        Args:
            gui: where.
            robots: of the team.
            sink: takes the commands.
        """
        self._sink, self._robots = sink, robots
        self._arming, self._robot, self._stopped = Arming.DISARMED, 0, np.zeros(robots, np.bool_)
        self._history = deque[tuple[float, float, float]]()
        self._state = gui.add_html("")
        self._arm = gui.add_button("Check the team", icon=viser.Icon.CHECK, color="gray", hint=_CHECK)
        self._arm.on_click(reaction(lambda _: self._next_step()))
        self._disarm = gui.add_button("Disarm", icon=viser.Icon.LOCK, color="gray", hint="No robot drives any more")
        self._disarm.on_click(reaction(lambda _: sink.push(Disarm())))
        self._lamps = gui.add_html("")
        self._table = gui.add_html("")
        self._picker = RobotPicker(gui, "Robot", robots, self._choose, hint="Robot that is stopped or released")
        self._one = gui.add_button("Stop this robot", icon=viser.Icon.HAND_STOP, color="gray", hint=_ONE)
        self._one.on_click(reaction(lambda _: self._stop_one()))
        self._chart = gui.add_html("")

    def _next_step(self) -> None:
        self._sink.push(Arm() if self._arming is Arming.CHECKED else AskArm())

    def _choose(self, robot: int | None) -> None:
        self._robot = robot or 0

    def _stop_one(self) -> None:
        stopped = bool(self._stopped[self._robot])
        self._sink.push(ReleaseRobot(self._robot) if stopped else StopRobot(self._robot))

    def update(self, snapshot: "Snapshot") -> None:
        """Shows a snapshot."""
        team, rules = snapshot.team, snapshot.rules
        if team is None or rules is None:
            return
        self._arming, self._stopped = team.arming, team.stopped
        velocity = snapshot.state.motion.velocity * (np.isinf(team.told_at) & team.armed)[:, None]
        digits = min(snapshot.setup.params.scale.speed_decimals, MOST_DIGITS)
        self._state.content = block(arming_html(team))
        self._lamps.content = block(
            f'<div class="title">Order to stand</div><div class="lamps">{lamps_html(team)}</div>'
        )
        self._table.content = block(robots_html(team, rules, np.hypot(*velocity.T), digits))
        self._arm.label = "Arm: let the team drive" if team.arming is Arming.CHECKED else "Check the team"
        self._arm.color = "yellow" if team.arming is Arming.CHECKED else "gray"
        self._arm.disabled = team.arming in (Arming.CHECKING, Arming.ARMED)
        self._disarm.disabled = team.arming is Arming.DISARMED
        self._picker.show(self._robot, self._robots)
        self._one.label = "Release this robot" if self._stopped[self._robot] else "Stop this robot"
        self._plot(team)

    def _plot(self, team: TeamState) -> None:
        age = team.track.age(team.now)
        oldest = float(age.max(initial=0.0, where=np.isfinite(age)))
        self._history.append((team.now, 1e3 * team.latency, 1e3 * oldest))
        while self._history[0][0] < team.now - SPAN:
            self._history.popleft()
        time, latency, oldest_pose = np.array(self._history).T
        curves = [
            Curve("latency", time - time[0], latency, CSS.operator),
            Curve("oldest pose", time - time[0], oldest_pose, CSS.robot, dashed=True),
        ]
        self._chart.content = block(f'<div class="title">Link</div>{chart_svg(curves, "s", "ms")}')
