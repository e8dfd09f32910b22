"""Without the packages of the extras the library and headless runs work, and what needs one names its extra."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

EXTRAS = (
    "viser", "websockets", "msgspec", "zstandard", "mapbox_earcut", "cv2", "pyxdf", "edfio", "tqdm", "matplotlib",
    "sklearn", "daqp", "pyrvo", "pylsl", "playwright",
)  # fmt: skip
_WITHOUT = f"""
import sys
from importlib.abc import MetaPathFinder

class Missing(MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {EXTRAS!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)
        return None

sys.meta_path.insert(0, Missing())
"""
_LIBRARY = """
import higvf_console as hc
for name in hc.__all__:
    getattr(hc, name)
setup = hc.make_setup([[0, 0], [60, 0]], hc.Hazards().circle((200, 0), 20), path=hc.line_path((0, 0)))
print(hc.Controller(setup).step([[0, 0], [60, 0]]).shape, hc.filter_velocities([[0, 0]], [[1, 0]]).velocity.tolist())
print(hc.run(setup, 0.1)["ticks"])
"""
_COMMAND = """
from higvf_console.cli.main import main
sys.exit(main(sys.argv[1:]))
"""


def run_without_extras(code: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """A fresh process in which no package of an extra can be imported."""
    return subprocess.run(
        [sys.executable, "-c", _WITHOUT + code, *arguments], capture_output=True, text=True, check=False
    )


def test_the_library_needs_no_extra() -> None:
    done = run_without_extras(_LIBRARY)
    assert (done.returncode, done.stdout) == (0, "(2, 2) [[1.0, 0.0]]\n5\n"), done.stderr


def test_a_headless_run_needs_no_extra() -> None:
    done = run_without_extras(_COMMAND, "run", "firefighting", "--headless", "--duration", "0.5")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["ticks"] == 25


def test_a_scripted_headless_run_needs_no_extra(tmp_path: Path) -> None:
    script = tmp_path / "script.yaml"
    script.write_text("- {at_s: 0.1, do: pick, robot: 2}\n")
    done = run_without_extras(_COMMAND, "run", "empty", "--headless", "--duration", "0.2", "--script", str(script))
    assert [command["kind"] for command in json.loads(done.stdout)["commands"]] == ["Pick"], done.stderr


def test_all_scenarios_are_listed_without_an_extra_that_one_needs() -> None:
    done = run_without_extras(_COMMAND, "scenarios")
    assert done.returncode == 0, done.stderr
    assert (
        "building                   (this needs the module 'cv2': pip install 'higvf-console[images]')" in done.stdout
    )
    assert "firefighting               Three robots" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (
            ["run", "empty", "--no-browser"],
            "the console needs the module 'viser': pip install 'higvf-console[console]'",
        ),
        (["run", "building", "--headless"], "this needs the module 'cv2': pip install 'higvf-console[images]'"),
        (["reproduce"], "higvf reproduce needs the module 'matplotlib': pip install 'higvf-console[report]'"),
        (["bench", "--suite", "ui"], "suite ui needs the module 'viser': pip install 'higvf-console[console]'"),
        (["run", "empty", "--headless", "--lsl-out", "x"], "--lsl-out needs pylsl: pip install 'higvf-console[lsl]'"),
    ],
)
def test_a_command_that_needs_an_extra_names_it_in_one_line(arguments: list[str], line: str) -> None:
    done = run_without_extras(_COMMAND, *arguments)
    assert done.returncode == 2, done.stderr
    (message,) = [text for text in done.stderr.splitlines() if not text.startswith("Compiling")]
    assert message.startswith(f"higvf: {line}")


@pytest.mark.parametrize(("suffix", "content", "module"), [("edf", b"0       " + b" " * 600, "edfio")])
def test_a_recording_that_needs_an_extra_names_it_in_one_line(
    suffix: str, content: bytes, module: str, tmp_path: Path
) -> None:
    file = tmp_path / f"recording.{suffix}"
    file.write_bytes(content)
    done = run_without_extras(_COMMAND, "inspect", str(file))
    assert done.returncode == 2, done.stderr
    assert f"needs the module '{module}': pip install 'higvf-console[devices]'" in done.stderr
    assert done.stderr.count("\n") == 1
