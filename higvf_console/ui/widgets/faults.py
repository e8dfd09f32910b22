"""Fault injection: an input freezes, drops out or lags, so that operator and team can be seen to cope."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import viser

from higvf_console.core.commands import FaultKind, InjectFault
from higvf_console.core.interface import PointerSink
from higvf_console.ui.widgets.callbacks import chosen, reaction
from higvf_console.ui.widgets.number import NumberField, NumberRange

LONGEST_S, SHORTEST_S = 60.0, 0.1
_KINDS: dict[str, Any] = {
    "Freeze: everything arrives at the end": FaultKind.FREEZE,
    "Drop: everything is lost": FaultKind.DROP,
    "Delay: everything arrives late": FaultKind.DELAY,
}


class FaultWidgets:
    """Which input, which fault, for how long, and the button."""

    def __init__(self, gui: viser.GuiApi, channels: Sequence[str], sink: PointerSink) -> None:
        """Adds the fields of one fault and the button that injects it.

        Args:
            gui: where.
            channels: names of the inputs, at least one.
            sink: takes the fault.
        """
        names: dict[str, Any] = {name: name for name in channels}
        self._fault = InjectFault(channel=channels[-1])
        self._channel = gui.add_dropdown("Input", tuple(names), initial_value=self._fault.channel)
        self._kind = gui.add_dropdown("Fault", tuple(_KINDS), hint="STOP always gets through")
        self._seconds = NumberField(
            gui, "Lasts", self._fault.seconds, NumberRange("s", SHORTEST_S, LONGEST_S),
            lambda value: self._choose(seconds=value),
        )  # fmt: skip
        self._delay = NumberField(
            gui, "Delay", self._fault.delay, NumberRange("s", 0.0, LONGEST_S), lambda value: self._choose(delay=value),
            hint="For a delay only",
        )  # fmt: skip
        self._inject = gui.add_button("Inject", icon=viser.Icon.PLUG_CONNECTED_X, color="gray")
        self._channel.on_update(reaction(lambda value: self._choose(channel=chosen(value, names))))
        self._kind.on_update(reaction(lambda value: self._choose(kind=chosen(value, _KINDS))))
        self._inject.on_click(reaction(lambda _: sink.push(self._fault)))

    def _choose(self, **changes: Any) -> None:
        self._fault = replace(self._fault, **changes)
        self._seconds.show(self._fault.seconds)
        self._delay.show(self._fault.delay)
