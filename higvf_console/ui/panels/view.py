"""What is shown, and how: theme and text size, vector field, trails, links; and what the marks mean."""

from typing import TYPE_CHECKING, Any

import viser

from higvf_console.control.guidance.field import FieldKind
from higvf_console.ui.interaction.tools import TOOLS
from higvf_console.ui.run_state import FROZEN, PAUSED, STOPPED
from higvf_console.ui.theme import CSS, TEXT_SIZES, THEMES
from higvf_console.ui.ui_state import MOST_LINKED, UiStore, change_look
from higvf_console.ui.widgets.callbacks import chosen, mirror, reaction, truth
from higvf_console.ui.widgets.html import block

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

FIELDS: dict[str, Any] = {
    "Off": None,
    "Path": FieldKind.PATH,
    "Composite": FieldKind.COMPOSITE,
    "Blended": FieldKind.BLENDED,
}
SWITCHES = {
    "trails": ("Trails", "Where the robots were in the last seconds (teams of up to 200)"),
    "links": ("Links", f"Which robots exchange intentions; off at first in a team of more than {MOST_LINKED}"),
    "boundaries": ("Boundaries", "Reactive (dashed) and repulsive boundaries of obstacles"),
    "labels": ("Numbers", "Robot numbers (teams of up to 50)"),
    "names": ("Obstacle names", "As Why and the messages call them, such as circle 3"),
    "heat": ("Gaze heat map", "Where you have looked in this run; the brighter, the longer"),
    "clearance": (
        "Safety circles",
        "Two circles that touch are as close as two robots may be; pale: enlarged for unicycles and noise",
    ),
}
CAMERA = {
    "camera": ("Camera picture", "What the overhead camera sees, from straight above; grey and dated when it is late")
}


class ViewPanel:
    """Switches that write the `UiState`; the keyboard may change the field too."""

    def __init__(self, gui: viser.GuiApi, ui: UiStore, *, camera: bool = False) -> None:
        """Adds a switch for each layer, the look of every page, and the legend.

        Args:
            gui: where it is added.
            ui: what is chosen.
            camera: whether a camera shows the arena.
        """
        self._ui = ui
        self._field = gui.add_dropdown(
            "Field", tuple(FIELDS), hint="Path: toward the path. Composite: also around obstacles. "
            "Blended: what the influenced robot would want if it stood there (V)",
        )  # fmt: skip
        self._field.on_update(reaction(self._choose))
        switches = {**SWITCHES, **CAMERA} if camera else SWITCHES
        self._switches = {name: self._make_switch(gui, name, *words) for name, words in switches.items()}
        self._theme = gui.add_dropdown("Theme", tuple(THEMES), hint="Applies to every page")
        self._theme.on_update(reaction(lambda value: self._wear(palette=chosen(value, THEMES))))
        self._text = gui.add_dropdown(
            "Text size", tuple(TEXT_SIZES), initial_value="Normal", hint="Applies to every page"
        )
        self._text.on_update(reaction(lambda value: self._wear(text=chosen(value, TEXT_SIZES))))
        gui.add_html(block(key_html()))

    def _choose(self, value: object) -> None:
        self._ui.update(field=chosen(value, FIELDS))

    def _wear(self, **changes: Any) -> None:
        self._ui.change(change_look(**changes))

    def _make_switch(self, gui: viser.GuiApi, name: str, label: str, hint: str) -> viser.GuiInputHandle[bool]:
        switch = gui.add_checkbox(label, bool(getattr(self._ui.state, name)), hint=hint)
        switch.on_update(reaction(lambda value: self._ui.update(**{name: truth(value)})))
        return switch

    def update(self, _: "Snapshot") -> None:
        """Shows what is chosen now."""
        for name, switch in self._switches.items():
            mirror(switch, bool(getattr(self._ui.state, name)))
        mirror(self._field, _name_of(self._ui.state.field, FIELDS))
        mirror(self._theme, _name_of(self._ui.state.look.palette, THEMES))
        mirror(self._text, _name_of(self._ui.state.look.text, TEXT_SIZES))


def _name_of(value: object, choices: dict[str, Any]) -> str:
    return next(name for name, choice in choices.items() if choice == value)


def key_html() -> str:
    """What the marks in the arena mean."""
    dart = '<path d="M18 7 2 1 6 7 2 13z" fill="{0}"/>'
    diamond = '<path d="M10 -1 18 7 10 15 2 7z" fill="none" stroke="{0}" stroke-width="2"/>'
    ring = '<circle cx="10" cy="7" r="6.5" fill="{1}" stroke="{0}" stroke-width="2"/>'
    rows = [
        (dart.format(CSS.robot), "robot"),
        (dart.format(CSS.operator), "the influenced robot, and your path"),
        (ring.format(CSS.fire_edge, CSS.fire), "burning fire, and the zone it is fought from"),
        (ring.format(CSS.progress, CSS.fire), "being put out; the arc is the work done"),
        (ring.format(CSS.scorched_edge, CSS.scorched), "out, with the area it burnt"),
        (ring.format(CSS.trouble, "none"), "no safe velocity: least violation"),
        (diamond.format(CSS.trouble), "held by barriers"),
        (ring.format(CSS.gaze, "none"), "where you look"),
    ]
    lines = "".join(f'<svg viewBox="0 0 20 14">{mark}</svg><span>{words}</span>' for mark, words in rows)
    marks = f'<div class="dim" style="margin:6px 0 4px">Legend</div><div class="key">{lines}</div>'
    return marks + tools_html() + states_html()


def tools_html() -> str:
    """Icon, name and key of every tool."""
    lines = "".join(
        f'<svg viewBox="0 0 24 24" class="tool">{look.icon}</svg>'
        f'<span>{look.title} <span class="dim">({look.key})</span></span>'
        for look in TOOLS.values()
    )
    return f'<div class="dim" style="margin:10px 0 4px">Tools</div><div class="key">{lines}</div>'


def states_html() -> str:
    """What Pause, Freeze and STOP do, one sentence each."""
    lines = "".join(
        f'<b style="color:var(--hg-{state.colour})">{word}</b><span>{state.text}</span>'
        for word, state in (("Pause", PAUSED), ("Freeze", FROZEN), ("STOP", STOPPED))
    )
    return f'<div class="dim" style="margin:10px 0 4px">Pause, Freeze, STOP</div><div class="key words">{lines}</div>'
