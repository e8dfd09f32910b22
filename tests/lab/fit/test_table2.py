"""Table II: verdicts follow from the numbers, and the shipped world gives what the paper describes."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
import yaml

from higvf_console.core.arrays import floats
from higvf_console.lab.fit.firefighting import FirefightingRun
from higvf_console.lab.fit.table2 import STROKES, Verdict, kept_fit, summed, table2, verdicts
from higvf_console.lab.reproduce.paper import COLUMNS
from higvf_console.scenario.scenario import data_folder

ALONE, PRIORITY, HIDDEN = COLUMNS


def as_printed() -> dict[str, FirefightingRun]:
    return {
        name: FirefightingRun(column.order, floats(column.loss_area), 2100, 1.0) for name, column in COLUMNS.items()
    }


def missed(runs: Mapping[str, FirefightingRun]) -> list[str]:
    return [verdict.target for verdict in verdicts(runs) if not verdict.met]


@pytest.fixture(scope="module")
def found() -> dict[str, Any]:
    return table2()


def test_the_papers_own_numbers_meet_every_target() -> None:
    assert missed(as_printed()) == []
    assert len(verdicts(as_printed())) == 16


def test_the_second_column_is_compared_with_the_sum_of_its_entries() -> None:
    assert summed(COLUMNS[PRIORITY]) == pytest.approx(48251.89)
    assert summed(COLUMNS[ALONE]) == pytest.approx(51547.1)


@pytest.mark.parametrize("fire", range(5))
def test_a_fire_six_per_cent_off_misses_its_target(fire: int) -> None:
    runs = as_printed()
    area = runs[ALONE].loss_area.copy()
    area[fire] *= 1.06
    runs[ALONE] = runs[ALONE]._replace(loss_area=area)
    assert f"fire {fire + 1} without human [m²]" in missed(runs)


def test_a_run_that_burns_less_is_judged_by_size_and_sign() -> None:
    runs = as_printed()
    runs[HIDDEN] = runs[HIDDEN]._replace(loss_area=0.975 * runs[HIDDEN].loss_area)
    assert missed(runs) == [
        "total, find undetected target [m²]",
        "change of the total, find undetected target [%]",
        "sign of each fire's change, find undetected target",
    ]


def test_another_order_and_a_violation_miss_their_targets() -> None:
    runs = as_printed()
    runs[PRIORITY] = runs[PRIORITY]._replace(order=(1, 2, 3, 4, 5), min_clearance=-0.01)
    assert missed(runs) == ["order, change target priority", "smallest clearance of all runs [m]"]


def test_the_smallest_change_of_a_fire_counts_as_a_change() -> None:
    runs = as_printed()
    area = runs[HIDDEN].loss_area.copy()
    area[0] = np.nextafter(area[0], np.inf)
    runs[HIDDEN] = runs[HIDDEN]._replace(loss_area=area)
    assert missed(runs) == ["sign of each fire's change, find undetected target"]


def test_the_table_has_the_documented_shape(found: dict[str, Any]) -> None:
    assert list(found["table2"]) == ["without_human", "change_priority", "find_hidden"]
    for name, column in found["table2"].items():
        assert list(column) == ["order", "loss_area_m2", "total_m2"]
        assert len(column["loss_area_m2"]) == 5
        assert column["total_m2"] == pytest.approx(sum(column["loss_area_m2"]))
        assert found["relative_error"][name]["total"] == pytest.approx(column["total_m2"] / summed(COLUMNS[name]) - 1.0)


def test_the_shipped_world_has_the_papers_orders_and_signs(found: dict[str, Any]) -> None:
    for name, column in found["table2"].items():
        assert tuple(column["order"]) == COLUMNS[name].order
    alone, priority, hidden = (np.array(column["loss_area_m2"]) for column in found["table2"].values())
    assert np.sign(priority - alone).tolist() == [0, 1, -1, -1, -1]
    assert np.sign(hidden - alone).tolist() == [0, 0, 0, 0, -1]


def test_the_shipped_world_meets_the_targets_of_the_column_that_it_was_fitted_to(found: dict[str, Any]) -> None:
    targets = [Verdict(**target) for target in found["targets"]]
    fitted = [target for target in targets if "without human" in target.target]
    assert len(fitted) == 7
    assert [target.target for target in fitted if not target.met] == []


def test_the_stored_fit_belongs_to_this_engine_and_world(found: dict[str, Any]) -> None:
    """Where this fails, the engine has changed: run `higvf fit` again and ship what it writes."""
    kept = kept_fit()
    for name, column in found["table2"].items():
        assert kept["table2"][name]["loss_area_m2"] == pytest.approx(column["loss_area_m2"], rel=1e-9)
    assert kept["targets"] == found["targets"]


def test_the_spread_holds_the_chosen_world(found: dict[str, Any]) -> None:
    for name, value in found["chosen"].items():
        ranges = found["spread"]["parameters"][name]
        assert ranges["low"] <= value == ranges["chosen"] <= ranges["high"]
    for name, column in found["table2"].items():
        ranges = found["spread"]["predictions"][f"total_m2.{name}"]
        assert ranges["low"] <= column["total_m2"] <= ranges["high"]


@pytest.mark.parametrize("name", STROKES)
def test_a_stroke_waits_for_the_fire_that_it_is_said_to_wait_for(name: str) -> None:
    stroke = STROKES[name]
    (entry,) = yaml.safe_load((data_folder() / "scenarios" / "scripts" / f"{stroke.script}.yaml").read_text())
    assert entry["when"] == {"extinguished": stroke.after}
