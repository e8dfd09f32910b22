"""The clock and the run: pause, freeze, step, speed, reset in two steps. STOP is its own red button on every page.

The buttons stand in the strip over the arena (`browser_js/strip.js`); this module takes what they send.
"""

import time as clock
from typing import TYPE_CHECKING

import viser

from higvf_console.core.arguments import one_of
from higvf_console.core.commands import Acknowledge, Freeze, Pause, ResetRun, Resume, SetSpeed, Step
from higvf_console.core.interface import PointerSink
from higvf_console.ui.page import page
from higvf_console.ui.page.notice import telling
from higvf_console.ui.run_state import FROZEN, PAUSED
from higvf_console.ui.widgets.speeds import SPEEDS

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

CONFIRM_S = 4.0  # within which a reset must be confirmed


class RunControls:
    """Turns what the strip's buttons send into commands; what a button means follows the state of the run."""

    def __init__(self, server: viser.ViserServer, sink: PointerSink) -> None:
        """Gives every page the strip and listens to it; commands go to `sink`."""
        self._server, self._sink = server, sink
        self._paused, self._frozen = False, False
        self._asked = -CONFIRM_S
        self._shown: bool | None = None
        page.listen(server, "run", telling(server, self._act))
        hints = {
            "pause": f"Pause or resume (P). Paused: {PAUSED.text}",
            "freeze": f"Freeze or run the clock (Z). Frozen: {FROZEN.text}",
            "step": "One step of the frozen clock (X)",
            "speed": "Simulation time relative to real time; live devices need 1",
            "reset": "Back to the start; press twice",
        }
        page.install(server, "strip", {"speeds": list(SPEEDS), "hints": hints})

    def _act(self, _client_id: int, body: page.Body) -> None:
        """A button of the strip was pressed.

        Raises:
            ValueError: there is no such speed.
        """
        match body["act"]:
            case "pause":
                self._sink.push(Resume() if self._paused else Pause())
            case "freeze":
                self._sink.push(Freeze(not self._frozen))
            case "step":
                if not self._frozen:
                    self._sink.push(Freeze(True))
                self._sink.push(Step())
            case "speed":
                self._sink.push(SetSpeed(SPEEDS[one_of("speed", body["value"], SPEEDS)]))
            case "reset":
                self._reset()
            case _:
                self._sink.push(Acknowledge())

    def _reset(self) -> None:
        now = clock.monotonic()
        confirmed = now - self._asked < CONFIRM_S
        self._asked = -CONFIRM_S if confirmed else now
        if confirmed:
            self._sink.push(ResetRun())

    def update(self, snapshot: "Snapshot") -> None:
        """Follows a snapshot."""
        self._paused, self._frozen = snapshot.state.intent.paused, snapshot.frozen
        asked = clock.monotonic() - self._asked < CONFIRM_S
        if asked != self._shown:
            self._shown = asked
            page.call(self._server, "strip", "asked", asked)
