"""The console: what the operator sees and touches, between a session and the browser.

    session thread    ->  session.snapshot  ->  view thread: scene, panels  ->  viser  ->  pages
    session.pointer  <-  commands            <-  viser's event loop: keys, pointer, widgets

The view thread alone changes what is shown, and never the state; callbacks push commands and return. So neither a slow
browser nor a slow panel is ever felt by the robots.
"""

import logging
import math
import threading
import time
from collections.abc import Callable, Coroutine
from typing import TYPE_CHECKING

import numpy as np
import viser

from higvf_console.arrays import Floats
from higvf_console.commands import (
    AskReset,
    ClearPath,
    Confirm,
    Discard,
    Freeze,
    OperatorCommand,
    Pause,
    Pick,
    ResetStop,
    Resume,
    ReversePath,
    Step,
    Stop,
    StrokeBegin,
    StrokeCancel,
    StrokeEnd,
    StrokePoints,
)
from higvf_console.session.previewer import Choice, Previewer
from higvf_console.sim.unicycle import body_centres
from higvf_console.ui import camera, keys, page, pointer, theme
from higvf_console.ui.calibration import Calibration
from higvf_console.ui.panels.fires import FiresPanel
from higvf_console.ui.panels.html import SPACER
from higvf_console.ui.panels.inputs import InputsPanel
from higvf_console.ui.panels.log import LogPanel
from higvf_console.ui.panels.preview import PreviewPanel
from higvf_console.ui.panels.run import RunPanel
from higvf_console.ui.panels.status import StatusPanel
from higvf_console.ui.panels.steer import SteerPanel
from higvf_console.ui.panels.view import ViewPanel, next_field
from higvf_console.ui.panels.why import WhyPanel
from higvf_console.ui.scene import Scene, View
from higvf_console.viewport import Viewport

if TYPE_CHECKING:
    from higvf_console.session.session import Session, Snapshot

FRAME = 1 / 30  # [s]
FRAMES_PER_PANEL = 6  # panels are renewed five times a second
PICK_RADIUS_PX = 26.0  # a click this close to a robot picks it, at one device pixel a CSS pixel

_log = logging.getLogger(__name__)


class Hand:
    """Turns what a page's pointer and keys do into commands; called on viser's event loop."""

    def __init__(self, session: "Session", view: View, steer: SteerPanel) -> None:
        """Starts with nobody drawing."""
        self._session, self._view, self._steer = session, view, steer
        self._drawing: int | None = None
        self._viewports: dict[int, Viewport] = {}

    def stroke(self, client_id: int, phase: pointer.Phase, points: Floats) -> None:
        """A stroke begins, grows and ends; of two pages that draw at once, the later one has the pen."""
        if phase == "start":
            self._drawing = client_id
            self._push(StrokeBegin())
        elif client_id != self._drawing:
            return
        if phase == "cancel":
            self._push(StrokeCancel())
        elif len(points):
            self._push(StrokePoints(points=points))
        if phase == "end":
            self._push(StrokeEnd(smoothing=self._steer.smoothing, preview=not self._view.commit_at_once))
        if phase in ("cancel", "end"):
            self._drawing = None

    def click(self, client_id: int, point: Floats) -> None:
        """Picks the robot at a ground point (2,) [m]; a second click shows or hides why it moves."""
        viewport = self._viewports.get(client_id)
        reach = PICK_RADIUS_PX * viewport.metres_per_px if viewport else math.inf
        motion, look_ahead = self._session.snapshot.state.motion, self._session.setup.gains.robots.look_ahead
        robot = robot_near(body_centres(motion.position, motion.heading, look_ahead), point, reach)
        if robot is None:
            return
        if robot == self._session.snapshot.state.intent.influenced:
            self._view.explained, self._view.reasons = None, not self._view.reasons
        self._push(Pick(robot))

    def viewport(self, client_id: int, viewport: Viewport) -> None:
        """How a page lies over the ground; gaze is mapped through that of the page that told last."""
        self._viewports[client_id] = self._session.viewport = viewport

    def leave(self, client_id: int) -> None:
        """A page has gone."""
        self._viewports.pop(client_id, None)

    def key(self, _client_id: int, name: str) -> None:
        """A key of `keys.KEYMAP`, or the same action out of the command palette."""
        if name == "stop":  # first, and on its own: nothing may come between
            self._push(Stop())
            return
        snapshot = self._session.snapshot
        commands: dict[str, OperatorCommand] = {
            "ask_reset": AskReset(),
            "reset_stop": ResetStop(),
            "pause": Resume() if snapshot.state.intent.paused else Pause(),
            "confirm": Confirm(),
            "discard": Discard(),
            "clear_path": ClearPath(),
            "reverse_path": ReversePath(),
            "freeze": Freeze(not snapshot.frozen),
            "step": Step(),
        }
        if name == "field_arrows":
            self._view.field = next_field(self._view.field)
        elif name in commands:
            self._push(commands[name])
        elif name.startswith("pick_"):
            robot = int(name.removeprefix("pick_")) - 1
            if 0 <= robot < len(snapshot.state.motion.position):
                self._push(Pick(robot))

    def _push(self, command: OperatorCommand) -> None:
        self._session.pointer.push(command)


