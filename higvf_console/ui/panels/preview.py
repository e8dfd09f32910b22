"""The look ahead: what the stroke would lead to, and the word that commits it."""

from typing import TYPE_CHECKING, Any

import numpy as np
import viser

from higvf_console.analysis.preview import FiresOut, Preview
from higvf_console.core.commands import Confirm, Discard
from higvf_console.core.interface import PointerSink
from higvf_console.core.numbers import measured, percent
from higvf_console.core.state import NOBODY
from higvf_console.operator.reducer import proposal, waiting
from higvf_console.ui.widgets.callbacks import chosen, reaction
from higvf_console.ui.widgets.html import area, block, nearness

if TYPE_CHECKING:
    from higvf_console.runtime.background.previewer import Previewer
    from higvf_console.runtime.snapshot import Snapshot

_COMMIT, _REDRAW, _DISCARD = "Commit", "Redraw", "Discard"
_ARROW, _MINUS = " \u2192 ", "\u2212"
_HELP = (
    "Drag in the arena to draw a path for the influenced robot; its predicted outcome is shown here and in the arena. "
    "Click a robot, or press its number, to influence it."
)
_NO_ROLL = " There is no prediction with the centralised safety filter."
_FAILED = "The preview failed and is off; paths can still be drawn. The reason is in the server's log."


class PreviewPanel:
    """The read-out, of a height that hardly changes while the hand is at work; buttons show while something waits."""

    def __init__(self, gui: viser.GuiApi, previewer: "Previewer", sink: PointerSink) -> None:
        """Adds the comparison and the buttons that commit, redraw or discard what is pending."""
        self._previewer, self._sink = previewer, sink
        self._html = gui.add_html("")
        self._actions = gui.add_button_group(
            "Preview",
            (_COMMIT, _REDRAW, _DISCARD),
            visible=False,
            hint="Follow the drawn path (Enter), draw another instead, or discard everything pending (Esc)",
        )
        self._actions.on_click(reaction(self._act))

    def _act(self, value: object) -> None:
        actions: dict[str, Any] = {_COMMIT: Confirm(), _REDRAW: Discard(proposal=False), _DISCARD: Discard()}
        self._sink.push(chosen(value, actions))

    def update(self, snapshot: "Snapshot") -> None:
        """Shows what waits and what is foreseen."""
        pointer_state = snapshot.state.pointer_state
        self._actions.visible = waiting(pointer_state, snapshot.time)
        preview = self._previewer.latest
        if preview is not None:
            content = preview_html(preview, proposal(pointer_state, snapshot.time))
        else:
            content = f'<span class="dim">{_help(self._previewer)}</span>'
        self._html.content = block(f'<div class="ahead">{content}</div>')


def _help(previewer: "Previewer") -> str:
    if previewer.failed:
        return _FAILED
    return _HELP if previewer.available else _HELP + _NO_ROLL


def preview_html(preview: Preview, proposed: int = NOBODY) -> str:
    """The read-out of a preview."""
    after = "after Resume" if preview.resumed else "from now"
    rows = [("Ahead", f'{preview.horizon:g} s <span class="dim">{after}</span>')]
    if proposed != NOBODY:
        rows.append(("Proposed", f'<span class="operator">robot {proposed + 1}</span>'))
    if preview.start.motion.fire_burning.any():
        rows += [("Burnt", burnt_line(preview)), ("Order", fires_line(preview))]
    rows += [
        ("Safety margin", nearness(preview.clearance)),
        ("Path", path_line(preview)),
    ]
    lines = "".join(f"<dt>{name}</dt><dd>{value}</dd>" for name, value in rows)
    warned = "".join(f'<div class="warn">{warning}</div>' for warning in warnings(preview))
    return f"<dl>{lines}</dl>{warned}"


def burnt_line(preview: Preview) -> str:
    """Loss area at the horizon, and its difference from doing nothing."""
    loss, otherwise = preview.future.loss_area, preview.otherwise.loss_area
    gap = loss - otherwise
    if abs(gap) < 0.5:
        change = '<span class="dim">as without it</span>'
    else:
        sign, mood = ("+", "warn") if gap > 0 else (_MINUS, "good")
        share = f", {sign}{percent(abs(gap) / otherwise, 1)}" if otherwise > 0.0 else ""
        change = f'<span class="{mood}">{sign}{area(abs(gap))} m²{share}</span>'
    return f"{area(loss)} m² {change}"


def fires_line(preview: Preview) -> str:
    """The order in which fires go out, and the other one where it differs."""
    order, other = fire_order(preview.future.fires_out), fire_order(preview.otherwise.fires_out)
    return order if order == other else f'{order} <span class="dim">(without your path: {other})</span>'


def fire_order(out: FiresOut) -> str:
    """Fires by the numbers that people see."""
    return _ARROW.join(str(fire + 1) for fire, _ in out) or "none"


def path_line(preview: Preview) -> str:
    """Whether and when the path is finished."""
    if preview.finish is not None:
        return f"finished in {preview.finish:.1f} s"
    if preview.given_up is not None:
        return f'<span class="warn">given up after {preview.given_up:.1f} s</span>'
    return f"takes longer than {preview.horizon:g} s"


def warnings(preview: Preview) -> list[str]:
    """What the operator should know before it is committed."""
    found: list[str] = []
    if preview.infeasible is not None:
        found.append(f"No safe velocity in {preview.infeasible:.1f} s: least violation")
    if preview.deadlock is not None:
        found.append(f"Held by barriers in {preview.deadlock:.1f} s")
    if len(preview.repulsive):
        length = float(np.hypot(*(preview.repulsive[:, 1] - preview.repulsive[:, 0]).T).sum())
        found.append(f"{measured(length)} m of the path in repulsive areas")
    return found
