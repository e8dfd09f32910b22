"""A run reports to the laboratory's other devices what happens, as a marker stream."""

import json
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

from higvf_console.channels import marker_outlet
from higvf_console.channels.marker_outlet import MarkerOutlet
from higvf_console.core.commands import Cursor, Pause, Pick
from higvf_console.core.errors import InputError
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import Scenario
from tests.fake_interfaces import FakeInterface


class Outlet:
    """Notes what is pushed."""

    def __init__(self, info: Any) -> None:
        self.info = info
        self.pushed: list[dict[str, Any]] = []

    def push_sample(self, sample: list[str]) -> None:
        self.pushed.append(json.loads(sample[0]))


@pytest.fixture(name="outlets")
def _outlets(monkeypatch: pytest.MonkeyPatch) -> list[Outlet]:
    """The outlets that are opened, on no network."""
    made: list[Outlet] = []

    def outlet(info: Any) -> Outlet:
        made.append(Outlet(info))
        return made[-1]

    def info(*words: object) -> SimpleNamespace:
        said: dict[str, str] = {}
        return SimpleNamespace(
            words=words, said=said, desc=lambda: SimpleNamespace(append_child_value=said.__setitem__)
        )

    fake = SimpleNamespace(StreamInfo=info, StreamOutlet=outlet, cf_string="string")

    def library(_: str) -> SimpleNamespace:
        return fake

    monkeypatch.setattr(marker_outlet, "import_module", library)
    return made


def test_commands_and_events_are_told_and_cursors_are_not(team: Scenario, outlets: list[Outlet]) -> None:
    mouse = FakeInterface(
        "bci", (0.1, Pick(1, source="bci", confidence=0.8)), (0.1, Cursor(np.zeros(2))), (0.2, Pause())
    )
    session = Session(team, [mouse], markers=MarkerOutlet("console", team.name, 3))
    for _ in range(15):
        session.tick()
    session.close()
    (outlet,) = outlets
    labels = [marker["label"] for marker in outlet.pushed]
    assert labels.index("Pick") < labels.index("Pause")
    assert "Cursor" not in labels
    expected = {"label": "Pick", "robot": 1, "source": "bci", "confidence": 0.8, "sequence": 0, "time": 0.1}
    assert outlet.pushed[labels.index("Pick")] == expected
    events = {marker["event"]: marker for marker in outlet.pushed if "event" in marker}
    assert events["picked"]["robot"] == 1
    assert not {"robot", "fire", "channel"} & set(events["paused"]), "it is about the whole team"


def test_the_source_id_is_the_same_in_every_run(outlets: list[Outlet]) -> None:
    for seed in (1, 2):
        MarkerOutlet("console", "firefighting", seed)
    assert outlets[0].info.words == outlets[1].info.words
    assert outlets[0].info.said == {"scenario": "firefighting", "seed": "1"}


def test_without_the_library_or_a_name_the_reason_is_said(
    monkeypatch: pytest.MonkeyPatch, outlets: list[Outlet]
) -> None:
    with pytest.raises(InputError, match="--lsl-out: the stream needs a name"):
        MarkerOutlet(" ", "team", 0)

    def missing(name: str) -> ModuleType:
        raise ImportError(f"No module named {name!r}")

    monkeypatch.setattr(marker_outlet, "import_module", missing)
    with pytest.raises(InputError, match=r"pip install 'higvf-console\[lsl\]'"):
        MarkerOutlet("console", "team", 0)
    assert outlets == []
