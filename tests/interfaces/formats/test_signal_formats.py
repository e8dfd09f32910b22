"""Recordings of EMG and BCI are recognised by content, on one clock, with notes on repairs."""

import gzip
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

import edfio
import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.formats.signals.reading import read_decisions, read_signals
from higvf_interfaces.formats.signals.records import SignalRequest, whole
from tests.interfaces.formats.xdf_files import Stream, xdf

Write = Callable[..., str]
Sample = Callable[[str], Path]

MUSE = "timestamps,TP9,Right AUX,Marker0\n" + "".join(
    f"{500 + k / 256:.3f},{k % 7}.5,{k % 5},{2 if k == 128 else 0}\n" for k in range(512)
)
NEW_TITLES = (
    "Sample Index, EXG Channel 0, EXG Channel 1, Accel Channel 0, Not Used, Not Used, Timestamp, Marker Channel, "
    "Timestamp (Formatted)"
)
ABOUT = "%OpenBCI Raw EXG Data\n%Number of channels = 2\n%Sample Rate = 250 Hz\n%Board = OpenBCI_GUI$BoardCyton\n"


def eeg(kind: str = "EEG", source: str = "a1", *, sign: int = 1, closed: bool = True) -> Stream:
    times = [900.0 + k / 100 for k in range(300)]
    return Stream(
        name="Muse",
        type=kind,
        source=source,
        rate=100,
        times=times,
        samples=[(sign * k, -sign * k) for k in range(300)],
        labels=("TP9", "AF7"),
        closed=closed,
    )


def marks(*labels: str, kind: str = "Markers", name: str = "Cues") -> Stream:
    return Stream(name, kind, "", 0, [901.0 + k for k in range(len(labels))], labels)


def openbci(rows: int, *, seconds: bool = False, lost: int = -1, marker_at: int = -1) -> str:
    lines: list[str] = []
    for k in range(rows):
        count = k + (3 if 0 <= lost <= k else 0)
        stamp = f"{1700000000 + count / 250:.6f}" if seconds else f"{1700000000000 + 4 * count}"
        lines.append(f"{count % 256}, {k}.5, -{k}.25, 0.1,0,0, {stamp}, {3.0 if k == marker_at else 0.0}, 12:00:00.000")
    return ABOUT + NEW_TITLES + "\n" + "\n".join(lines) + "\n"


def test_markers_of_an_xdf_file_are_plain_labels_spans_or_json(write: Write) -> None:
    labels = ("fist", "0s", "0e", '{"label": "left", "confidence": 0.7}', '{"marker": 3}', '{"odd": 1}', "")
    log = read_decisions(write(xdf(eeg(), marks(*labels)), "a.bin"))
    assert log.format == "xdf-markers"
    assert [d.label for d in log.decisions] == ["fist", "0s", "0e", "left", "3"]
    assert [d.confidence for d in log.decisions] == [None, None, None, 0.7, None]
    assert log.decisions[0].time == pytest.approx(1.0), "0 is the earliest sample of any stream"
    assert log.epoch == pytest.approx(900.0)


def test_signals_and_markers_of_an_xdf_file_share_one_clock(write: Write) -> None:
    record = read_signals(write(xdf(eeg(), marks("a"))))
    samples = whole(record)
    assert (record.names, record.units, record.rate) == (("TP9", "AF7"), ("uV", "uV"), pytest.approx(100))
    assert samples.times[100] == pytest.approx(1.0, abs=1e-6)
    assert samples.values[100].tolist() == [100, -100]


def test_pyxdf_does_not_write_to_the_terminal(write: Write, caplog: pytest.LogCaptureFixture) -> None:
    read_signals(write(xdf(eeg(), marks("a"))))
    assert caplog.records == []


def test_streams_with_the_same_name_are_selected_by_type_source_or_number(write: Write) -> None:
    file = write(xdf(eeg("ACC", "x", sign=-1), eeg(source="y"), marks("a")))
    with pytest.raises(InputError) as refusal:
        read_signals(file)
    assert "the file has 2 signal streams; choose one by stream=TYPE, NAME, SOURCE or NUMBER" in str(refusal.value)
    assert "#1: type ACC, name Muse, source x (2 channels, 100 Hz, 300 samples)" in str(refusal.value)
    assert "type Markers, name Cues (1 channels, texts, 1 samples)" in str(refusal.value)
    for words in ("eeg", "y", "2", "#2", "Muse+EEG", "muse+y"):
        assert whole(read_signals(file, SignalRequest(stream=words))).values[7].tolist() == [7, -7]
    with pytest.raises(InputError, match="stream=Muse fits 2 signal streams"):
        read_signals(file, SignalRequest(stream="Muse"))
    with pytest.raises(InputError, match="stream=GSR fits 0 signal streams"):
        read_signals(file, SignalRequest(stream="GSR"))


