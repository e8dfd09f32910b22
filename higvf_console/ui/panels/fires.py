"""What it costs: the loss area over time against the run without an operator, and a table of the fires."""

from typing import TYPE_CHECKING

import numpy as np
import viser

from higvf_console.core.arrays import Floats, floats
from higvf_console.ui.theme import CSS
from higvf_console.ui.widgets.chart import Curve, chart_svg
from higvf_console.ui.widgets.fire_table import fire_table_html
from higvf_console.ui.widgets.html import area, block

if TYPE_CHECKING:
    from higvf_console.analysis.baseline import Baseline
    from higvf_console.runtime.session import Session
    from higvf_console.runtime.snapshot import Snapshot

SAMPLE_PERIOD = 0.5  # of the curve [s]
MOST_SAMPLES = 400  # beyond, every second one goes
_NO_FIRES = block('<span class="dim">This scenario has no fires.</span>')


class LossHistory:
    """The total loss area of this run over time, thinned as it grows."""

    def __init__(self) -> None:
        """Starts empty."""
        self._period = SAMPLE_PERIOD
        self._samples: list[tuple[float, float]] = []

    def add(self, time: float, total: float) -> None:
        """Takes a sample [s, m^2] if one is due; a time that runs backwards starts anew."""
        if self._samples and time < self._samples[-1][0]:
            self._samples, self._period = [], SAMPLE_PERIOD
        if self._samples and time < self._samples[-1][0] + self._period:
            return
        self._samples.append((time, total))
        if len(self._samples) > MOST_SAMPLES:
            self._samples, self._period = self._samples[::2], 2 * self._period

    def curve(self) -> tuple[Floats, Floats]:
        """Times (n,) [s] and total loss areas (n,) [m^2]."""
        samples = floats(self._samples, -1, 2)
        return samples[:, 0], samples[:, 1]


class FiresPanel:
    """Chart and table; one line in a scenario without fires."""

    def __init__(self, gui: viser.GuiApi, session: "Session") -> None:
        """Starts with an empty curve."""
        self._session = session
        self._history = LossHistory()
        self._chart = gui.add_html("")
        self._table = gui.add_html("")

    def update(self, snapshot: "Snapshot") -> None:
        """Shows a snapshot."""
        if not len(snapshot.setup.world.fire_position):
            self._chart.content, self._table.content = _NO_FIRES, ""
            return
        total = float(snapshot.loss_area.sum())
        self._history.add(snapshot.time, total)
        baseline = self._session.baseline
        chart = chart_html(*self._history.curve(), baseline)
        self._chart.content = chart + summary_html(snapshot.time, total, baseline)
        self._table.content = fire_table_html(snapshot)


def chart_html(time: Floats, loss: Floats, baseline: "Baseline | None") -> str:
    """The area burnt in this run [s, m^2] drawn through, in the one that nobody touches dashed."""
    curves = [Curve("this run", time, loss, CSS.operator)]
    if baseline is not None:
        curves.append(Curve("without operator", baseline.time, baseline.loss_area, CSS.axis_text, dashed=True))
    return block(chart_svg(curves, "s", "m²"))


def summary_html(time: float, total: float, baseline: "Baseline | None") -> str:
    """The loss so far, and what it was at the same time without an operator."""
    line = f"Burnt so far <b>{area(total)} m²</b>"
    if baseline is not None:
        other = float(np.interp(time, baseline.time, baseline.loss_area))
        line += f' <span class="dim">without operator {area(other)}</span>'
    return block(line)
