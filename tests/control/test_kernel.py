"""Kernels: called from Python and from each other, kept on disk, and compiled in spite of a cache that is damaged."""

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from higvf_console.control.compilation import cache
from higvf_console.control.compilation.progress import listening
from higvf_console.control.compilation.store import Store
from higvf_console.control.intention.neighbours import within
from higvf_console.control.kernel import Kernel, closed, kernel

pytestmark = pytest.mark.skipif(not isinstance(within, Kernel), reason="NUMBA_DISABLE_JIT=1 leaves kernels plain")


@kernel
def half(x: float) -> float:
    if x < 0.0:
        raise ValueError("negative")
    return x / 2.0


@kernel
def quarter(x: float) -> float:
    return half(half(x))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The cache of this test."""
    monkeypatch.setattr(cache, "STORE", Store(lambda: tmp_path / "cache"))
    return tmp_path / "cache"


def as_new(function: Callable[..., Any]) -> Kernel:
    """A kernel as another process has it: nothing compiled yet."""
    assert isinstance(function, Kernel)
    return Kernel(function.py_func)


def compiled(function: Callable[..., Any], *arguments: Any) -> list[str]:
    """What had to be compiled for a first call in another process."""
    names: list[str] = []
    with listening(names.append):
        as_new(function)(*arguments)
    return names


def test_a_kernel_calls_others_and_python_calls_any_of_them() -> None:
    assert quarter(2.0) == 0.5
    assert half(2.0) == 1.0
    assert quarter(x=3.0) == 0.75


def test_only_what_python_calls_becomes_machine_code(folder: Path) -> None:
    assert compiled(quarter, 1.0) == ["quarter"]
    assert [file.name.split("-")[0] for file in folder.iterdir()] == ["quarter"]


def test_an_error_in_a_kernel_reaches_python_through_its_callers() -> None:
    with pytest.raises(ValueError, match="negative"):
        quarter(-1.0)


def test_an_inner_view_called_from_python_raises_and_does_not_crash() -> None:
    function = as_new(quarter)
    with pytest.raises(TypeError):
        function.dispatchers.linked(1.0)


def test_a_closed_kernel_refuses_other_types_at_once() -> None:
    function = as_new(quarter)
    assert function(1.0) == 0.25
    closed(function)
    with pytest.raises(TypeError, match="No matching definition"):
        function(np.ones(3))
    assert function(2.0) == 0.5


def test_a_kernel_is_pickled_by_its_name() -> None:
    assert pickle.loads(pickle.dumps(within)) is within


def test_a_kernel_keeps_name_and_documentation() -> None:
    assert within.__name__ == "within"
    assert within.__doc__ is not None


def test_machine_code_is_kept_for_the_next_process(folder: Path) -> None:
    assert compiled(quarter, 1.0) == ["quarter"]
    assert compiled(quarter, 1.0) == []
    assert compiled(quarter, 1) == ["quarter"]
    assert len(list(folder.iterdir())) == 2


def overwrite(content: bytes) -> Callable[[Path], None]:
    def damage(folder: Path) -> None:
        for file in folder.iterdir():
            file.write_bytes(content)

    return damage


def cut(folder: Path) -> None:
    for file in folder.iterdir():
        file.write_bytes(file.read_bytes()[:100])


def exchange(folder: Path) -> None:
    """Sound files of something else."""
    for file in folder.iterdir():
        Store(lambda: folder).write(file.name, pickle.dumps({"version": 3}))


def garble(folder: Path) -> None:
    """Sound files that are no pickles."""
    for file in folder.iterdir():
        Store(lambda: folder).write(file.name, b"not a pickle")


@pytest.mark.parametrize("damage", [overwrite(b""), overwrite(b"\x80\x04garbage" * 9), cut, exchange, garble])
def test_a_damaged_file_costs_a_line_and_a_compilation(
    damage: Callable[[Path], None], folder: Path, caplog: pytest.LogCaptureFixture
) -> None:
    compiled(quarter, 1.0)
    damage(folder)
    assert as_new(quarter)(8.0) == 2.0
    assert len(caplog.records) == 1
    line = caplog.records[0].getMessage()
    assert line.startswith(f"The compile cache file {folder}")
    assert line.endswith("; compiling it anew.")
    assert "\n" not in line
    assert compiled(quarter, 1.0) == []


def test_a_folder_that_cannot_be_used_costs_a_line_in_a_process(tmp_path: Path) -> None:
    (tmp_path / "higvf").write_text("not a folder")
    program = "from tests.control.test_kernel import quarter, half; print(quarter(2.0), half(2.0))"
    found = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        env={**os.environ, "XDG_CACHE_HOME": str(tmp_path)},
        check=True,
    )
    assert found.stdout == "0.5 1.0\n"
    lines = found.stderr.splitlines()
    assert len(lines) == 1
    assert lines[0].startswith(f"The compile cache {tmp_path / 'higvf'}")
    assert lines[0].endswith("; compiling without it.")


def test_processes_that_compile_at_once_do_not_disturb_each_other(tmp_path: Path) -> None:
    program = "from tests.control.test_kernel import quarter, half; print(quarter(2.0), half(2.0))"
    running = [
        subprocess.Popen(
            [sys.executable, "-c", program],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "XDG_CACHE_HOME": str(tmp_path)},
        )
        for _ in range(2)
    ]
    assert [process.communicate() for process in running] == [("0.5 1.0\n", "")] * 2
    (folder,) = (tmp_path / "higvf").iterdir()
    assert sorted(file.name.split("-")[0] for file in folder.iterdir()) == ["half", "quarter"]


def test_a_kernel_that_another_process_has_lowered_is_linked_into_its_caller(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from higvf_console.control.compilation import handover

    first = as_new(half)
    handover.hand_over(first)
    handover.lower(first, 1.0)
    assert [file.name.split(".")[-1] for file in folder.iterdir()] == ["lowered"]

    second = as_new(half)
    handover.hand_over(second)
    monkeypatch.setattr(sys.modules[__name__], "half", second)
    assert as_new(quarter)(8.0) == 2.0
    assert sum(second.dispatchers.linked.stats.cache_hits.values()) == 1
    assert as_new(quarter)(16.0) == 4.0
