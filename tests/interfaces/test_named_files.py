"""File names are expanded, and unusable ones are refused."""

from collections.abc import Callable
from pathlib import Path

import pytest

from higvf_console.core.errors import HigvfError, InputError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.decisions.emg import open_emg
from higvf_interfaces.gaze.interface import open_gaze
from higvf_interfaces.paths import named
from higvf_interfaces.scripts.interface import open_script

NOBODY = "~nobody-of-this-name/file"


def test_a_home_folder_is_expanded_and_an_unknown_one_stays_as_written() -> None:
    assert named("~/look.tsv") == Path.home() / "look.tsv"
    assert named(NOBODY) == Path(NOBODY)


def test_a_file_in_an_unknown_home_folder_is_refused(write: Callable[..., str]) -> None:
    table = write("time,x [px],y [px]\n0,1,1\n")
    for opened in (
        lambda: open_gaze(InputSpec("gaze", NOBODY)),
        lambda: open_gaze(InputSpec("gaze", table, {"calibration": NOBODY})),
        lambda: open_script(InputSpec("script", NOBODY)),
    ):
        with pytest.raises(HigvfError, match=f"{NOBODY}: "):
            opened()


@pytest.mark.parametrize(
    ("options", "expected"), [({}, "decisions (.*command-csv"), ({"decoder": "ssvep"}, "a signal (.*signal-csv")]
)
def test_a_folder_instead_of_a_file_is_refused_with_the_formats(
    tmp_path: Path, options: dict[str, str], expected: str
) -> None:
    with pytest.raises(InputError, match=f"{tmp_path}: is a folder; give a file of {expected}".replace("(", r"\(")):
        open_emg(InputSpec("emg", str(tmp_path), options))
