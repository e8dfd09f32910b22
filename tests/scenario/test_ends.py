"""How a run ends, as a scenario file says it: read strictly, and written back."""

import pytest

from higvf_console.core.errors import ScenarioError
from higvf_console.scenario.ends import Ends, EndWhen
from higvf_console.scenario.scenario import Scenario, parse_scenario
from higvf_console.scenario.writer import scenario_yaml

TEXT = """
version: 1
arena: {size_m: [1200, 700]}
robots: {start_m: [[700, 300], [670, 350]]}
fires: [{at_m: [500, 250], radius_m: 20}]
"""


def parsed(ends: str, text: str = TEXT) -> Scenario:
    return parse_scenario(f"{text}ends: {ends}\n", "t.yaml")


def test_a_run_ends_when_all_fires_are_out_unless_the_file_says_otherwise() -> None:
    assert parse_scenario(TEXT, "t.yaml").ends == Ends(EndWhen.ALL_FIRES_OUT, 0.0)
    assert parsed("{when: path_finished, after_s: 2}").ends == Ends(EndWhen.PATH_FINISHED, 2.0)


@pytest.mark.parametrize(
    ("ends", "message"),
    [
        ("{when: fires_out}", r"t\.yaml: ends\.when: 'fires_out' is not one of all_fires_out, path_finished, never"),
        ("never", r"t\.yaml: ends: 'never' is not a section with the keys when, after_s"),
        ("{after_s: 3}", r"t\.yaml: ends: the key 'when' is missing; known keys: when, after_s"),
        (
            "{when: never, after_s: 3}",
            r"ends\.after_s: 3 s after an end that never comes; remove it, or give when: all_",
        ),
        ("{when: path_finished, after_s: -1}", r"ends\.after_s: -1 is not a number from 0 to 3600 s"),
        ("{when: never, at_s: 3}", r"ends\.at_s: unknown key"),
    ],
)
def test_an_end_that_is_not_understood_is_refused_in_one_line(ends: str, message: str) -> None:
    with pytest.raises(ScenarioError, match=message) as refused:
        parsed(ends)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("ends", ["{when: path_finished}", "{when: all_fires_out, after_s: 1.5}", "{when: never}"])
def test_an_end_comes_back_from_the_file_that_is_written(ends: str) -> None:
    scenario = parsed(ends)
    setup = scenario.setup()
    again = parse_scenario(scenario_yaml(setup, setup.start, scenario), "t.yaml")
    assert again.ends == scenario.ends


def test_a_briefing_comes_back_too() -> None:
    scenario = parse_scenario(f"{TEXT}briefing: Two robots, one fire.\n", "t.yaml")
    setup = scenario.setup()
    assert parse_scenario(scenario_yaml(setup, setup.start, scenario), "t.yaml").briefing == "Two robots, one fire."


def test_an_end_that_cannot_come_is_warned_of() -> None:
    circle = "path: {circle: {at_m: [600, 350], radius_m: 200}}\n"
    assert any("the path has no end" in warning for warning in parsed("{when: path_finished}", TEXT + circle).warnings)
    timed = "path: {circle: {at_m: [600, 350], radius_m: 200}, duration_s: 5}\n"
    assert parsed("{when: path_finished}", TEXT + timed).warnings == ()
    bare = TEXT.replace("fires: [{at_m: [500, 250], radius_m: 20}]\n", "")
    assert any(
        "no fires to be out" in warning for warning in parsed("{when: all_fires_out, after_s: 1}", bare).warnings
    )
