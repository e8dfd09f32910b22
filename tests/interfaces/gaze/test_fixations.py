"""Fixation detection agrees with the labels of the recording software."""

import csv
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.arrays import Bools, Floats, bools, floats
from higvf_interfaces.formats.reading import read_gaze
from higvf_interfaces.gaze.dispersion import covered, still_stretches
from higvf_interfaces.gaze.fixations import (
    IDT,
    METHODS,
    PX_PER_DEG,
    THRESHOLDS,
    angular_speed,
    centroid,
    classify,
    cut_blinks,
    fill_gaps,
    merge,
    runs,
)

TOBII_SAMPLE = "tobii_prolab_de_excerpt/prolab_de_first600rows.tsv"


def clock(count: int, step: float) -> Floats:
    return floats([k * step for k in range(count)])


def jumps(*targets: float, dwell: float = 0.3, rate: float = 120.0) -> tuple[Floats, Floats, Bools]:
    """Time, points and validity of an eye that rests on (target, 100) for `dwell` each."""
    x = np.repeat(np.array(targets), round(dwell * rate))
    time = np.arange(len(x)) / rate
    return time, np.stack([x, np.full(len(x), 100.0)], axis=1), np.ones(len(x), dtype=np.bool_)


def test_ivt_agrees_with_the_recording_softwares_own_labels(sample: Callable[[str], Path]) -> None:
    path = sample(TOBII_SAMPLE)
    gaze = read_gaze(str(path))
    with path.open(encoding="utf-8-sig", newline="") as stream:
        rows = [row for row in csv.DictReader(stream, delimiter="\t") if row["Sensor"] == "Eye Tracker"]
    theirs = np.array([row["Eye movement type"] for row in rows])
    filled, seen = fill_gaps(gaze.time, gaze.points, gaze.valid, THRESHOLDS.longest_filled)
    steady = cut_blinks(gaze.time, seen, THRESHOLDS.longest_filled, THRESHOLDS.blink_margin)
    speed = angular_speed(gaze.time, filled, steady, PX_PER_DEG, THRESHOLDS.window)
    comparable = np.isfinite(speed) & np.isin(theirs, ["Fixation", "Saccade"])
    agreement = np.mean((theirs == "Fixation")[comparable] == (speed < THRESHOLDS.speed)[comparable])
    assert np.count_nonzero(comparable) > 400
    assert agreement >= 0.97


def test_centroids_agree_with_those_of_the_recording_software(sample: Callable[[str], Path]) -> None:
    path = sample(TOBII_SAMPLE)
    gaze = read_gaze(str(path))
    with path.open(encoding="utf-8-sig", newline="") as stream:
        rows = [row for row in csv.DictReader(stream, delimiter="\t") if row["Eye movement type"] == "Fixation"]
    keys = ("Fixation point X [DACS px]", "Fixation point Y [DACS px]")
    theirs = np.unique([[float(row[key]) for key in keys] for row in rows if row[keys[0]]], axis=0)
    found = classify(gaze.time, gaze.points, gaze.valid)
    ours = [centroid(found, first, last) for first, last in zip(found.first, found.last, strict=True)]
    distance = [np.hypot(*(theirs - centre).T).min() for centre in ours]
    assert len(ours) == 11
    assert max(distance) < 0.5 * PX_PER_DEG


def test_idt_finds_the_recording_softwares_fixations_too(sample: Callable[[str], Path]) -> None:
    gaze = read_gaze(str(sample(TOBII_SAMPLE)))
    by_speed = classify(gaze.time, gaze.points, gaze.valid)
    by_dispersion = classify(gaze.time, gaze.points, gaze.valid, method=IDT)
    steady = by_speed.steady
    within = [covered(len(gaze.time), found.first, found.last) for found in (by_speed, by_dispersion)]
    assert np.mean((within[0] == within[1])[steady]) > 0.85
    assert abs(len(by_dispersion.first) - len(by_speed.first)) <= 3


@pytest.mark.parametrize("method", METHODS)
def test_each_rest_of_the_eye_is_one_fixation_with_its_centroid(method: str) -> None:
    gaze = classify(*jumps(100, 400, 800), method=method)
    centres = [centroid(gaze, first, last) for first, last in zip(gaze.first, gaze.last, strict=True)]
    np.testing.assert_allclose(centres, [[100, 100], [400, 100], [800, 100]], atol=1e-9)
    np.testing.assert_allclose(gaze.time[gaze.last] - gaze.time[gaze.first], 0.3, atol=0.06)


def test_a_slow_drift_is_one_fixation_by_speed_and_several_by_dispersion() -> None:
    time = clock(240, 1 / 120)
    points = np.stack([5 * PX_PER_DEG * time, np.zeros(240)], axis=1)
    valid = np.ones(240, dtype=np.bool_)
    assert len(classify(time, points, valid).first) == 1
    assert len(classify(time, points, valid, method=IDT).first) == pytest.approx(10, abs=1)


