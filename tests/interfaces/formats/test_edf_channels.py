"""EDF and BDF files: the channels that are wanted are read, triggers are events, and odd annotations do not matter."""

from collections.abc import Callable
from pathlib import Path

import edfio
import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.formats.signals.edf_annotations import read_annotations
from higvf_interfaces.formats.signals.reading import read_decisions, read_signals
from higvf_interfaces.formats.signals.records import SignalRequest, whole

Write = Callable[..., str]


def signal(label: str, rate: float, seconds: float = 4.0, unit: str = "uV") -> edfio.EdfSignal:
    values = np.sin(np.arange(round(rate * seconds)) / 7) * 100
    return edfio.EdfSignal(values, rate, label=label, physical_dimension=unit, physical_range=(-500, 500))


@pytest.fixture
def two_rates(tmp_path: Path) -> str:
    """Two EMG channels at 1000 Hz and three of an accelerometer at 100 Hz."""
    emg = [signal("EMG1", 1000), signal("EMG2", 1000)]
    edfio.Edf([*emg, *(signal(f"ACC {axis}", 100, unit="g") for axis in "XYZ")]).write(tmp_path / "a.edf")
    return str(tmp_path / "a.edf")


def test_the_rate_with_the_most_samples_is_read_and_the_other_channels_are_named(two_rates: str) -> None:
    record = read_signals(two_rates)
    assert (record.names, record.rate) == (("EMG1", "EMG2"), 1000)
    assert any("ACC X (100 Hz), ACC Y (100 Hz), ACC Z (100 Hz); choose them by" in note for note in record.notes)


def test_the_named_channels_decide_the_rate(two_rates: str) -> None:
    record = read_signals(two_rates, SignalRequest(channels=("acc z", "ACC X")))
    assert (record.names, record.units, record.rate, record.notes) == (("ACC Z", "ACC X"), ("g", "g"), 100, [])
    assert whole(record).values.shape == (400, 2)


def test_named_channels_of_different_rates_are_refused_with_the_rates(two_rates: str) -> None:
    with pytest.raises(InputError, match=r"different rates.*EMG1 \(1000 Hz\).*ACC Z \(100 Hz\)"):
        read_signals(two_rates, SignalRequest(channels=("EMG1", "ACC X")))
    with pytest.raises(InputError, match=r"no channel 'emg9'.*ACC Z \(100 Hz\)"):
        read_signals(two_rates, SignalRequest(channels=("EMG9",)))


def test_many_slow_channels_are_not_dropped_for_a_fast_one(tmp_path: Path) -> None:
    edfio.Edf([signal("ECG", 500), *(signal(f"C{k}", 250) for k in range(8))]).write(tmp_path / "a.edf")
    assert read_signals(str(tmp_path / "a.edf")).rate == 250


def flattened(content: bytes, place: int, count: int) -> bytes:
    """An EDF file whose signal `place` of `count` has a physical minimum and maximum of 0."""
    for field in (104, 112):  # bytes of a signal's header before its physical minimum and maximum
        start = 256 + field * count + 8 * place
        content = content[:start] + b"0       " + content[start + 8 :]
    return content


def test_a_channel_without_a_physical_range_is_left_out_and_named(tmp_path: Path, write: Write) -> None:
    edfio.Edf([signal("EMG1", 250), signal("EMG2", 250)]).write(tmp_path / "a.edf")
    file = write(flattened((tmp_path / "a.edf").read_bytes(), 1, 2))
    record = read_signals(file)
    assert (record.names, record.notes) == (("EMG1",), ["without a physical range, left out: EMG2"])
    with pytest.raises(InputError, match=r"channel EMG2 has no physical range .*leave it out of channels="):
        read_signals(file, SignalRequest(channels=("EMG1", "EMG2")))


