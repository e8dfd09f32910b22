"""What the documents show can be repeated: figures of the first two minutes, the scenario by hand."""

import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from higvf_console.channels.channels import open_interface
from higvf_console.core.interface import InputSpec
from higvf_console.runtime.headless import run_headless
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import load_scenario, parse_scenario

ROOT = Path(__file__).parents[2]
TUTORIAL = (ROOT / "docs" / "tutorial" / "first-two-minutes.md").read_text(encoding="utf-8")
README = (ROOT / "README.md").read_text(encoding="utf-8")


@cache
def report(script: str | None) -> dict[str, Any]:
    scenario = load_scenario("firefighting")
    spec = InputSpec("script", f"{ROOT}/scenarios/scripts/{script}.yaml", {}, {}, scenario.arena, 3)
    session = Session(scenario, [open_interface(spec)] if script else [])
    try:
        return run_headless(session)
    finally:
        session.close()


def area(value: float) -> str:
    return f"{value:,.0f} m²".replace(",", " ")


@pytest.mark.parametrize("page", [TUTORIAL, README], ids=["tutorial", "README"])
def test_the_loss_areas_of_the_first_two_minutes_are_those_of_the_runs(page: str) -> None:
    for script in (None, "hidden-fire"):
        found = report(script)
        for shown in (
            area(found["loss_area_m2"][4]),
            area(found["loss_area_total_m2"]),
            f"{found['duration_s']:.1f} s",
        ):
            assert shown in page


@pytest.mark.parametrize("page", [TUTORIAL, README], ids=["tutorial", "README"])
def test_what_the_path_saves_is_the_difference_of_the_runs(page: str) -> None:
    alone, led = report(None)["loss_area_total_m2"], report("hidden-fire")["loss_area_total_m2"]
    assert area(alone - led) in page
    assert f"{100 * (alone - led) / alone:.1f} %" in page


def test_the_saving_of_the_priority_stroke_is_that_of_the_run() -> None:
    alone, led = report(None)["loss_area_total_m2"], report("priority")["loss_area_total_m2"]
    assert f"{area(alone - led)} ({100 * (alone - led) / alone:.1f} %)" in TUTORIAL


def test_the_shown_margins_are_those_of_the_runs() -> None:
    for script in (None, "hidden-fire"):
        assert f"{report(script)['min_clearance_margin_m']:.2f} m" in TUTORIAL


def test_the_scenario_that_is_shown_by_hand_is_accepted() -> None:
    page = (ROOT / "docs" / "how-to" / "write-a-scenario.md").read_text(encoding="utf-8")
    (shown,) = re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)
    assert parse_scenario(shown, "two-fires.yaml").warnings == ()
