"""Interfaces are found by entry point, and nothing else is known of them."""

import sys
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest

from higvf_console.channels import channels
from higvf_console.channels.channels import GROUP, interface_names, open_interface
from higvf_console.cli.main import main
from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec


def test_the_shipped_interfaces_are_installed() -> None:
    assert {"console", "gaze", "emg", "bci", "script"} <= set(interface_names())


def test_an_interface_is_opened_by_its_name() -> None:
    interface = open_interface(InputSpec("console"))
    assert interface.name == "console"
    interface.close()


def test_an_unknown_interface_is_answered_with_the_installed_names() -> None:
    with pytest.raises(InputError, match=r"no interface 'gase' \(did you mean 'gaze'\?\); installed interfaces: bci, "):
        open_interface(InputSpec("gase"))


def installed(monkeypatch: pytest.MonkeyPatch, folder: Path, module: str) -> None:
    """Installs the interface `glove` from a module with this text."""
    (folder / "torn_glove.py").write_text(module)
    monkeypatch.syspath_prepend(folder)
    monkeypatch.delitem(sys.modules, "torn_glove", raising=False)

    def points(group: str) -> Any:
        return [EntryPoint("glove", "torn_glove:open_glove", group)]

    monkeypatch.setattr(channels, "entry_points", points)


def test_an_interface_that_is_no_python_is_one_clear_line(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    installed(monkeypatch, tmp_path, "x = (")
    assert main(["check-interface", "glove"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("higvf: interface 'glove' (torn_glove:open_glove) does not load: '(' was never closed")


def test_an_interface_that_crashes_while_it_opens_is_one_clear_line_and_breaks_the_contract(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    installed(monkeypatch, tmp_path, "def open_glove(spec): raise OSError(5, 'cannot open', spec.source)")
    crash = "interface 'glove' does not open: OSError: [Errno 5] cannot open: 'left'"
    assert main(["run", "empty", "--headless", "--input", "glove=left"]) == 2
    assert capsys.readouterr().err == f"higvf: {crash}\n"
    assert main(["check-interface", "glove", "--input", "glove=left"]) == 1
    assert capsys.readouterr().out == f"FAILED opens, or refuses its input with InputError: {crash}\n"


def test_an_interface_that_does_not_import_says_where_it_should_be(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(group: str) -> Any:
        return [EntryPoint("glove", "no_such_lab.glove:open_glove", group)]

    monkeypatch.setattr(channels, "entry_points", broken)
    with pytest.raises(
        InputError, match=r"interface 'glove' \(no_such_lab\.glove:open_glove\) does not load: No module"
    ):
        open_interface(InputSpec("glove"))
    assert GROUP == "higvf_console.interfaces"


def test_an_interface_that_opens_as_nothing_is_one_clear_line(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    installed(monkeypatch, tmp_path, "def open_glove(spec): pass")
    assert main(["run", "empty", "--headless", "--input", "glove"]) == 2
    assert capsys.readouterr().err == "higvf: interface 'glove' opens as None, without name, poll, health, close\n"
