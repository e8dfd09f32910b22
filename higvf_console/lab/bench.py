"""Benchmarks: medians of contenders that take turns in one run, so that a noisy machine is equally noisy to all.

Compare the ratios; the milliseconds are this machine's.
"""

import json
import statistics
import time
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from higvf_console.errors import HigvfError

_LEAST_ROUNDS = 15
_MOST_ROUNDS = 400


class Case(NamedTuple):
    """One line of a suite's table.

    Attributes:
        scene: what is measured.
        robots: N.
        milliseconds: median of each contender; None where it is not installed [ms].
        facts: further numbers, by name.
    """

    scene: str
    robots: int
    milliseconds: Mapping[str, float | None]
    facts: Mapping[str, float]


class Suite(NamedTuple):
    """A benchmark: what its table is called, what the contenders are compared with, and its cases."""

    title: str
    yardstick: str
    cases: tuple[Case, ...]


def main(suite: str, as_json: bool) -> None:
    """Runs a suite and prints its table, or one JSON object."""
    print(run_suite(suite, as_json))


def run_suite(name: str, as_json: bool) -> str:
    """The table of a suite, or its JSON.

    Raises:
        HigvfError: no such suite; the message lists them.
    """
    suites = _suites()
    if name not in suites:
        raise HigvfError(f"no benchmark suite {name!r}; choose {', '.join(suites)}")
    suite = suites[name]()
    return json.dumps(_plain(name, suite), indent=2) if as_json else _table(suite)


def take_turns(
    contenders: Mapping[str, Callable[[int], object]],
    prepare: Mapping[str, Callable[[int], object]] | None = None,
    seconds: float = 1.0,
) -> dict[str, float]:
    """Median time of each contender [ms]; all are called once a round, with the number of the round.

    Args:
        contenders: by name; called once before, so that compilation and set-up are over.
        prepare: what to call, untimed, before a contender of the same name.
        seconds: how long to go on, within 15 to 400 rounds.
    """
    prepare = prepare or {}
    times: dict[str, list[float]] = {name: [] for name in contenders}
    for call in contenders.values():
        call(0)
    end = time.perf_counter() + seconds
    for turn in range(1, _MOST_ROUNDS + 1):
        for name, call in contenders.items():
            if name in prepare:
                prepare[name](turn)
            start = time.perf_counter()
            call(turn)
            times[name].append(time.perf_counter() - start)
        if turn >= _LEAST_ROUNDS and time.perf_counter() > end:
            break
    return {name: 1e3 * statistics.median(taken) for name, taken in times.items()}


def _suites() -> dict[str, Callable[[], Suite]]:
    from higvf_console.lab import bench_filter, bench_tick  # noqa: PLC0415 (they use this module)

    return {"filter": bench_filter.run, "tick": bench_tick.run}


def _plain(name: str, suite: Suite) -> dict[str, Any]:
    cases = [
        {
            "scene": case.scene,
            "robots": case.robots,
            "median_ms": dict(case.milliseconds),
            f"ratio_to_{suite.yardstick}": {
                contender: None if taken is None else taken / _own(suite, case)
                for contender, taken in case.milliseconds.items()
            },
            **case.facts,
        }
        for case in suite.cases
    ]
    return {"suite": name, "title": suite.title, "cases": cases}


def _own(suite: Suite, case: Case) -> float:
    own = case.milliseconds[suite.yardstick]
    assert own is not None
    return own


def _table(suite: Suite) -> str:
    """Milliseconds, and in brackets how many times the yardstick's."""
    first = suite.cases[0]
    head = ["scene", "robots", *first.milliseconds, *first.facts]
    lines = [head]
    for case in suite.cases:
        own = _own(suite, case)
        times = [
            f"{taken:.3f}" + (f" ({taken / own:.1f}x)" if name != suite.yardstick else "")
            if taken is not None
            else "not installed"
            for name, taken in case.milliseconds.items()
        ]
        lines.append([case.scene, str(case.robots), *times, *(f"{fact:.3g}" for fact in case.facts.values())])
    widths = [max(len(line[column]) for line in lines) for column in range(len(head))]
    rows = ["  ".join(cell.rjust(width) for cell, width in zip(line, widths, strict=True)) for line in lines]
    return "\n".join([f"{suite.title}; median ms, in brackets times {suite.yardstick}", *rows])
