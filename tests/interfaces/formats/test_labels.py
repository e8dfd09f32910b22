"""Events that a file tells apart have different labels, and what a label leaves out is said."""

from collections.abc import Callable

from higvf_interfaces.formats.records import CommandLog
from higvf_interfaces.formats.signals.reading import read_decisions
from tests.interfaces.formats.xdf_files import Stream, xdf

Write = Callable[..., str]
HEADER = (
    "Brain Vision Data Exchange Header File Version 1.0\n[Common Infos]\nMarkerFile=a.vmrk\nSamplingInterval=2000\n"
)
MARKERS = "Brain Vision Data Exchange Marker File, Version 1.0\n[Marker Infos]\nMk1=New Segment,,1,1,0,2016\n"


def labels(log: CommandLog) -> list[str]:
    return [decision.label for decision in log.decisions]


def test_events_of_one_trial_type_are_told_apart_by_their_value(write: Write) -> None:
    rows = "9.6,0,response,202\n15.1,0,response,201\n19.4,0.2,stimulus,11\n20,0,stimulus,11\n21,0,n/a,5\n"
    log = read_decisions(write(("onset,duration,trial_type,value\n" + rows).replace(",", "\t"), "a_events.tsv"))
    assert labels(log) == ["response/202", "response/201", "stimulus", "stimulus", "5"]
    assert log.notes == ("events labelled response are of 2 kinds: read as LABEL/KIND",)


def test_values_that_are_measurements_are_left_out_of_the_label(write: Write) -> None:
    rows = "".join(f"{k}\t0\tgo\t{0.31 + k / 100}\n" for k in range(40))
    log = read_decisions(write("onset\tduration\ttrial_type\tvalue\n" + rows, "a_events.tsv"))
    assert set(labels(log)) == {"go"}
    assert log.notes == ("events labelled go are of 40 kinds, which are ignored",)


def test_brainvision_markers_of_two_types_and_one_description_are_told_apart(write: Write) -> None:
    write(MARKERS + "Mk2=Stimulus,  2,501,1,0\nMk3=Response,  2,751,1,0\nMk4=Stimulus,  1,1001,1,0\n", "a.vmrk")
    log = read_decisions(write(HEADER, "a.vhdr"))
    assert labels(log) == ["Stimulus/2", "Response/2", "1"]
    assert log.notes == ("events labelled 2 are of 2 kinds: read as KIND/LABEL",)


def test_all_texts_of_a_marker_are_its_label(write: Write) -> None:
    pairs = Stream("two", "Markers", "t", 0, [10.0, 11.0, 12.0], [("go", "left"), ("go", ""), ("go", "right")])
    log = read_decisions(write(xdf(pairs)))
    assert labels(log) == ["go/left", "go", "go/right"]
    assert (
        "each marker has 2 channels: its label is all of them, joined by /, or the first alone if that is JSON"
        in log.notes
    )


def test_numbers_of_a_marker_are_its_label_too(write: Write) -> None:
    log = read_decisions(write(xdf(Stream("codes", "Markers", "t", 0, [1.0, 2.0], [(1.0, 7.0), (2.0, 7.5)]))))
    assert labels(log) == ["1/7", "2/7.5"]
