"""Every interface can be opened by its entry point and keeps the contract."""

from collections.abc import Callable
from importlib.metadata import entry_points

import pytest

from higvf_console.core.interface import ChannelHealth, InputSpec, Interface, OperatorContext, PointerSink

GROUP = "higvf_console.interfaces"
SOURCES = {
    "mouse": "",
    "gaze": "time,x [m],y [m]\n0,1,2\n0.01,1,2\n",
    "emg": "time,label\n0,fist\n",
    "bci": "time,label\n0,robot1\n",
    "script": "- {at_s: 0, do: pause}\n",
}


def test_all_adapters_are_entry_points() -> None:
    assert {point.name for point in entry_points(group=GROUP)} >= set(SOURCES)


@pytest.mark.parametrize("name", SOURCES)
def test_an_adapter_opened_by_name_polls_tells_its_health_and_closes_twice(
    name: str, write: Callable[..., str], at: Callable[..., OperatorContext]
) -> None:
    (point,) = entry_points(group=GROUP, name=name)
    source = write(SOURCES[name]) if SOURCES[name] else ""
    interface: Interface = point.load()(InputSpec(name, source))
    assert interface.name == name
    assert all(command.source == name for command in interface.poll(at(1.0)))
    assert isinstance(interface.health(1.0), ChannelHealth)
    interface.close()
    interface.close()


def test_the_mouse_is_a_pointer_sink() -> None:
    (point,) = entry_points(group=GROUP, name="mouse")
    mouse: PointerSink = point.load()(InputSpec("mouse"))
    assert callable(mouse.push)
