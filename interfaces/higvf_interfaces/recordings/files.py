"""Writers of synthetic recordings: pure functions from samples to the text of a file."""

import csv
import io
import json
from collections.abc import Iterable, Sequence

from higvf_interfaces.formats.records import Decision
from higvf_interfaces.recordings.gaze import Samples

_PRO_LAB_COLUMNS = (
    "Recording timestamp [ms]",
    "Sensor",
    "Project name",
    "Recording resolution height [px]",
    "Recording resolution width [px]",
    "Eyetracker timestamp [μs]",
    "Event",
    "Gaze point X [DACS px]",
    "Gaze point Y [DACS px]",
    "Validity left",
    "Validity right",
)


def write_gaze_tsv(
    samples: Samples, screen: tuple[float, float], *, project: str = "synthetic", decimal_comma: bool = False
) -> str:
    """Return gaze as a Tobii Pro Lab export that has only the columns needed for gaze.

    Args:
        samples: gaze samples in screen pixels.
        screen: width and height of the screen [px].
        project: project name.
        decimal_comma: whether to write a decimal comma, as Pro Lab does under, for example, a German locale.
    """

    def decimal(value: float) -> str:
        return f"{value:.1f}".replace(".", ",") if decimal_comma else f"{value:.1f}"

    constant = (project, f"{screen[1]:.0f}", f"{screen[0]:.0f}")
    rows: list[Sequence[str]] = [_PRO_LAB_COLUMNS, ("0", "", *constant, "", "RecordingStart", "", "", "", "")]
    for time, (x, y), valid in zip(samples.time.tolist(), samples.points.tolist(), samples.valid.tolist(), strict=True):
        gaze = (decimal(x), decimal(y), "Valid", "Valid") if valid else ("", "", "Invalid", "Invalid")
        rows.append((f"{1e3 * time:.0f}", "Eye Tracker", *constant, f"{1e6 * time:.0f}", "", *gaze))
    return "".join("\t".join(cells) + "\n" for cells in rows)


def write_gaze_csv(samples: Samples) -> str:
    """Return gaze as a plain CSV in screen pixels; missing samples have empty cells."""
    rows = [
        (f"{time:.6f}", f"{x:.1f}" if valid else "", f"{y:.1f}" if valid else "", "1.0" if valid else "0.0")
        for time, (x, y), valid in zip(
            samples.time.tolist(), samples.points.tolist(), samples.valid.tolist(), strict=True
        )
    ]
    return _table(("time", "x [px]", "y [px]", "confidence"), rows)


def write_command_csv(decisions: Sequence[Decision]) -> str:
    """Return a command log as a CSV `time,label,confidence`; an unknown confidence is an empty cell."""
    rows = [(f"{d.time:.6g}", d.label, "" if d.confidence is None else f"{d.confidence:g}") for d in decisions]
    return _table(("time", "label", "confidence"), rows)


def write_command_jsonl(decisions: Sequence[Decision]) -> str:
    """Return a command log as JSON lines; an unknown confidence is left out."""
    entries = [{key: value for key, value in d._asdict().items() if value is not None} for d in decisions]
    return "".join(json.dumps(entry) + "\n" for entry in entries)


def _table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([header, *rows])
    return text.getvalue()
