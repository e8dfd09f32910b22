"""Device times pass one gate, whatever the format: range, order, gaps, and a clock that was set."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.decisions.emg import open_emg
from higvf_interfaces.formats.clock import DeviceClock, clock_warnings, event_times, joined
from higvf_interfaces.formats.common_clock import ArrivalClock, on_one_clock
from higvf_interfaces.formats.reading import read_gaze
from higvf_interfaces.formats.signals.reading import read_decisions, read_signals
from higvf_interfaces.formats.signals.records import SignalRequest, whole
from higvf_interfaces.gaze.interface import open_gaze
from tests.interfaces.formats.xdf_files import Stream, xdf

Write = Callable[..., str]
UNIX = 1_683_195_330.0
STEADY = np.arange(500) / 100.0


def gaze_of(times: Floats, write: Write) -> str:
    return write("time [s],x [px],y [px]\n" + "".join(f"{t:.4f},{k},2\n" for k, t in enumerate(times.tolist())))


def stream_of(times: Floats, rate: float = 100.0) -> Stream:
    return Stream("Tobii", "Gaze", "g", rate, times.tolist(), [(float(k), 2.0) for k in range(len(times))], ("x", "y"))


def jumped(by: float, at: int = 250) -> Floats:
    return floats(STEADY + by * (np.arange(500) >= at))


@pytest.mark.parametrize("by", [UNIX, -UNIX, 200_000.0, -50.0], ids=["to Unix time", "from it", "200 000 s", "back"])
@pytest.mark.parametrize("form", ["table", "xdf", "xdf without rate", "signals"])
def test_samples_after_a_clock_was_set_follow_on_and_it_is_said(by: float, form: str, write: Write) -> None:
    times = floats(jumped(by) + 100.0)
    if form == "table":
        gaze = read_gaze(gaze_of(times, write))
        found, notes = gaze.time, gaze.notes
    elif form == "signals":
        table = "timestamps,C3\n" + "".join(f"{t:.4f},{k}.5\n" for k, t in enumerate(times.tolist()))
        record = read_signals(write(table))
        found = whole(record).times
        notes = tuple(record.notes)
    else:
        gaze = read_gaze(write(xdf(stream_of(times, 100.0 if form == "xdf" else 0.0))))
        found, notes = gaze.time, gaze.notes
    assert found - found[0] == pytest.approx(STEADY, abs=0.02)
    said = "1 clock restart joined" if by < 0 else f"the clock was set 1 time, by up to {by:.0f} s: joined"
    assert notes == (said,)


@pytest.mark.parametrize("at", [1, 100, 300])
def test_a_lone_stamp_far_from_the_others_shifts_nothing(at: int, write: Write) -> None:
    times = STEADY.copy()
    times[at] += 5000.0
    gaze = read_gaze(gaze_of(floats(times), write))
    assert gaze.time == pytest.approx(np.delete(STEADY, at))
    assert gaze.notes == ("1 implausible time stamp ignored",)


def test_times_out_of_range_are_no_times(write: Write) -> None:
    gaze = read_gaze(write(xdf(stream_of(floats(np.where(np.arange(500) == 300, 3.5e307, STEADY)), 0.0))))
    assert gaze.time == pytest.approx(np.delete(STEADY, 300))
    assert "1 implausible time stamp ignored" in gaze.notes


def test_a_signal_that_jumped_by_200_000_s_keeps_its_rate(write: Write) -> None:
    times = (100.0 + np.arange(2560) / 256.0 + 200_000.0 * (np.arange(2560) >= 1280)).tolist()
    record = read_signals(write(xdf(Stream("Muse", "EEG", "m", 256, times, [(1.0,)] * 2560, ("TP9",)))))
    assert record.rate == pytest.approx(256)
    assert whole(record).times[-1] == pytest.approx(2559 / 256)
    assert record.notes == ["the clock was set 1 time, by up to 200000 s: joined"]


def test_a_short_loss_of_samples_is_not_smeared_over_the_others(write: Write) -> None:
    times = floats(STEADY + 1.0 * (np.arange(500) >= 250))  # fewer than the 500 samples that pyxdf smooths across
    assert read_gaze(write(xdf(stream_of(times)))).time == pytest.approx(times, abs=1e-3)


def test_a_log_whose_first_stamp_precedes_the_setting_of_the_clock_waits_for_no_years(write: Write) -> None:
    log = read_decisions(write(f"time,label\n0,rest\n{UNIX},fist\n{UNIX + 1.5},open\n"))
    assert [decision.time for decision in log.decisions] == pytest.approx([0.0, 1.5, 3.0])
    assert log.notes == ("the clock was set 1 time, by up to 1683195330 s: joined",)
    assert log.decisions[1].time + log.epoch == pytest.approx(UNIX)  # aligns with signals of the clock as it was set


@pytest.mark.parametrize(
    ("stamps", "times", "note"),
    [
        ([5.0, UNIX, 7.0], [5, 5, 7], "1 implausible time stamp ignored"),
        ([5.0, 7.0, 6.5], [5, 6.5, 7], "entries out of order: sorted by time"),
        ([5.0, 60.0, 6.0], [5, 6, 60], "entries out of order by up to 54 s: sorted by time"),
        ([5.0, 7.0, 500.0], [5, 7, 500], None),  # operators pause
        ([5.0, 7.0, 5000.0], [5, 7, 5000], "a gap of 4993 s is waited for"),
        ([UNIX, UNIX + 2, 3.0], [0, 2, 4], "1 clock restart joined"),
    ],
    ids=["lone", "out of order", "far out of order", "a pause", "a long pause", "restarted"],
)
def test_events_are_kept_whatever_their_clock_did(stamps: list[float], times: list[float], note: str | None) -> None:
    found = event_times(floats(stamps), from_epoch=True)
    assert sorted(found.order.tolist()) == [0, 1, 2]
    assert found.times == pytest.approx(times)
    assert note is None or note in found.notes
    assert note is not None or found.notes == ()


def test_streams_of_different_clocks_each_begin_at_time_0_and_it_is_said(write: Write) -> None:
    eeg = Stream("Muse", "EEG", "m", 100, (71_360 + STEADY).tolist(), [(1.0,)] * 500, ("TP9",))
    cues = Stream("Stim", "Markers", "s", 0, [UNIX, UNIX + 2.0], ["robot1", "robot2"])
    late = Stream("Late", "Markers", "l", 0, [71_364.0], ["robot3"])
    file = write(xdf(eeg, cues, late))
    log = read_decisions(file, SignalRequest(stream="Stim"))
    assert [decision.time for decision in log.decisions] == pytest.approx([0.0, 2.0])
    assert log.epoch == UNIX
    assert any(note.startswith("Muse, Late and Stim lie 1683123") and "different clocks" in note for note in log.notes)
    assert read_decisions(file, SignalRequest(stream="Late")).decisions[0].time == pytest.approx(4.0)
    assert any("Stim and Muse lie" in note for note in read_signals(file).notes)


def test_a_chain_of_streams_shares_one_clock() -> None:
    spans = [(0.0, 10.0), (3000.0, 3010.0), (6000.0, 6010.0), (1e6, 1e6), (np.nan, np.nan)]
    assert on_one_clock(spans, 0) == [0, 1, 2, 4]
    assert on_one_clock(spans, 3) == [3, 4]


def test_a_clock_that_restarts_between_blocks_is_joined() -> None:
    clock = DeviceClock(Path("a file"), 0.0)
    first, second = (clock.repair(floats(block))[0] for block in (STEADY, STEADY))
    assert np.concatenate([first, second]) == pytest.approx(np.arange(1000) / 100)


def test_a_recording_without_times_is_refused(write: Write) -> None:
    with pytest.raises(InputError, match="no row has a time"):
        read_gaze(write("time [s],x [px],y [px]\nnan,1,2\n,3,4\n"))


def test_rows_slightly_out_of_order_stay_for_the_reader_to_drop() -> None:
    times, repairs = joined(floats([0.0, 0.2, 0.1, 0.3]))
    assert times == pytest.approx([0.0, 0.2, 0.1, 0.3])
    assert repairs.notes == ()


@pytest.mark.parametrize("off", [0.0, UNIX, -UNIX, 120.0, -50.0])
def test_a_live_sample_arrives_soon_after_its_stamp(off: float) -> None:
    clock = ArrivalClock(60.0, 1.0)
    times = [clock.time(1000.0 + k / 100 + off, 1000.0 + k / 100 + 0.005) for k in range(100)]
    assert times == pytest.approx([1000.0 + k / 100 for k in range(100)], abs=0.006 if off != -50.0 else 51)
    assert clock.notes == (
        () if off in (0.0, -50.0) else (f"its clock was {abs(off):.0f} s off this machine's: joined 1 time",)
    )


def test_a_live_clock_that_is_set_back_does_not_stop_the_stream() -> None:
    clock = ArrivalClock(60.0, 1.0)
    stamps = [1000.0 + k / 100 - 30.0 * (k >= 50) for k in range(100)]
    times = [clock.time(stamp, 1000.0 + k / 100) for k, stamp in enumerate(stamps)]
    assert np.diff(times) == pytest.approx(0.01)
    assert clock.time(float("nan"), 1001.0) == 1001.0
    assert clock.notes == (
        "1 sample without a time: arrival used",
        "its clock was 30 s off this machine's: joined 1 time",
    )


def test_a_run_is_warned_of_a_clock_and_of_nothing_else(write: Write) -> None:
    late = write(f"time,label\n0,rest\n{UNIX},fist\n{UNIX + 1.5},open\n", "late.csv")
    assert open_emg(InputSpec("emg", late)).warnings == ("the clock was set 1 time, by up to 1683195330 s: joined",)
    usual = write(f"time,label\n{UNIX + 0.5},open\n{UNIX},fist\n", "usual.csv")
    assert open_emg(InputSpec("emg", usual)).warnings == ()
    (warning,) = open_gaze(InputSpec("gaze", gaze_of(jumped(-50.0), write))).warnings
    assert warning == "1 clock restart joined"


@pytest.mark.parametrize(
    ("times", "said"),
    [
        ([1.0, 3.0], "lie 1997 s apart, perhaps on different clocks; shift one with start="),
        ([5_001_000.0, 5_003_000.0], "lie 4995999 s apart, so on different clocks (perhaps milliseconds): "),
    ],
    ids=["from the start of the program", "milliseconds"],
)
def test_a_marker_clock_of_another_kind_is_said(times: list[float], said: str, write: Write) -> None:
    start = 2000.0 if times[0] == 1.0 else 5000.0
    eeg = Stream("Muse", "EEG", "m", 100, (start + STEADY / 5).tolist(), [(1.0,)] * 500, ("TP9",))
    marks = Stream("Psy", "Markers", "p", 0, times, ["fist", "open"])
    log = read_decisions(write(xdf(eeg, marks)))
    assert any(said in note for note in log.notes)
    assert clock_warnings(log.notes)


def test_a_signal_without_increasing_times_is_refused(write: Write) -> None:
    with pytest.raises(InputError, match="the 300 samples of stream Muse have no increasing times"):
        read_signals(write(xdf(Stream("Muse", "EEG", "m", 100, [0.0] * 300, [(1.0,)] * 300, ("A",)))))
