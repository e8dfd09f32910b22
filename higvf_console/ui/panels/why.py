"""Why a robot moves as it does: its velocity in parts, who had a say, what it sees, and whether the method holds."""

from typing import TYPE_CHECKING, Any

import numpy as np
import viser

from higvf_console.arrays import ints
from higvf_console.session.explain import explain
from higvf_console.session.sight import sights
from higvf_console.session.tight_rows import tight_rows
from higvf_console.sim.certificates import certificates
from higvf_console.ui.panels.callbacks import mirror, number_in, one_of, reaction, truth
from higvf_console.ui.panels.html import block
from higvf_console.ui.panels.shares import ShareHistory, bands_svg, legend_html
from higvf_console.ui.panels.why_tables import certificate_html, parts_html, rows_html, sight_html
from higvf_console.ui.scene import View

if TYPE_CHECKING:
    from higvf_console.session.session import Session, Snapshot

MOST_LISTED = 50  # robots; one of a larger team is chosen by number
MOST_SHARED = 200  # robots; a larger team has no chart of its own
CERTIFIED_EVERY = 5  # updates; lambda_2 of a larger team takes longer, and is renewed ten times less often
_STEERED = "The one you steer"
_WHICH = "Whose velocity is explained; in the arena, click the robot that you steer once more"


class WhyPanel:
    """One robot's reasons; writes a `View`, so that the arena shows the same robot."""

    def __init__(self, gui: viser.GuiApi, session: "Session", view: View) -> None:
        """Builds the choices and explains the present moment once, which loads all that later moments need."""
        self._setup, self._view = session.setup, view
        self._robots = len(session.setup.start.motion.position)
        self._history, self._updates = ShareHistory(), 0
        self._picker = self._make_picker(gui)
        self._arrows = self._make_switch(gui, "reasons", "Arrows in the arena", "The parts of the velocity, in colour")
        self._sight = self._make_switch(
            gui, "sights", "Lines of sight", "To the fires that it sees; dashed where an obstacle is in the way"
        )
        self._parts, self._say, self._seen, self._certified = (gui.add_html("") for _ in range(4))
        self.update(session.snapshot)

    def _make_picker(self, gui: viser.GuiApi) -> viser.GuiDropdownHandle[str] | viser.GuiNumberHandle[int]:
        if self._robots <= MOST_LISTED:
            self._names: dict[str, Any] = {_STEERED: None} | {f"Robot {k + 1}": k for k in range(self._robots)}
            listed = gui.add_dropdown("Explain", tuple(self._names), hint=_WHICH)
            listed.on_update(reaction(lambda name: self._choose(one_of(name, self._names))))
            return listed
        numbered = gui.add_number("Explain", 0, min=0, max=self._robots, step=1, hint=f"{_WHICH}; 0 = that one")
        numbered.on_update(reaction(lambda value: self._choose(int(number_in(value, 0, self._robots)) - 1)))
        return numbered

    def _make_switch(self, gui: viser.GuiApi, name: str, label: str, hint: str) -> viser.GuiCheckboxHandle:
        switch = gui.add_checkbox(label, bool(getattr(self._view, name)), hint=hint)
        switch.on_update(reaction(lambda value: setattr(self._view, name, truth(value))))
        return switch

    def _choose(self, robot: int | None) -> None:
        self._view.explained = None if robot is None or robot < 0 else robot

    def update(self, snapshot: "Snapshot") -> None:
        """Explains the last control period of a snapshot."""
        mirror(self._arrows, self._view.reasons)
        mirror(self._sight, self._view.sights)
        robot = self._view.robot(snapshot)
        self._explain(snapshot, robot)
        self._seen.content = block(sight_html(sights(robot, snapshot.last, self._setup), snapshot, robot, self._setup))
        if self._updates % (CERTIFIED_EVERY if self._robots <= MOST_SHARED else 10 * CERTIFIED_EVERY) == 0:
            found = certificates(self._setup, snapshot.state, snapshot.trace, snapshot.worst)
            self._certified.content = block(certificate_html(found))
        self._updates += 1

    def _explain(self, snapshot: "Snapshot", robot: int) -> None:
        team = np.arange(self._robots) if self._robots <= MOST_SHARED else ints([robot])
        why = explain(snapshot.last, self._setup.gains, team)
        row = robot if self._robots <= MOST_SHARED else 0
        velocity = snapshot.last.after.velocity[robot]
        tight = tight_rows(robot, snapshot.last, self._setup)
        self._parts.content = block(parts_html(robot, why.parts[row], velocity) + rows_html(tight))
        self._history.add(snapshot.time, robot, why.say[row], why.say.mean(axis=0))
        time, own, shared = self._history.curves()
        charts = [bands_svg(f"robot {robot + 1}", time, own)]
        if 1 < self._robots <= MOST_SHARED:
            charts.append(bands_svg("team", time, shared))
        self._say.content = block(f'<div class="title">Who has a say</div>{"".join(charts)}<div>{legend_html()}</div>')

    def cleanup(self) -> None:
        """Removes everything."""
        for widget in (
            self._picker, self._arrows, self._sight, self._parts, self._say, self._seen, self._certified,
        ):  # fmt: skip
            widget.remove()
