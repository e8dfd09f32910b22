"""What is shown: the vector field, trails, links, boundaries, numbers; and what the marks mean."""

from typing import TYPE_CHECKING, Any

import viser

from higvf_console.control.field import FieldKind
from higvf_console.ui.panels.callbacks import mirror, one_of, reaction, truth
from higvf_console.ui.panels.html import block
from higvf_console.ui.scene import View
from higvf_console.ui.theme import DARK

if TYPE_CHECKING:
    from higvf_console.session.session import Snapshot

FIELDS: dict[str, Any] = {
    "Off": None,
    "Path": FieldKind.PATH,
    "Composite": FieldKind.COMPOSITE,
    "Blended": FieldKind.BLENDED,
}
SWITCHES = {
    "trails": ("Trails", "Where the robots were in the last seconds (teams of up to 200)"),
    "links": ("Links", "Which robots exchange intentions"),
    "boundaries": ("Boundaries", "Reactive (dashed) and repulsive boundaries of obstacles"),
    "labels": ("Numbers", "Robot numbers (teams of up to 50)"),
    "heat": ("Gaze heat map", "Where you have looked in this run; the brighter, the longer"),
    "clearance": (
        "Safety circles",
        "Two circles that touch are as close as two robots may be; pale: as unicycles and noise enlarge them",
    ),
}


class ViewPanel:
    """Switches that write a `View`; the keyboard may change the field too."""

    def __init__(self, gui: viser.GuiApi, view: View) -> None:
        """Builds the switches."""
        self._view = view
        self._field = gui.add_dropdown(
            "Field", tuple(FIELDS), hint="Path: toward the path. Composite: round obstacles too. "
            "Blended: what the chosen robot would want if it stood there (V)",
        )  # fmt: skip
        self._field.on_update(reaction(self._choose))
        self._switches = [self._make_switch(gui, name, *words) for name, words in SWITCHES.items()]
        self._key = gui.add_html(block(key_html()))

    def _choose(self, value: object) -> None:
        self._view.field = one_of(value, FIELDS)

    def _make_switch(self, gui: viser.GuiApi, name: str, label: str, hint: str) -> viser.GuiCheckboxHandle:
        switch = gui.add_checkbox(label, bool(getattr(self._view, name)), hint=hint)
        switch.on_update(reaction(lambda value: setattr(self._view, name, truth(value))))
        return switch

    def update(self, _: "Snapshot") -> None:
        """Shows the field that is chosen now."""
        mirror(self._field, next(name for name, kind in FIELDS.items() if kind == self._view.field))

    def cleanup(self) -> None:
        """Removes the switches."""
        for widget in (self._field, *self._switches, self._key):
            widget.remove()


def next_field(kind: FieldKind | None) -> FieldKind | None:
    """The field after this one, in the order of the list; after the last, off."""
    kinds = list(FIELDS.values())
    return kinds[(kinds.index(kind) + 1) % len(kinds)]


def key_html() -> str:
    """What the marks in the arena mean."""
    dart = '<path d="M18 7 2 1 6 7 2 13z" fill="{0}"/>'
    diamond = '<path d="M10 -1 18 7 10 15 2 7z" fill="none" stroke="{0}" stroke-width="2"/>'
    ring = '<circle cx="10" cy="7" r="6.5" fill="{1}" stroke="{0}" stroke-width="2"/>'
    rows = [
        (dart.format(DARK.robot), "robot"),
        (dart.format(DARK.operator), "the robot you steer, and your path"),
        (ring.format(DARK.fire_edge, DARK.fire), "burning fire, and the zone it is fought from"),
        (ring.format(DARK.progress, DARK.fire), "being put out; the arc is the work done"),
        (ring.format(DARK.scorched_edge, DARK.scorched), "out, with the area it burnt"),
        (ring.format(DARK.trouble, "none"), "no safe velocity: least violation"),
        (diamond.format(DARK.trouble), "held by barriers"),
        (ring.format(DARK.gaze, "none"), "where you look"),
    ]
    lines = "".join(f'<svg viewBox="0 0 20 14">{mark}</svg><span>{words}</span>' for mark, words in rows)
    return f'<div class="dim" style="margin:6px 0 4px">Marks</div><div class="key">{lines}</div>'