def test_a_file_of_nothing_but_channels_without_a_range_is_refused(tmp_path: Path, write: Write) -> None:
    edfio.Edf([signal("EMG1", 250)]).write(tmp_path / "a.edf")
    with pytest.raises(InputError, match="no channel with a signal; it has: EMG1"):
        read_signals(write(flattened((tmp_path / "a.edf").read_bytes(), 0, 1)))


def biosemi(path: Path, base: int = 0) -> str:
    """A BDF file whose Status channel has the codes 1 and 2 for 20 samples each, below bits of the device's state."""
    rate, count = 256, 1024
    status = np.full(count, 0x180000 | base)
    status[256:276] += 1
    status[512:532] += 2
    channel = edfio.BdfSignal.from_digital(
        status.astype(np.int32), rate, label="Status", physical_dimension="Boolean",
        physical_range=(-8388608, 8388607), digital_range=(-8388608, 8388607),
    )  # fmt: skip
    values = np.sin(np.arange(count) / 7) * 100
    eeg = edfio.BdfSignal(values, rate, label="A1", physical_dimension="uV", physical_range=(-500, 500))
    edfio.Bdf([eeg, channel]).write(path)
    return str(path)


@pytest.mark.parametrize(("base", "codes"), [(0, ["1", "2"]), (0xFF00, ["65281", "65282"])])
def test_the_status_channel_of_biosemi_is_events_and_no_signal(tmp_path: Path, base: int, codes: list[str]) -> None:
    file = biosemi(tmp_path / "a.bdf", base)
    record = read_signals(file)
    assert (record.names, record.notes) == (("A1",), ["triggers, no signal: Status"])
    decisions = read_decisions(file).decisions
    assert [(decision.time, decision.label) for decision in decisions] == [(1.0, codes[0]), (2.0, codes[1])]


def test_a_trigger_channel_that_is_named_is_read_as_a_signal(tmp_path: Path) -> None:
    record = read_signals(biosemi(tmp_path / "a.bdf"), SignalRequest(channels=("Status",)))
    assert whole(record).values[300, 0] == 0x180000


def test_triggers_and_annotations_of_an_edf_file_are_events_together(tmp_path: Path) -> None:
    pulse = np.zeros(1000)
    pulse[500:510] = 7
    trigger = edfio.EdfSignal(pulse, 250, label="TRIG", physical_dimension="", physical_range=(-100, 100))
    notes = [edfio.EdfAnnotation(1.0, None, "go")]
    edfio.Edf([signal("EMG", 250), trigger], annotations=notes).write(tmp_path / "a.edf")
    assert read_decisions(str(tmp_path / "a.edf")).decisions == (Decision(1.0, "go", None), Decision(2.0, "7", None))


def test_a_byte_that_is_not_utf_8_spoils_neither_annotations_nor_signals(tmp_path: Path, write: Write) -> None:
    notes = [edfio.EdfAnnotation(float(k), None, text) for k, text in ((1, "fist"), (2, "debut"), (3, "µ"))]
    edfio.Edf([signal("EMG", 250)], annotations=notes).write(tmp_path / "a.edf")
    file = write((tmp_path / "a.edf").read_bytes().replace(b"debut", b"d\xe9but"), "b.edf")
    log = read_decisions(file)
    assert [(d.time, d.label) for d in log.decisions] == [(1.0, "fist"), (2.0, "début"), (3.0, "µ")]
    assert "an annotation is not UTF-8: read as Latin-1" in log.notes
    assert len(whole(read_signals(file)).times) == 1000


def test_annotations_agree_with_those_of_edfio(tmp_path: Path) -> None:
    notes = [edfio.EdfAnnotation(k * 0.375, 0.1 if k % 2 else None, f"label {k}") for k in range(20)]
    path = tmp_path / "a.edf"
    edfio.Edf([signal("EMG", 250, 8)], annotations=notes, data_record_duration=0.5).write(path)
    mine = read_annotations(path, 2)
    assert mine.texts == tuple((note.onset, note.text) for note in edfio.read_edf(path).annotations)
    assert (mine.continuous, mine.repaired) == (True, False)
