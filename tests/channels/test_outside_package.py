"""A lab adds a device by installing a package with an entry point; the console need not change."""

import shutil
import tomllib
from pathlib import Path

import pytest

from higvf_console.channels.channels import interface_names, open_interface
from higvf_console.channels.interface_check import check_interface
from higvf_console.cli.main import main
from higvf_console.core.commands import Pause, Resume
from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import Scenario

PACKAGE = Path(__file__).parents[1] / "outside_package"


@pytest.fixture(autouse=True)
def _installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Lays the package out as an installer does: its module, and its metadata with the entry points."""
    site = tmp_path / "site-packages"
    project = tomllib.loads((PACKAGE / "pyproject.toml").read_text())["project"]
    metadata = site / f"{project['name'].replace('-', '_')}-{project['version']}.dist-info"
    metadata.mkdir(parents=True)
    shutil.copy(PACKAGE / "my_gamepad.py", site)
    (metadata / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n"
    )
    groups = project["entry-points"].items()
    lines = [f"[{group}]\n" + "".join(f"{k} = {v}\n" for k, v in points.items()) for group, points in groups]
    (metadata / "entry_points.txt").write_text("\n".join(lines))
    monkeypatch.syspath_prepend(site)


@pytest.fixture
def presses(tmp_path: Path) -> str:
    """Pause at 0.1 s, resume at 0.3 s."""
    (tmp_path / "presses.txt").write_text("0.1 A\n0.3 B\n")
    return str(tmp_path / "presses.txt")


def test_it_is_found_by_its_entry_point_and_keeps_the_contract(presses: str) -> None:
    assert "gamepad" in interface_names()
    findings = check_interface(InputSpec("gamepad", presses), seconds=1.0)
    assert [finding for finding in findings if not finding.kept] == []


def test_it_steers_a_session(presses: str, team: Scenario) -> None:
    session = Session(team, [open_interface(InputSpec("gamepad", presses))])
    for _ in range(20):
        session.tick()
    assert [type(applied.command) for applied in session.commands] == [Pause, Resume]
    session.close()


def test_it_is_checked_from_the_command_line(presses: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check-interface", "gamepad", "--input", f"gamepad={presses}", "--seconds", "1"]) == 0
    assert "ok     gives only known commands: 2 seen" in capsys.readouterr().out


def test_its_own_errors_reach_the_person(tmp_path: Path) -> None:
    (tmp_path / "bad.txt").write_text("0.1 A\nsoon B\n")
    with pytest.raises(InputError, match=r"bad\.txt, line 2: 'soon B' is not SECONDS BUTTON with one of A, B, X, Y"):
        open_interface(InputSpec("gamepad", str(tmp_path / "bad.txt")))
