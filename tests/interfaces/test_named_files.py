"""Files are named as operators do, and a home that nobody has is no crash."""

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


def test_a_home_is_found_and_that_of_nobody_stays_as_written() -> None:
    assert named("~/look.tsv") == Path.home() / "look.tsv"
    assert named(NOBODY) == Path(NOBODY)


def test_a_file_in_the_home_of_nobody_is_refused(write: Callable[..., str]) -> None:
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
def test_a_folder_where_a_file_is_due_is_refused_with_what_is(
    tmp_path: Path, options: dict[str, str], expected: str
) -> None:
    with pytest.raises(InputError, match=f"{tmp_path}: is a folder; give a file of {expected}".replace("(", r"\(")):
        open_emg(InputSpec("emg", str(tmp_path), options))
