"""Certificates: the conditions under which the method keeps its promises, each as a number beside its limit.

sampling         barriers hold between two control steps                           known before the run
formation        explicit Euler on the formation's springs is stable               known before the run
intention map    the printed update's spectral radius; the corrected one has no limit
intention bound  |v_s| against its bound, independent of N                          each tick
connectivity     lambda_2 of the communication links: 0 = the team is split into parts without a link
barrier          the smallest h so far: never negative
"""
# SciPy's sparse graphs have no types.
# pyright: reportUnknownArgumentType=false, reportUnknownMemberType=false, reportUnknownVariableType=false

import math
from typing import NamedTuple

import numpy as np

from higvf_console.control.forms import PRINTED
from higvf_console.control.intention.intention import map_radius
from higvf_console.control.parameters import Parameters, controlled
from higvf_console.control.safety.barriers.sampling import SAMPLING_LIMIT, sampling_conditions
from higvf_console.control.safety.hazards import worst_hazards
from higvf_console.core.arrays import Floats, Ints
from higvf_console.core.state import Motion, SimState, Trace, World

FORMATION_LIMIT = 2.0  # of dt k_form 2 deg
CONNECTED = 1e-6  # lambda_2 of a connected graph is above it
DENSE = 100  # robots; lambda_2 of a larger team is found by shift and invert: 20 ms in place of 2 s for 1000
ROUNDING = 1e-9  # of a bound that is met with equality
_SAMPLING = "If it fails, a robot may violate its clearance between two control steps."
_FORMATION = "If it fails, the formation oscillates with growing amplitude."
_INTENTION = "If it fails, a shared intention is stronger than what the robots and the human put into it."
_DIVERGENT = "If it fails, the shared intention grows without limit."
_SPLIT = "If it fails, the team is split, and a part of it does not receive the human intention."
_BARRIER = "If it fails, a robot has violated its clearance in this run."
_SHIFT = -0.01  # below the least eigenvalue, 0, so that the shifted Laplacian can be inverted


class Certificate(NamedTuple):
    """One condition.

    Attributes:
        name: what is certified.
        symbol: the value as a formula.
        meaning: what its failing would mean, in one sentence.
        value: now, or the worst so far.
        limit: what it must not pass.
        least: whether the limit is the least value allowed; else the largest.
    """

    name: str
    symbol: str
    meaning: str
    value: float
    limit: float
    least: bool = False

    @property
    def met(self) -> bool:
        """Whether the condition holds, up to rounding."""
        if self.least:
            return self.value >= self.limit - ROUNDING
        return self.value <= self.limit * (1.0 + ROUNDING)


class Worst(NamedTuple):
    """The worst of a run so far.

    Attributes:
        barrier: smallest h of any robot; inf when nobody came near anything.
        intention: largest |v_s| over its bound of the same tick.
    """

    barrier: float = math.inf
    intention: float = 0.0


def watched(worst: Worst, motion: Motion, trace: Trace, params: Parameters) -> Worst:
    """The worst of a run with one more tick."""
    bound = intention_bound(motion, params)
    ratio = intention_norm(motion) / bound if bound > 0.0 else 0.0
    return Worst(min(worst.barrier, float(trace.barrier.min(initial=math.inf))), max(worst.intention, ratio))


def intention_norm(motion: Motion) -> float:
    """The largest |v_s| of the team."""
    return math.sqrt(float(np.square(motion.intention).sum(axis=1).max(initial=0.0)))


def intention_bound(motion: Motion, params: Parameters) -> float:
    """Bound on |v_s|, [15] corrected: no robot's can exceed what its own pulls weigh, whatever its neighbours do.

    max(w1 T/(w0 + w1), (w1 T + w3 H)/(w0 + w1 + w3)), T and H the largest |v_t| and |v_h| so far, and the second term
    with w3 boosted as on the way out of a deadlock. Infinite for the printed update.
    """
    if params.forms.intention == PRINTED:
        return math.inf
    weights, robot, human = params.intention, motion.robot_peak, motion.human_peak
    own = weights.robot_weight * robot
    alone = weights.decay + weights.robot_weight
    bounds = [own / alone] if alone > 0.0 else []
    for boost in (1.0, params.stall.human_boost) if human > 0.0 else ():
        pull = boost * weights.human_weight
        bounds.append((own + pull * human) / max(alone + pull, 1e-300))
    return max(bounds, default=math.inf)


def connectivity(links: Ints, robots: int) -> float:
    """lambda_2, the second smallest eigenvalue of the Laplacian of `links` (E, 2); a lone robot has none: inf."""
    from scipy.sparse import coo_array, csc_array  # noqa: PLC0415 (slow to import)
    from scipy.sparse.csgraph import connected_components  # noqa: PLC0415
    from scipy.sparse.csgraph import laplacian as sparse_laplacian  # noqa: PLC0415
    from scipy.sparse.linalg import eigsh  # noqa: PLC0415

    if robots < 2:
        return math.inf
    if len(links) == robots * (robots - 1) // 2:
        return float(robots)
    if robots <= DENSE:
        return float(np.linalg.eigvalsh(laplacian(links, robots))[1])
    graph = coo_array((np.ones(len(links)), (links[:, 0], links[:, 1])), shape=(robots, robots)).tocsr()
    if connected_components(graph, directed=False)[0] > 1:
        return 0.0
    matrix = csc_array(sparse_laplacian(graph + graph.T))
    start = np.linspace(-1.0, 1.0, robots)
    return float(max(eigsh(matrix, k=2, sigma=_SHIFT, v0=start, return_eigenvectors=False)))


def laplacian(links: Ints, robots: int) -> Floats:
    """Graph Laplacian (N, N) of links (E, 2)."""
    matrix = np.zeros((robots, robots))
    matrix[links[:, 0], links[:, 1]] = matrix[links[:, 1], links[:, 0]] = -1.0
    return matrix - np.diag(matrix.sum(axis=1))


def certificates(
    world: World, params: Parameters, start: SimState, state: SimState, trace: Trace, worst: Worst
) -> tuple[Certificate, ...]:
    """All conditions of a run from `start` as they are now; those of single ticks at their worst so far."""
    params, robots = controlled(params), len(state.motion.position)
    hazards = worst_hazards(world, start.motion.fire_radius)
    sampling = max(sampling_conditions(hazards, params.safety), key=lambda kind: kind.value)
    degree = int(np.bincount(trace.links.ravel(), minlength=robots).max(initial=0))
    stiffness = 2.0 * params.safety.control_period * params.formation.formation_rate * degree
    found = [
        Certificate(f"Sampling ({sampling.kind})", "dt beta h_near²", _SAMPLING, sampling.value, SAMPLING_LIMIT),
        Certificate("Formation", "dt k_form 2 deg", _FORMATION, stiffness, FORMATION_LIMIT),
        Certificate("Intention", "largest |v_s| / bound", _INTENTION, worst.intention, 1.0),
        Certificate("Connectivity", "lambda_2", _SPLIT, connectivity(trace.links, robots), CONNECTED, least=True),
        Certificate("Barrier", "least h", _BARRIER, worst.barrier, 0.0, least=True),
    ]
    if params.forms.intention == PRINTED:
        radius = map_radius(laplacian(trace.links, robots), state.intent.influenced, params.intention)
        found[2] = Certificate("Intention map", "spectral radius", _DIVERGENT, radius, 1.0)
    return tuple(found)
