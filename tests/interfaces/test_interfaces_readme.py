"""The examples and tables of interfaces/README.md agree with the code."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from higvf_console.core.interface import InputSpec
from higvf_console.core.reading.document import read_yaml
from higvf_interfaces.decisions.actions import ACTIONS
from higvf_interfaces.decisions.bci import CLASSES
from higvf_interfaces.decisions.emg import GESTURES, open_emg
from higvf_interfaces.decisions.interface import OPTIONS as DECISION_OPTIONS
from higvf_interfaces.formats.reading import GAZE_FORMATS, GazeFormat
from higvf_interfaces.formats.records import ANYTHING
from higvf_interfaces.formats.signals.reading import DECISION_FORMATS, SIGNAL_FORMATS
from higvf_interfaces.formats.text import look
from higvf_interfaces.gaze.calibration import read_calibration
from higvf_interfaces.gaze.interface import OPTIONS as GAZE_OPTIONS
from higvf_interfaces.recordings.plan import make_recordings
from higvf_interfaces.scripts.file import DETAILS, EVENTS, read_script

README = (Path(__file__).parents[2] / "interfaces" / "README.md").read_text(encoding="utf-8")
INPUTS, CALIBRATION, SCRIPT, PLAN = re.findall(r"```yaml\n(.*?)```", README, re.DOTALL)


def test_the_shown_script_is_accepted(write: Callable[..., str]) -> None:
    script = read_script(Path(write(SCRIPT)))
    assert (len(script.entries), script.warnings) == (2, ())


def test_the_shown_plan_makes_its_recordings(write: Callable[..., str]) -> None:
    assert set(make_recordings(Path(write(PLAN)))) == {"gaze.tsv", "emg.csv", "bci.jsonl"}


def test_the_shown_settings_are_accepted(write: Callable[..., str]) -> None:
    content = read_yaml(INPUTS, "README.md").value
    open_emg(InputSpec("emg", write("time,label\n1,fist\n", "log.csv"), settings=content["inputs"]["emg"]))


def test_the_shown_calibration_fits(write: Callable[..., str]) -> None:
    assert read_calibration(Path(write(CALIBRATION))).residual < 0.5


def test_the_shown_format_reads_its_file(write: Callable[..., str]) -> None:
    shown: dict[str, object] = {}
    exec(re.findall(r"```python\n(.*?)```", README, re.DOTALL)[-1], shown)
    known, file = shown["FORMAT"], look(write("MY TRACKER\n0 0.5 0.25\n0.01 0.75 0.25\n"))
    assert isinstance(known, GazeFormat)
    assert known.matches(file)
    (block,) = known.stream(file, ANYTHING).blocks
    assert block.points.tolist() == [[0.5, 0.25], [0.75, 0.25]]


def test_the_table_of_eye_trackers_has_every_format_once() -> None:
    rows = re.findall(
        r"^\|[^|]*\| `([a-z-]+)` \|[^|]*\|[^|]*\| [^|]*(?:real:|from the documentation|of our own)[^|]*\|$",
        README,
        re.MULTILINE,
    )
    assert sorted(rows) == sorted(known.name for known in GAZE_FORMATS)


@pytest.mark.parametrize(
    "name",
    [*GAZE_OPTIONS, *DECISION_OPTIONS, *ACTIONS, *GESTURES, "robot9", *DETAILS, *EVENTS,
     *(known.name for known in (*GAZE_FORMATS, *DECISION_FORMATS, *SIGNAL_FORMATS))],
)  # fmt: skip
def test_every_option_action_label_and_format_is_described(name: str) -> None:
    assert re.search(rf"`[^`\n]*\b{re.escape(name)}\b[^`\n]*`", README), name


def test_the_default_classes_of_the_bci_are_those_described() -> None:
    assert set(CLASSES) == {f"robot{n}" for n in range(1, 10)} | {str(n) for n in range(1, 10)} | {"idle", "rest"}
