"""Scenarios to and from the operator's computer, and an overhead image with the obstacles in it."""

from collections.abc import Callable
from functools import partial
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

import viser

from higvf_console.core.commands import LoadScenario
from higvf_console.core.edits import AddOutlines
from higvf_console.core.errors import ScenarioError
from higvf_console.core.interface import PointerSink
from higvf_console.runtime.background.worker import submitted
from higvf_console.scenario.writer import scenario_yaml
from higvf_console.ui.page import files
from higvf_console.ui.page.message_filter import settings_of
from higvf_console.ui.page.notice import tell
from higvf_console.ui.scene.background import Background
from higvf_console.ui.ui_state import UiStore, move_background
from higvf_console.ui.widgets.callbacks import chosen, number_in, reaction
from higvf_console.ui.widgets.html import block, text
from higvf_console.ui.widgets.number import NumberField, NumberRange
from higvf_console.world.editing.overhead import Pixels, outlines_in, read_picture
from higvf_console.world.masks import MaskPlace
from higvf_console.world.setup import Setup

if TYPE_CHECKING:
    from concurrent.futures import Future

    from higvf_console.core.arrays import Floats
    from higvf_console.runtime.session import Session
    from higvf_console.runtime.snapshot import Snapshot

_DARK, _BRIGHT = "Dark", "Bright"
_SCENARIO, _IMAGE = "scenario", "image"


