"""What the console costs and how soon it answers: bytes on the wire, processor, frames, and from stroke to motion.

A console runs in a process of its own, with two clients: a page in headless Chromium that steers, and one without a
screen that reads as fast as the console sends (`lab.bench.wire`). All three share this machine.

bytes and messages   that the second client gets in a second while the team moves: what a page that keeps up gets
server CPU           processor time of the console's process, engine included, as a share of one core
frames               animation frames of the page in a second; without a graphics card the processor draws them
latency              from the dispatch of the last pointer event of a stroke, by the page's clock, to the arrival of
                     the first message with other robot positions at the second client, by the system's clock: the
                     page's script, both ways over the loopback, the wait for the control period, the view, and what
                     the three take from each other. The team stands until then. A device's own delay, and
                     drawing what has arrived, are not in it
"""

import math
import os
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from higvf_console.control.parameters import SafetyParameters
from higvf_console.core.errors import HigvfError
from higvf_console.lab.bench.console_page import ConsolePage, browser_at_hand, console_of, cpu_seconds
from higvf_console.lab.bench.wire import Watcher, first_motion

TEAMS = (3, 100, 1000)
STROKES = 40  # timed, for each team
SETTLING_S, MEASURED_S = 4.0, 10.0
PERIOD_MS, VIEW_MS = 1e3 * SafetyParameters().control_period, 33.0
TARGET_P99_MS = 2.0 * PERIOD_MS + VIEW_MS
_STILL_S = 0.4  # without motion, until a team counts as standing
_PATIENCE_S = 10.0
_WIDTH = 0.2  # of a stroke, as a share of the canvas

_TEAM = """
version: 1
arena: {{size_m: [{width}, {height}], walls: true}}
robots: {{count: {robots}, spacing_m: 40, jitter_m: 5}}
parameters:
  formation: {{communication_range: 60}}
duration_s: 3600
"""
_FIRES = """
fires:
  - {{at_m: [80, 80], radius_m: 20, robots_needed: 2}}
  - {{at_m: [{right}, {top}], radius_m: 20, robots_needed: 2}}
"""
_SHIPPED = {3: "firefighting", 1000: "swarm"}  # whose fires keep the team moving


class Traffic(NamedTuple):
    """What a moving team costs.

    Attributes:
        scenario: what ran.
        bytes_per_s: from server to page.
        messages_per_s: likewise.
        cpu_share: of one core.
        frames_per_s: of the page.
    """

    scenario: str
    bytes_per_s: float
    messages_per_s: float
    cpu_share: float
    frames_per_s: float


class Latency(NamedTuple):
    """From the end of a stroke to the first motion on the wire [ms].

    Attributes:
        p50: median.
        p99: exceeded by one in a hundred; of fewer strokes, nearly the worst.
        worst: the largest.
        strokes: how many were timed.
    """

    p50: float
    p99: float
    worst: float
    strokes: int


def run(teams: Sequence[int] = TEAMS, strokes: int = STROKES, seconds: float = MEASURED_S) -> dict[str, Any]:
    """The figures of the suite.

    Args:
        teams: numbers of robots.
        strokes: timed for each team.
        seconds: over which traffic is counted.

    Raises:
        HigvfError: no Playwright, Chromium or /proc, or a console that does not do what it should.
    """
    load = os.getloadavg()[0]
    cases: list[dict[str, Any]] = []
    with browser_at_hand() as browser, tempfile.TemporaryDirectory() as folder:
        for robots in teams:
            traffic = _traffic(browser, _SHIPPED.get(robots) or _written(Path(folder), robots, fires=True), seconds)
            latency = _latency(browser, _written(Path(folder), robots, fires=False), strokes)
            cases.append({"robots": robots, "traffic": traffic._asdict(), "latency_ms": latency._asdict()})
    return {
        "suite": "ui", "load_before": load, "cores": os.cpu_count(), "p99_target_ms": TARGET_P99_MS, "cases": cases,
    }  # fmt: skip


