"""The communication graph at the start, and whether the team's intention and formation converge on it."""
# SciPy's sparse graphs have no types.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from typing import NamedTuple

import numpy as np

from higvf_console.control.forms import PRINTED
from higvf_console.control.intention.intention import map_radius
from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Floats, ints
from higvf_console.core.errors import ScenarioError
from higvf_console.sim.certificates import FORMATION_LIMIT, laplacian
from higvf_console.world.neighbour_search import kd_tree

PRINTED_RADIUS = 0.9  # spectral radius to which the printed intention update is scaled
_WEIGHTS = ("decay", "robot_weight", "neighbour_weight", "human_weight")


class Network(NamedTuple):
    """The communication graph at the start: the most links that one robot has, and the connected components."""

    degree: int
    components: int


def start_network(position: Floats, links: tuple[tuple[int, int], ...] | None, activation_distance: float) -> Network:
    """The graph of robots at `position` (N, 2): the given links, or all pairs within `activation_distance` [m]."""
    robots = len(position)
    if links is None and np.isinf(activation_distance):
        return Network(robots - 1, 1)
    edges = (
        ints(links, -1, 2)
        if links is not None
        else kd_tree(position).query_pairs(activation_distance, output_type="ndarray")
    )
    from scipy.sparse import coo_array  # noqa: PLC0415 (slow to import)
    from scipy.sparse.csgraph import connected_components  # noqa: PLC0415

    graph = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(robots, robots))
    degree = np.bincount(edges.ravel(), minlength=robots).max()
    return Network(int(degree), int(connected_components(graph, directed=False)[0]))


def intention_radius(
    position: Floats, links: tuple[tuple[int, int], ...] | None, influenced: int, params: Parameters
) -> float:
    """Spectral radius of the intention update as printed, on the communication graph at the start.

    Args:
        position: (N, 2) [m].
        links: given links; None = all pairs within the communication range.
        influenced: index of the influenced robot.
        params: weights and communication range.
    """
    robots = len(position)
    activation_distance = min(params.formation.communication_range, 1e9)
    edges = (
        ints(links, -1, 2)
        if links is not None
        else kd_tree(position).query_pairs(activation_distance, output_type="ndarray")
    )
    return map_radius(laplacian(ints(edges, -1, 2), robots), influenced, params.intention)


def convergent(
    params: Parameters, position: Floats, links: tuple[tuple[int, int], ...] | None, influenced: int
) -> tuple[Parameters, tuple[str, ...]]:
    """The parameters with weights for which the printed intention update converges, and a warning if that changed them.

    Weights that suit the corrected update make the printed one diverge: they are scaled to `PRINTED_RADIUS`.
    """
    radius = intention_radius(position, links, influenced, params)
    if params.forms.intention != PRINTED or radius < 1.0:
        return params, ()
    scale = PRINTED_RADIUS / radius
    weights = {name: scale * getattr(params.intention, name) for name in _WEIGHTS}
    warning = (
        f"the intention update as printed has spectral radius {radius:.3g} and diverges: "
        f"its weights are multiplied by {scale:.3g}, which makes it {PRINTED_RADIUS:g}"
    )
    return params._replace(intention=params.intention._replace(**weights)), (warning,)


def check_intention(radius: float, source: str) -> None:
    """Refuses an intention update in its printed form that diverges.

    Raises:
        ScenarioError: the spectral `radius` is not below 1; the message gives it and the way out.
    """
    if radius >= 1.0:
        raise ScenarioError(
            f"{source}: forms.intention: the printed update has spectral radius {radius:.3g} and diverges (limit 1); "
            f"multiply all four weights of parameters.intention by less than {1.0 / radius:.3g}, or take 'corrected'"
        )


def check_formation(degree: int, params: Parameters, source: str) -> None:
    """Refuses a formation too stiff for the control period (explicit Euler, `FORMATION_LIMIT`).

    Args:
        degree: the most links that one robot has.
        params: with `formation_rate` and `control_period`.
        source: the scenario file.

    Raises:
        ScenarioError: dt k_form 2 deg_max is not below the limit.
    """
    stiffness = 2.0 * params.safety.control_period * params.formation.formation_rate * degree
    if stiffness >= FORMATION_LIMIT:
        raise ScenarioError(
            f"{source}: parameters.formation: control_period x formation_rate x 2 x {degree} links of one robot is "
            f"{stiffness:.3g} and must stay below {FORMATION_LIMIT:g}; lower formation_rate "
            f"({params.formation.formation_rate:g} 1/s), set communication_range, or give links"
        )
