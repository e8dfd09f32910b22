"""Presets of tunables suit every shipped scenario, and are known again."""

import pytest

from higvf_console.core.edits import SetParameters
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import load_scenario, scenario_names
from higvf_console.world.editing.parameters import FIXED, parameter_names
from higvf_console.world.editing.presets import AS_IN_THE_SCENARIO, PRESETS, preset_name, preset_values


@pytest.mark.parametrize("scenario", scenario_names())
def test_every_preset_is_accepted_by_every_scenario_and_known_again(scenario: str) -> None:
    loaded = load_scenario(scenario)
    run = Run(loaded.setup(), scenario=loaded)
    for name in (*PRESETS, AS_IN_THE_SCENARIO):
        events = run.apply(SetParameters(preset_values(name, loaded.params)))
        assert [event.text for event in events if event.kind == "refused"] == []
        assert preset_name(run.setup.params, loaded.params) == name
    assert run.setup.params == loaded.setup().params


def test_presets_name_tunables_that_can_change() -> None:
    for factors in PRESETS.values():
        assert set(factors) <= set(parameter_names()) - set(FIXED)