def test_a_truncated_xdf_file_gives_its_readable_part_with_a_note(write: Write) -> None:
    complete = xdf(eeg(closed=False), marks("a"))
    assert read_signals(write(complete)).notes == ["the recording was cut off: only its 300 readable samples are used"]
    torn = read_signals(write(complete[:-500]))
    assert torn.notes == ["the recording was cut off: only its 200 readable samples are used"]
    assert whole(torn).values[199].tolist() == [199, -199]
    with pytest.raises(InputError, match="the XDF file cannot be read"):
        read_signals(write(complete[:200]))


def test_edf_channels_become_a_signal_and_annotations_decisions(tmp_path: Path) -> None:
    signals = [
        edfio.EdfSignal(np.arange(400.0) * (k + 1), 200, label=f"EMG{k}", physical_dimension="uV") for k in (0, 1)
    ]
    slow = edfio.EdfSignal(np.zeros(20), 10, label="Temp", physical_dimension="degC")
    notes = [edfio.EdfAnnotation(0.5, None, "fist"), edfio.EdfAnnotation(1.25, 0.1, "rest")]
    edfio.Edf([*signals, slow], annotations=notes).write(tmp_path / "sub-1_task-x_emg.edf")
    (tmp_path / "sub-1_task-x_channels.tsv").write_text(
        "name\ttype\tunits\tstatus\nEMG0\tEMG\tV\tgood\nEMG1\tEMG\tuV\tbad\n"
    )
    record = read_signals(str(tmp_path / "sub-1_task-x_emg.edf"))
    samples = whole(record)
    assert (record.names, record.units, record.rate) == (("EMG0", "EMG1"), ("uV", "uV"), 200)
    assert samples.values[300].tolist() == pytest.approx([300, 600], abs=0.02)
    assert samples.times[300] == 1.5
    assert record.notes == [
        "other rates than 200 Hz, left out: Temp (10 Hz); choose them by channels=",
        "marked bad in channels.tsv: EMG1",
        "channels.tsv contradicts the header in the units of 1 channels: the header is used",
    ]
    log = read_decisions(str(tmp_path / "sub-1_task-x_emg.edf"))
    assert log.decisions == (Decision(0.5, "fist", None), Decision(1.25, "rest", None))


def test_a_truncated_edf_file_gives_its_readable_part_with_a_note(tmp_path: Path, write: Write) -> None:
    edfio.Edf([edfio.EdfSignal(np.arange(400.0), 200, label="EMG")], data_record_duration=0.5).write(tmp_path / "a.edf")
    record = read_signals(write((tmp_path / "a.edf").read_bytes()[:-250]))
    assert len(whole(record).times) == 200
    assert any("cut off" in note for note in record.notes)


def test_bdf_is_read_like_edf(tmp_path: Path) -> None:
    signal = edfio.BdfSignal(np.arange(256.0), 128, label="C3", physical_dimension="uV")
    edfio.Bdf([signal], annotations=[edfio.EdfAnnotation(1.0, None, "go")]).write(tmp_path / "a.bdf")
    assert whole(read_signals(str(tmp_path / "a.bdf"))).values[200, 0] == pytest.approx(200, abs=0.01)
    assert read_decisions(str(tmp_path / "a.bdf")).decisions == (Decision(1.0, "go", None),)


@pytest.mark.parametrize("seconds", [False, True], ids=["milliseconds", "seconds"])
def test_a_new_openbci_recording_is_read_through_its_wrapping_counter(write: Write, seconds: bool) -> None:
    record = read_signals(write(openbci(600, seconds=seconds)))
    samples = whole(record)
    assert (record.names, record.units, record.rate) == (("EXG Channel 0", "EXG Channel 1"), ("uV", "uV"), 250)
    assert samples.values[599].tolist() == [599.5, -599.25]
    assert samples.times == pytest.approx(np.arange(600) / 250, abs=1e-3)
    assert record.epoch == pytest.approx(1_700_000_000)
    assert record.notes == []


def test_lost_openbci_samples_are_found_by_the_counter(write: Write) -> None:
    record = read_signals(write(openbci(600, lost=400)))
    samples = whole(record)
    assert record.notes == ["3 samples lost by the radio link"]
    assert samples.times[400] - samples.times[399] == pytest.approx(4 / 250, abs=1e-3)


def test_markers_of_an_openbci_recording_are_decisions(write: Write) -> None:
    (decision,) = read_decisions(write(openbci(300, marker_at=125))).decisions
    assert (decision.label, decision.time) == ("3", pytest.approx(0.5, abs=0.01))
    with pytest.raises(InputError, match="no event is marked in this openbci-txt table"):
        read_decisions(write(openbci(300)))


