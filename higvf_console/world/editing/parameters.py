"""Edits of the tunables during a run: checked against their ranges; a few are fixed for a run."""

from collections.abc import Mapping

from higvf_console.control.parameters import GROUPS, Parameters, current_name
from higvf_console.core.errors import ScenarioError, closest
from higvf_console.core.quantity import Quantity, quantities, with_values
from higvf_console.core.scale import USUAL_SCALE, Scale
from higvf_console.world.layout import Layout

# What a run's clock and the robots' model rest on; a scenario file sets them.
FIXED = ("safety.control_period", "robots.look_ahead")


def parameter_names() -> tuple[str, ...]:
    """Names of all tunables, as "group.name"."""
    params = Parameters()
    return tuple(f"{group}.{name}" for group in GROUPS for name in quantities(type(getattr(params, group))))  # pyright: ignore[reportUnknownArgumentType]


def parameter(params: Parameters, name: str) -> float:
    """A tunable by its name "group.name"."""
    group, key = name.split(".")
    return float(getattr(getattr(params, group), key))


def quantity_of(name: str, scale: Scale = USUAL_SCALE) -> Quantity:
    """What the tunable "group.name" means, with its range at a scale."""
    group, key = name.split(".")
    return quantities(type(getattr(Parameters(), group)))[key].at(scale)  # pyright: ignore[reportUnknownArgumentType]


def with_parameters(layout: Layout, values: Mapping[str, float]) -> tuple[Parameters, str]:
    """The parameters with other values, and what has changed in words.

    Raises:
        ScenarioError: an unknown name, a value out of range, or a tunable that is fixed for a run.
    """
    params, known = layout.params, parameter_names()
    former = "".join(
        f" {name} is renamed; write {current_name(name)}." for name in values if current_name(name) != name
    )
    values = {current_name(name): value for name, value in values.items()}
    for name, value in values.items():
        if name not in known:
            raise ScenarioError(f"there is no parameter '{name}'{closest(name, known)}")
        if name in FIXED and value != parameter(params, name):
            raise ScenarioError(f"{name} is fixed during a run: set it in a scenario file and load that")
        group, key = name.split(".")
        params = params._replace(**{group: with_values(getattr(params, group), {key: value}, group, params.scale)})
    if params.boundaries.reactive_margin <= params.boundaries.repulsive_margin:
        raise ScenarioError(
            f"boundaries.reactive_margin ({params.boundaries.reactive_margin:g} m) must be above "
            f"boundaries.repulsive_margin ({params.boundaries.repulsive_margin:g} m)"
        )
    changed = [name for name in values if parameter(params, name) != parameter(layout.params, name)]
    if not changed:
        return params, f"The parameters are as they were.{former}"
    if len(changed) > 1:
        return params, f"{len(changed)} parameters have changed: {', '.join(changed)}.{former}"
    text = f"{changed[0]} is {parameter(params, changed[0]):g} {quantity_of(changed[0]).unit}".rstrip()
    return params, f"{text}.{former}"
