"""Interfaces are found by entry point, and nothing else is known of them."""

from importlib.metadata import EntryPoint
from typing import Any

import pytest

from higvf_console.errors import InputError
from higvf_console.interface import InputSpec
from higvf_console.session import channels
from higvf_console.session.channels import GROUP, interface_names, open_interface


def test_the_shipped_interfaces_are_installed() -> None:
    assert {"mouse", "gaze", "emg", "bci", "script"} <= set(interface_names())


def test_an_interface_is_opened_by_its_name() -> None:
    interface = open_interface(InputSpec("mouse"))
    assert interface.name == "mouse"
    interface.close()


def test_an_unknown_interface_is_answered_with_the_installed_names() -> None:
    with pytest.raises(InputError, match=r"no interface 'gase' \(did you mean 'gaze'\?\); installed interfaces: bci, "):
        open_interface(InputSpec("gase"))


def test_an_interface_that_does_not_import_says_where_it_should_be(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(group: str) -> Any:
        return [EntryPoint("glove", "no_such_lab.glove:open_glove", group)]

    monkeypatch.setattr(channels, "entry_points", broken)
    with pytest.raises(
        InputError, match=r"interface 'glove' \(no_such_lab\.glove:open_glove\) does not load: No module"
    ):
        open_interface(InputSpec("glove"))
    assert GROUP == "higvf_console.interfaces"
