"""Spread and sensitivity on worlds whose loss areas are a known function of the sample."""

from collections.abc import Sequence

import numpy as np
import pytest

from higvf_console.lab.fit.firefighting import FirefightingRun
from higvf_console.lab.fit.report import sensitivity, spread
from higvf_console.lab.fit.space import NAMES, SPACE, Sample, on_grid
from higvf_console.lab.fit.table2 import ALONE, Columns
from higvf_console.lab.reproduce.paper import COLUMNS

CENTRE = on_grid(np.array([(free.low + free.high) / 2 for free in SPACE]))
BAR = NAMES.index("bar.x")


def printed(factor: float = 1.0, changed: float = 1.0) -> Columns:
    """The paper's columns, all areas times `factor`, those of columns 2 and 3 times `changed` as well."""
    return {
        name: FirefightingRun(
            column.order, factor * (1.0 if name == ALONE else changed) * np.array(column.loss_area), 2000, 1.0
        )
        for name, column in COLUMNS.items()
    }


def with_bar(metres: float) -> Sample:
    return tuple(value + metres * (place == BAR) for place, value in enumerate(CENTRE))


def by_bar(samples: Sequence[Sample]) -> list[Columns | None]:
    """All areas grow by 1 % a metre that the bar stands farther right; beyond 60 m there is no run."""
    shifts = [sample[BAR] - CENTRE[BAR] for sample in samples]
    return [None if abs(shift) > 60.0 else printed(1.0 + 0.01 * shift) for shift in shifts]


def test_sensitivity_is_the_slope_of_areas_and_totals() -> None:
    found = sensitivity(CENTRE, by_bar)
    step = found["bar.x"]["step"]
    assert found["bar.x"]["fires"] == pytest.approx([0.01 * step] * 5)
    assert list(found["bar.x"]["totals"].values()) == pytest.approx([0.01 * step] * 3)
    assert list(found["bar.x"]["reductions"].values()) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert found["fires.stand_off"]["fires"] == [0.0] * 5
    assert [found[name]["unit"] for name in ("bar.x", "fires.extinguish_time")] == ["m", "s/m"]


def test_a_change_of_columns_2_and_3_alone_is_a_change_of_the_reductions() -> None:
    def run(samples: Sequence[Sample]) -> list[Columns | None]:
        return [printed(changed=1.0 + 0.01 * (sample[BAR] - CENTRE[BAR])) for sample in samples]

    found = sensitivity(CENTRE, run)["bar.x"]
    assert found["fires"] == [0.0] * 5
    share = sum(COLUMNS["find_hidden"].loss_area) / sum(COLUMNS[ALONE].loss_area)
    assert found["reductions"]["find_hidden"] == pytest.approx(0.01 * found["step"] * share)


def test_sensitivity_that_cannot_be_computed_is_none() -> None:
    assert sensitivity(with_bar(60.0), by_bar)["bar.x"] is None


def test_the_spread_reports_ranges_and_the_share_that_meets_each_target() -> None:
    samples = [CENTRE, with_bar(1.0), with_bar(4.0), with_bar(90.0)]
    found = spread(samples, by_bar)
    assert found["parameters"]["bar.x"] == {
        "chosen": CENTRE[BAR], "low": CENTRE[BAR], "high": CENTRE[BAR] + 90.0, "unit": "m",
    }  # fmt: skip
    total = found["predictions"]["total_m2.find_hidden"]
    paper = sum(COLUMNS["find_hidden"].loss_area)
    assert (total["paper"], total["low"]) == pytest.approx((paper, paper))
    assert (total["median"], total["high"]) == pytest.approx((1.01 * paper, 1.04 * paper))
    assert found["targets_met"]["fire 1 without human [m²]"] == 1.0
    assert found["targets_met"]["total, find undetected target [m²]"] == pytest.approx(2 / 3)
    assert found["all_met"] == pytest.approx(2 / 3)


def test_the_nearest_sample_misses_least() -> None:
    found = spread([with_bar(4.0), with_bar(1.0), with_bar(3.0)], by_bar)
    assert found["nearest"]["sample"]["bar.x"] == CENTRE[BAR] + 1.0
    assert all(target["met"] for target in found["nearest"]["targets"])
