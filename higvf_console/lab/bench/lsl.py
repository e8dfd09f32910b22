"""Live streams over the loopback: latency from push to command, and memory growth over an hour of gaze.

A thread pushes markers at irregular times. The latency runs from just before the push to the return of the poll that
yields the command. Continuous polling measures the stream itself; polling once per control period adds the wait for the
tick, uniform over the period, as in a session.
"""

import os
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np

from higvf_console.channels.channels import open_interface
from higvf_console.channels.interface_check import PERIOD
from higvf_console.core.commands import Cursor
from higvf_console.core.errors import HigvfError
from higvf_console.core.interface import InputSpec, Interface, OperatorContext

PUSHES = 500
HOUR_S, RATE = 3600, 120  # of gaze
P99_TARGET_MS = 20.0
_PAUSES = (0.003, 0.023)  # between pushes [s]
_BATCH = 600  # samples pushed between two rounds of polling
_TIMEOUT = 30.0  # [s]
_LABELS = ("fist", "open")
_CONFIG = """[multicast]
ResolveScope = machine
[lab]
KnownPeers = {{127.0.0.1}}
SessionID = higvf-bench-{process}
[log]
level = -2
"""


def run(pushes: int = PUSHES, hour_s: float = HOUR_S) -> dict[str, Any]:
    """Runs the suite and returns its figures.

    Args:
        pushes: markers timed for each way of polling.
        hour_s: length of the virtual gaze stream [s].

    Raises:
        HigvfError: pylsl is not installed, or a stream is not found.
    """
    with tempfile.TemporaryDirectory() as folder:
        config = Path(folder) / "lsl_api.cfg"
        config.write_text(_CONFIG.format(process=os.getpid()), encoding="utf-8")
        os.environ.setdefault("LSLAPICFG", str(config))
        try:
            lsl = import_module("pylsl")
        except (ImportError, OSError, RuntimeError) as problem:
            raise HigvfError(f"suite lsl needs pylsl: pip install 'higvf-console[lsl]' ({problem})") from problem
        latency = {"polled continuously": _latency(lsl, pushes, 0.0), "polled each tick": _latency(lsl, pushes, PERIOD)}
        return {"suite": "lsl", "p99_target_ms": P99_TARGET_MS, "latency_ms": latency, "hour": _hour(lsl, hour_s)}


def table(figures: dict[str, Any]) -> str:
    """The figures as text."""
    lines = [
        f"Live streams over the loopback: latency from push to command, target p99 < {figures['p99_target_ms']:g} ms"
    ]
    for how, taken in figures["latency_ms"].items():
        lines.append(f"{how:>20}  p50 {taken['p50']:.2f} ms  p99 {taken['p99']:.2f} ms  ({taken['count']} pushes)")
    hour = figures["hour"]
    lines.append(
        f"{hour['stream_s']:g} s of gaze in {hour['took_s']:.0f} s: {hour['samples']} samples; "
        f"memory grew by {hour['growth_mb']:.1f} MB after the first fifth"
    )
    return "\n".join(lines)


def _latency(lsl: Any, pushes: int, period: float) -> dict[str, float]:
    """Latency percentiles from push to command [ms], with polls `period` [s] apart; 0 polls continuously."""
    name = f"markers polled at {period:g}"
    outlet = lsl.StreamOutlet(lsl.StreamInfo(name, "Markers", 1, 0.0, lsl.cf_string, name))
    interface = open_interface(InputSpec("emg", "lsl", {"name": name}))
    pushed, taken, begun = list[float](), list[float](), time.perf_counter()

    def push() -> None:
        draw = np.random.default_rng(0)
        for number in range(pushes):
            time.sleep(draw.uniform(*_PAUSES))
            pushed.append(time.perf_counter())
            outlet.push_sample([_LABELS[number % 2]])  # each is an onset

    device = Thread(target=push, daemon=True)
    try:
        _wait_for(outlet.have_consumers)
        device.start()
        deadline = begun + _TIMEOUT + pushes * _PAUSES[1]
        while len(taken) < pushes and time.perf_counter() < deadline:
            commands = interface.poll(_context(time.perf_counter() - begun))
            now = time.perf_counter()
            taken += [1e3 * (now - at) for at in pushed[len(taken) : len(taken) + len(commands)]]
            time.sleep(period or 0.0002)
    finally:
        interface.close()
    return percentiles(taken)


def percentiles(milliseconds: Sequence[float]) -> dict[str, float]:
    """Median and 99th percentile of latencies, and their number.

    Raises:
        HigvfError: there are none.
    """
    if not milliseconds:
        raise HigvfError("suite lsl: no push came back as a command")
    p50, p99 = np.percentile(milliseconds, (50, 99)).tolist()
    return {"p50": round(p50, 3), "p99": round(p99, 3), "count": len(milliseconds)}


def _hour(lsl: Any, stream_s: float) -> dict[str, float]:
    """Memory growth over a gaze stream with its own timestamps, pushed as fast as it is polled."""
    info = lsl.StreamInfo("gaze of an hour", "Gaze", 2, RATE, lsl.cf_double64, "gaze of an hour")
    channels = info.desc().append_child("channels")
    for label in ("x", "y"):
        channel = channels.append_child("channel")
        channel.append_child_value("label", label)
        channel.append_child_value("unit", "pixels")
    outlet = lsl.StreamOutlet(info)
    gaze = open_interface(InputSpec("gaze", "lsl", {"name": info.name(), "screen": "1200x700"}))
    samples, draw = round(stream_s * RATE), np.random.default_rng(0)
    begun, first, early = time.perf_counter(), lsl.local_clock(), 0.0
    try:
        _wait_for(outlet.have_consumers)
        for start in range(0, samples, _BATCH):
            count = min(_BATCH, samples - start)
            looked = np.repeat(draw.uniform((100, 100), (1100, 600), (1 + count // 40, 2)), 40, axis=0)[:count]
            points = (looked + draw.normal(0.0, 3.0, looked.shape)).tolist()
            for number, point in enumerate(points, start):
                outlet.push_sample(point, first + number / RATE)
            _drain(gaze, points[-1], start / RATE)
            if start <= samples / 5 < start + _BATCH:
                early = _memory_mb()
    finally:
        gaze.close()
    return {
        "stream_s": stream_s,
        "took_s": round(time.perf_counter() - begun, 1),
        "samples": samples,
        "memory_mb": round(_memory_mb(), 1),
        "growth_mb": round(_memory_mb() - early, 2),
    }


def _drain(gaze: Interface, newest: list[float], now: float) -> None:
    """Polls until the cursor reaches the newest point."""
    deadline = time.perf_counter() + _TIMEOUT
    while time.perf_counter() < deadline:
        for command in gaze.poll(_context(now)):
            if isinstance(command, Cursor) and abs(float(command.point[0]) - newest[0]) < 1e-6:
                return
    raise HigvfError("suite lsl: the newest sample did not arrive")


def _wait_for(ready: Callable[[], bool]) -> None:
    deadline = time.perf_counter() + _TIMEOUT
    while not ready():
        if time.perf_counter() > deadline:
            raise HigvfError("suite lsl: no consumer connected to the stream")
        time.sleep(0.01)


def _context(now: float) -> OperatorContext:
    return OperatorContext(
        time=now,
        operator="bench",
        viewport=None,
        clutch=False,
        paused=False,
        influenced=0,
        extinguished=(),
        robots=3,
    )


def _memory_mb() -> float:
    """Peak memory of the process so far [MB]."""
    resource = import_module("resource")  # not on Windows
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return float(peak) / (2**20 if sys.platform == "darwin" else 2**10)
