"""What the adapter tests share: an operator's context, files made on the spot."""

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
    """Makes the context of a session at a time; three robots, nothing pressed, nothing burnt out."""

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
    """Writes a file and returns its name."""

    def written(content: str | bytes, name: str = "file.txt") -> str:
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return str(path)

    return written


@pytest.fixture(scope="session")
def lsl(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    """The Lab Streaming Layer, alone on this machine; skips the test where it is not installed."""
    return isolated_library(tmp_path_factory.mktemp("lsl"))
