"""Does a long run need more and more? Memory, handles and threads over time, see `lab.bench.usage`.

robots      1 000 robots live; the page in control draws a stroke every few seconds
observers   50 more pages watch a small team; one of them reloads each second
headless    simulated hours, as fast as they can be computed; a channel picks robots and draws

Live consoles run in processes of their own, and in real time.
"""

import math
import multiprocessing
import tempfile
from collections.abc import Sequence
from itertools import count
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from higvf_console.core.arguments import one_of
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import OperatorCommand, Pick, StrokeBegin, StrokeEnd, StrokePoints
from higvf_console.core.errors import HigvfError
from higvf_console.core.interface import Capabilities, ChannelHealth, ChannelState, OperatorContext
from higvf_console.core.numbers import grouped
from higvf_console.core.optional import require
from higvf_console.lab.bench.console_page import console_of
from higvf_console.lab.bench.usage import RULE, Trends, Usage, sample, trends
from higvf_console.runtime.headless import run_headless
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import parse_scenario
from higvf_console.sim.warm_up import warm_up

MINUTES, HOURS = 2.0, 1.0
ROBOTS, OBSERVERS = 1000, 50
CASES = ("robots", "observers", "headless")
_TEAM = 10  # robots of the other cases
_PICK_EVERY = 25  # control periods of a headless run
_STROKE_EVERY_PICKS = 20

_SCENARIO = """
version: 1
arena: {{size_m: [{width}, {height}], walls: true}}
robots: {{count: {robots}, spacing_m: 40, jitter_m: 5}}
fires:
  - {{at_m: [80, 80], radius_m: 20, growth_m_per_s: 0, robots_needed: {robots}}}
  - {{at_m: [{right}, {top}], radius_m: 20, growth_m_per_s: 0, robots_needed: {robots}}}
parameters:
  formation: {{communication_range: 60}}
ends: {{when: never}}
duration_s: 60
"""


class Case(NamedTuple):
    """What was measured.

    Attributes:
        name: of `CASES`.
        title: what ran.
        seconds: that were sampled [s].
        samples: how many there are.
        trends: of memory, handles and threads.
    """

    name: str
    title: str
    seconds: float
    samples: int
    trends: Trends


def run(minutes: float = MINUTES, hours: float = HOURS, cases: Sequence[str] = CASES) -> list[Case]:
    """Runs the suite.

    Args:
        minutes: for which each of the live cases runs.
        hours: that the headless case simulates.
        cases: those of `CASES` to run.

    Raises:
        HigvfError: no such case; a console does not start, ends, or closes a page; or the system has no /proc.
    """
    for case in cases:
        one_of("case", case, CASES, HigvfError)
    measured: list[Case] = []
    for case in cases:
        match case:
            case "robots":
                measured.append(live(case, ROBOTS, 0, 60.0 * minutes))
            case "observers":
                measured.append(live(case, _TEAM, OBSERVERS, 60.0 * minutes))
            case _:
                measured.append(headless(hours))
    return measured


def flat(cases: Sequence[Case]) -> bool:
    """Whether nothing rises in any case."""
    return all(case.trends.flat for case in cases)


def plain(cases: Sequence[Case]) -> dict[str, Any]:
    """The results, ready for JSON."""
    return {
        "suite": "endurance",
        "rule": RULE,
        "flat": flat(cases),
        "cases": [
            {
                "case": case.name,
                "title": case.title,
                "seconds": round(case.seconds, 1),
                "samples": case.samples,
                "flat": case.trends.flat,
                "memory_mb": case.trends.memory._asdict(),
                "handles": case.trends.handles._asdict(),
                "threads": case.trends.threads._asdict(),
            }
            for case in cases
        ],
    }


def table(cases: Sequence[Case]) -> str:
    """The results as text."""
    lines = [f"Flat: {RULE}"]
    for case in cases:
        lines.append(f"{case.title}: {case.samples} samples in {case.seconds:.0f} s")
        for name, found in zip(("memory [MB]", "handles", "threads"), case.trends, strict=True):
            verdict = "flat" if found.flat else "NOT FLAT"
            lines.append(
                f"{name:>14}  mean {found.mean:9.2f}  slope {found.per_hour:+10.3f} per hour  "
                f"rise {found.rise:+9.3f}  {verdict}"
            )
    return "\n".join(lines)


def scenario_of(robots: int) -> str:
    """The YAML text of a scenario that never ends: fires that take the whole team, which starts between them.

    Its duration limits the run without an operator, which the console computes beside the first minute.
    """
    width, height = _arena(robots)
    return _SCENARIO.format(width=width, height=height, robots=robots, right=width - 80.0, top=height - 80.0)


