"""Dispersion-based fixation detection (I-DT): the longest runs of gaze that stay within a small window.

Salvucci and Goldberg, "Identifying fixations and saccades in eye-tracking protocols", ETRA 2000. A window of the
shortest duration slides until the dispersion is within the limit, then grows while it stays within the limit.
"""

import numpy as np

from higvf_console.core.arrays import Bools, Floats, Ints, bools, ints

_STEP = 64  # samples by which a run grows at first


def still_stretches(
    time: Floats, points: Floats, steady: Bools, within: float, shortest: float, longest_gap: float
) -> tuple[Ints, Ints]:
    """Find the runs of samples whose dispersion (width plus height) stays within a limit.

    Args:
        time: (n,) strictly increasing [s].
        points: (n, 2) [px]; finite where `steady`.
        steady: (n,) samples that may belong to a fixation; any other sample ends a run.
        within: limit of the dispersion [px].
        shortest: minimum duration of a run [s].
        longest_gap: a longer gap in time ends a run [s].

        Returns:
            Indices of the first and last sample of each run, (m,) each.
    """
    firsts: list[int] = []
    lasts: list[int] = []
    for start, stop in zip(*_unbroken(time, steady, longest_gap), strict=True):
        begin = start
        while begin <= stop:
            last = int(np.searchsorted(time, time[begin] + shortest))  # pyright: ignore[reportUnknownArgumentType]
            if last > stop:
                break
            if _dispersion(points[begin : last + 1]) > within:
                begin += 1
                continue
            last = _grown(points, begin, last, stop, within)
            firsts.append(begin)
            lasts.append(last)
            begin = last + 1
    return ints(firsts), ints(lasts)


def covered(count: int, first: Ints, last: Ints) -> Bools:
    """Return whether each of `count` samples lies in a run from `first` to `last` inclusive."""
    edges = np.zeros(count + 1, dtype=np.int64)
    np.add.at(edges, first, 1)
    np.add.at(edges, last + 1, -1)
    return bools(np.cumsum(edges)[:-1] > 0)


def _unbroken(time: Floats, steady: Bools, longest_gap: float) -> tuple[list[int], list[int]]:
    padded = np.concatenate([[False], steady, [False]])
    broken = np.concatenate([[False], np.diff(time) > longest_gap, [False]])
    starts = np.flatnonzero(padded[1:] & (~padded[:-1] | broken))
    stops = np.flatnonzero(padded[:-1] & (~padded[1:] | broken)) - 1
    return starts.tolist(), stops.tolist()


def _dispersion(points: Floats) -> float:
    return float(np.ptp(points, axis=0).sum())


def _grown(points: Floats, begin: int, last: int, stop: int, within: float) -> int:
    """Return the last sample of the longest run from `begin` that stays within the limit."""
    low, high, step = points[begin : last + 1].min(axis=0), points[begin : last + 1].max(axis=0), _STEP
    while last < stop:
        more = points[last + 1 : min(last + step, stop) + 1]
        lows = np.minimum(low, np.minimum.accumulate(more))
        highs = np.maximum(high, np.maximum.accumulate(more))
        out = np.flatnonzero((highs - lows).sum(axis=1) > within)
        if len(out):
            return last + int(out[0])
        low, high, last, step = lows[-1], highs[-1], last + len(more), 2 * step
    return stop
