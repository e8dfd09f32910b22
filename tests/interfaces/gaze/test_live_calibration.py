"""A live calibration needs a fixation of each of five targets."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.arrays import Floats, bools, floats
from higvf_console.core.viewport import Arena, fit
from higvf_interfaces.gaze.calibration import Calibration, read_calibration, targets, to_arena
from higvf_interfaces.gaze.chunked_fixations import Pixels
from higvf_interfaces.gaze.live_calibration import COUNT, REST, TRAVEL, LiveCalibration
from tests.browser import wait_until

ARENA = Arena(0.0, 0.0, 1200.0, 700.0)
SCREEN = (1920.0, 1080.0)
RATE = 60
LOOKED = fit(ARENA, *SCREEN).to_screen(targets(ARENA, COUNT)) + np.array([[30.0, -20.0]])  # the tracker is off


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def samples(points: Floats, start: float, *, noise: float = 3.0, seed: int = 1) -> Iterator[Pixels]:
    """Gaze in blocks of five samples."""
    noisy = points + np.random.default_rng(seed).normal(0, noise, points.shape)
    time = start + np.arange(len(points)) / RATE
    for first in range(0, len(points), 5):
        part = slice(first, first + 5)
        yield Pixels(floats(time[part]), floats(noisy[part]), bools(np.isfinite(noisy[part]).all(axis=1)))


def rest(point: Floats, seconds: float) -> Floats:
    return floats(np.tile(point, (round(seconds * RATE), 1)))


def look_round(calibration: LiveCalibration, points: Floats) -> Calibration | None:
    """Fixates each point until the next target is shown."""
    clock = 0.0
    for number, point in enumerate(points, start=1):
        for block in samples(rest(point, 4.0), clock):
            clock = float(block.time[-1]) + 1 / RATE
            made = calibration.take(block)
            if made is not None:
                return made
            if calibration.report().number != number:
                break
    return None


def test_fixating_every_target_gives_a_calibration_that_is_stored() -> None:
    calibration = LiveCalibration(ARENA, SCREEN, 38.0)
    calibration.begin()
    made = look_round(calibration, floats(LOOKED))
    assert made is not None
    assert made.residual < 3.0
    np.testing.assert_allclose(to_arena(made, floats(LOOKED)), targets(ARENA, COUNT), atol=3.0)
    wait_until(lambda: "; written to" in calibration.report().outcome)
    assert calibration.report().target is None
    again = read_calibration(Path(made.file))
    np.testing.assert_allclose(again.homography, made.homography, rtol=1e-6)
    assert (again.screen, again.made) == (SCREEN, made.made)


def test_a_target_needs_travel_time_and_a_fixation() -> None:
    calibration = LiveCalibration(ARENA, SCREEN, 38.0)
    calibration.begin()
    blocks = samples(rest(floats(LOOKED[0]), 3.0), 5.0)
    shares = [(float(block.time[-1]), calibration.report().progress) for block in blocks
              if calibration.take(block) is None and calibration.report().number == 1]  # fmt: skip
    assert all(share == 0.0 for time, share in shares if time < 5.0 + TRAVEL)
    assert shares[-1][0] == pytest.approx(5.0 + TRAVEL + REST, abs=0.2)
    assert [share for _, share in shares] == sorted(share for _, share in shares)


def test_a_glance_away_restarts_the_fixation_and_a_blink_does_not() -> None:
    def needed(between: Floats) -> float:
        calibration = LiveCalibration(ARENA, SCREEN, 38.0)
        calibration.begin()
        gaze = floats(np.concatenate([rest(floats(LOOKED[0]), TRAVEL + 0.5), between, rest(floats(LOOKED[0]), 3.0)]))
        for block in samples(gaze, 0.0):
            calibration.take(block)
            if calibration.report().number == 2:
                return float(block.time[-1])
        raise AssertionError("the second target never came")

    blink, glance = rest(floats([np.nan, np.nan]), 0.2), rest(floats([960, 540]), 0.2)
    assert needed(blink) < TRAVEL + REST + 0.2
    assert needed(glance) > TRAVEL + 0.5 + 0.2 + REST - 0.1


def test_cancelling_leaves_no_file(tmp_path: Path) -> None:
    calibration = LiveCalibration(ARENA, SCREEN, 38.0)
    calibration.begin()
    for block in samples(rest(floats(LOOKED[0]), 1.2), 0.0):
        calibration.take(block)
    assert calibration.report().target is not None
    calibration.cancel()
    calibration.take(next(samples(rest(floats(LOOKED[0]), 0.1), 2.0)))
    assert calibration.report().target is None
    assert "Cancelled" in calibration.report().outcome
    assert list(tmp_path.iterdir()) == []


def test_gaze_that_stays_in_one_place_fails_to_calibrate() -> None:
    calibration = LiveCalibration(ARENA, SCREEN, 38.0)
    calibration.begin()
    assert look_round(calibration, floats([[960, 540]] * COUNT)) is None
    assert calibration.report().outcome.startswith("Failed: calibration:")


def test_a_calibration_that_cannot_be_written_is_used_and_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def elsewhere(path: Path) -> Path:
        return tmp_path / "gone" / path

    monkeypatch.setattr(Path, "absolute", elsewhere)
    calibration = LiveCalibration(ARENA, SCREEN, 38.0)
    calibration.begin()
    assert look_round(calibration, floats(LOOKED)) is not None
    wait_until(lambda: "not written" in calibration.report().outcome)
