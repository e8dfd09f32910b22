"""Command logs read the same as CSV and as JSON lines."""

import json
from collections.abc import Callable

import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.formats.reading import read_gaze
from higvf_interfaces.formats.signals.reading import read_decisions, read_signals
from higvf_interfaces.formats.signals.records import SignalRequest, whole
from higvf_interfaces.inspect.inspection import inspect

Write = Callable[..., str]


def test_a_table_is_read_and_a_missing_confidence_is_none(write: Write) -> None:
    log = read_decisions(write('time,label,confidence\n1.5,fist,0.9\n2,"a, b",\n3.5,open\n'))
    assert log.format == "command-csv"
    assert log.decisions == ((1.5, "fist", 0.9), (2.0, "a, b", None), (3.5, "open", None))


def test_a_table_without_a_confidence_column_is_read(write: Write) -> None:
    assert read_decisions(write("time,label\n1,fist\n")).decisions == ((1.0, "fist", None),)


def test_json_lines_are_read_whatever_the_file_is_called(write: Write) -> None:
    text = '{"time": 1.5, "label": "fist", "confidence": 0.9}\n\n{"label": "open", "time": 2}\n'
    log = read_decisions(write(text, "log.csv"))
    assert log.format == "command-jsonl"
    assert log.decisions == ((1.5, "fist", 0.9), (2.0, "open", None))


def test_a_truncated_json_line_is_dropped_with_a_note(write: Write) -> None:
    log = read_decisions(write('{"time": 1, "label": "fist"}\n{"time": 2, "la'))
    assert len(log.decisions) == 1
    assert log.notes == ("1 lines that are not JSON objects dropped, first: line 2",)


def test_a_truncated_row_is_dropped_with_a_note(write: Write) -> None:
    log = read_decisions(write("time,label,confidence\n1,fist,0.9\n2,op"))
    assert len(log.decisions) == 1
    assert log.notes == ("truncated last row dropped",)


def test_entries_out_of_order_are_sorted_with_a_note(write: Write) -> None:
    log = read_decisions(write("time,label\n2,b\n1,a\n"))
    assert [decision.label for decision in log.decisions] == ["a", "b"]
    assert log.notes == ("entries out of order: sorted by time",)


def test_milliseconds_and_epochs_become_session_seconds(write: Write) -> None:
    assert read_decisions(write("time [ms],label\n1500,a\n")).decisions[0].time == 1.5
    log = read_decisions(write('{"time": 1700000000.25, "label": "a"}\n{"time": 1700000001.25, "label": "b"}\n'))
    assert [decision.time for decision in log.decisions] == [0, 1]
    assert log.epoch == 1_700_000_000.25
    assert "epoch" in log.notes[0]


@pytest.mark.parametrize("confidence", ["87", "-0.1", "high"])
def test_an_invalid_confidence_is_refused_with_its_row(write: Write, confidence: str) -> None:
    with pytest.raises(InputError, match=rf"row 2: confidence '{confidence}' is not a number from 0 to 1"):
        read_decisions(write(f"time,label,confidence\n1,a,1.0\n2,b,{confidence}\n"))
    lines = (
        f'{{"time": 1, "label": "a", "confidence": "1.0"}}\n\n{{"time": 2, "label": "b", "confidence": "{confidence}"}}'
    )
    with pytest.raises(InputError, match=rf"line 3: confidence '{confidence}' is not a number from 0 to 1"):
        read_decisions(write(lines))


def test_line_numbers_in_messages_count_blank_lines(write: Write) -> None:
    log = read_decisions(write('\n{"time": 1, "label": "a"}\n\n{"time": 2'))
    assert log.notes == ("1 lines that are not JSON objects dropped, first: line 4",)


def test_a_recording_of_the_console_is_refused_with_the_command_that_replays_it(write: Write) -> None:
    file = write('{"recording": 1, "seed": 0}\n{"time": 0.02, "command": {"kind": "stop"}}\n', "run.jsonl")
    with pytest.raises(InputError, match=r"is a recording of this console; play it with: higvf replay .*run\.jsonl"):
        read_decisions(file)
    with pytest.raises(InputError, match="higvf replay"):
        inspect(InputSpec("file", file))


def test_a_command_log_with_a_further_column_of_numbers_is_inspected_as_a_command_log(write: Write) -> None:
    told = inspect(InputSpec("file", write("time,event,trial\n1,fist,1\n2.5,open,2\n")))
    assert (told["kind"], told["labels"]) == ("commands", {"fist": 1, "open": 1})
    marked = "timestamps,C3,marker\n" + "".join(f"{k / 100},{k % 5},{k % 50 == 0:d}\n" for k in range(200))
    assert inspect(InputSpec("file", write(marked)))["kind"] == "signals"


def test_a_gaze_table_that_is_given_as_a_log_is_led_to_its_channel(write: Write) -> None:
    table = "Recording timestamp [ms]\tEvent\tGaze point X [DACS px]\tGaze point Y [DACS px]\n1\tstart\t2\t3\n"
    with pytest.raises(InputError, match=r"looks like a table of gaze, which the channel gaze reads \(gaze=FILE\)"):
        read_decisions(write(table))