class FilesPanel:
    """Buttons, and fields that place the image; what cannot be used is said below them."""

    def __init__(
        self,
        server: viser.ViserServer,
        session: "Session",
        sink: PointerSink,
        ui: UiStore,
        on_saved: Callable[[Setup], None],
        open_scenarios: Callable[[int], None],
    ) -> None:
        """Builds the widgets, and lets pages send files.

        Args:
            server: whose pages.
            session: whose world is saved.
            sink: takes the commands.
            ui: what is chosen in the page.
            on_saved: hears what was saved.
            open_scenarios: shows a page (client) the scenarios to choose from.
        """
        self._server, self._session, self._sink, self._ui, self._on_saved = server, session, sink, ui, on_saved
        self._said = ""
        kinds = {
            _SCENARIO: files.FileKind(".yaml,.yml", self._load),
            _IMAGE: files.FileKind("image/*", self._lay),
        }
        self._choose = files.install(server, kinds, self._refuse)
        gui = server.gui
        with gui.add_folder("Files", expand_by_default=False):
            save = gui.add_button(
                "Save scenario", icon=viser.Icon.DOWNLOAD, hint="The present state as a scenario file"
            )
            save.on_click(self._save)
            open_one = "Shipped scenarios and your own files; starts a new run, which can be undone"
            self._make_button(gui, "Open scenario", viser.Icon.FOLDER_OPEN, open_one, open_scenarios)
            image = "Shown on the ground; obstacles can be made from it"
            self._make_button(gui, "Overhead image", viser.Icon.UPLOAD, image, self._choose_image)
            self._fields = self._make_fields(gui)
            self._note = gui.add_html("", visible=False)

    def _make_button(
        self, gui: viser.GuiApi, label: str, icon: viser.IconName, hint: str, act: Callable[[int], None]
    ) -> None:
        """A button that acts for the page (client) that presses it."""
        button = gui.add_button(label, icon=icon, color="gray", hint=hint)

        async def pressed(event: viser.GuiEvent[Any]) -> None:
            if event.client_id is not None:
                act(event.client_id)

        button.on_click(pressed)

    def _make_fields(self, gui: viser.GuiApi) -> list[Any]:
        place, corner = self._placed, NumberRange("m", -1e6, 1e6)
        self._scale = NumberField(
            gui, "Scale", 1.0, NumberRange("m per pixel", 1e-4, 1e4), lambda value: place(scale=value), visible=False
        )
        self._left = NumberField(
            gui, "Left", 0.0, corner, lambda value: place(left=value), visible=False,
            hint="x of the lower left corner of the image",
        )  # fmt: skip
        self._bottom = NumberField(
            gui, "Bottom", 0.0, corner, lambda value: place(bottom=value), visible=False, hint="y of that corner"
        )
        self._shade = gui.add_button_group("Obstacles are", (_DARK, _BRIGHT), visible=False)
        self._threshold = gui.add_slider(
            "Threshold", 0, 255, 1, 128, visible=False, hint="Brightness below which a pixel is dark"
        )
        self._remove = gui.add_button("Remove image", color="gray", visible=False)
        self._shade.on_click(reaction(self._trace))
        self._remove.on_click(reaction(lambda _: self._ui.update(background=None)))
        return [self._scale, self._left, self._bottom, self._shade, self._threshold, self._remove]

    async def _save(self, event: viser.GuiEvent[Any]) -> None:
        if event.client is None:
            return
        snapshot, scenario = self._session.snapshot, self._session.scenario
        try:
            content = scenario_yaml(snapshot.setup, snapshot.state, scenario, rounded=True)
        except ScenarioError as error:
            self._said = f"Not saved: {error}"
            return
        event.client.send_file_download(f"{scenario.name}.yaml", content.encode(), save_immediately=True)
        self._said = ""
        self._on_saved(snapshot.setup)

    def choose_scenario(self, client_id: int) -> None:
        """Opens the chooser of scenario files of a page that has just been clicked."""
        self._choose(_SCENARIO, client_id)

    def _choose_image(self, client_id: int) -> None:
        self._choose(_IMAGE, client_id)

    def _load(self, _client_id: int, name: str, content: bytes) -> None:
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise ValueError("not UTF-8 text, as a scenario file is") from error
        if "\0" in text:
            raise ValueError("not text, as a scenario file is")
        self._sink.push(LoadScenario(text=text, name=PurePath(name).name, waits=self._session.waits))
        self._said = ""

    def _lay(self, client_id: int, name: str, content: bytes) -> None:
        def laid(outcome: "Future[Pixels]") -> None:
            if outcome.cancelled():
                return
            if (error := outcome.exception()) is not None:
                self._refuse(client_id, name, str(error))
                return
            picture, arena = outcome.result(), self._session.setup.arena
            scale = arena.width / picture.shape[1]
            self._ui.update(background=Background(picture, MaskPlace((arena.x_min, arena.y_min), scale)))
            self._said = ""

        submitted(self._session.worker, read_picture, content).add_done_callback(laid)

    def _placed(self, *, scale: float | None = None, left: float | None = None, bottom: float | None = None) -> None:
        background = self._ui.state.background
        if background is None:
            return
        (x, y), now = background.place
        corner = (x if left is None else left, y if bottom is None else bottom)
        self._ui.change(move_background(MaskPlace(corner, now if scale is None else scale)))

    def _trace(self, shade: object) -> None:
        background = self._ui.state.background
        bright = chosen(shade, {_DARK: False, _BRIGHT: True})
        if background is None:
            return
        threshold = number_in(self._threshold.value, 0, 255)
        traced = partial(outlines_in, bright=bright)
        outcome = submitted(self._session.worker, traced, background.picture, background.place, threshold)
        outcome.add_done_callback(self._traced)

    def _traced(self, outcome: "Future[tuple[Floats, ...]]") -> None:
        if outcome.cancelled():
            return
        if (error := outcome.exception()) is not None:
            self._said = f"No obstacles: {error}"
            return
        self._sink.push(AddOutlines(outlines=outcome.result()))
        self._said = ""

    def _refuse(self, client_id: int, name: str, reason: str) -> None:
        settings_of(self._server).refusals.tell("file", f"page {client_id}", f"file {name!r}: {reason}")
        self._said = f"{name}: {reason}"
        tell(self._server.get_clients().get(client_id), self._said)

    def update(self, _snapshot: "Snapshot") -> None:
        """Shows the fields while there is an image, and what could not be used."""
        background = self._ui.state.background
        for widget in self._fields:
            widget.visible = background is not None
        if background is not None:
            (left, bottom), scale = background.place
            for field, value in ((self._scale, scale), (self._left, left), (self._bottom, bottom)):
                field.show(value)
        self._note.visible = bool(self._said)
        self._note.content = block(f'<span class="warn">{text(self._said)}</span>')
