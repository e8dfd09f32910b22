"""What a process uses over time: the slope, the verdict, and what is read of a real process."""

import os
import subprocess
import sys

import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.errors import HigvfError
from higvf_console.lab.bench.usage import COUNT_RISE, MEMORY_RISE, Usage, sample, trend, trends, usage_of


def samples(memory: list[float], handles: float = 10.0) -> list[Usage]:
    return [Usage(100.0 + time, value, handles, 4.0) for time, value in enumerate(memory)]


def test_the_slope_is_that_of_the_line_through_noisy_values() -> None:
    times = floats(np.linspace(50.0, 650.0, 601))
    noise = np.sin(np.arange(601) * 2.0 * np.pi / 7.0)
    found = trend(times, floats(300.0 + 0.02 * (times - 350.0) + noise), allowed=12.5)
    assert found.mean == pytest.approx(300.0, abs=0.01)
    assert found.per_hour == pytest.approx(72.0, rel=0.01)
    assert found.rise == pytest.approx(12.0, rel=0.01)
    assert found.flat
    assert not trend(times, floats(0.02 * times), allowed=11.5).flat
    assert trend(times, floats(-5.0 * times), allowed=0.1).flat, "what falls is no leak"


def test_the_warm_up_is_left_out() -> None:
    rising_at_first = [100.0 + 10.0 * min(time, 20) for time in range(101)]
    found = trends(samples(rising_at_first))
    assert found.memory.per_hour == pytest.approx(0.0, abs=1e-9)
    assert found.flat
    assert not trends(samples([100.0 + 10.0 * min(time, 60) for time in range(101)])).flat


def test_memory_may_rise_by_a_share_and_a_count_by_a_number() -> None:
    def leaking(share: float) -> list[float]:
        return [1000.0 * (1.0 + share * (time - 62.5) / 75.0) for time in range(101)]

    assert trends(samples(leaking(0.9 * MEMORY_RISE))).memory.flat
    assert not trends(samples(leaking(1.1 * MEMORY_RISE))).memory.flat
    dropped = samples([500.0] * 101)
    one_handle_a_minute = [usage._replace(handles=10.0 + (usage.time - 100.0) * COUNT_RISE / 60.0) for usage in dropped]
    found = trends(one_handle_a_minute)
    assert not found.handles.flat
    assert not found.flat
    assert found.threads.flat


def test_too_few_samples_are_an_error_and_no_verdict() -> None:
    with pytest.raises(HigvfError, match="2 samples are too few for a slope"):
        trends(samples([1.0, 2.0]))
    with pytest.raises(HigvfError, match="0 samples are too few"):
        trends([])


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_process_is_sampled_with_its_children_until_it_is_enough() -> None:
    alone = usage_of(os.getpid())
    assert alone.memory > 10.0
    with subprocess.Popen([sys.executable, "-c", "print(flush=True); input()"], stdin=-1, stdout=-1) as child:
        assert child.stdout is not None
        child.stdout.readline()
        together = usage_of(os.getpid())
        assert together.threads >= alone.threads + 1
        assert together.handles >= alone.handles + 3
        assert together.memory > alone.memory + 3.0
        turns: list[int] = []
        taken = sample(child.pid, lambda _: len(turns) < 4, period=0.001, each=lambda: turns.append(1))
        assert [usage.threads for usage in taken] == [1.0] * 4
        child.communicate(b"\n")
    with pytest.raises(HigvfError, match=f"process {child.pid} in /proc"):
        usage_of(child.pid)
