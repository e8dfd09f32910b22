"""Sample times are steady despite jitter and bursts of the time stamps."""

import numpy as np
import pytest

from higvf_console.core.arrays import Floats, floats
from higvf_interfaces.formats.signals.sample_clock import SampleClock, estimate_rate

RATE = 250.0
TRUE = floats(np.arange(5000) / RATE)


def smoothed(stamps: Floats, clock: SampleClock) -> Floats:
    parts = [clock.times(part, np.ones(len(part))) for part in np.array_split(stamps, len(stamps) // 500)]
    return floats(np.concatenate(parts))


def bursts(stamps: Floats) -> Floats:
    """Stamps of a radio link: all samples of a packet have the time of its arrival."""
    return floats(np.repeat(stamps[9::10], 10) + 1e6)


def test_bursty_stamps_become_steady_times_that_follow_their_drift() -> None:
    fast = floats(TRUE * 1.0005)
    times = smoothed(bursts(fast), SampleClock(RATE))
    assert np.ptp(np.diff(times)) < 1e-3
    assert times[-1] - times[1000] == pytest.approx(fast[-1] - fast[1000], abs=0.02)


def test_a_gap_is_kept_and_a_long_gap_is_shortened() -> None:
    clock = SampleClock(RATE)
    stamps = TRUE + 2.0 * (np.arange(5000) >= 2000) + 300.0 * (np.arange(5000) >= 4000)
    times = smoothed(floats(stamps), clock)
    steps = np.diff(times)
    assert steps[1999] == pytest.approx(2.0, abs=0.01)
    assert steps[3999] == pytest.approx(10.0, abs=0.01)
    assert clock.repairs.notes == ("1 gap shortened to 10 s, the longest 300 s",)


def test_steps_back_of_the_clock_are_joined() -> None:
    clock = SampleClock(RATE)
    times = smoothed(floats(TRUE - 100.0 * (np.arange(5000) >= 2000)), clock)
    assert times == pytest.approx(TRUE, abs=0.01)
    assert clock.repairs.notes == ("1 clock restart joined",)


def test_missing_stamps_are_interpolated_at_the_nominal_rate() -> None:
    stamps = TRUE.copy()
    stamps[1000:3000] = np.nan
    assert smoothed(floats(stamps), SampleClock(RATE)) == pytest.approx(TRUE, abs=1e-6)
    assert smoothed(floats(np.full(5000, np.nan)), SampleClock(RATE)) == pytest.approx(TRUE, abs=1e-6)


def test_the_rate_is_estimated_despite_bursts_and_gaps() -> None:
    stamps = bursts(floats(TRUE + 30.0 * (np.arange(5000) >= 4000)))
    assert estimate_rate(stamps) == pytest.approx(RATE, rel=0.01)
    assert np.isnan(estimate_rate(floats([1.0])))
    assert np.isnan(estimate_rate(floats([1.0, 1.0])))


@pytest.mark.parametrize(("rate", "burst"), [(256.0, 0.3), (500.0, 0.1), (1000.0, 0.25), (2000.0, 0.2)])
def test_bursts_that_do_not_divide_the_span_do_not_bias_the_rate(rate: float, burst: float) -> None:
    taken = np.arange(4096) / rate
    assert estimate_rate(floats(np.floor(taken / burst) * burst)) == pytest.approx(rate, rel=0.01)


def test_a_gap_of_a_second_does_not_bias_the_rate() -> None:
    stamps = floats(TRUE[:4096] + 1.0 * (np.arange(4096) > 2000))
    assert estimate_rate(stamps) == pytest.approx(RATE, rel=1e-3)
