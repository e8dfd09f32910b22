"""How a benchmark measures: contenders take turns in one run, so that a noisy machine is equally noisy to all."""

import statistics
import time
from collections.abc import Callable, Mapping
from typing import NamedTuple

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
