"""The panel *Files*: scenarios and pictures to and from a page; what cannot be used is said, and nothing is done."""

import asyncio
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.commands import LoadScenario
from higvf_console.core.edits import AddOutlines
from higvf_console.core.errors import ScenarioError
from higvf_console.core.interface import PointerSink
from higvf_console.core.viewport import Arena
from higvf_console.runtime.session import Session
from higvf_console.ui.page import files as page_files
from higvf_console.ui.panels import files as module
from higvf_console.ui.panels.files import FilesPanel
from higvf_console.ui.ui_state import UiStore
from tests.fake_gui import PAGE, Gui

PICTURE = np.zeros((50, 100, 3), np.uint8)
SETUP = SimpleNamespace(arena=Arena(10.0, 20.0, 210.0, 120.0))


class Shown:
    """The panel, the pages that it talks to, and a worker that answers at once."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.gui, self.ui, self.given = Gui(), UiStore(), list[Any]()
        self.saved, self.opened, self.downloads, self.told = list[Any](), list[int](), list[str](), list[str]()
        self.kinds: dict[str, page_files.FileKind] = {}
        self.answer: object = None
        monkeypatch.setattr(page_files, "install", self._install)
        monkeypatch.setattr(module, "submitted", self._submitted)
        monkeypatch.setattr(module, "settings_of", self._settings)
        monkeypatch.setattr(module, "tell", self._tell)
        session: Any = SimpleNamespace(
            snapshot=SimpleNamespace(setup=SETUP, state=None), scenario=SimpleNamespace(name="mine"), setup=SETUP,
            waits=False, worker=None,
        )  # fmt: skip
        self.panel = FilesPanel(
            self.gui.as_server(get_clients=dict[int, Any]),
            cast(Session, session),
            cast(PointerSink, SimpleNamespace(push=self.given.append)),
            self.ui,
            self.saved.append,
            self.opened.append,
        )

    def _install(self, _server: object, kinds: Any, _refused: object) -> Callable[[str, int], None]:
        self.kinds = kinds
        return lambda kind, client: self.downloads.append(f"choose {kind} on {client}")

    def _settings(self, _server: object) -> object:
        return SimpleNamespace(refusals=SimpleNamespace(tell=print))

    def _tell(self, _client: object, text: str) -> None:
        self.told.append(text)

    def _download(self, name: str, *_: object, **__: object) -> None:
        self.downloads.append(name)

    def _submitted(self, *_: object) -> Future[Any]:
        outcome: Future[Any] = Future()
        if isinstance(self.answer, Exception):
            outcome.set_exception(self.answer)
        else:
            outcome.set_result(self.answer)
        return outcome

    def press(self, label: str) -> None:
        client = SimpleNamespace(send_file_download=self._download)
        event = SimpleNamespace(client_id=PAGE, client=client)
        with ThreadPoolExecutor(1) as server:  # this thread may have a loop of a browser test
            server.submit(lambda: asyncio.run(cast(Any, self.gui[label])._react(event))).result()

    def note(self) -> str:
        self.panel.update(cast(Any, None))
        html = self.gui.html[0]
        return html.content if html.visible else ""


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> Shown:
    return Shown(monkeypatch)


def test_a_scenario_file_is_loaded_by_its_name_without_a_folder(shown: Shown) -> None:
    shown.kinds["scenario"].received(PAGE, "folder/other.yaml", "\ufeffversion: 1".encode())
    assert shown.given == [LoadScenario(text="version: 1", name="other.yaml", waits=False)]


@pytest.mark.parametrize(("content", "reason"), [(b"\xff\xfe\x00", "not UTF-8 text"), (b"a\0b", "not text")])
def test_a_file_that_is_no_text_is_refused(shown: Shown, content: bytes, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        shown.kinds["scenario"].received(PAGE, "a.yaml", content)
    assert shown.given == []


def test_the_scenario_is_saved_under_its_name(shown: Shown, monkeypatch: pytest.MonkeyPatch) -> None:
    def written(*_: object, **__: object) -> str:
        return "version: 1"

    monkeypatch.setattr(module, "scenario_yaml", written)
    shown.press("Save scenario")
    assert shown.downloads == ["mine.yaml"]
    assert shown.saved == [SETUP]


def test_a_scenario_that_cannot_be_written_is_not_saved_and_the_reason_stands_below(
    shown: Shown, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> str:
        raise ScenarioError("robot <3> is too near")

    monkeypatch.setattr(module, "scenario_yaml", fail)
    shown.press("Save scenario")
    assert (shown.downloads, shown.saved) == ([], [])
    assert "Not saved: robot &lt;3&gt; is too near" in shown.note()


def test_buttons_act_for_the_page_that_presses_them(shown: Shown) -> None:
    shown.press("Open scenario")
    shown.press("Overhead image")
    assert shown.opened == [PAGE]
    assert shown.downloads == [f"choose image on {PAGE}"]


def test_a_picture_fills_the_width_of_the_arena_and_can_be_placed_and_removed(shown: Shown) -> None:
    shown.panel.update(cast(Any, None))
    assert not shown.gui["Remove image"].visible
    shown.answer = PICTURE
    shown.kinds["image"].received(PAGE, "a.png", b"")
    background = shown.ui.state.background
    assert background is not None
    assert background.place == ((10.0, 20.0), 2.0)
    shown.panel.update(cast(Any, None))
    assert shown.gui["Remove image"].visible
    shown.gui["Left (m)"].touch("15")
    background = shown.ui.state.background
    assert background is not None
    assert background.place == ((15.0, 20.0), 2.0)
    shown.gui["Remove image"].touch()
    assert shown.ui.state.background is None


def test_a_picture_that_cannot_be_read_is_told_to_its_page(shown: Shown) -> None:
    shown.answer = ValueError("no picture")
    shown.kinds["image"].received(PAGE, "a.png", b"")
    assert shown.ui.state.background is None
    assert shown.told == ["a.png: no picture"]
    assert "a.png: no picture" in shown.note()


def test_obstacles_are_made_from_the_picture_or_the_reason_is_given(shown: Shown) -> None:
    shown.gui["Obstacles are"].touch("Dark")
    assert shown.given == [], "there is no picture"
    shown.answer = PICTURE
    shown.kinds["image"].received(PAGE, "a.png", b"")
    outlines = (floats([[0, 0], [1, 0], [0, 1]]),)
    shown.answer = outlines
    shown.gui["Obstacles are"].touch("Bright")
    (edit,) = shown.given
    assert isinstance(edit, AddOutlines)
    assert edit.outlines is outlines
    shown.answer = ValueError("nothing is bright")
    shown.gui["Obstacles are"].touch("Bright")
    assert "No obstacles: nothing is bright" in shown.note()