def test_a_title_that_stands_twice_is_refused(write: Write) -> None:
    with pytest.raises(InputError, match="several columns are called 'label'; rename those that are not meant"):
        read_decisions(write("time,label,label\n1,fist,open\n"))
    with pytest.raises(InputError, match="several columns are called 'x \\[px\\]'"):
        read_gaze(write("time,x [px],y [px],x [px]\n0,1,2,900\n0.01,1,2,900\n0.02,1,2,900\n"))


def test_milliseconds_that_are_called_so_are_not_doubted(write: Write) -> None:
    log = read_decisions(write('{"time_ms": 1000, "label": "fist"}\n{"time_ms": 6000, "label": "open"}\n'))
    assert [decision.time for decision in log.decisions] == [1.0, 6.0]
    assert log.notes == ()


def test_a_log_without_times_or_labels_is_refused(write: Write) -> None:
    with pytest.raises(InputError, match="no entry has a time"):
        read_decisions(write("time,label\n,fist\n"))
    with pytest.raises(InputError, match="no entry has both a time and a label"):
        read_decisions(write("time,label\n1,\n"))
    with pytest.raises(InputError, match=r"no label column .*; has: time, what"):
        read_decisions(write("time,what\n1,fist\n"), SignalRequest(format="command-csv"))
    with pytest.raises(InputError, match=r"unrecognised format.*command-jsonl.*command-csv"):
        read_decisions(write("time,what\n1,fist\n"))


ISO = ("2026-11-30T15:20:01.250Z", "2026-11-30T16:20:02.750+01:00", "2026-11-30 15:20:06.25")


@pytest.mark.parametrize("form", ["csv", "semicolon", "json"])
def test_times_may_be_dates(write: Callable[..., str], form: str) -> None:
    if form == "json":
        text = "".join(json.dumps({"time": time, "label": "fist"}) + "\n" for time in ISO)
    else:
        text = "time,label\n" + "".join(f"{time},fist\n" for time in ISO)
    log = read_decisions(write(text.replace(",", ";").replace(".", ",") if form == "semicolon" else text))
    assert [decision.time for decision in log.decisions] == pytest.approx([0.0, 1.5, 5.0], abs=1e-6)
    assert log.epoch == pytest.approx(1_796_052_001.25)


@pytest.mark.parametrize("time", ["2026-13-30T15:20:01", "2026-11-30T25:00:00", "20261130 x", "0000-01-01 00:00:00"])
def test_a_date_that_is_none_is_no_time(write: Callable[..., str], time: str) -> None:
    with pytest.raises(InputError, match="no entry has a time"):
        read_decisions(write(f"time,label\n{time},fist\n"))


def read_slow_signals(file: str) -> object:
    return whole(read_signals(file, SignalRequest(rate=10.0)))


@pytest.mark.parametrize(
    ("header", "row", "read"),
    [
        ("time,label", "2,5,open", read_decisions),
        ("time,x [px],y [px]", "2,5,100,200", read_gaze),
        ("timestamps,C3", "2,5,7,5", read_slow_signals),
    ],
    ids=["log", "gaze", "signals"],
)
def test_a_row_of_more_cells_than_the_header_is_refused(
    write: Write, header: str, row: str, read: Callable[[str], object]
) -> None:
    with pytest.raises(InputError, match=r"row 1: \d cells for \d columns; numbers with a decimal comma need another"):
        read(write(f"{header}\n{row}\n{row}\n"))


@pytest.mark.parametrize("scale", [1e3, 1e6, 1e9], ids=["ms", "μs", "ns"])
def test_epoch_times_may_count_smaller_units(write: Write, scale: float) -> None:
    stamps = [int(seconds * 1e3) * int(scale / 1e3) for seconds in (1_700_000_000.0, 1_700_000_001.5)]
    log = read_decisions(write(f"time,label\n{stamps[0]},fist\n{stamps[1]},open\n"))
    assert [decision.time for decision in log.decisions] == pytest.approx([0.0, 1.5], abs=1e-5)


@pytest.mark.parametrize(
    ("header", "times", "warned"),
    [
        ("time", (1500, 3000, 9000), True),
        ("time_ms", (1500, 3000, 9000), False),
        ("time", (1.5, 300.5, 900.0), False),
        ("time", (1, 2, 3, 300), False),
        ("time", (1_700_000_000, 1_700_000_200), False),
        ("time", ("2026-11-30 10:00:00", "2026-11-30 10:10:00"), False),
    ],
)
def test_times_that_may_be_milliseconds_are_warned_of(
    write: Write, header: str, times: tuple[object, ...], warned: bool
) -> None:
    log = read_decisions(write(f"{header},label\n" + "".join(f"{time},fist\n" for time in times)))
    assert any("if they are milliseconds, call them time_ms" in note for note in log.notes) is warned


def test_what_is_no_time_is_shown(write: Write) -> None:
    with pytest.raises(InputError, match=r"no entry has a time; '23:59:58.5' is none; a log without times needs"):
        read_decisions(write("time,label\n23:59:58.5,fist\n"))