def test_runs_of_small_dispersion_are_maximal_and_within_the_limit() -> None:
    rng = np.random.default_rng(4)
    time, points = clock(600, 0.01), floats(np.cumsum(rng.normal(0, 3, (600, 2)), axis=0))
    steady = bools(rng.random(600) > 0.02)
    first, last = still_stretches(time, points, steady, 30.0, 0.1, 0.075)
    assert len(first) > 5
    for start, stop in zip(first.tolist(), last.tolist(), strict=True):
        assert np.ptp(points[start : stop + 1], axis=0).sum() <= 30
        assert steady[start : stop + 1].all()
        assert time[stop] - time[start] >= 0.1 - 1e-9
        longer = points[start : stop + 2]
        assert stop == 599 or not steady[stop + 1] or np.ptp(longer, axis=0).sum() > 30
    assert (first[1:] > last[:-1]).all()


def test_rests_half_a_degree_apart_are_one_fixation() -> None:
    assert len(classify(*jumps(100, 100 + 0.4 * PX_PER_DEG)).first) == 1


def test_a_brief_deviation_does_not_split_a_fixation() -> None:
    time, points, valid = jumps(400, 400)
    points[36:, 0] += 1.5 * PX_PER_DEG * np.exp(-np.arange(36) / 6)
    gaze = classify(time, points, valid)
    assert len(runs(time, gaze.fixating, THRESHOLDS.merge_time)[0]) == 2
    assert len(gaze.first) == 1


def test_rests_shorter_than_sixty_milliseconds_are_no_fixations() -> None:
    time, points, valid = jumps(100, 400, 800, dwell=0.05)
    assert len(classify(time, points, valid).first) == 0


def test_short_gaps_are_filled_by_a_line_and_long_ones_are_not() -> None:
    time = clock(6, 0.02)
    points = floats([[k, 2 * k] for k in range(6)])
    valid = bools([True, False, False, True, True, True])
    points[~valid] = np.nan
    filled, seen = fill_gaps(time, points, valid, 0.075)
    np.testing.assert_allclose(filled, [[k, 2 * k] for k in range(6)])
    assert seen.all()
    filled, seen = fill_gaps(time, points, valid, 0.05)
    assert seen.tolist() == valid.tolist()
    assert np.isnan(filled[1:3]).all()


def test_gaps_at_the_ends_are_never_filled() -> None:
    time = clock(4, 0.01)
    _, seen = fill_gaps(time, np.zeros((4, 2)), bools([False, True, True, False]), 0.075)
    assert seen.tolist() == [False, True, True, False]


def test_samples_next_to_a_blink_or_a_gap_are_cut() -> None:
    time = np.concatenate([clock(30, 0.01), 1.0 + clock(10, 0.01)])
    seen = np.ones(40, dtype=np.bool_)
    seen[10:20] = False
    steady = cut_blinks(time, seen, 0.075, 0.05)
    assert np.flatnonzero(~steady).tolist() == [*range(5, 25), *range(25, 30), *range(30, 35)]


def test_angular_speed_of_a_steady_sweep_is_its_speed() -> None:
    time = clock(60, 1 / 120)
    points = np.stack([20 * PX_PER_DEG * time, np.zeros(60)], axis=1)
    speed = angular_speed(time, points, np.ones(60, dtype=np.bool_), PX_PER_DEG, 0.033)
    np.testing.assert_allclose(speed, 20.0)


def test_speed_is_nan_where_gaze_is_unknown() -> None:
    speed = angular_speed(clock(3, 0.01), np.zeros((3, 2)), bools([True, False, True]), PX_PER_DEG, 0.033)
    assert np.isnan(speed).all()


@pytest.mark.parametrize("pattern", ["", "1", "0", "1101", "0110", "111"])
def test_runs_are_maximal_sequences_of_fixating_samples(pattern: str) -> None:
    fixating = bools([letter == "1" for letter in pattern])
    first, last = runs(clock(len(pattern), 0.01), fixating, 0.075)
    rebuilt = np.zeros(len(pattern), dtype=np.bool_)
    for start, stop in zip(first, last, strict=True):
        rebuilt[start : stop + 1] = True
    assert rebuilt.tolist() == fixating.tolist()
    assert (first[1:] > last[:-1] + 1).all()


def test_a_gap_in_time_ends_a_run() -> None:
    first, last = runs(floats([0, 0.01, 1.0, 1.01]), np.ones(4, dtype=np.bool_), 0.075)
    assert list(zip(first.tolist(), last.tolist(), strict=True)) == [(0, 1), (2, 3)]


def test_runs_far_apart_in_time_or_angle_stay_apart() -> None:
    time = floats([0, 0.01, 0.05, 0.06, 0.3, 0.31])
    points = floats([[0, 0], [0, 0], [5, 0], [5, 0], [5, 0], [5, 0]])
    fixating = np.ones(6, dtype=np.bool_)
    first, last = np.array([0, 2, 4]), np.array([1, 3, 5])
    assert merge(time, points, fixating, first, last, longest_gap=0.075, reach=10)[0].tolist() == [0, 4]
    assert merge(time, points, fixating, first, last, longest_gap=0.075, reach=1)[0].tolist() == [0, 2, 4]


def test_a_recording_of_one_sample_or_without_gaze_has_no_fixation() -> None:
    assert len(classify(np.zeros(1), np.zeros((1, 2)), np.ones(1, dtype=np.bool_)).first) == 0
    assert len(classify(clock(3, 1.0), np.zeros((3, 2)), np.zeros(3, dtype=np.bool_)).first) == 0
