"""The wheel holds everything that a run outside the checkout needs, and nothing else."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

pytest.importorskip("hatchling", reason="the build backend is not installed")

ROOT = Path(__file__).parents[2]
DATA = ("scenarios", "assets/masks", "assets/recordings")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    folder = tmp_path_factory.mktemp("wheel")
    build = f"from hatchling.build import build_wheel; build_wheel({str(folder)!r})"
    subprocess.run([sys.executable, "-c", build], cwd=ROOT, check=True, capture_output=True, timeout=120)
    (file,) = folder.glob("*.whl")
    return zipfile.ZipFile(file)


def sources(folder: str) -> set[str]:
    return {
        str(file.relative_to(ROOT))
        for file in (ROOT / folder).rglob("*")
        if file.is_file() and "__pycache__" not in file.parts
    }


def test_every_module_and_script_of_the_page_is_in_the_wheel(wheel: zipfile.ZipFile) -> None:
    held = set(wheel.namelist())
    assert sources("higvf_console") <= held
    assert {name.removeprefix("interfaces/") for name in sources("interfaces/higvf_interfaces")} <= held


@pytest.mark.parametrize("folder", DATA)
def test_every_data_file_is_in_the_wheel(wheel: zipfile.ZipFile, folder: str) -> None:
    assert {f"higvf_console/{name}" for name in sources(folder)} <= set(wheel.namelist())


def test_the_wheel_holds_no_tests_and_no_documentation(wheel: zipfile.ZipFile) -> None:
    tops = {name.partition("/")[0] for name in wheel.namelist()}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"higvf_console", "higvf_interfaces"}


def test_the_wheel_names_the_command_and_the_interfaces(wheel: zipfile.ZipFile) -> None:
    (name,) = [name for name in wheel.namelist() if name.endswith("entry_points.txt")]
    entries = wheel.read(name).decode()
    assert "higvf = higvf_console.cli.main:main" in entries
    assert "gaze = higvf_interfaces.gaze.interface:open_gaze" in entries
