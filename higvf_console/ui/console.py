"""The console: what the operator sees and touches, between a session and the browser.

    session thread    ->  session.snapshot  ->  view thread: scene, panels  ->  viser  ->  pages
    session.pointer  <-  roles  <-  commands <-  viser's event loop: keys, pointer, widgets

The view thread alone changes what is shown, and never the state; callbacks push commands and return. So neither a slow
browser nor a slow panel delays the robots.
"""

import logging
import threading
import time
from collections.abc import Callable, Coroutine
from functools import partial
from typing import TYPE_CHECKING

import viser

from higvf_console.core.events import Event, Severity
from higvf_console.core.state import NO_PATH, NOBODY, Path, PathKind
from higvf_console.operator.path_commands import in_hand
from higvf_console.runtime.background.previewer import Choice, Previewer
from higvf_console.runtime.history import History
from higvf_console.ui import theme
from higvf_console.ui.cards.run_card import RunCard
from higvf_console.ui.frame_pace import FramePace
from higvf_console.ui.interaction import camera, hints, keys, pointer, tools
from higvf_console.ui.interaction.arena import ArenaInteraction, PageActions
from higvf_console.ui.interaction.calibration import Calibration
from higvf_console.ui.page import page
from higvf_console.ui.page.roles import Roles
from higvf_console.ui.panel import Panel
from higvf_console.ui.panels.edit import EditPanel
from higvf_console.ui.panels.files import FilesPanel
from higvf_console.ui.panels.fires import FiresPanel
from higvf_console.ui.panels.glance import GlancePanel
from higvf_console.ui.panels.history import HistoryPanel
from higvf_console.ui.panels.inputs import InputsPanel
from higvf_console.ui.panels.log import LogPanel
from higvf_console.ui.panels.preview import PreviewPanel
from higvf_console.ui.panels.run import RunControls
from higvf_console.ui.panels.status import StatusStrip
from higvf_console.ui.panels.steer import SteerPanel
from higvf_console.ui.panels.team import TeamPanel
from higvf_console.ui.panels.tune import TunePanel
from higvf_console.ui.panels.view import ViewPanel
from higvf_console.ui.panels.why import WhyPanel
from higvf_console.ui.scene.scene import Scene
from higvf_console.ui.ui_state import Change, UiState, UiStore, add_alarms, begin_scenario, follow_path, keep_choice
from higvf_console.ui.widgets.html import style_html

if TYPE_CHECKING:
    from higvf_console.runtime.persistence.drafts import Drafts
    from higvf_console.runtime.session import Session
    from higvf_console.runtime.snapshot import Snapshot
    from higvf_console.scenario.scenario import Scenario
    from higvf_console.world.setup import Setup

# Between two frames, at least [s]: viser looks 60 times a second whether there is anything to send, and sends nothing
# while a frame is being shown. Frames without a gap between them would starve the pages.
REST = 1 / 50
FRAMES_PER_PANEL = 6  # panels are renewed five times a second, in turn, so that no frame waits for all of them

_log = logging.getLogger(__name__)


def add_commands(gui: viser.GuiApi, hand: ArenaInteraction, roles: Roles) -> None:
    """Offers what the keys do in the command palette (Ctrl+K) too; STOP to every page."""
    for binding in keys.KEYMAP:
        if binding.name in keys.NAMES:
            command = gui.add_command(binding.text, description=f"Key {binding.key}")
            command.on_trigger(_trigger(hand, binding.name))
            if binding.name == "stop":
                roles.allow(page.uuid_of(command))


def _trigger(hand: ArenaInteraction, name: str) -> Callable[[viser.CommandEvent], Coroutine[None, None, None]]:
    async def react(event: viser.CommandEvent) -> None:
        hand.key(event.client_id or 0, name)

    return react


def page_actions(server: viser.ViserServer) -> PageActions:
    """What the hand does in the pages of a server."""

    def open_tab(name: str, client_id: int) -> None:
        page.call(server, "tabs", "open", name, client_id)

    return PageActions(partial(tools.show, server), open_tab, partial(keys.note, server))


