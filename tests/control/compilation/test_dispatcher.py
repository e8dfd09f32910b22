"""How kernels are linked: an entry has the code of all that it calls; a lowered kernel keeps its own alone."""

import gc
from pathlib import Path
from typing import Any, cast

import pytest

from higvf_console.control.kernel import Kernel, kernel

pytestmark = pytest.mark.usefixtures("own_cache")


@kernel
def _third(x: float) -> float:
    return x + 1.0


@kernel
def _second(x: float) -> float:
    return 2.0 * _third(x)


@kernel
def _first(x: float) -> float:
    return _second(x) + _third(x)


@kernel
def _untypable(x: float) -> object:
    return x.no_such_attribute  # pyright: ignore[reportAttributeAccessIssue, reportUnknownMemberType]


@pytest.fixture
def own_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("higvf_console.control.compilation.cache.STORE._folder", tmp_path / "cache")


def lowered(function: object) -> Any:
    """The library of a kernel that other kernels have called."""
    (compiled,) = cast(Kernel, function).dispatchers.linked.overloads.values()
    return compiled.library


def defined(module: Any) -> str:
    return " ".join(function.name for function in module.functions if not function.is_declaration)


def test_an_entry_calls_kernels_that_call_kernels() -> None:
    assert _first(3.0) == 12.0


def test_the_code_of_a_lowered_kernel_stays_apart_until_another_process_needs_it() -> None:
    from llvmlite.binding import parse_bitcode

    assert _first(3.0) == 12.0
    library = lowered(_second)
    assert "_third" not in defined(library._final_module)
    _, _, code = library.serialize_using_object_code()
    assert "_third" in defined(parse_bitcode(code))
    assert "_third" not in defined(library._final_module)


def test_the_garbage_collector_runs_again_after_a_kernel_was_compiled_or_could_not_be() -> None:
    assert _second(1.0) == 4.0
    assert gc.isenabled()
    with pytest.raises(Exception, match="no_such_attribute"):
        _untypable(1.0)
    assert gc.isenabled()
