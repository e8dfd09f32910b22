"""Recordings of OpenBCI boards and of BrainFlow, in the dialects of their programs, are read whole or refused."""

from collections.abc import Callable

import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.signals.reading import read_decisions, read_signals
from higvf_interfaces.formats.signals.records import SignalRequest, whole

Write = Callable[..., str]
ABOUT = "%OpenBCI Raw EEG Data\n{}%Sample Rate = {} Hz\n%First Column = SampleIndex\n"


def old(
    rows: int, channels: int, *, modulus: int = 256, rate: int = 250, count: bool = True, stamps: str = "both"
) -> str:
    """A recording without a header row: counter, channels, three accelerometer channels, times."""
    lines: list[str] = []
    for k in range(rows):
        values = [f"{k % 7 + 10 * c:.2f}" for c in range(channels)] + ["0.016", "0.474", "0.114"]
        time = k / rate
        day = [f"14:45:{time:06.3f}"] if stamps in ("both", "day") else []
        epoch = [str(1541598342000 + round(1000 * time))] if stamps in ("both", "epoch") else []
        lines.append(", ".join([str(k % modulus), *values, *day, *epoch]))
    about = ABOUT.format(f"%Number of channels = {channels}\n" if count else "%\n", f"{rate}.0")
    return about + "\n".join(lines) + "\n"


@pytest.mark.parametrize("modulus", [101, 201, 256])
def test_no_sample_is_lost_where_the_counter_of_any_board_wraps(write: Write, modulus: int) -> None:
    record = read_signals(write(old(2010, 4, modulus=modulus, rate=200)))
    samples = whole(record)
    assert (len(samples.times), record.rate, record.notes) == (2010, 200, [])
    assert np.diff(samples.times) == pytest.approx(0.005, abs=1e-6)


def test_samples_lost_where_a_counter_wraps_are_found(write: Write) -> None:
    lines = old(2010, 4, modulus=201, rate=200).splitlines(keepends=True)
    begin = len(ABOUT.format("\n", "").splitlines())
    file = write("".join(lines[: begin + 1004] + lines[begin + 1007 :]))
    record = read_signals(file)
    assert np.diff(whole(record).times).max() == pytest.approx(0.02, abs=2e-3)
    assert record.notes == ["3 samples lost by the radio link"]


@pytest.mark.parametrize(("channels", "stamps"), [(8, "day"), (16, "both"), (4, "epoch")])
def test_without_a_count_the_columns_tell_the_channels(write: Write, channels: int, stamps: str) -> None:
    record = read_signals(write(old(300, channels, count=False, stamps=stamps)))
    assert len(record.names) == channels
    assert whole(record).values[8].tolist() == [1 + 10 * c for c in range(channels)]
    assert any("no line %Number of channels" in note for note in record.notes)


def test_columns_that_fit_no_board_are_refused_unless_channels_are_chosen(write: Write) -> None:
    file = write(old(300, 6, count=False))
    with pytest.raises(InputError, match=r"12 columns fit no board with 4, 8, 16 channels; choose by channels=EXG"):
        read_signals(file)
    request = SignalRequest(channels=("EXG Channel 5", "EXG Channel 0"))
    assert whole(read_signals(file, request)).values[8].tolist() == [51, 1]


def test_a_count_that_contradicts_the_columns_is_refused(write: Write) -> None:
    with pytest.raises(InputError, match="%Number of channels = 16 contradicts the 7 columns"):
        read_signals(write(old(300, 4).replace("channels = 4", "channels = 16")))


def commas(text: str) -> str:
    return text.replace(".", ",")


def test_decimal_commas_are_joined_where_a_blank_follows_the_delimiter(write: Write) -> None:
    record = read_signals(write(commas(old(600, 4, rate=200))))
    samples = whole(record)
    assert (record.rate, record.notes) == (200, [])
    assert samples.values[8].tolist() == [1, 11, 21, 31]
    assert np.diff(samples.times) == pytest.approx(0.005, abs=1e-6)


@pytest.mark.parametrize("delimiter", [";", "\t"])
def test_decimal_commas_with_another_delimiter_are_read(write: Write, delimiter: str) -> None:
    text = commas(old(600, 4, rate=200).replace(", ", delimiter))
    assert whole(read_signals(write(text))).values[8].tolist() == [1, 11, 21, 31]


def test_decimal_commas_that_cannot_be_told_from_delimiters_are_refused(write: Write) -> None:
    text = commas(old(600, 4).replace(", ", ","))
    with pytest.raises(
        InputError, match=r"decimal commas and are separated by commas.*record them with a decimal point"
    ):
        read_signals(write(text))


