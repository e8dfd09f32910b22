"""Presets of tunables: each a few factors of the scenario's own values, so that it suits slow and fast teams alike."""

from collections.abc import Mapping

from higvf_console.control.parameters import Parameters
from higvf_console.world.editing.parameters import FIXED, parameter, parameter_names

AS_IN_THE_SCENARIO = "As in the scenario"
PRESETS: Mapping[str, Mapping[str, float]] = {
    AS_IN_THE_SCENARIO: {},
    # Slower, and braking earlier: barrier constraints become active at a larger distance.
    "Cautious": {
        "blending.cruise_speed": 0.6,
        "safety.speed_limit": 0.75,
        "safety.pair_gain": 0.5,
        "safety.obstacle_gain": 0.5,
    },
    # The operator's field prevails over what robot and neighbours intend, and for longer.
    "Human leads": {"intention.human_weight": 3.0, "intention.robot_weight": 0.5, "path.progress_timeout": 2.0},
    # The human intention weighs about as much as the others.
    "Robots lead": {"intention.human_weight": 0.1, "path.progress_timeout": 0.5},
    # A stiffer formation that weighs more in the blend; neighbours agree faster.
    "Tight formation": {
        "formation.formation_rate": 1.5,
        "blending.formation_gain": 4.0,
        "intention.neighbour_weight": 2.0,
    },
}


def preset_values(name: str, scenario: Parameters) -> dict[str, float]:
    """All tunables that can change in a run, by "group.name", as a preset has them.

    Args:
        name: one of `PRESETS`.
        scenario: the tunables as the scenario has them.
    """
    factors = PRESETS[name]
    return {
        tunable: parameter(scenario, tunable) * factors.get(tunable, 1.0)
        for tunable in parameter_names()
        if tunable not in FIXED
    }


def preset_name(params: Parameters, scenario: Parameters) -> str | None:
    """The preset that some tunables are; None = none of them."""
    for name in PRESETS:
        if all(parameter(params, tunable) == value for tunable, value in preset_values(name, scenario).items()):
            return name
    return None
