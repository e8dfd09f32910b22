"""What `higvf_console` exports: importable, listed, documented, typed; its example runs."""

import doctest
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import higvf_console
import higvf_interfaces

PUBLIC = [name for name in higvf_console.__all__ if name not in ("OperatorCommand", "commands")]


def test_names_are_listed_once_and_sorted() -> None:
    assert sorted(set(higvf_console.__all__)) == sorted(higvf_console.__all__)
    assert set(higvf_console.__all__) <= set(dir(higvf_console))
    assert len(dir(higvf_console)) == len(set(dir(higvf_console)))


@pytest.mark.parametrize("name", PUBLIC)
def test_every_public_name_says_what_it_is(name: str) -> None:
    thing = getattr(higvf_console, name)
    documentation = inspect.getdoc(thing) or ""
    assert len(documentation) > 20
    assert thing.__name__ == name
    if inspect.isfunction(thing) and inspect.signature(thing).parameters:
        assert "Args:" in documentation or name == "open_interface"
        assert "Raises:" in documentation or name in ("scenario_names",)
        for parameter in inspect.signature(thing).parameters:
            assert f"{parameter}:" in documentation or name in ("load_scenario", "open_interface", "read_recording")


def test_type_checkers_see_the_names_that_are_exported() -> None:
    text = Path(higvf_console.__file__).read_text(encoding="utf-8")
    seen = text.partition("if TYPE_CHECKING:")[2].partition("_HOMES")[0]
    for name in higvf_console.__all__:
        assert name in seen


def test_both_packages_are_marked_as_typed() -> None:
    for package in (higvf_console, higvf_interfaces):
        assert Path(str(package.__file__)).with_name("py.typed").is_file()


def test_the_example_of_the_package_runs() -> None:
    result = doctest.testmod(higvf_console, optionflags=doctest.ELLIPSIS)
    assert result.attempted >= 5
    assert result.failed == 0


def test_importing_the_package_loads_no_compiler() -> None:
    code = "import sys, higvf_console; print(sorted({'numba', 'scipy', 'numpy', 'yaml', 'viser'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
