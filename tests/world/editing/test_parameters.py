"""Tunables that would make a part of the controller diverge are refused before they apply."""

import numpy as np
import pytest

from higvf_console.control.forms import CORRECTED, PRINTED, Forms
from higvf_console.core.edits import SetParameters
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import parse_scenario
from tests.world.editing.actions import SCENE, edited_run


@pytest.mark.parametrize(
    ("intention", "values", "limit"),
    [
        (CORRECTED, {"formation.formation_rate": 45.0}, "must stay below 2"),
        (CORRECTED, {"safety.pair_gain": 900.0}, "parameters.safety"),
        (PRINTED, {"intention.human_weight": 900.0}, "spectral radius"),
    ],
)
def test_an_unstable_value_is_refused_with_its_limit(intention: float, values: dict[str, float], limit: str) -> None:
    run = Run(parse_scenario(SCENE, "a test").with_forms(Forms(intention=intention)).setup())
    before = run.setup
    (event,) = run.apply(SetParameters(values))
    assert event.kind == "refused"
    assert limit in event.text
    assert run.setup is before


def test_the_corrected_intention_takes_any_weight() -> None:
    run = Run(parse_scenario(SCENE, "a test").setup())
    run.apply(SetParameters({"intention.human_weight": 900.0}))
    assert run.setup.params.intention.human_weight == 900.0


def test_a_value_that_only_the_next_start_would_feel_is_refused_too() -> None:
    run = edited_run()
    out = run.state.motion._replace(fire_burning=np.zeros(2, bool), tick=1)
    run.state = run.state._replace(motion=out)
    (event,) = run.apply(SetParameters({"fires.stand_off": 1.0}))
    assert event.kind == "refused"
    assert "stand_off" in event.text
