"""The clock and the run: pause, freeze, step, speed, reset in two steps. STOP is its own red button on every page."""

import time as clock
from typing import TYPE_CHECKING, Any

import viser

from higvf_console.core.commands import Freeze, Pause, ResetRun, Resume, SetSpeed, Step
from higvf_console.core.interface import PointerSink
from higvf_console.ui.panels.widgets.callbacks import mirror, one_of, reaction
from higvf_console.ui.panels.widgets.html import TIMES

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

SPEEDS: dict[str, Any] = {f"{factor:g}{TIMES}": factor for factor in (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)}
CONFIRM_S = 4.0  # within which a reset must be confirmed
_FREEZE, _UNFREEZE, _STEP = "Freeze clock", "Run clock", "Step once"


class RunPanel:
    """Buttons whose words follow the state of the run."""

    def __init__(self, gui: viser.GuiApi, sink: PointerSink) -> None:
        """Builds the buttons."""
        self._sink = sink
        self._paused, self._frozen = False, False
        self._asked = -CONFIRM_S
        self._pause = gui.add_button(
            "Pause", icon=viser.Icon.PLAYER_PAUSE, hint="Robots hold their place and only avoid hazards (P)"
        )
        self._pause.on_click(reaction(lambda _: sink.push(Resume() if self._paused else Pause())))
        self._clock = gui.add_button_group(
            "Clock", (_FREEZE, _STEP), hint="The simulation clock (Z, X); stepping needs a frozen clock"
        )
        self._clock.on_click(reaction(self._on_clock))
        self._speed = gui.add_dropdown(
            "Speed",
            tuple(SPEEDS),
            initial_value=nearest_speed(1.0),
            hint="Simulation time relative to real time; live devices need 1",
        )
        self._speed.on_update(reaction(lambda value: sink.push(SetSpeed(one_of(value, SPEEDS)))))
        self._reset = gui.add_button("Reset run", icon=viser.Icon.ROTATE, color="gray", hint="Back to the start")
        self._reset.on_click(reaction(lambda _: self._on_reset()))

    def _on_clock(self, value: object) -> None:
        action = one_of(value, {_FREEZE: Freeze(True), _UNFREEZE: Freeze(False), _STEP: Step()})
        if isinstance(action, Step) and not self._frozen:
            self._sink.push(Freeze(True))
        self._sink.push(action)

    def _on_reset(self) -> None:
        now = clock.monotonic()
        if now - self._asked < CONFIRM_S:
            self._asked = -CONFIRM_S
            self._sink.push(ResetRun())
        else:
            self._asked = now

    def update(self, snapshot: "Snapshot") -> None:
        """Makes the words fit a snapshot."""
        intent = snapshot.state.intent
        self._paused, self._frozen = intent.paused, snapshot.frozen
        self._pause.disabled = intent.stopped
        self._pause.label = "Stopped: reset STOP first" if intent.stopped else _pause_label(intent.paused)
        self._pause.icon = viser.Icon.PLAYER_PLAY if intent.paused else viser.Icon.PLAYER_PAUSE
        self._clock.options = (_UNFREEZE if snapshot.frozen else _FREEZE, _STEP)
        mirror(self._speed, nearest_speed(snapshot.speed))
        asked = clock.monotonic() - self._asked < CONFIRM_S
        self._reset.label = "Press again to reset the run" if asked else "Reset run"
        self._reset.color = "red" if asked else "gray"


def _pause_label(paused: bool) -> str:
    return "Resume" if paused else "Pause"


def nearest_speed(factor: float) -> str:
    """The name of the offered speed that is nearest to a factor."""
    return min(SPEEDS, key=lambda name: abs(SPEEDS[name] - factor))