def outline_of(robots: int, turn: int) -> Floats:
    """A stroke (20, 2) [m] across the arena of `scenario_of`; another one each turn."""
    share = np.linspace(0.2, 0.8, 20)[:: 1 if turn % 2 else -1]
    wave = 0.5 + 0.2 * np.sin(2.0 * np.pi * (share + 0.1 * turn))
    return floats(np.stack([share, wave], axis=1) * _arena(robots))


def _arena(robots: int) -> tuple[float, float]:
    height = 40.0 * math.ceil(math.sqrt(robots)) + 500.0
    return 1.6 * height, height


def live(name: str, robots: int, observers: int, seconds: float) -> Case:
    """Runs a console with a page in control and so many observers.

    Args:
        name: of the case.
        robots: of the team.
        observers: pages that watch.
        seconds: for which it is sampled [s].

    Raises:
        HigvfError: as for `run`.
    """
    require("viser", "console", "suite endurance")
    from higvf_console.lab.bench.live_pages import LivePages  # noqa: PLC0415 (needs viser)

    with tempfile.TemporaryDirectory() as folder:
        scenario, tokens = Path(folder) / "endurance.yaml", Path(folder) / "tokens"
        scenario.write_text(scenario_of(robots), encoding="utf-8")
        seats = 2 * (observers + 1)  # a quarter is kept for those who may steer
        options = ("--pages", str(seats), "--token-file", str(tokens))
        with console_of(str(scenario), *options) as server:
            secrets = dict(line.split() for line in tokens.read_text(encoding="utf-8").splitlines())
            watching = server.url.replace(secrets["experimenter"], secrets["observer"])
            with LivePages(server.url, watching, observers) as pages:
                strokes = (outline_of(robots, turn) for turn in count())
                pages.fill_history(strokes)
                samples = sample(server.process, lambda now: now < seconds, each=lambda: pages.act(strokes))
    return _case(name, f"{robots} robots live, {observers} observers", samples)


def headless(hours: float, period: float = 1.0) -> Case:
    """Simulates so many hours in a process of its own.

    Args:
        hours: of simulated time.
        period: from one sample to the next [s].

    Raises:
        HigvfError: as for `run`.
    """
    processes = multiprocessing.get_context("spawn")
    ours, theirs = processes.Pipe()
    process = processes.Process(target=simulate, args=(hours, theirs), daemon=True)
    process.start()
    assert process.pid is not None
    try:
        _wait_for(ours, process)  # it has begun
        samples = sample(process.pid, lambda _: not ours.poll(), period=period)
        ticks = _wait_for(ours, process)
    finally:
        process.terminate()
        process.join()
    return _case("headless", f"{grouped(ticks)} control periods ({hours:g} h) headless", samples)


def _wait_for(pipe: "Connection[object, int]", process: BaseProcess) -> int:
    while not pipe.poll(1.0):
        if not process.is_alive():
            raise HigvfError(f"suite endurance: the headless run has ended with status {process.exitcode}")
    return pipe.recv()


def simulate(hours: float, pipe: "Connection[int, object]") -> None:
    """Runs headless; tells when it begins, and the control periods that it took; stays until it is ended."""
    scenario = parse_scenario(scenario_of(_TEAM), "the benchmark's scenario")
    session = Session(scenario, [Operator()])
    warm_up(session.setup.start, session.setup.world, session.setup.params)
    pipe.send(0)
    report = run_headless(session, 3600.0 * hours)
    pipe.send(report["ticks"])
    pipe.recv()


class Operator:
    """An interface that picks a robot twice a second, and draws a stroke every ten seconds."""

    name = "script"
    capabilities = Capabilities()

    def __init__(self) -> None:
        """Starts with the first robot."""
        self._polled = 0

    def poll(self, context: OperatorContext) -> Sequence[OperatorCommand]:
        """What it does in this control period."""
        self._polled += 1
        turn, rest = divmod(self._polled, _PICK_EVERY)
        if rest:
            return ()
        pick = Pick(turn % context.robots)
        if turn % _STROKE_EVERY_PICKS:
            return (pick,)
        outline = outline_of(context.robots, turn // _STROKE_EVERY_PICKS)
        return pick, StrokeBegin(), StrokePoints(points=outline), StrokeEnd()

    def health(self, now: float) -> ChannelHealth:  # noqa: ARG002
        """Always live."""
        return ChannelHealth(ChannelState.LIVE, "picks and draws")

    def close(self) -> None:
        """Does nothing: the interface holds no resources."""


def _case(name: str, title: str, samples: Sequence[Usage]) -> Case:
    return Case(name, title, samples[-1].time - samples[0].time, len(samples), trends(samples))