def test_an_old_openbci_recording_without_a_header_is_read(write: Write) -> None:
    about = "%OpenBCI Raw EEG Data\n%\n%Number of channels = 2\n%Sample Rate = 250.0 Hz\n"
    rows = [f"{k % 256}, {k}.5, -{k}.25, 0.1, 0.2, 0.3, 10:00:{k // 250:02d}.{4 * (k % 250):03d}" for k in range(300)]
    for tail in ("", ", 1510000000000"):
        record = read_signals(write(about + "\n".join(row + tail for row in rows) + "\n"))
        samples = whole(record)
        assert samples.values[299].tolist() == [299.5, -299.25]
        assert record.names == ("EXG Channel 0", "EXG Channel 1")
    plain = whole(read_signals(write(about + "\n".join(rows) + "\n")))
    assert plain.times == pytest.approx(np.arange(300) / 250, abs=1e-3)


def test_a_truncated_last_row_is_dropped_with_a_note(write: Write) -> None:
    record = read_signals(write(openbci(300)[:-40]))
    assert len(whole(record).times) == 299
    assert record.notes == ["1 truncated rows dropped"]


@pytest.mark.parametrize("rows", [1000, 20_000], ids=["short", "long"])
def test_a_compressed_table_damaged_later_on_gives_its_readable_part_with_a_note(write: Write, rows: int) -> None:
    text = "timestamps,C3,Marker0\n" + "".join(f"{k / 100},{k % 7}.5,{int(k == 50)}\n" for k in range(rows))
    packed = bytearray(gzip.compress(text.encode()))
    packed[-8] ^= 1  # of the checksum
    file = write(bytes(packed), "emg.csv.gz")
    record = read_signals(file)
    samples = whole(record)
    assert rows - 2 <= len(samples.times) <= rows
    assert samples.times == pytest.approx(np.arange(len(samples.times)) / 100)
    (note,) = record.notes
    assert note.startswith("only the readable part is used: ")
    log = read_decisions(file)
    assert (len(log.decisions), log.notes) == (1, (note,))


def test_a_myo_file_needs_a_given_rate(write: Write) -> None:
    file = write("\n".join(",".join(str((k * (c + 3)) % 256 - 128) for c in range(8)) for k in range(100)) + "\n")
    with pytest.raises(InputError, match="cannot be replayed without times; give rate=200"):
        read_signals(file)
    record = read_signals(file, SignalRequest(rate=200))
    assert whole(record).times == pytest.approx(np.arange(100) / 200)
    assert record.notes == ["no times in the file: samples spaced by the given rate, 200 Hz"]


def test_times_in_the_file_take_precedence_over_a_given_rate(write: Write, tmp_path: Path) -> None:
    edfio.Edf([edfio.EdfSignal(np.arange(200.0), 100, label="EMG")]).write(tmp_path / "a.edf")
    rows = "".join(f"{k / 100},{k % 7}.5\n" for k in range(300))
    table = write("timestamps,C3\n" + rows, "a.csv")
    for file in (write(xdf(eeg()), "a.xdf"), str(tmp_path / "a.edf"), table):
        record = read_signals(file, SignalRequest(rate=200))
        assert (record.rate, whole(record).times[100]) == (pytest.approx(100), pytest.approx(1, abs=1e-3))
        assert record.notes == ["the given rate, 200 Hz, is ignored: the file specifies 100 Hz"]
    assert read_signals(table, SignalRequest(rate=100.2)).notes == []


def test_a_muse_table_is_a_signal_and_its_marker_column_decisions(write: Write) -> None:
    file = write(MUSE)
    record = read_signals(file, SignalRequest(channels=("right aux",)))
    samples = whole(record)
    assert record.names == ("Right AUX",)
    assert record.rate == pytest.approx(256, rel=0.005)
    assert samples.times == pytest.approx(np.arange(512) / 256, abs=2e-3)
    (decision,) = read_decisions(file).decisions
    assert (decision.label, decision.time) == ("2", pytest.approx(0.5, abs=5e-3))
    with pytest.raises(InputError, match="there is no channel 'Oz'; the file has: TP9, Right AUX"):
        read_signals(file, SignalRequest(channels=("Oz",)))


def test_a_marker_over_several_samples_is_one_event(write: Write) -> None:
    rows = "".join(f"{k / 100},{k}.5,{'5' if 20 <= k < 30 or k >= 40 else '0'}\n" for k in range(50))
    log = read_decisions(write("timestamps,C3,Marker0\n" + rows))
    assert [(round(d.time, 2), d.label) for d in log.decisions] == [(0.2, "5"), (0.4, "5")]


