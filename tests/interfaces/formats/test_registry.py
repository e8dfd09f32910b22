"""Other packages add formats by entry point; what they break is one clear line."""

from collections.abc import Callable
from pathlib import Path

import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.formats import registry
from higvf_interfaces.formats.reading import GAZE_FORMATS, gaze_formats, read_gaze
from higvf_interfaces.formats.signals.reading import read_decisions, read_signals
from higvf_interfaces.inspect.inspection import inspect

TRACKER = """
import math
from higvf_interfaces.formats.reading import GazeFormat
from higvf_interfaces.formats.records import CommandLog, Decision, GazeStream, blocks_of
from higvf_interfaces.formats.signals.reading import SignalFormat

def matches(file):
    return file.first_line == "OWN TRACKER"

def stream(file, wanted):
    rows = (tuple(map(float, line.split())) for line in list(file.lines())[1:])
    samples = [(time, x, y, True, math.nan) for time, x, y in rows]
    return GazeStream("own", ("time", "x", "y"), "unit", blocks_of(samples), [])

def log(file, request):
    return CommandLog((Decision(0.5, "fist", None),), 0.0, "own-log", ())

FORMAT = GazeFormat("own", "my own tracker", matches, stream)
LOG = SignalFormat("own-log", "my own log", lambda file: file.first_line == "OWN LOG", log)
"""
Install = Callable[..., None]


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Install:
    """Lays out a package with a module and entry points `name = value`, as an installer does."""
    monkeypatch.syspath_prepend(tmp_path / "site")

    def laid_out(module: str, source: str, **points: str) -> None:
        metadata = tmp_path / "site" / f"{module}-1.0.dist-info"
        metadata.mkdir(parents=True)
        (tmp_path / "site" / f"{module}.py").write_text(source)
        (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
        groups = [f"[{getattr(registry, group)}]\nown = {module}:{name}\n" for group, name in points.items()]
        (metadata / "entry_points.txt").write_text("\n".join(groups))

    return laid_out


def test_a_gaze_format_of_another_package_is_detected_read_and_inspected(
    install: Install, write: Callable[..., str]
) -> None:
    install("own_tracker", TRACKER, GAZE="FORMAT", DECISIONS="LOG")
    file = write("OWN TRACKER\n" + "".join(f"{k / 100} 0.5 0.25\n" for k in range(40)))
    gaze = read_gaze(file)
    assert (gaze.format, gaze.frame, len(gaze.time)) == ("own", "unit", 40)
    assert inspect(InputSpec("gaze", file))["format"] == "own"
    assert read_decisions(write("OWN LOG\n")).format == "own-log"
    with pytest.raises(InputError, match=r"unrecognised format; .*own: my own tracker"):
        read_gaze(write("nothing\n"))


def test_without_other_packages_the_formats_are_those_of_the_console() -> None:
    assert gaze_formats() == GAZE_FORMATS


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("import missing_driver", r"format 'own' \(broken:FORMAT\) does not load: No module named 'missing_driver'"),
        ("FORMAT = 3", r"format 'own' \(broken:FORMAT\) is 3, not a GazeFormat; repair or uninstall its package"),
        (TRACKER.replace('GazeFormat("own"', 'GazeFormat("gaze-csv"'), "has the name of another format, 'gaze-csv'"),
        (TRACKER.replace("file.first_line ==", "file.colour =="), "failed: AttributeError: .*'colour'"),
    ],
)
def test_a_broken_format_is_named_with_the_way_out(
    install: Install, write: Callable[..., str], monkeypatch: pytest.MonkeyPatch, source: str, message: str
) -> None:
    monkeypatch.delitem(__import__("sys").modules, "broken", raising=False)
    install("broken", source, GAZE="FORMAT")
    with pytest.raises(InputError, match=message):
        read_gaze(write("time,x [px],y [px]\n0,1,2\n"))


def test_a_gaze_format_does_not_stand_in_the_way_of_signals(install: Install, write: Callable[..., str]) -> None:
    install("broken_gaze", "FORMAT = 3", GAZE="FORMAT")
    rows = "".join(f"{k / 250},{k % 7}\n" for k in range(600))
    assert read_signals(write("timestamps,C3\n" + rows)).names == ("C3",)
