"""A parser reads any recording of EMG or BCI or refuses it with an `InputError`."""

import contextlib
from pathlib import Path

import edfio
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.signals.reading import DECISION_FORMATS, SIGNAL_FORMATS, read_decisions, read_signals
from higvf_interfaces.formats.signals.records import SignalRequest, whole
from tests.interfaces.formats.xdf_files import Stream, xdf

MARKS = Stream("Cues", "Markers", "", 0, [9.0, 9.5, 10.0], ["fist", "0s", '{"label": "a", "confidence": 0.5}'])
SIGNAL = Stream("EMG", "EEG", "a", 100, [9.0 + k / 100 for k in range(20)], [(k, -k) for k in range(20)], ("A", "B"))
OPENBCI = (
    "%OpenBCI Raw EXG Data\n%Number of channels = 2\n%Sample Rate = 250 Hz\nSample Index, EXG Channel 0, Timestamp, "
    "Marker Channel\n0, 1.5, 1700000000000, 0\n1, 2.5, 1700000000004, 1\n2, 3.5, 1700000000008, 0\n"
)
OLD = (
    "%OpenBCI Raw EEG Data\n%Number of channels = 2\n%Sample Rate = 250.0 Hz\n"
    "0, 1.5, 2, 0, 10:00:00.000\n1, 2, 3, 0, 10:00:00.004\n"
)
MYO = "1,2,3,4,5,6,7,8\n-1,-2,-3,-4,-5,-6,-7,-8\n"
MUSE = "timestamps,TP9,Marker0\n500.000,1.5,0\n500.004,2.5,1\n500.008,3.5,0\n"
MARKERS = (
    "Brain Vision Data Exchange Marker File, Version 1.0\n[Marker Infos]\nMk1=Stimulus,S  1,501,1,0\nMk2=a,,9,1,0\n"
)
HEADER = "BrainVision Data Exchange Header File Version 1.0\n[Common Infos]\nMarkerFile=file\nSamplingInterval=4000\n"
EVENTS = "onset\tduration\ttrial_type\tconfidence\n1\t0\tfist\t0.5\n2\tn/a\tn/a\t\n"
TEXTS = tuple(text.encode() for text in (OPENBCI, OLD, MYO, MUSE, MARKERS, HEADER, EVENTS))
hard = settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
cells = st.sampled_from(
    ["", "0", "1", "-1", "255", "1e308", "-1e308", "1e-320", "nan", "inf", "1,5", "10:00:00.5", "9" * 400, '"', "n/a",
     "1700000000000", "\x00", "%", "٣", "fist"]
)  # fmt: skip


@pytest.fixture(scope="module")
def edf(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A small EDF+ file."""
    file = tmp_path_factory.mktemp("edf") / "a.edf"
    signal = edfio.EdfSignal(np.arange(40.0), 20, label="EMG")
    edfio.Edf([signal], annotations=[edfio.EdfAnnotation(0.5, None, "fist")]).write(file)
    return file.read_bytes()


def survive(file: Path) -> None:
    """Reads `file` with every reader; only `InputError`s may be raised, and times must increase."""
    for rate in (None, 200.0):
        for name in (None, *(known.name for known in SIGNAL_FORMATS)):
            with contextlib.suppress(InputError):
                samples = whole(read_signals(str(file), SignalRequest(name, rate=rate)))
                assert (np.diff(samples.times) > 0).all()
                assert samples.values.shape[0] == len(samples.times)
        for name in (None, *(known.name for known in DECISION_FORMATS)):
            with contextlib.suppress(InputError):
                decisions = read_decisions(str(file), SignalRequest(name, rate=rate)).decisions
                times = [decision.time for decision in decisions]
                assert times == sorted(times)
                assert all(decision.label for decision in decisions)


def damaged(content: bytes, data: st.DataObject) -> bytes:
    """The content with some bytes overwritten and its end cut off."""
    bytes_ = bytearray(content)
    for place in data.draw(st.lists(st.integers(0, len(bytes_) - 1), max_size=4)):
        bytes_[place] = data.draw(st.integers(0, 255))
    return bytes(bytes_[: data.draw(st.integers(0, len(bytes_)))])


@hard
@given(seed=st.sampled_from(TEXTS), data=st.data())
def test_damaged_text_files(tmp_path: Path, seed: bytes, data: st.DataObject) -> None:
    (tmp_path / "file").write_bytes(damaged(seed, data))
    survive(tmp_path / "file")


@hard
@given(data=st.data())
def test_damaged_xdf_files(tmp_path: Path, data: st.DataObject) -> None:
    (tmp_path / "file").write_bytes(damaged(xdf(SIGNAL, MARKS), data))
    survive(tmp_path / "file")


@hard
@given(data=st.data())
def test_damaged_edf_files(tmp_path: Path, edf: bytes, data: st.DataObject) -> None:
    (tmp_path / "file").write_bytes(damaged(edf, data))
    survive(tmp_path / "file")


@hard
@given(
    header=st.sampled_from([OPENBCI.rsplit("\n", 4)[0], MUSE.splitlines()[0], EVENTS.splitlines()[0], ""]),
    rows=st.lists(st.lists(cells, max_size=8), max_size=8),
)
def test_arbitrary_cells_below_a_valid_header(tmp_path: Path, header: str, rows: list[list[str]]) -> None:
    delimiter = "\t" if "\t" in header else ","
    (tmp_path / "file").write_text("\n".join([header, *(delimiter.join(row) for row in rows)]), encoding="utf-8")
    survive(tmp_path / "file")


@hard
@given(magic=st.sampled_from([b"XDF:", b"0       ", b"\xffBIOSEMI", b""]), content=st.binary(max_size=600))
def test_random_bytes_after_valid_magic_bytes(tmp_path: Path, magic: bytes, content: bytes) -> None:
    (tmp_path / "file").write_bytes(magic + content)
    survive(tmp_path / "file")
