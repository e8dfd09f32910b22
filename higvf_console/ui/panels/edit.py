"""What is chosen for editing, number by number; the arena; who is linked."""

from collections.abc import Mapping
from functools import partial
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
_HELP = (
    "Choose the arrow above the arena (M) and click a robot, a fire or an obstacle. Drag it to move it, its square to "
    "resize it, its disc to turn it. The tools beside the arrow add entities, draw obstacles and link robots."
)


class _Form:
    """Number fields of one entity; it stays the entity's while what was typed there may still arrive."""

    def __init__(self, gui: viser.GuiApi, sink: PointerSink) -> None:
        self.place: EntityRef | None = None
        self._sink = sink
        self._fields = [
            NumberField(gui, " ", 0.0, NumberRange(), partial(self._change, slot), visible=False)
            for slot in range(_MOST_NUMBERS)
        ]

    def _change(self, slot: int, number: float) -> None:
        if self.place is not None and slot < len(NUMBERS[self.place.kind]):
            self._sink.push(ChangeEntity(self.place.kind, self.place.row, list(NUMBERS[self.place.kind])[slot], number))

    def hide(self) -> None:
        """Hides the fields; they still mean the same entity."""
        for field in self._fields:
            field.visible = False

    def show(self, place: EntityRef, numbers: Mapping[str, float], decimals: int, settle: float) -> None:
        """Shows an entity's numbers, but for those that were typed less than `settle` [s] ago."""
        self.place = place
        shown = list(numbers.items())
        for slot, field in enumerate(self._fields):
            field.visible = slot < len(shown)
            if slot >= len(shown):
                continue
            name, value = shown[slot]
            quantity = NUMBERS[place.kind][name]
            label = name if name in ("x", "y") else name.capitalize()
            field.describe(label, NumberRange(quantity.unit), quantity.text)
            field.show(round(value, decimals), settle)


class EditPanel:
    """Number fields whose names follow what is chosen.

    A field may be left by the click that chooses another entity, and what was typed there arrives after it. So two
    forms take turns: a number is of the entity whose form it was typed into.
    """

    def __init__(self, gui: viser.GuiApi, sink: PointerSink, ui: UiStore) -> None:
        """Builds the widgets; none has a meaning before `update`."""
        self._sink, self._ui = sink, ui
        self._place: EntityRef | None = None
        self._arena, self._walls = Arena(0.0, 0.0, 1.0, 1.0), True
        self._head = gui.add_html("")
        self._form, self._other_form = _Form(gui, sink), _Form(gui, sink)
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

    def _make_side(self, gui: viser.GuiApi, name: str, label: str) -> NumberField:
        hint = "Position of this side of the arena"
        return NumberField(
            gui, label, 0.0, NumberRange("m"), lambda number: self._set_arena(sides={name: number}), hint=hint
        )

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
            self._form.hide()
            self._form, self._other_form = self._other_form, self._form
        self._head.content = block(
            f'<span class="dim">{_HELP}</span>'
            if self._place is None
            else f'<div class="title">{name_of(self._place).capitalize()}</div>'
        )
        self._delete.visible = self._place is not None
        self._arena, self._walls = layout.arena, layout.walls
        self._show_numbers(layout, snapshot, SETTLE_S if self._place == former else 0.0)
        for name, field in self._sides.items():
            field.show(round(float(getattr(layout.arena, name)), layout.params.scale.decimals))
        mirror(self._walled, layout.walls)
        self._by_range.disabled = layout.links is None

    def _show_numbers(self, layout: Layout, snapshot: "Snapshot", settle: float) -> None:
        if self._place is None:
            return
        numbers: dict[str, Any] = numbers_of(self._place, layout, snapshot.state.motion)
        if layout.params.robots.look_ahead == 0.0:
            numbers.pop("heading", None)
        self._form.show(self._place, numbers, layout.params.scale.decimals, settle)
