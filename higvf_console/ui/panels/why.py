"""Why a robot moves as it does: its velocity in parts, authority shares, what it sees, and whether the method holds."""

from typing import TYPE_CHECKING

import numpy as np
import viser

from higvf_console.analysis.active_constraints import active_constraints
from higvf_console.analysis.explain import explain
from higvf_console.analysis.sight import sights
from higvf_console.core.arrays import ints
from higvf_console.sim.certificates import certificates
from higvf_console.ui.ui_state import UiStore, robot_explained
from higvf_console.ui.widgets.authority import AuthorityHistory, bands_svg, legend_html
from higvf_console.ui.widgets.callbacks import mirror, reaction, truth
from higvf_console.ui.widgets.html import block
from higvf_console.ui.widgets.picker import RobotPicker
from higvf_console.ui.widgets.why_tables import certificate_html, guard_html, parts_html, rows_html, sight_html

if TYPE_CHECKING:
    from higvf_console.runtime.session import Session
    from higvf_console.runtime.snapshot import Snapshot

MOST_SHARED = 200  # robots; a larger team has no chart of its own
CERTIFIED_EVERY = 5  # updates; lambda_2 of a larger team takes longer, and is renewed ten times less often
_STEERED = "Influenced robot"
_WHICH = "Robot whose velocity is explained. In the arena: click the influenced robot again"


class WhyPanel:
    """One robot's reasons; writes the `UiState`, so that the arena shows the same robot."""

    def __init__(self, gui: viser.GuiApi, session: "Session", ui: UiStore) -> None:
        """Builds the choices and explains the present moment once, which loads all that later moments need."""
        self._ui = ui
        self._robots = len(session.setup.start.motion.position)
        self._history, self._updates = AuthorityHistory(), 0
        self._picker = RobotPicker(gui, "Explain", self._robots, self._choose, hint=_WHICH, nobody=_STEERED)
        self._arrows = self._make_switch(gui, "reasons", "Arrows in the arena", "The parts of the velocity, in colour")
        self._sight = self._make_switch(
            gui, "sights", "Lines of sight", "To the fires that it sees; dashed where an obstacle is in the way"
        )
        self._parts, self._authority, self._seen, self._certified = (gui.add_html("") for _ in range(4))
        self.update(session.snapshot)

    def _make_switch(self, gui: viser.GuiApi, name: str, label: str, hint: str) -> viser.GuiCheckboxHandle:
        switch = gui.add_checkbox(label, bool(getattr(self._ui.state, name)), hint=hint)
        switch.on_update(reaction(lambda value: self._ui.update(**{name: truth(value)})))
        return switch

    def _choose(self, robot: int | None) -> None:
        self._ui.update(explained=robot)

    def update(self, snapshot: "Snapshot") -> None:
        """Explains the last control period of a snapshot."""
        self._robots = len(snapshot.state.motion.position)
        self._picker.show(self._ui.state.explained, self._robots)
        mirror(self._arrows, self._ui.state.reasons)
        mirror(self._sight, self._ui.state.sights)
        robot = robot_explained(self._ui.state, snapshot)
        self._explain(snapshot, robot)
        self._seen.content = block(
            sight_html(sights(robot, snapshot.last, snapshot.setup), snapshot, robot, snapshot.setup)
        )
        if self._updates % (CERTIFIED_EVERY if self._robots <= MOST_SHARED else 10 * CERTIFIED_EVERY) == 0:
            world, params, start = snapshot.setup.world, snapshot.setup.params, snapshot.setup.start
            found = certificates(world, params, start, snapshot.state, snapshot.trace, snapshot.worst)
            self._certified.content = block(certificate_html(found))
        self._updates += 1

    def _explain(self, snapshot: "Snapshot", robot: int) -> None:
        team = np.arange(self._robots) if self._robots <= MOST_SHARED else ints([robot])
        why = explain(snapshot.last, snapshot.setup.params, team)
        row = robot if self._robots <= MOST_SHARED else 0
        velocity = snapshot.last.after.velocity[robot]
        tight = active_constraints(robot, snapshot.last, snapshot.setup)
        digits = snapshot.setup.params.scale.speed_decimals
        self._parts.content = block(
            parts_html(robot, why.parts[row], velocity, digits)
            + rows_html(tight)
            + guard_html(snapshot.last.guard, robot)
        )
        self._history.add(snapshot.time, robot, why.authority[row], why.authority.mean(axis=0))
        time, own, shared = self._history.curves()
        charts = [bands_svg(f"robot {robot + 1}", time, own)]
        if 1 < self._robots <= MOST_SHARED:
            charts.append(bands_svg("team", time, shared))
        self._authority.content = block(
            f'<div class="title">Authority shares</div>{"".join(charts)}<div>{legend_html()}</div>'
        )
