"""Test devices: Lab Streaming Layer outlets of this process, invisible outside this machine."""

import os
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any
from uuid import uuid4

import pytest

PATIENCE = 20.0  # [s]
_CONFIG = """[ports]
IPv6 = disable
[multicast]
ResolveScope = machine
[lab]
KnownPeers = {{127.0.0.1}}
SessionID = {session}
[log]
level = -3
"""


def isolated_library(folder: Path) -> ModuleType:
    """Load `pylsl` with a configuration that isolates its session from the network."""
    config = folder / "lsl_api.cfg"
    config.write_text(_CONFIG.format(session=f"test-{uuid4().hex}"))
    os.environ["LSLAPICFG"] = str(config)
    return pytest.importorskip("pylsl")


class Device:
    """An outlet that a test can push to and kill."""

    def __init__(
        self,
        lsl: Any,
        kind: str,
        *,
        name: str,
        rate: float = 0.0,
        labels: Sequence[str] = (),
        unit: str = "",
        system: str = "",
        source_id: str | None = None,
    ) -> None:
        texts = not labels
        form = lsl.cf_string if texts else lsl.cf_double64
        info = lsl.StreamInfo(
            name, kind, max(1, len(labels)), rate, form, f"{name}-1" if source_id is None else source_id
        )
        channels = info.desc().append_child("channels")
        for label in labels:
            channel = channels.append_child("channel")
            channel.append_child_value("label", label)
            channel.append_child_value("unit", unit)
            channel.append_child_value("coordinate_system", system)
        self._outlet: Any = lsl.StreamOutlet(info)

    def push(self, *values: Any, at: float = 0.0) -> None:
        self._outlet.push_sample(list(values), at)

    def consumed(self) -> bool:
        return bool(self._outlet.have_consumers())

    def kill(self) -> None:
        self._outlet = None


def until(done: Callable[[], bool], timeout: float = PATIENCE) -> None:
    """Wait until `done` holds; fail the test after a time-out."""
    deadline = time.monotonic() + timeout
    while not done():
        assert time.monotonic() < deadline, "it never came"
        time.sleep(0.005)
