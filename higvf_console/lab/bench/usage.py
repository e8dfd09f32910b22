"""What a process uses over time, and whether that stays flat.

Resident memory, open handles and threads of a process and of those that it started are read from /proc once a second.
After a warm-up, a line of least squares is fitted to each of them; `Trend` has the rule by which it is flat.
"""

import os
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import HigvfError

WARM_UP = 0.25  # share of the time that is left out at the beginning
MEMORY_RISE = 0.01  # of its mean, that memory may rise by
COUNT_RISE = 1.0  # that a number of handles or threads may rise by
RULE = (
    f"after the first {100 * WARM_UP:.0f} % of the time, the line of least squares rises by less than "
    f"{100 * MEMORY_RISE:.0f} % of the "
    f"mean (memory) or by less than {COUNT_RISE:g} (handles, threads)"
)
_MEGABYTE = 1e6


class Usage(NamedTuple):
    """What a process and its descendants use at one time.

    Attributes:
        time: [s], of the monotonic clock.
        memory: resident [MB]; what processes share counts for each of them.
        handles: open file descriptors.
        threads: number of threads.
    """

    time: float
    memory: float
    handles: float
    threads: float


class Trend(NamedTuple):
    """The line of least squares through one of them.

    Attributes:
        mean: of the samples after the warm-up.
        per_hour: slope of the line [1/h].
        rise: of the line, over the time after the warm-up.
        flat: whether it rises by less than is allowed. A line that falls is flat.
    """

    mean: float
    per_hour: float
    rise: float
    flat: bool


class Trends(NamedTuple):
    """Of everything that is sampled.

    Attributes:
        memory: [MB].
        handles: open file descriptors.
        threads: number of threads.
    """

    memory: Trend
    handles: Trend
    threads: Trend

    @property
    def flat(self) -> bool:
        """Whether all of them are."""
        return all(trend.flat for trend in self)


def usage_of(process: int) -> Usage:
    """What a process, and those that it started, use now.

    Raises:
        HigvfError: there is no such process, or the system has no /proc.
    """
    try:
        memory, handles, threads = _own_usage(process)
    except OSError as error:
        raise HigvfError(f"suite endurance reads process {process} in /proc, which only Linux has ({error})") from error
    for child in _descendants(process):
        with suppress(OSError):  # it has ended
            more = _own_usage(child)
            memory, handles, threads = memory + more[0], handles + more[1], threads + more[2]
    return Usage(time.monotonic(), memory, handles, threads)


def _own_usage(process: int) -> tuple[float, float, float]:
    folder = Path(f"/proc/{process}")
    pages = int((folder / "statm").read_text(encoding="ascii").split()[1])
    memory = pages * os.sysconf("SC_PAGE_SIZE") / _MEGABYTE
    handles, threads = (sum(1 for _ in (folder / kind).iterdir()) for kind in ("fd", "task"))
    return memory, float(handles), float(threads)


def _descendants(process: int) -> list[int]:
    found: list[int] = []
    with suppress(OSError):
        for file in Path(f"/proc/{process}/task").glob("*/children"):
            with suppress(OSError):  # the thread has ended
                for child in map(int, file.read_text(encoding="ascii").split()):
                    found += [child, *_descendants(child)]
    return found


def sample(
    process: int, going_on: Callable[[float], bool], *, period: float = 1.0, each: Callable[[], object] = lambda: None
) -> list[Usage]:
    """Samples a process as long as it is asked to.

    Args:
        process: id of the process.
        going_on: whether to go on after so many seconds.
        period: from one sample to the next [s].
        each: called before each sample.

    Raises:
        HigvfError: the process has ended.
    """
    begun, samples = time.monotonic(), list[Usage]()
    while going_on(time.monotonic() - begun):
        each()
        samples.append(usage_of(process))
        time.sleep(max(0.0, begun + len(samples) * period - time.monotonic()))
    return samples


def trends(samples: Sequence[Usage]) -> Trends:
    """The trends after the warm-up.

    Raises:
        HigvfError: there are fewer than three samples after it.
    """
    table = floats(samples, -1, len(Usage._fields))
    if len(table):
        table = floats(table[table[:, 0] >= table[0, 0] + WARM_UP * (table[-1, 0] - table[0, 0])])
    if len(table) < 3:
        raise HigvfError(f"suite endurance: {len(samples)} samples are too few for a slope; measure for longer")
    times, memory, handles, threads = table.T
    return Trends(
        trend(times, memory, MEMORY_RISE * float(memory.mean())),
        trend(times, handles, COUNT_RISE),
        trend(times, threads, COUNT_RISE),
    )


def trend(times: Floats, values: Floats, allowed: float) -> Trend:
    """The line of least squares.

    Args:
        times: (n,) [s], not all the same.
        values: (n,).
        allowed: by which the line may rise over these times.
    """
    away = times - times.mean()
    slope = float(away @ values / (away @ away))
    rise = slope * float(np.ptp(times))
    return Trend(float(values.mean()), 3600.0 * slope, rise, rise < allowed)
