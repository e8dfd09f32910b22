"""Times that look right and mean something else are refused or warned of, each with the way out."""

from pathlib import Path
from typing import Any

import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.inspect.inspection import inspect


def described(file: Path) -> dict[str, Any]:
    return dict(inspect(InputSpec("inspect", str(file))))


def written(tmp_path: Path, name: str, text: str) -> Path:
    file = tmp_path / name
    file.write_text(text)
    return file


@pytest.mark.parametrize(
    ("times", "reason"),
    [
        (
            ("45353,5868750000", "45353,5869097222", "45353,5869444444"),
            "row 1: the time '45353,5868750000' seems to be",
        ),
        (("1.500", "3.000,5", "6.500,0"), "row 1: in the time '1.500' the mark may part thousands"),
        (("0.5", "1,500", "3,000.5"), "row 2: in the time '1,500' the mark may part thousands"),
    ],
)
def test_times_of_two_meanings_are_refused(tmp_path: Path, times: tuple[str, ...], reason: str) -> None:
    rows = "".join(f"{time};fist\n" for time in times)
    with pytest.raises(InputError, match=reason):
        described(written(tmp_path, "log.csv", f"time;label\n{rows}"))


def test_decimals_of_one_kind_and_times_of_one_day_are_read(tmp_path: Path) -> None:
    found = described(written(tmp_path, "log.csv", "time;label\n1.500;fist\n3.000;open\n"))
    assert found["duration_s"] == 1.5
    late = described(written(tmp_path, "late.csv", "time;label\n45353.5;fist\n45356.5;open\n"))
    assert late["duration_s"] == 3.0


@pytest.mark.parametrize(
    ("rows", "warning"),
    [
        (((1500, 90), (3000, 180), (6500, 390)), "they may be milliseconds"),
        (((250, 250), (625, 625), (1000, 1000)), "they equal the column sample"),
        (((10, 2500), (40, 10000), (70, 17500)), ""),
    ],
)
def test_onsets_that_are_no_seconds_are_warned_of(
    tmp_path: Path, rows: tuple[tuple[int, int], ...], warning: str
) -> None:
    table = "".join(f"{onset}\t1\t{sample}\tfist{k}\n" for k, (onset, sample) in enumerate(rows))
    found = described(written(tmp_path, "task_events.tsv", f"onset\tduration\tsample\ttrial_type\n{table}"))
    assert (warning in str(found["warnings"])) is True
    assert ("as BIDS has it" in str(found["warnings"])) is bool(warning)


@pytest.mark.parametrize(("stated", "warns"), [(250, True), (1000, True), (125, False)])
def test_a_rate_that_the_stamps_contradict_is_not_taken(tmp_path: Path, stated: int, warns: bool) -> None:
    head = f"%OpenBCI Raw EXG Data\n%Number of channels = 1\n%Sample Rate = {stated} Hz\n"
    rows = "".join(f"{k % 256}, {k % 9}.0, {1709388306 + k / 125:.6f}\n" for k in range(1250))
    found = described(written(tmp_path, "gui.txt", f"{head}Sample Index, EXG Channel 0, Timestamp\n{rows}"))
    assert found["rate_hz"] == pytest.approx(125.0, rel=0.01)
    assert found["duration_s"] == pytest.approx(9.992, abs=0.05)
    assert (f"the file states {stated} Hz" in str(found["warnings"])) is warns
