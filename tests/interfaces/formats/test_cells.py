"""Cells of text tables are parsed as the writing program meant them."""

from collections.abc import Callable

import pytest

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.reading import read_gaze
from higvf_interfaces.formats.signals.reading import read_decisions, read_signals
from higvf_interfaces.formats.signals.records import whole
from higvf_interfaces.formats.text import as_label, plain
from tests.interfaces.formats.xdf_files import Stream, xdf

Write = Callable[..., str]


def test_quotation_marks_around_the_cells_of_a_tab_separated_table_are_stripped(write: Write) -> None:
    gaze = read_gaze(write('"time"\t"x [px]"\t"y [px]"\t"valid"\n"0"\t"1.5"\t"2"\t"1"\n"0.1"\t"3"\t"4"\t"0"\n'))
    assert gaze.points.tolist() == [[1.5, 2], [3, 4]]
    assert gaze.valid.tolist() == [True, False]
    log = read_decisions(write('"time"\t"label"\n1\t"fist"\n'))
    assert log.decisions == ((1.0, "fist", None),)
    table = write('"timestamps"\t"C3"\t"Marker0"\n' + "".join(f'"{k / 10}"\t"{k}"\t"{k == 3:d}"\n' for k in range(9)))
    assert whole(read_signals(table)).values[:, 0].tolist() == list(range(9))
    assert [(round(d.time, 2), d.label) for d in read_decisions(table).decisions] == [(0.3, "1")]


@pytest.mark.parametrize(("text", "meant"), [('"a"', "a"), (' "a b" ', "a b"), ('"', '"'), ('""', ""), ('5"', '5"')])
def test_only_paired_quotation_marks_are_stripped(text: str, meant: str) -> None:
    assert plain(text) == meant


@pytest.mark.parametrize("no", ["0", "0.0", "False", "no", "Invalid", "n/a"])
def test_samples_marked_invalid_are_invalid(write: Write, no: str) -> None:
    gaze = read_gaze(write(f"time,x,y,valid\n0,1,2,1.0\n0.1,1,2,{no}\n0.2,1,2,\n"))
    assert gaze.valid.tolist() == [True, False, True]


@pytest.mark.parametrize(("scale", "unit"), [(1e3, "ms"), (1e6, "μs")])
def test_gaze_in_milliseconds_needs_a_unit(write: Write, scale: float, unit: str) -> None:
    rows = "".join(f"{scale * k / 60:.0f},1,2\n" for k in range(60))
    with pytest.raises(InputError, match=rf"write the unit into that title, perhaps timestamp \[{unit}\]"):
        read_gaze(write("timestamp,x,y\n" + rows))
    assert read_gaze(write(f"timestamp [{unit}],x,y\n" + rows)).time[-1] == pytest.approx(59 / 60, abs=1e-3)


def test_milliseconds_since_an_epoch_are_recognised_by_their_size(write: Write) -> None:
    gaze = read_gaze(write("timestamp,x,y\n" + "".join(f"{1_700_000_000_000 + 20 * k},1,2\n" for k in range(60))))
    assert gaze.time[:3] == pytest.approx([0, 0.02, 0.04], abs=1e-6)
    entries = ((1_700_000_000_000, "fist"), (1_700_000_002_500, "open"))
    table = "timestamp,label\n" + "".join(f"{time},{label}\n" for time, label in entries)
    lines = "".join(f'{{"time": {time}, "label": "{label}"}}\n' for time, label in entries)
    for text in (table, lines):
        assert [decision.time for decision in read_decisions(write(text)).decisions] == [0, 2.5]


@pytest.mark.parametrize(
    ("value", "label"),
    [(1.0, "1"), ("1.0", "1"), ("-2,0", "-2"), (0.0, "0"), (1234567.0, "1234567"), (1.5, "1.5"), ("1.50", "1.50"),
     ("fist ", "fist"), ("v1.0", "v1.0"), (7, "7"), (True, ""), (None, ""), (float("nan"), "")],
)  # fmt: skip
def test_an_integer_label_is_the_same_in_any_notation(value: object, label: str) -> None:
    assert as_label(value) == label


def test_numeric_labels_are_equal_in_all_log_formats(write: Write) -> None:
    table = read_decisions(write("time,label\n1,1.0\n2,1234567.0\n"))
    lines = read_decisions(write('{"time": 1, "label": 1.0}\n{"time": 2, "label": 1234567}\n'))
    codes = read_decisions(write(xdf(Stream("Cues", "Markers", "", 0, [0.0, 1.0], [[1.0], [1234567.0]]))))
    texts = ['{"label": 1.0}', '{"label": 1234567}']
    objects = read_decisions(write(xdf(Stream("Cues", "Markers", "", 0, [0.0, 1.0], texts))))
    plain_texts = read_decisions(write(xdf(Stream("Cues", "Markers", "", 0, [0.0, 1.0], ["1.0", "1234567"]))))
    events = read_decisions(write("onset\tduration\tvalue\n1\t0\t1.0\n2\t0\t1234567\n"))
    samples = "".join(f"{k / 10},{k},{ {4: '1.0', 6: '1234567.0'}.get(k, '0') }\n" for k in range(9))
    column = read_decisions(write("timestamps,C3,Marker0\n" + samples))
    for log in (table, lines, codes, objects, plain_texts, events, column):
        assert [decision.label for decision in log.decisions] == ["1", "1234567"], log.format
