"""What is chosen for editing, number by number; the arena; who is linked."""

import math
import time
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import viser

from higvf_console.core.arrays import floats
from higvf_console.core.edits import ChangeEntity, DeleteEntity, LinkByRange, SetArena
from higvf_console.core.interface import PointerSink
from higvf_console.core.viewport import Arena
from higvf_console.ui.ui_state import UiStore
from higvf_console.ui.widgets.callbacks import SETTLE_S, mirror, reaction, truth
from higvf_console.ui.widgets.html import block
from higvf_console.ui.widgets.number import NumberField, NumberRange
from higvf_console.world.editing.entities import NUMBERS, EntityRef, exists, name_of, numbers_of
from higvf_console.world.layout import Layout

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

_MOST_NUMBERS = max(len(numbers) for numbers in NUMBERS.values())
_SIDES = {"x_min": "Left", "y_min": "Bottom", "x_max": "Right", "y_max": "Top"}
_DIGITS = 3  # after the point: millimetres
_LATE_S = 0.3  # [s] what was typed before a click arrives at most so long after it
_HELP = (
    "Choose the arrow above the arena (M) and click a robot, a fire or an obstacle. Drag it to move it, its square to "
    "resize it, its disc to turn it. The tools beside the arrow add entities, draw obstacles and link robots."
)


class EditPanel:
    """Number fields whose names follow what is chosen."""

    def __init__(self, gui: viser.GuiApi, sink: PointerSink, ui: UiStore) -> None:
        """Builds the widgets; none has a meaning before `update`."""
        self._sink, self._ui = sink, ui
        self._place: EntityRef | None = None
        self._former: EntityRef | None = None  # what was chosen before, until
        self._chosen_at = -math.inf  # [s] of a clock
        self._arena, self._walls = Arena(0.0, 0.0, 1.0, 1.0), True
        self._head = gui.add_html("")
        self._fields = [self._make_field(gui, slot) for slot in range(_MOST_NUMBERS)]
        self._delete = gui.add_button(
            "Delete", icon=viser.Icon.TRASH, color="red", visible=False, hint="Delete the selected entity (Del)"
        )
        self._delete.on_click(reaction(lambda _: self._remove()))
        with gui.add_folder("Arena and links", expand_by_default=False):
            self._sides = {name: self._make_side(gui, name, label) for name, label in _SIDES.items()}
            self._walled = gui.add_checkbox("Walls", True, hint="Whether the sides of the arena hold robots back")
            self._walled.on_update(reaction(lambda value: self._set_arena(walls=truth(value))))
            self._by_range = gui.add_button(
                "Link by range", color="gray", hint="Link exactly the robots that are within communication range"
            )
            self._by_range.on_click(reaction(lambda _: sink.push(LinkByRange())))

    def _make_field(self, gui: viser.GuiApi, slot: int) -> NumberField:
        return NumberField(gui, " ", 0.0, NumberRange(), lambda number: self._change(slot, number), visible=False)

    def _make_side(self, gui: viser.GuiApi, name: str, label: str) -> NumberField:
        hint = "Position of this side of the arena"
        return NumberField(
            gui, label, 0.0, NumberRange("m"), lambda number: self._set_arena(sides={name: number}), hint=hint
        )

    def _change(self, slot: int, number: float) -> None:
        """A number was typed into a field; of what it showed then."""
        place = self._former if time.monotonic() - self._chosen_at < _LATE_S else self._place
        if place is not None and slot < len(NUMBERS[place.kind]):
            self._sink.push(ChangeEntity(place.kind, place.row, list(NUMBERS[place.kind])[slot], number))

    def _set_arena(self, walls: bool | None = None, sides: Mapping[str, float] = MappingProxyType({})) -> None:
        self._arena = self._arena._replace(**sides)  # the next side may come before the session has answered
        self._sink.push(SetArena(floats(list(self._arena)), self._walls if walls is None else walls))

    def _remove(self) -> None:
        if self._place is not None:
            self._ui.update(selected=None)
            self._sink.push(DeleteEntity(self._place.kind, self._place.row))

    def update(self, snapshot: "Snapshot") -> None:
        """Shows the numbers of what is chosen, and the arena."""
        layout = snapshot.setup.layout
        place, former = self._ui.state.selected, self._place
        self._place = place if place is not None and exists(place, layout) else None
        if self._place != former:
            self._former, self._chosen_at = former, time.monotonic()
        self._head.content = block(
            f'<span class="dim">{_HELP}</span>'
            if self._place is None
            else f'<div class="title">{name_of(self._place).capitalize()}</div>'
        )
        self._delete.visible = self._place is not None
        self._arena, self._walls = layout.arena, layout.walls
        self._show_numbers(layout, snapshot, SETTLE_S if self._place == former else 0.0)
        for name, field in self._sides.items():
            field.show(round(float(getattr(layout.arena, name)), _DIGITS))
        mirror(self._walled, layout.walls)
        self._by_range.disabled = layout.links is None

    def _show_numbers(self, layout: Layout, snapshot: "Snapshot", settle: float) -> None:
        place, numbers = self._place, dict[str, Any]()
        if place is not None:
            numbers = numbers_of(place, layout, snapshot.state.motion)
            if layout.params.robots.look_ahead == 0.0:
                numbers.pop("heading", None)
        shown = list(numbers.items())
        for slot, field in enumerate(self._fields):
            field.visible = slot < len(shown)
            if place is None or slot >= len(shown):
                continue
            name, value = shown[slot]
            quantity = NUMBERS[place.kind][name]
            label = name if name in ("x", "y") else name.capitalize()
            field.describe(label, NumberRange(quantity.unit), quantity.text)
            field.show(round(value, _DIGITS), settle)
