"""viser's widgets without a server or a browser: tests read what panels show, and touch it as a page does."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from types import SimpleNamespace
from typing import Any, cast

import viser

PAGE = 7


class Widget:
    """Has what it was made with as attributes."""

    update_timestamp = 0.0  # nobody has touched it

    def __init__(self, label: str = "", **options: object) -> None:
        self.label, self.told, self.removed = label, list[str](), False
        self.visible, self.disabled = True, False
        self.value: Any = None
        self.content = self.options = cast(Any, None)
        self._react = cast(Any, None)
        vars(self).update(options)

    def on_update(self, react: Callable[[Any], Any]) -> None:
        self._react = react

    on_click = on_update

    def _tell(self, _title: str, text: str, **_: object) -> None:
        self.told.append(text)

    def remove(self) -> None:
        self.removed = True

    def touch(self, value: object = None, page: int | None = PAGE) -> None:
        """A page gives the widget a value; what it is told comes to `told`."""
        self.value = value
        client = SimpleNamespace(add_notification=self._tell)
        event = SimpleNamespace(client_id=page, client=client, target=self)
        try:
            self._react(event).send(None)  # runs to its end: a reaction awaits nothing
        except StopIteration:
            return
        raise AssertionError("a reaction must return at once")


class Gui:
    """Makes widgets, and finds them by label; those without a label are in `html`, in their order."""

    def __init__(self) -> None:
        self.html: list[Widget] = []
        self.widgets: dict[str, Widget] = {}

    def __getitem__(self, label: str) -> Widget:
        return self.widgets[label]

    def _add(self, label: str, **options: object) -> Widget:
        self.widgets[label] = Widget(label, **options)
        return self.widgets[label]

    def add_html(self, content: str, **options: Any) -> Widget:
        self.html.append(Widget(content=content, **options))
        return self.html[-1]

    def add_button(self, label: str, **options: object) -> Widget:
        return self._add(label, **options)

    def add_button_group(self, label: str, options: tuple[str, ...], **others: object) -> Widget:
        return self._add(label, options=options, **others)

    def add_dropdown(self, label: str, options: tuple[str, ...], **others: Any) -> Widget:
        return self._add(label, **{"value": others.get("initial_value", options[0]), "options": options, **others})

    def add_checkbox(self, label: str, value: bool, **options: object) -> Widget:
        return self._add(label, value=value, **options)

    def add_text(self, label: str, value: str, **options: object) -> Widget:
        return self._add(label, value=value, **options)

    def add_slider(
        self, label: str, _low: float, _high: float, _step: float, value: float, **options: object
    ) -> Widget:
        return self._add(label, value=value, **options)

    def add_folder(self, _label: str | None, **_: object) -> AbstractContextManager[None]:
        return nullcontext()

    @property
    def as_viser(self) -> viser.GuiApi:
        """The same, for a panel that is built with it."""
        return cast(viser.GuiApi, self)

    def as_server(self, **others: object) -> viser.ViserServer:
        """A server that has these widgets."""
        return cast(viser.ViserServer, SimpleNamespace(gui=self, **others))