def robot_near(position: Floats, point: Floats, reach: float) -> int | None:
    """Index of the robot, among (N, 2) [m], that is nearest to a point (2,) and within `reach` [m] of it."""
    if not len(position):
        return None
    gap = np.hypot(position[:, 0] - point[0], position[:, 1] - point[1])
    nearest = int(np.argmin(gap))
    return nearest if gap[nearest] <= reach else None


def add_commands(gui: viser.GuiApi, hand: Hand) -> None:
    """Offers what the keys do in the command palette (Ctrl+K) too."""
    for binding in keys.KEYMAP:
        if binding.name in keys.NAMES:
            command = gui.add_command(binding.text, description=f"Key {binding.key}")
            command.on_trigger(_trigger(hand, binding.name))


def _trigger(hand: Hand, name: str) -> Callable[[viser.CommandEvent], Coroutine[None, None, None]]:
    async def react(event: viser.CommandEvent) -> None:
        hand.key(event.client_id or 0, name)

    return react


class Console:
    """Scene and panels of one session, on one viser server."""

    def __init__(self, session: "Session", server: viser.ViserServer) -> None:
        """Builds everything; nothing moves before `run` or `start`."""
        self._session, self._server = session, server
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None
        self._view = View()
        self._previewer = Previewer(session, self._choice)
        self._stopped: bool | None = None
        self._frames = 0
        self._failures: set[str] = set()
        theme.dress(server, session.scenario.title)
        self._scene = Scene(server, session.setup, self._view)
        self._build_panels()
        camera.install(server, self._scene.camera_arena)
        hand = Hand(session, self._view, self._steer)
        pointer.install(server, hand, theme.DARK.stroke)
        self._calibration = Calibration(server, session.calibrated)
        keys.install(server, hand.key, session.pointer.beat)
        page.on_leave(server, hand.leave)
        add_commands(server.gui, hand)

    def _build_panels(self) -> None:
        gui, session, sink = self._server.gui, self._session, self._session.pointer
        status = StatusPanel(gui, session.setup.gains.safety.control_period, sink)
        run = RunPanel(gui, sink)
        gui.add_html(SPACER)
        tabs = gui.add_tab_group()
        with tabs.add_tab("Steer"):
            preview = PreviewPanel(gui, self._previewer, sink)
            self._steer = SteerPanel(gui, session.scenario, len(session.setup.start.motion.position), sink, self._view)
        with tabs.add_tab("Fires"):
            fires = FiresPanel(gui, session)
        with tabs.add_tab("Why"):
            why = WhyPanel(gui, session, self._view)
        with tabs.add_tab("Inputs"):
            inputs = InputsPanel(gui, session, sink)
        with tabs.add_tab("View"):
            view = ViewPanel(gui, self._view)
        with tabs.add_tab("Log"):
            log = LogPanel(self._server)
        self._panels = (status, run, self._steer, preview, fires, why, inputs, view, log)

    def _choice(self) -> Choice:
        return Choice(self._view.horizon, self._steer.smoothing)

    def start(self) -> None:
        """Runs the view on a thread of its own, and the look ahead on another."""
        self._previewer.start()
        self._thread = threading.Thread(target=self.run, args=(self._stopping,), name="view", daemon=True)
        self._thread.start()

    def run(self, stopping: threading.Event) -> None:
        """Shows the latest snapshot 30 times a second until `stopping` is set."""
        due = time.perf_counter()
        while not stopping.is_set():
            self.show(self._session.snapshot)
            due = max(due + FRAME, time.perf_counter())
            stopping.wait(due - time.perf_counter())

    def show(self, snapshot: "Snapshot") -> None:
        """Shows one snapshot. A part that fails is logged once and does not keep the others from showing."""
        with self._server.atomic():
            self._try("scene", lambda: self._show_scene(snapshot))
            self._try("calibration", lambda: self._calibration.update(snapshot.inputs.capture))
            if self._frames % FRAMES_PER_PANEL == 0:
                for panel in self._panels:
                    self._try(type(panel).__name__, lambda panel=panel: panel.update(snapshot))
        self._frames += 1
        if snapshot.state.intent.stopped != self._stopped:
            self._stopped = snapshot.state.intent.stopped
            keys.show_stopped(self._server, self._stopped)

    def _show_scene(self, snapshot: "Snapshot") -> None:
        if self._scene.setup is not snapshot.setup:
            self._scene.clear()
            self._scene = Scene(self._server, snapshot.setup, self._view)
        self._scene.update(snapshot, self._previewer.latest)

    def _try(self, part: str, update: Callable[[], None]) -> None:
        try:
            update()
        except Exception:
            if part not in self._failures:
                self._failures.add(part)
                _log.exception("%s cannot be shown", part)

    def close(self) -> None:
        """Stops both threads; the server stays."""
        self._previewer.close()
        self._stopping.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None
