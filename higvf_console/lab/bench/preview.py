"""Cost of the preview: speed of its simulation, previews per second, and its effect on the control loop.

The lateness of a control period is the time by which it begins later than one period after its predecessor. A session
with a growing stroke runs in real time twice: without and with the thread that computes previews.
"""

import time
from collections.abc import Sequence
from itertools import pairwise
from threading import Event as Signal
from threading import Thread
from typing import Any, NamedTuple

import numpy as np

from higvf_console.analysis.preview import USUAL, foresee, wish
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.command import CONSOLE
from higvf_console.core.commands import OperatorCommand, StrokeBegin, StrokeEnd, StrokePoints
from higvf_console.core.interface import Capabilities, ChannelHealth, ChannelState, OperatorContext
from higvf_console.core.numbers import grouped
from higvf_console.core.state import SimState
from higvf_console.lab.bench.timing import take_turns
from higvf_console.operator.reducer import apply_command
from higvf_console.runtime.background.previewer import Previewer
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import load_scenario, parse_scenario
from higvf_console.sim.simulation import roll
from higvf_console.sim.warm_up import warm_up
from higvf_console.world.setup import Setup

ROBOTS = 10
_ROLLED = 60.0  # [s]
_STROKE_LASTS = 4.0  # duration of the stroke [s]
_EDGES = (0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, float("inf"))  # bin edges of the histogram [ms]
_SETTLING = 50  # first control periods, not counted because of first calls

_SCENARIO = f"""
version: 1
arena: {{size_m: [1200, 700], walls: true}}
robots: {{count: {ROBOTS}, spacing_m: 40, jitter_m: 5}}
fires:
  - {{at_m: [150, 150], radius_m: 20, robots_needed: 2}}
  - {{at_m: [1050, 550], radius_m: 25, robots_needed: 2}}
obstacles:
  circles:
    - {{at_m: [300, 500], radius_m: 20}}
    - {{at_m: [900, 200], radius_m: 20}}
duration_s: 600
"""


class Lateness(NamedTuple):
    """Lateness of control periods [ms].

    Attributes:
        p50: median.
        p99: 99th percentile.
        p999: 99.9th percentile.
        worst: maximum.
        periods: number of periods counted.
        previews_per_s: previews finished per second.
        histogram: counts between `_EDGES`.
    """

    p50: float
    p99: float
    p999: float
    worst: float
    periods: int
    previews_per_s: float
    histogram: tuple[int, ...]


class PreviewBench(NamedTuple):
    """The results of the suite.

    Attributes:
        realtime_factor: simulated seconds per second, for one rollout of the firefighting scenario.
        previews_per_s: previews of the usual horizon per second (path, rollouts with and without it), `ROBOTS` robots.
        period_ms: control period [ms].
        without: lateness without previews.
        with_preview: lateness while a thread computes previews.
    """

    realtime_factor: float
    previews_per_s: float
    period_ms: float
    without: Lateness
    with_preview: Lateness


class Sketcher:
    """An interface that draws one point per control period and never ends a stroke, so that no robot is influenced."""

    name = CONSOLE  # as which its commands are signed
    capabilities = Capabilities(draws_previewed=True)

    def __init__(self, outline: Floats) -> None:
        """Draws along `outline` (n, 2) [m] repeatedly."""
        self._outline, self._next = outline, 0

    def poll(self, context: OperatorContext) -> Sequence[OperatorCommand]:  # noqa: ARG002
        """The next point; a new stroke begins at the end of the outline."""
        point = StrokePoints(points=self._outline[self._next : self._next + 1])
        commands: list[OperatorCommand] = [point] if self._next else [StrokeBegin(), point]
        self._next = (self._next + 1) % len(self._outline)
        return commands

    def health(self, now: float) -> ChannelHealth:  # noqa: ARG002
        """Always live."""
        return ChannelHealth(ChannelState.LIVE, "draws")

    def close(self) -> None:
        """Does nothing: the interface holds no resources."""


def run(seconds: float = 30.0) -> PreviewBench:
    """Runs the suite; each of the two real-time runs takes `seconds`."""
    factor = _realtime_factor(load_scenario("firefighting").setup())
    scenario = parse_scenario(_SCENARIO, "the benchmark's scenario")
    setup = scenario.setup()
    warm_up(setup.start, setup.world, setup.params)
    outline = _outline(round(_STROKE_LASTS / setup.params.safety.control_period))
    drawn = _drawn(setup, outline)
    spent = take_turns({"preview": lambda _: _preview(drawn, setup)})["preview"]
    late = [_lateness(Session(scenario, [Sketcher(outline)]), ahead, seconds) for ahead in (False, True)]
    return PreviewBench(factor, 1e3 / spent, 1e3 * setup.params.safety.control_period, *late)