def test_brainvision_markers_count_samples_from_one(write: Write) -> None:
    header = (
        "BrainVision Data Exchange Header File Version 1.0\n[Common Infos]\nMarkerFile=$b.vmrk\nSamplingInterval=2000\n"
    )
    marks = (
        "Brain Vision Data Exchange Marker File, Version 1.0\n; a comment\n[Common Infos]\nDataFile=a.eeg\n"
        "[Marker Infos]\nMk1=New Segment,,1,1,0,20200101\nMk2=Stimulus,S  1,501,1,0\nMk3=Response,,1001,1,0\n"
    )
    mark_file = write(marks, "a.vmrk")
    with pytest.raises(InputError, match=r"put the \.vhdr beside it, or give rate=HZ"):
        read_decisions(mark_file)
    assert read_decisions(mark_file, SignalRequest(rate=1000)).decisions[0].time == 0.5
    head_file = write(header, "a.vhdr")
    for file, given in ((mark_file, None), (head_file, None), (mark_file, 1000)):
        assert read_decisions(file, SignalRequest(rate=given)).decisions == (
            Decision(1.0, "S 1", None),
            Decision(2.0, "Response", None),
        )


def test_a_bids_events_table_is_read_with_its_missing_values(write: Write) -> None:
    table = "onset\tduration\ttrial_type\tvalue\n2.5\t1\tn/a\t7\n1\tn/a\tfist\t1\nn/a\t0\topen\t2\n"
    log = read_decisions(write(table))
    assert log.decisions == (Decision(1.0, "fist", None), Decision(2.5, "7", None))
    assert log.notes == ("1 events without onset or label dropped", "entries out of order by up to 2 s: sorted by time")


def test_raw_samples_instead_of_decisions_are_refused_with_the_decoders(write: Write) -> None:
    with pytest.raises(InputError, match=r"holds raw samples .* not decisions; give decoder=lda or ssvep"):
        read_decisions(write(MUSE.replace("Marker0", "Gyro")))
    with pytest.raises(InputError, match=r"format: 'edf\+' is not one of xdf-signals, edf, openbci-txt"):
        read_signals(write(MUSE), SignalRequest(format="edf+"))


def test_a_log_without_times_needs_a_given_period(write: Write) -> None:
    for text in ("label,confidence\nfist,0.5\nopen,\n", '{"label": "fist", "confidence": 0.5}\n{"label": "open"}\n'):
        file = write(text)
        with pytest.raises(InputError, match="a log without times needs period=SECONDS"):
            read_decisions(file)
        log = read_decisions(file, SignalRequest(rate=4.0))
        assert log.decisions == (Decision(0.0, "fist", 0.5), Decision(0.25, "open", None))
        assert log.notes == ("no times in the file: entries spaced by the given period, 0.25 s",)


def test_a_command_log_with_a_further_column_of_numbers_is_not_a_signal(write: Write) -> None:
    log = read_decisions(write("timestamp,marker,trial\n1,3,1\n2,3,2\n"))
    assert [(d.time, d.label) for d in log.decisions] == [(1, "3"), (2, "3")]


@pytest.mark.parametrize("name", ["gaze", "log"])
def test_other_tables_are_not_taken_for_signals(write: Write, name: str) -> None:
    text = {"gaze": "time,x,y,confidence\n0,1,2,1\n", "log": "time,label,confidence\n0,fist,0.5\n"}[name]
    with pytest.raises(InputError, match="unrecognised format of a signal"):
        read_signals(write(text))


def test_the_shared_recordings_are_read(sample: Sample) -> None:
    gestures = str(sample("xdf_emg8_gestures/test1.xdf"))
    assert len(read_decisions(gestures).decisions) == 48
    assert whole(read_signals(gestures)).values.shape == (23390, 8)
    muse = str(sample("eeg_ssvep_muse/data_2017-09-14-21.20.04.csv"))
    record = read_signals(muse)
    assert record.rate == pytest.approx(256, rel=0.001)
    assert np.diff(whole(record).times).min() > 0
    assert len(read_decisions(muse).decisions) == 32
    cyton = read_signals(str(sample("openbci_gui_v6/OpenBCI_GUI-v6-blinks-jawClench-alpha_first60s.txt")))
    times = whole(cyton).times
    assert len(times) == 15000
    assert (times[-1], np.ptp(np.diff(times))) == (pytest.approx(60, abs=0.2), pytest.approx(0, abs=1e-3))
    assert datetime.fromtimestamp(cyton.epoch, UTC).year == 2019
    wrists = read_signals(str(sample("emg_bids_edf/sub-01_task-typing_emg.edf")))
    assert whole(wrists).values.shape == (1000, 32)
    band = sample("xdf_muse_eeg/sub-P031_ses-S001_task-Default_run-001_eeg.xdf")
    assert len(read_signals(str(band), SignalRequest(stream="EEG")).names) == 5
    minimal = read_decisions(str(sample("xdf_minimal/minimal.xdf")))
    assert [d.label for d in minimal.decisions[1:3]] == ["Hello", "World"]
