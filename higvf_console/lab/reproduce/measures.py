"""Measures of a run: distance to the path, laps, formation error, order of the fires, clearance."""

import math

import numpy as np

from higvf_console.control.guidance.paths import EVERYWHERE, nearest
from higvf_console.core.arrays import Bools, Floats
from higvf_console.core.state import Path
from higvf_console.lab.reproduce.runs import Run


def path_distance(path: Path, points: Floats) -> Floats:
    """Distances (n,) of points (n, 2) to a path [m]."""
    return np.array([math.dist(p, nearest(path, 0.0, EVERYWHERE, p[0], p[1])[1:3]) for p in points.tolist()])


def leader_track(run: Run) -> Floats:
    """Positions (T + 1, 2) of the influenced robot, also when it changes [m]."""
    return run.position[np.arange(len(run.time)), run.influenced]


def settled_at(time: Floats, error: Floats, band: float) -> float:
    """Time from which `error` (n,) stays within `band` [s]; inf if it never does."""
    outside = np.flatnonzero(error > band)
    if not len(outside):
        return float(time[0])
    return float(time[outside[-1] + 1]) if outside[-1] + 1 < len(time) else math.inf


def laps(path: Path, points: Floats) -> float:
    """Number of laps of a track (n, 2) along a circular path, in its direction."""
    angle = np.unwrap(np.arctan2(points[:, 1] - path.shape[1], points[:, 0] - path.shape[0]))
    return float(path.direction * (angle[-1] - angle[0]) / (2.0 * math.pi))


def formation_error(run: Run) -> Floats:
    """Formation error (T + 1,): root mean square of |p_i - p_j| - d_ij over all pairs [m]."""
    return np.sqrt(np.mean((pair_distances(run.position) - pair_distances(run.setup.world.formation)) ** 2, axis=-1))


def formation_size(run: Run) -> float:
    """Mean of the desired distances d_ij [m]."""
    return float(pair_distances(run.setup.world.formation).mean())


def pair_distances(position: Floats) -> Floats:
    """Distances (..., pairs) between all pairs of robots at (..., N, 2) [m]."""
    first, second = np.triu_indices(position.shape[-2], 1)
    gap = position[..., first, :] - position[..., second, :]
    return np.hypot(gap[..., 0], gap[..., 1])


def extinguished_at(run: Run) -> Floats:
    """Time (M,) at which each fire went out [s]; inf if it burns at the end."""
    out = np.full(run.burning.shape[1], math.inf)
    for fire in range(len(out)):
        gone = np.flatnonzero(~run.burning[:, fire])
        if len(gone):
            out[fire] = run.time[gone[0]]
    return out


def order(run: Run) -> tuple[int, ...]:
    """Numbers of the fires, from 1, in the order in which they went out."""
    return tuple(run.report["extinguished"])


def intervals(flags: Bools) -> list[tuple[int, int]]:
    """First and last index of each interval of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int64)))
    return [(int(a), int(b) - 1) for a, b in edges.reshape(-1, 2)]


def smallest_clearance(run: Run) -> float:
    """Minimum clearance to all hazards and between robots over the run [m]; negative = violation."""
    pairs = pair_distances(run.position)
    apart = float(pairs.min()) - run.setup.params.safety.robot_clearance if pairs.size else math.inf
    return min(float(run.clearance.min()), apart)