def table(figures: dict[str, Any]) -> str:
    """The figures as text."""
    lines = [
        f"Console; {figures['cores']} cores, load {figures['load_before']:.1f} before; stroke to motion, "
        f"target p99 < {figures['p99_target_ms']:g} ms",
        f"{'robots':>6}  {'kB/s':>8}  {'messages/s':>10}  {'server CPU':>10}  {'frames/s':>8}  "
        f"{'p50 ms':>7}  {'p99 ms':>7}  {'worst ms':>8}",
    ]
    for case in figures["cases"]:
        traffic, latency = case["traffic"], case["latency_ms"]
        lines.append(
            f"{case['robots']:6d}  {traffic['bytes_per_s'] / 1e3:8.1f}  {traffic['messages_per_s']:10.1f}  "
            f"{traffic['cpu_share']:10.0%}  {traffic['frames_per_s']:8.1f}  "
            f"{latency['p50']:7.1f}  {latency['p99']:7.1f}  {latency['worst']:8.1f}"
        )
    return "\n".join(lines)


def summary(milliseconds: Sequence[float]) -> Latency:
    """Percentiles of latencies [ms], at least one."""
    p50, p99 = np.percentile(milliseconds, [50.0, 99.0]).tolist()
    return Latency(p50, p99, max(milliseconds), len(milliseconds))


def scenario_of(robots: int, *, fires: bool) -> str:
    """A scenario of a team in the middle of its arena, with two fires or none."""
    side = 40.0 * math.ceil(math.sqrt(robots)) + 500.0
    width, height = 1.6 * side, side
    text = _TEAM + _FIRES * fires
    return text.format(width=width, height=height, robots=robots, right=width - 80.0, top=height - 80.0)


def _written(folder: Path, robots: int, *, fires: bool) -> str:
    file = folder / f"team-{robots}{'-fires' * fires}.yaml"
    file.write_text(scenario_of(robots, fires=fires), encoding="utf-8")
    return str(file)


def _traffic(browser: Any, scenario: str, seconds: float) -> Traffic:
    with console_of(scenario) as server:
        page, watcher = ConsolePage(browser, server.url), Watcher(server.url)
        time.sleep(SETTLING_S)
        begun, cpu = time.perf_counter(), cpu_seconds(server.process)
        received, messages = watcher.received, watcher.messages
        frames = page.frame_rate(seconds)
        took = time.perf_counter() - begun
        traffic = Traffic(
            Path(scenario).stem,
            (watcher.received - received) / took,
            (watcher.messages - messages) / took,
            (cpu_seconds(server.process) - cpu) / took,
            frames,
        )
        page.close()
        watcher.close()
    return traffic


def _latency(browser: Any, scenario: str, strokes: int) -> Latency:
    with console_of(scenario) as server:
        page, watcher = ConsolePage(browser, server.url), Watcher(server.url)
        time.sleep(SETTLING_S)
        taken = [_one(page, watcher) for _ in range(strokes)]
        page.close()
        watcher.close()
    return summary(taken)


def _one(page: ConsolePage, watcher: Watcher) -> float:
    """One stroke from rest to motion [ms]; the run is set back behind it."""
    watcher.forget()
    ended = page.stroke(_WIDTH)
    end = time.monotonic() + _PATIENCE_S
    while (moved := first_motion(watcher.frames(), ended)) is None:
        if time.monotonic() > end:
            raise HigvfError(f"no robot moved within {_PATIENCE_S:g} s of a stroke")
        time.sleep(0.01)
    page.reset()
    _wait_until_still(watcher)
    return 1e3 * (moved - ended)


def _wait_until_still(watcher: Watcher) -> None:
    end = time.monotonic() + _PATIENCE_S
    while time.monotonic() < end:
        since = time.time()
        watcher.forget()
        time.sleep(_STILL_S)
        if first_motion(watcher.frames(), since) is None:
            return
    raise HigvfError(f"the team does not stand {_PATIENCE_S:g} s after a reset of the run")
