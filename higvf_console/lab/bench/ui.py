"""Cost and latency of the console: network traffic, CPU, frame rate, latency from stroke to motion.

A console runs in its own process with two clients: a page with control in headless Chromium, and a headless client that
reads as fast as the console sends (`lab.bench.viser_client`). All three share this machine.

bytes and messages   received per second by the headless client while the team moves
server CPU           CPU time of the console's process, engine included, as a share of one core
frames               animation frames of the page per second; without a graphics card, the CPU draws them
latency              from the dispatch of the last pointer event of a stroke (clock of the page) to the first message
                     with new robot positions at the headless client (clock of the system), for a team at rest. It
                     includes the script of the page, the loopback in both directions, the wait for the control period,
                     the view, and contention for the CPU. It excludes the delay of a pointing device and the drawing
                     of what has arrived
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
from higvf_console.lab.bench.console_page import ConsolePage, console_of, cpu_seconds, open_browser
from higvf_console.lab.bench.viser_client import ViserClient, first_motion

TEAMS = (3, 100, 1000)
STROKES = 40  # timed for each team
SETTLING_S, MEASURED_S = 4.0, 10.0
PERIOD_MS, VIEW_MS = 1e3 * SafetyParameters().control_period, 33.0
TARGET_P99_MS = 2.0 * PERIOD_MS + VIEW_MS
_STILL_S = 0.4  # time without motion after which a team is at rest
_TIMEOUT_S = 10.0
_WIDTH = 0.2  # width of a stroke, as a share of the canvas

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
_SHIPPED = {3: "firefighting", 1000: "swarm"}  # scenarios whose fires keep the team moving


class Traffic(NamedTuple):
    """Cost of showing a moving team.

    Attributes:
        scenario: name of the scenario.
        bytes_per_s: bytes per second from the server to one client.
        messages_per_s: messages per second from the server to one client.
        cpu_share: CPU time of the server, as a share of one core.
        frames_per_s: frame rate of the page.
    """

    scenario: str
    bytes_per_s: float
    messages_per_s: float
    cpu_share: float
    frames_per_s: float


class Latency(NamedTuple):
    """Latency from the end of a stroke to the first message with motion [ms].

    Attributes:
        p50: median.
        p99: 99th percentile; close to the maximum for fewer than 100 strokes.
        worst: maximum.
        strokes: number of strokes timed.
    """

    p50: float
    p99: float
    worst: float
    strokes: int


def run(teams: Sequence[int] = TEAMS, strokes: int = STROKES, seconds: float = MEASURED_S) -> dict[str, Any]:
    """Runs the suite and returns its figures.

    Args:
        teams: numbers of robots.
        strokes: number of strokes timed for each team.
        seconds: duration of the traffic measurement [s].

    Raises:
        HigvfError: Playwright, Chromium or /proc is missing, or the console does not start or respond.
    """
    load = os.getloadavg()[0]
    cases: list[dict[str, Any]] = []
    with open_browser() as browser, tempfile.TemporaryDirectory() as folder:
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
        f"Console on {figures['cores']} cores, load {figures['load_before']:.1f} before; latency from stroke to "
        f"motion, target p99 < {figures['p99_target_ms']:g} ms",
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
    """Percentiles of one or more latencies [ms]."""
    p50, p99 = np.percentile(milliseconds, [50.0, 99.0]).tolist()
    return Latency(p50, p99, max(milliseconds), len(milliseconds))


def scenario_of(robots: int, *, fires: bool) -> str:
    """The YAML text of a scenario with a team in the middle of its arena, with two fires or none."""
    height = 40.0 * math.ceil(math.sqrt(robots)) + 500.0
    width = 1.6 * height
    text = _TEAM + _FIRES * fires
    return text.format(width=width, height=height, robots=robots, right=width - 80.0, top=height - 80.0)


def _written(folder: Path, robots: int, *, fires: bool) -> str:
    file = folder / f"team-{robots}{'-fires' * fires}.yaml"
    file.write_text(scenario_of(robots, fires=fires), encoding="utf-8")
    return str(file)


def _traffic(browser: Any, scenario: str, seconds: float) -> Traffic:
    with console_of(scenario) as server:
        page, client = ConsolePage(browser, server.url), ViserClient(server.url)
        time.sleep(SETTLING_S)
        begun, cpu = time.perf_counter(), cpu_seconds(server.process)
        received, messages = client.received, client.messages
        frames = page.frame_rate(seconds)
        took = time.perf_counter() - begun
        traffic = Traffic(
            Path(scenario).stem,
            (client.received - received) / took,
            (client.messages - messages) / took,
            (cpu_seconds(server.process) - cpu) / took,
            frames,
        )
        page.close()
        client.close()
    return traffic


def _latency(browser: Any, scenario: str, strokes: int) -> Latency:
    with console_of(scenario) as server:
        page, client = ConsolePage(browser, server.url), ViserClient(server.url)
        time.sleep(SETTLING_S)
        taken = [_one(page, client) for _ in range(strokes)]
        page.close()
        client.close()
    return summary(taken)


def _one(page: ConsolePage, client: ViserClient) -> float:
    """Latency of one stroke by a team at rest [ms]; the run is reset afterwards."""
    client.forget()
    ended = page.stroke(_WIDTH)
    end = time.monotonic() + _TIMEOUT_S
    while (moved := first_motion(client.frames(), ended)) is None:
        if time.monotonic() > end:
            raise HigvfError(f"no robot moved within {_TIMEOUT_S:g} s after a stroke")
        time.sleep(0.01)
    page.reset()
    _wait_until_still(client)
    return 1e3 * (moved - ended)


def _wait_until_still(client: ViserClient) -> None:
    end = time.monotonic() + _TIMEOUT_S
    while time.monotonic() < end:
        since = time.time()
        client.forget()
        time.sleep(_STILL_S)
        if first_motion(client.frames(), since) is None:
            return
    raise HigvfError(f"the team is not at rest {_TIMEOUT_S:g} s after a reset of the run")