def plain(bench: PreviewBench) -> dict[str, Any]:
    """The results, ready for JSON."""
    without, with_preview = (
        {**late._asdict(), "histogram": [[edge, count] for edge, count in zip(_EDGES, late.histogram, strict=False)]}
        for late in (bench.without, bench.with_preview)
    )
    return {
        "suite": "preview",
        "realtime_factor": bench.realtime_factor,
        "previews_per_s": bench.previews_per_s,
        "robots": ROBOTS,
        "horizon_s": USUAL,
        "period_ms": bench.period_ms,
        "lateness_ms": {"without_preview": without, "with_preview": with_preview},
    }


def table(bench: PreviewBench) -> str:
    """The results as text."""
    edges = [f"{edge:g}" for edge in _EDGES]
    bins = [f"{low} to {high} ms" for low, high in pairwise(edges)]
    lines = [
        f"Rollout of the firefighting scenario: {grouped(bench.realtime_factor)} times real time",
        f"Previews of {USUAL:g} s with {ROBOTS} robots: {bench.previews_per_s:.1f} per second",
        f"Lateness of a control period of {bench.period_ms:g} ms while a stroke grows:",
        f"{'':>14}{'no preview':>12}{'preview':>12}",
    ]
    for name in ("p50", "p99", "p999", "worst"):
        pair = (getattr(bench.without, name), getattr(bench.with_preview, name))
        lines.append(f"{name + ' ms':>14}" + "".join(f"{value:12.3f}" for value in pair))
    for counts in zip(bins, bench.without.histogram, bench.with_preview.histogram, strict=True):
        lines.append(f"{counts[0]:>14}{counts[1]:12d}{counts[2]:12d}")
    lines.append(f"The thread finished {bench.with_preview.previews_per_s:.1f} previews per second")
    return "\n".join(lines)


def _realtime_factor(setup: Setup) -> float:
    ticks = round(_ROLLED / setup.params.safety.control_period)
    state = _drawn(setup, _outline(50))
    wished = apply_command(state, StrokeEnd(), setup)[0]
    spent = take_turns({"roll": lambda _: roll(wished, setup.world, setup.params, ticks)})["roll"]
    return 1e3 * _ROLLED / spent


def _outline(points: int) -> Floats:
    """A sine wave (points, 2) across the arena [m]."""
    x = np.linspace(650.0, 1050.0, points)
    return floats(np.stack([x, 350.0 + 120.0 * np.sin(x / 80.0)], axis=1))


def _drawn(setup: Setup, outline: Floats) -> SimState:
    state = apply_command(setup.start, StrokeBegin(), setup)[0]
    return apply_command(state, StrokePoints(points=outline), setup)[0]


def _preview(state: SimState, setup: Setup) -> None:
    wished = wish(state, setup)
    assert wished is not None
    foresee(state, wished, setup)


def _lateness(session: Session, ahead: bool, seconds: float) -> Lateness:
    """Runs a session in real time and measures the lateness; runs longer if fewer than 100 periods have begun."""
    begun: list[float] = []
    tick = session.tick

    def noted(*, advance: bool = True) -> None:
        begun.append(time.perf_counter())
        tick(advance=advance)

    session.tick = noted  # pyright: ignore[reportAttributeAccessIssue]
    stopping, previewer = Signal(), Previewer(session)
    if ahead:
        previewer.start()
    loop = Thread(target=session.run, args=(stopping,))
    loop.start()
    start = time.perf_counter()
    while (lasted := time.perf_counter() - start) < seconds or (len(begun) < 2 * _SETTLING and loop.is_alive()):
        time.sleep(0.05)
    stopping.set()
    loop.join()
    previewer.close()
    session.close()
    period = session.setup.params.safety.control_period
    late = 1e3 * np.maximum(np.diff(begun)[_SETTLING:] - period, 0.0)
    p50, p99, p999 = np.percentile(late, [50.0, 99.0, 99.9]).tolist()
    counts = np.histogram(late, _EDGES)[0].tolist()
    return Lateness(p50, p99, p999, float(late.max()), len(late), previewer.count / lasted, tuple(counts))
