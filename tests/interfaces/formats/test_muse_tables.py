"""Tables of Muse head bands: Mind Monitor's, and those of BlueMuse, muse-lsl and Petal Metrics."""

from collections.abc import Callable

import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.signals.reading import read_decisions, read_signals
from higvf_interfaces.formats.signals.records import SignalRequest, signal_places, whole

Write = Callable[..., str]
TITLES = (
    "TimeStamp,Delta_TP9,Alpha_TP9,RAW_TP9,RAW_AF7,AUX_RIGHT,Accelerometer_X,Gyro_X,HeadBandOn,HSI_TP9,HSI_AF7,"
    "Battery,Elements\n"
)


def mind_monitor(rate: float = 256, off: range = range(0), loose: range = range(0)) -> str:
    rows: list[str] = []
    for k in range(600):
        second, milli = divmod(round(1000 * k / rate), 1000)
        stamp = f"2025-07-01 {14 + second // 3600}:{second // 60 % 60:02d}:{second % 60:02d}.{milli:03d}"
        worn, fit = int(k not in off), "4.0" if k in loose else "1.0"
        rows.append(f"{stamp},0.49,0.77,{800 + k % 5}.5,{810 + k % 3}.25,0,0.1,5.2,{worn},{fit},1.0,85.0,")
        if k in (128, 384):
            rows.append(stamp + ",,,,,,,,,,,," + ("/muse/elements/blink" if k == 128 else "/Marker/1"))
    return TITLES + "\n".join(rows) + "\n"


def test_the_raw_electrodes_of_mind_monitor_are_the_channels(write: Write) -> None:
    record = read_signals(write(mind_monitor()))
    samples = whole(record)
    assert (record.format, record.names, record.units[0]) == (
        "mind-monitor", ("RAW_TP9", "RAW_AF7", "AUX_RIGHT"), "uV",
    )  # fmt: skip
    assert record.rate == pytest.approx(256, rel=1e-3)
    assert samples.values.shape == (600, 3), "rows of events are no samples"
    assert samples.values[7, :2].tolist() == [802.5, 811.25]
    assert samples.times[-1] == pytest.approx(599 / 256, abs=2e-3)


def test_events_of_mind_monitor_are_decisions_on_the_clock_of_its_signals(write: Write) -> None:
    file = write(mind_monitor())
    log = read_decisions(file)
    assert [(d.label, round(d.time, 3)) for d in log.decisions] == [("blink", 0.5), ("Marker/1", 1.5)]
    assert log.epoch == read_signals(file).epoch


def test_samples_while_the_head_band_is_off_are_missing(write: Write) -> None:
    record = read_signals(write(mind_monitor(off=range(100, 150), loose=range(30))))
    samples = whole(record)
    assert np.flatnonzero(np.isnan(samples.values).all(axis=1)).tolist() == list(range(100, 150))
    assert "50 samples with the head band off are missing" in record.notes
    assert "30 samples of RAW_TP9 with a bad fit (HSI)" in record.notes


def test_a_recording_of_averages_is_refused_with_the_setting(write: Write) -> None:
    with pytest.raises(InputError, match="recorded at 1 Hz, too slow for EEG; set the recording interval"):
        read_signals(write(mind_monitor(rate=1)))


def table(titles: str, row: str) -> str:
    lines = [row.format(k=k, ms=1527976488650.125 + k * 3.90625, s=1527976488.65 + k / 256) for k in range(600)]
    return titles + "\n" + "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("titles", "row", "names"),
    [
        ("timestamps,TP9,AF7,Marker0", "{ms:.3f},{k}.5,7.25,0", ("TP9", "AF7")),
        ("timestamps,TP9,AF7,Secondary Timestamp (Unix)", "{s:.6f},{k}.5,7.25,{s:.6f}", ("TP9", "AF7")),
        ("id,lsl_ts,unix_ts,ch1,ch2", "{k},{k}e-2,{s:.3f},{k}.5,7.25", ("ch1", "ch2")),
        (",timestamps,TP9,AF7", "{k},{s:.6f},{k}.5,7.25", ("TP9", "AF7")),
        ("timestamps,Sample Index,TP9,AF7,Battery", "{s:.6f},{k},{k}.5,7.25,80", ("TP9", "AF7")),
    ],
)
def test_counters_and_further_time_stamps_are_no_signals(
    write: Write, titles: str, row: str, names: tuple[str, ...]
) -> None:
    record = read_signals(write(table(titles, row)))
    assert record.names == names
    assert whole(record).values[9].tolist() == [9.5, 7.25]


def test_a_left_out_column_is_noted_and_may_be_chosen(write: Write) -> None:
    file = write(table("id,lsl_ts,ch1,ch2", "{k},{s:.3f},{k}.5,7.25"))
    record = read_signals(file)
    for _ in range(2):
        whole(record)
        assert [note for note in record.notes if "no signals, left out: id; choose them" in note]
    assert whole(read_signals(file, SignalRequest(channels=("id",)))).values[9, 0] == 9


def test_a_file_of_nothing_but_such_names_keeps_them() -> None:
    assert signal_places(["id", "index"]) == [0, 1]
    assert signal_places(["TP9", "Secondary Timestamp (LSL)", "Status"]) == [0]
