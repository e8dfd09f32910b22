"""The numbers of what is chosen; pure, without a browser."""

from contextlib import nullcontext
from types import SimpleNamespace
from typing import Any, cast

import viser

from higvf_console.core.edits import ChangeEntity, EntityKind
from higvf_console.ui.panels.edit import EditPanel
from higvf_console.ui.ui_state import UiStore
from higvf_console.world.editing.entities import EntityRef
from tests.teams import team
from tests.ui.widgets.test_number import Widget


def ignored(_: object) -> None:
    """A callback that is never called."""


class Gui:
    """Makes widgets, and keeps its text fields."""

    def __init__(self) -> None:
        self.fields: list[Any] = []

    def add_text(self, label: str, value: str, **options: Any) -> Widget:
        field = Widget()
        field.value = value
        vars(field).update(label=label, **({"visible": True, "hint": ""} | options))
        self.fields.append(field)
        return field

    def add_html(self, _: str) -> Any:
        return SimpleNamespace(content="")

    def add_folder(self, _: str, **__: Any) -> Any:
        return nullcontext()

    def add_button(self, *_: Any, **__: Any) -> Any:
        return SimpleNamespace(on_click=ignored, visible=False, disabled=False)

    def add_checkbox(self, *_: Any, **__: Any) -> Any:
        return SimpleNamespace(on_update=ignored, value=True, update_timestamp=0.0)


def test_a_number_that_arrives_after_the_next_click_is_of_the_entity_that_it_was_typed_for() -> None:
    setup = team(fires=[(500.0, 250.0, 20.0), (300.0, 450.0, 30.0)])
    snapshot = cast(Any, SimpleNamespace(setup=setup, state=setup.start))
    gui, commands, ui = Gui(), list[Any](), UiStore()
    panel = EditPanel(cast(viser.GuiApi, gui), cast(Any, SimpleNamespace(push=commands.append)), ui)

    def chosen(row: int) -> Any:
        ui.update(selected=EntityRef(EntityKind.FIRE, row))
        panel.update(snapshot)
        return next(field for field in gui.fields if field.visible and field.label == "x (m)")

    first, second = chosen(0), chosen(1)
    assert (first.visible, second.visible) == (False, True)
    second.type("310")
    first.type("505")  # it was on its way when the second fire was chosen
    assert [(edit.index, edit.name, edit.value) for edit in commands] == [(1, "x", 310.0), (0, "x", 505.0)]
    assert all(type(edit) is ChangeEntity for edit in commands)
    assert chosen(0).value == "500"
