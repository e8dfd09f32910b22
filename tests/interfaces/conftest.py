"""Fixtures of the interface tests: an operator's context, files, and an isolated Lab Streaming Layer."""

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from higvf_console.core.interface import OperatorContext
from higvf_console.core.viewport import Viewport
from tests.interfaces.live.lsl_devices import isolated_library

ContextAt = Callable[..., OperatorContext]


@pytest.fixture
def at() -> ContextAt:
    """Returns a function that makes the context at a session time: three robots, clutch open, no fire extinguished."""

    def context(
        time: float,
        *,
        clutch: bool = False,
        paused: bool = False,
        extinguished: tuple[int, ...] = (),
        viewport: Viewport | None = None,
        robots: int = 3,
    ) -> OperatorContext:
        return OperatorContext(
            time=time,
            operator="operator",
            viewport=viewport,
            clutch=clutch,
            paused=paused,
            influenced=0,
            extinguished=extinguished,
            robots=robots,
        )

    return context


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., str]:
    """Returns a function that writes a file and returns its name."""

    def written(content: str | bytes, name: str = "file.txt") -> str:
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return str(path)

    return written


@pytest.fixture(scope="session")
def lsl(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    """The module `pylsl`, isolated from the network; skips the test if it is not installed."""
    return isolated_library(tmp_path_factory.mktemp("lsl"))