def sd_card(channels: int, count: bool = False) -> str:
    rows = [
        ",".join([str(k % 256), *(f"{k + c}.50" for c in range(channels)), *(["0.1", "0.2", "0.3"] * (k % 10 == 0))])
        for k in range(400)
    ]
    about = ABOUT.format(f"%Number of channels = {channels}\n" if count else "", "250.0")
    return about.replace("%OpenBCI Raw EEG Data", "%OBCI SD Convert - 2016") + "\n".join(rows) + "\n"


@pytest.mark.parametrize(("channels", "count"), [(8, False), (16, False), (8, True)])
def test_a_recording_from_an_sd_card_keeps_the_rows_with_and_without_accelerometer(
    write: Write, channels: int, count: bool
) -> None:
    record = read_signals(write(sd_card(channels, count)), SignalRequest(rate=250))
    samples = whole(record)
    assert samples.values.shape == (400, channels)
    assert samples.values[10].tolist() == [10.5 + c for c in range(channels)]
    assert samples.times[-1] == pytest.approx(399 / 250)


def test_a_recording_whose_first_column_is_the_time_is_read_by_that_time(write: Write) -> None:
    about = (
        "%OpenBCI Raw EEG Data\n%\n%Sample Rate = 250.0 Hz\n%First Column = Time in sec\n%Second Column = SampleIndex\n"
    )
    rows = "".join(
        f"{k / 250:.6f},{k % 256},{','.join(f'{k + c}.0' for c in range(8))},0.1,0.2,0.3,\n" for k in range(300)
    )
    samples = whole(read_signals(write(about + rows)))
    assert samples.values[5].tolist() == [5.0 + c for c in range(8)], "the counter is no channel"
    assert samples.times == pytest.approx(np.arange(300) / 250, abs=1e-4)
    with pytest.raises(InputError, match=r"%First Column = battery is not understood; known: SampleIndex, Time in sec"):
        read_signals(write((about + rows).replace("Time in sec", "Battery")))


def brainflow(width: int, channels: int, rate: int = 250, delimiter: str = "\t") -> str:
    rows: list[str] = []
    for k in range(600):
        others = ["0.0"] * (width - channels - 3)
        values = [f"{k + c}.25" for c in range(channels)]
        stamp = f"{1671576040 + k / rate:.6f}"
        rows.append(delimiter.join([f"{k % 256}.0", *values, *others, stamp, "3.0" if k == 250 else "0.0"]))
    return "\n".join(rows) + "\n"


@pytest.mark.parametrize(
    ("width", "channels", "rate"), [(24, 8, 250), (32, 16, 125), (15, 4, 200), (8, 4, 256), (7, 4, 256)]
)
@pytest.mark.parametrize("delimiter", ["\t", ","])
def test_a_brainflow_file_is_read_by_its_width(
    write: Write, width: int, channels: int, rate: int, delimiter: str
) -> None:
    record = read_signals(write(brainflow(width, channels, rate, delimiter)))
    samples = whole(record)
    assert (record.format, record.units[0], record.rate) == ("brainflow-csv", "uV", pytest.approx(rate, rel=1e-3))
    assert samples.values[7].tolist() == [7.25 + c for c in range(channels)]
    assert samples.times[-1] == pytest.approx(599 / rate, abs=1e-3)
    assert any(f"{width} columns: read as those of" in note for note in record.notes)


def test_markers_of_a_brainflow_file_are_decisions(write: Write) -> None:
    (decision,) = read_decisions(write(brainflow(24, 8))).decisions
    assert (decision.label, decision.time) == ("3", pytest.approx(1.0, abs=1e-3))


def test_a_brainflow_file_of_another_board_needs_its_columns(write: Write) -> None:
    file = write(brainflow(21, 10))
    with pytest.raises(InputError, match=r"21 columns is of no known board .*channels=column 2\+column 3"):
        read_signals(file)
    record = read_signals(file, SignalRequest(channels=("column 3", "column 2")))
    assert whole(record).values[7].tolist() == [8.25, 7.25]


def test_a_counter_that_starts_anew_far_into_a_recording_loses_nothing(write: Write) -> None:
    rows = "".join(
        f"{k % 5000}, {k}.5, 1.25, 2.25, 3.25, 0.1, 0.2, 0.3, {1541598342000 + 4 * k}\n" for k in range(5100)
    )
    record = read_signals(write(ABOUT.format("%Number of channels = 4\n", "250.0") + rows))
    assert np.diff(whole(record).times) == pytest.approx(0.004, abs=1e-6)
    assert record.notes == []