class Console:
    """Scene and panels of one session, on one viser server.

    Attributes:
        ui: what is chosen to be seen, drawn and edited.
    """

    def __init__(self, session: "Session", server: viser.ViserServer, drafts: "Drafts | None" = None) -> None:
        """Builds everything; nothing moves before `run` or `start`.

        Args:
            session: what is shown.
            server: whose pages show it.
            drafts: keeps the edited world; None = nothing is kept.
        """
        self._session, self._server, self._drafts = session, server, drafts
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None
        self.ui = UiStore(_begin(session.scenario)(UiState()))
        self.ui.subscribe(self._wake)
        self._path: Path = NO_PATH
        self._previewer = Previewer(session, self._choice)
        self._stopped: bool | None = None
        self._history: History | None = None
        self._scenario = session.scenario
        self._frames, self._robots, self._influenced = 0, 0, NOBODY
        self._failures: set[str] = set()
        theme.dress(server, session.scenario.title)
        page.install(server, "frames", {})
        page.install(server, "tabs", {})
        page.install(server, "fields", {"words": []})
        self._scene = Scene(server, session.setup, self.ui.state.look)
        self._roles = Roles(server, session.pointer, session.pointer_limits.lost)
        self._build_panels()
        pointer.ignore_palms(server)
        camera.install(server, self._scene.camera_arena)
        hand = ArenaInteraction(session, self.ui, self._roles, page_actions(server))
        pointer.install(server, hand, theme.CSS.stroke)
        self._calibration = Calibration(server, session.calibrated)  # ahead of the keys: Esc is its own at times
        keys.install(server, hand.key)
        tools.install(server, hand.tool, hand.key)
        hints.install(server)
        page.on_leave(server, hand.leave)
        page.listen(server, "landscape", lambda _client_id, _body: theme.widen(server, self.ui.state.look))
        add_commands(server.gui, hand, self._roles)
        self._roles.install(hand.hand_over)

    def _build_panels(self) -> None:
        gui, session, sink, ui = self._server.gui, self._session, self._roles, self.ui
        card = RunCard(self._server, session, sink, self._drafts, self._choose_file)
        self._style = gui.add_html(style_html(self.ui.state.look))
        run = RunControls(self._server, sink)
        status = StatusStrip(self._server, session.setup.params.safety.control_period, ui)
        tabs = gui.add_tab_group()
        with tabs.add_tab("Steer"):
            preview = PreviewPanel(gui, self._previewer, sink)
            steer = SteerPanel(gui, session.scenario, len(session.setup.start.motion.position), sink, ui)
            glance = GlancePanel(gui, ui)
        team: tuple[Panel, ...] = ()
        if session.snapshot.team is not None:
            with tabs.add_tab("Team"):
                team = (TeamPanel(gui, len(session.snapshot.team.links), sink),)
        with tabs.add_tab("Fires"):
            fires = FiresPanel(gui, session)
        with tabs.add_tab("Why"):
            why = WhyPanel(gui, session, ui)
        with tabs.add_tab("Edit"):
            edit = EditPanel(gui, sink, ui)
            history = HistoryPanel(gui, sink)
            self._file = FilesPanel(self._server, session, sink, ui, self._saved, card.open_scenarios)
        with tabs.add_tab("Tune"):
            tune = TunePanel(gui, session, sink)
        with tabs.add_tab("Inputs"):
            inputs = InputsPanel(gui, session, sink)
        with tabs.add_tab("View"):
            view = ViewPanel(gui, ui)
        with tabs.add_tab("Log"):
            log = LogPanel(self._server, ui)
        self._panels: tuple[Panel, ...] = (
            card,
            status,
            run,
            steer,
            preview,
            glance,
            fires,
            why,
            edit,
            history,
            self._file,
            tune,
            inputs,
            view,
            log,
            *team,
        )

    def _choose_file(self, client_id: int) -> None:
        self._file.choose_scenario(client_id)

    def _saved(self, setup: "Setup") -> None:
        if self._drafts is not None:
            self._drafts.saved(setup)

    def _choice(self) -> Choice:
        state = self.ui.state
        return Choice(state.horizon, state.drawn_for, state.terms, state.drawn_robot)

    def _wake(self, before: UiState, now: UiState) -> None:
        """What was chosen is shown at once; what is dragged, which comes by the hundred, with the next frame."""
        if now.drag is before.drag:
            self._session.answered.set()

    def start(self) -> None:
        """Runs the view on a thread of its own, and the look ahead on another."""
        self._previewer.start()
        self._thread = threading.Thread(target=self.run, args=(self._stopping,), name="view", daemon=True)
        self._thread.start()

    def run(self, stopping: threading.Event) -> None:
        """Shows the latest snapshot 30 times a second, or less often while the run is late, until `stopping` is set.

        What answers the operator is shown out of turn: who acts waits for the control period, not for a frame besides.
        """
        due, answered, pace = time.perf_counter(), self._session.answered, FramePace()
        while not stopping.is_set():
            answered.clear()
            snapshot = self._session.snapshot
            self.show(snapshot)
            now = time.perf_counter()
            frame = pace.frame(snapshot.lost_time, now)
            due = max(due + frame if now >= due else due, now + REST)
            answered.wait(due - now)

    def show(self, snapshot: "Snapshot") -> None:
        """Shows one snapshot. A part that fails is logged once and does not keep the others from showing."""
        if snapshot.scenario is not self._scenario:
            self._take(snapshot.scenario)
        path = in_hand(snapshot.state)
        if path is not self._path:
            self._path = path
            self.ui.change(follow_path(path))
            if path.kind != PathKind.NONE:
                hints.happened(self._server, "draw")
        if snapshot.state.intent.influenced != self._influenced:
            self._influenced = snapshot.state.intent.influenced
            hints.happened(self._server, "pick")
        with self._server.atomic():
            self._try("scene", lambda: self._show_scene(snapshot))
            self._try("calibration", lambda: self._calibration.update(snapshot.inputs.capture))
        self._server.flush()  # viser would wait for the end of its own window of 1/60 s, as the panels may
        with self._server.atomic():
            turn = self._frames % FRAMES_PER_PANEL
            for panel in self._panels[turn::FRAMES_PER_PANEL]:
                self._try(type(panel).__name__, lambda panel=panel: panel.update(snapshot))
            if turn == 0:
                self._try("roles", self._roles.update)
        self._frames += 1
        if snapshot.history is not self._history:
            self._history = snapshot.history
            done, undone = self._history
            tools.show_history(self._server, done[-1].text if done else "", undone[0].text if undone else "")
        if snapshot.state.intent.stopped != self._stopped:
            self._stopped = snapshot.state.intent.stopped
            keys.show_stopped(self._server, self._stopped)
            if self._stopped:
                hints.happened(self._server, "stop")

    def _take(self, scenario: "Scenario") -> None:
        """Another scenario is in force: what was chosen, and the picture on the ground, were of the last one."""
        self._scenario = scenario
        self.ui.change(_begin(scenario))
        self._roles.timeout = self._session.pointer_limits.lost
        self._server.gui.set_panel_label(scenario.title)

    def _show_scene(self, snapshot: "Snapshot") -> None:
        robots = len(snapshot.state.motion.position)
        if robots != self._robots:
            self._robots = robots
            self.ui.update(group=frozenset())  # a number may be another's now
            keys.show_robots(self._server, robots)
        if self._scene.setup is not snapshot.setup:
            self.ui.change(keep_choice(snapshot.setup.layout))
        state = self.ui.state
        look = state.look
        if self._scene.setup is not snapshot.setup or self._scene.look != look:
            if self._scene.look != look:
                theme.wear(self._server, look)
                self._style.content = style_html(look)
            arena = self._scene.camera_arena
            self._scene.clear()
            self._scene = Scene(self._server, snapshot.setup, look)
            if self._scene.camera_arena != arena:
                camera.install(self._server, self._scene.camera_arena)
        viewport = self._session.viewport
        px = None if viewport is None else viewport.metres_per_px
        self._scene.update(snapshot, state, self._previewer.latest, px)

    def _try(self, part: str, update: Callable[[], None]) -> None:
        try:
            update()
        except Exception:
            if part not in self._failures:
                self._failures.add(part)
                _log.exception("%s cannot be shown", part)
                text = f"{part} cannot be shown any more; the values in it are old. The reason is in the server's log."
                self.ui.change(add_alarms((Event(self._session.snapshot.time, Severity.ALARM, "view", text),)))

    def close(self) -> None:
        """Stops both threads; the server stays."""
        self._previewer.close()
        self._stopping.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None


def _begin(scenario: "Scenario") -> Change:
    """What a scenario makes of what is chosen."""
    return begin_scenario(scenario.params.path.stroke_smoothing, len(scenario.robots.points))
