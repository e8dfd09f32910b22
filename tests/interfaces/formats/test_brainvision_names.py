"""BrainVision headers and marker files find each other after one or both were renamed."""

from pathlib import Path

import pytest

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.signals.reading import read_decisions

HEADER = (
    "Brain Vision Data Exchange Header File Version 1.0\n[Common Infos]\nMarkerFile={}\nSamplingInterval=2000\n"
    "NumberOfChannels=2\n"
)
MARKERS = "Brain Vision Data Exchange Marker File, Version 1.0\n[Marker Infos]\nMk1=Stimulus,S  1,501,1,0\n"


def times(path: Path) -> list[float]:
    return [decision.time for decision in read_decisions(str(path)).decisions]


def test_a_header_that_names_a_renamed_marker_file_uses_the_one_of_its_own_name(tmp_path: Path) -> None:
    (tmp_path / "new.vhdr").write_text(HEADER.format("old.vmrk"))
    (tmp_path / "new.vmrk").write_text(MARKERS)
    log = read_decisions(str(tmp_path / "new.vhdr"))
    assert log.decisions[0].time == pytest.approx(1.0)
    assert any("old.vmrk is missing: new.vmrk, which is named as the header, used" in note for note in log.notes)


def test_a_header_whose_marker_file_is_there_uses_that(tmp_path: Path) -> None:
    (tmp_path / "new.vhdr").write_text(HEADER.format("old.vmrk"))
    (tmp_path / "new.vmrk").write_text(MARKERS)
    (tmp_path / "old.vmrk").write_text(MARKERS.replace("501", "1001"))
    assert times(tmp_path / "new.vhdr") == [pytest.approx(2.0)]


def test_a_header_without_any_marker_file_is_refused_with_the_name(tmp_path: Path) -> None:
    (tmp_path / "new.vhdr").write_text(HEADER.format("old.vmrk"))
    with pytest.raises(InputError, match=r"old\.vmrk: there is no such file"):
        read_decisions(str(tmp_path / "new.vhdr"))


def test_a_marker_file_is_timed_by_the_only_header_that_names_it(tmp_path: Path) -> None:
    (tmp_path / "a.vmrk").write_text(MARKERS)
    (tmp_path / "renamed.vhdr").write_text(HEADER.format("a.vmrk"))
    (tmp_path / "other.vhdr").write_text(HEADER.format("b.vmrk").replace("2000", "1000"))
    assert times(tmp_path / "a.vmrk") == [pytest.approx(1.0)]
    (tmp_path / "second.vhdr").write_text(HEADER.format("a.vmrk").replace("2000", "1000"))
    with pytest.raises(InputError, match=r"the sampling interval is unknown: put the \.vhdr beside it, or give rate="):
        read_decisions(str(tmp_path / "a.vmrk"))
