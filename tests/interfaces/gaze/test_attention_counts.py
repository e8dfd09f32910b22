"""Attention counts sum to the gaze time, by the positions of the targets at each fixation."""

import numpy as np
import pytest

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.interface import Targets
from higvf_console.core.viewport import Arena
from higvf_interfaces.gaze.attention_counts import AttentionCounts
from higvf_interfaces.gaze.fixations import Fixation

ARENA = Arena(-100.0, 0.0, 1100.0, 700.0)
FIRES, RADIUS = floats([[100, 100], [500, 100]]), floats([30, 30])
NOBODY = Targets(FIRES, RADIUS, floats([], 0, 2))
DEGREE = 25.0


def at(x: float, y: float) -> Floats:
    return floats([x, y])


def looked(
    counts: AttentionCounts, point: Floats | None, targets: Targets = NOBODY, start: float = 0.0, end: float = 1.0
) -> None:
    for time in np.arange(round(start / 0.02), round(end / 0.02) + 1) * 0.02:
        counts.look(float(time), point, targets)


def test_the_heat_map_holds_the_gaze_time_by_place() -> None:
    counts = AttentionCounts(ARENA)
    looked(counts, at(500, 690))
    looked(counts, at(-90, 10), start=1.0, end=1.5)
    first = counts.report()
    looked(counts, None, start=1.5, end=9.0)
    report = counts.report()
    assert first and report
    np.testing.assert_array_equal(first.heat, report.heat)
    assert report.heat.sum() == pytest.approx(1.5)
    assert report.extent == ARENA
    row, column = np.unravel_index(np.argmax(report.heat), report.heat.shape)
    assert (row, column) == (1, 60), "row 0 is the top"
    assert report.heat[-2:, :2].sum() == pytest.approx(0.5)


def test_there_is_no_report_before_the_first_gaze_sample() -> None:
    counts = AttentionCounts(ARENA)
    looked(counts, None)
    assert counts.report() is None


def test_fixation_time_is_counted_by_fire_by_robot_and_elsewhere() -> None:
    counts = AttentionCounts(ARENA)
    targets = Targets(FIRES, RADIUS, floats([[500, 140], [900, 600]]))
    looked(counts, at(0, 0), targets, end=4.0)
    for start, end, point in (
        (0.0, 0.3, at(120, 100)),
        (0.4, 0.9, at(505, 160)),
        (1.0, 1.2, at(505, 60)),
        (2, 3, at(300, 400)),
    ):
        counts.fixate(Fixation(start, end, point), DEGREE)
    report = counts.report()
    assert report
    np.testing.assert_allclose(report.fires, [0.3, 0.2])
    np.testing.assert_allclose(report.robots, [0.5, 0.0])
    assert report.elsewhere == pytest.approx(1.0)
    assert report.fixation_rate == pytest.approx(4 / 4.0)
    assert report.fixation_duration == pytest.approx(2.0 / 4)
    assert 0.0 <= report.transition_entropy <= 1.0


def test_a_robot_counts_at_its_position_in_the_middle_of_the_fixation() -> None:
    counts = AttentionCounts(ARENA)
    here, there = (Targets(FIRES, RADIUS, floats([point])) for point in ([300, 400], [800, 400]))
    looked(counts, at(300, 400), here, end=1.0)
    looked(counts, at(300, 400), there, start=1.0, end=2.0)
    counts.fixate(Fixation(0.4, 0.8, at(305, 400)), DEGREE)
    counts.fixate(Fixation(1.4, 1.8, at(305, 400)), DEGREE)
    report = counts.report()
    assert report
    assert report.robots.tolist() == pytest.approx([0.4])
    assert report.elsewhere == pytest.approx(0.4)


def test_an_added_fire_does_not_change_the_times_of_others() -> None:
    counts = AttentionCounts(ARENA)
    looked(counts, at(0, 0))
    counts.fixate(Fixation(0.2, 0.6, at(100, 100)), DEGREE)
    more = Targets(floats([*FIRES.tolist(), [900, 600]]), floats([30, 30, 30]), floats([], 0, 2))
    looked(counts, at(0, 0), more, start=1.0, end=2.0)
    counts.fixate(Fixation(1.5, 1.8, at(900, 600)), DEGREE)
    report = counts.report()
    assert report
    np.testing.assert_allclose(report.fires, [0.4, 0.0, 0.3])
