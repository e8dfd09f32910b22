"""Interleaved timing: contenders take turns in one run, so that machine noise affects all of them equally."""

import statistics
import time
from collections.abc import Callable, Mapping
from typing import NamedTuple

_LEAST_ROUNDS = 15
_MOST_ROUNDS = 400


class Case(NamedTuple):
    """One line of a suite's table.

    Attributes:
        scene: name of the measured scene.
        robots: number of robots.
        milliseconds: median of each contender [ms]; None if it is not installed.
        facts: further numbers, by name.
    """

    scene: str
    robots: int
    milliseconds: Mapping[str, float | None]
    facts: Mapping[str, float]


class Suite(NamedTuple):
    """A benchmark.

    Attributes:
        title: heading of its table.
        reference: name of the contender that the others are compared with.
        cases: one for each line of the table.
    """

    title: str
    reference: str
    cases: tuple[Case, ...]


def take_turns(
    contenders: Mapping[str, Callable[[int], object]],
    prepare: Mapping[str, Callable[[int], object]] | None = None,
    seconds: float = 1.0,
) -> dict[str, float]:
    """Measures the median time of each contender [ms]; every round calls each of them once with its number.

    Args:
        contenders: by name; each is called once before timing starts, for compilation and set-up.
        prepare: called untimed before the contender of the same name.
        seconds: length of the measurement [s], limited to 15 to 400 rounds.
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
