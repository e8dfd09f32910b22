"""Inspectors are found by entry point; what they return is written as text or as JSON."""

import json
from collections.abc import Mapping
from importlib.metadata import EntryPoint
from pathlib import Path
from types import SimpleNamespace

import pytest

from higvf_console.channels import inspection
from higvf_console.cli.main import main
from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from tests.conftest import TEAM

DESCRIPTION: Mapping[str, object] = {
    "format": "horoscope", "samples": 3, "rate_hz": 0.5, "frame": None, "gaps": {"count": 2, "lost": {}},
    "streams": [{"name": "moon"}, {"name": "sun"}], "warnings": ["nothing is certain"],
}  # fmt: skip


def inspects(spec: InputSpec, plot: Path | None, steps: bool) -> Mapping[str, object]:
    return {**DESCRIPTION, "source": spec.source, "plot": str(plot), "steps": steps, "options": dict(spec.options)}


def knows_nothing(spec: InputSpec, plot: Path | None, steps: bool) -> Mapping[str, object]:  # noqa: ARG001
    raise InputError(f"{spec.source}: no idea")


@pytest.fixture
def installed(monkeypatch: pytest.MonkeyPatch) -> list[SimpleNamespace]:
    """What stands in the place of the installed inspectors."""
    points: list[SimpleNamespace] = []

    def found(group: str) -> list[SimpleNamespace]:
        assert group == inspection.GROUP
        return points

    monkeypatch.setattr(inspection, "entry_points", found)
    return points


def point(name: str, inspector: inspection.Inspector) -> SimpleNamespace:
    return SimpleNamespace(name=name, load=lambda: inspector)


def test_the_first_inspector_that_knows_the_file_is_heard(installed: list[SimpleNamespace]) -> None:
    installed += [point("b", inspects), point("a", knows_nothing)]
    assert inspection.inspect(InputSpec("inspect", "f"))["format"] == "horoscope"


def test_a_file_that_nobody_knows_is_refused_with_each_reason(installed: list[SimpleNamespace]) -> None:
    installed += [point("a", knows_nothing), point("b", knows_nothing)]
    with pytest.raises(InputError, match="f: no idea; f: no idea"):
        inspection.inspect(InputSpec("inspect", "f"))


def test_without_an_inspector_the_way_out_is_said(installed: list[SimpleNamespace]) -> None:
    assert not installed
    with pytest.raises(InputError, match=r"no inspector is installed .*install the package again"):
        inspection.inspect(InputSpec("inspect", "f"))


def test_text_has_a_line_for_what_there_is_and_warnings_last() -> None:
    lines = inspection.as_text(DESCRIPTION).splitlines()
    assert lines == [
        "format: horoscope", "samples: 3", "rate hz: 0.5", "gaps:", "  count: 2",
        "streams: name moon, name sun", "Warning: nothing is certain",
    ]  # fmt: skip


def test_json_keeps_every_key_and_knows_no_nan() -> None:
    assert json.loads(inspection.as_json({**DESCRIPTION, "rate_hz": float("nan")})) == {**DESCRIPTION, "rate_hz": None}


def test_the_command_takes_options_behind_the_file(
    installed: list[SimpleNamespace], capsys: pytest.CaptureFixture[str]
) -> None:
    installed.append(point("a", inspects))
    assert main(["inspect", "look.csv:frame=screen,stream=2", "--json", "--steps", "--plot", "p.png"]) == 0
    written = json.loads(capsys.readouterr().out)
    assert (written["source"], written["options"]) == ("look.csv", {"frame": "screen", "stream": "2"})
    assert (written["plot"], written["steps"]) == ("p.png", True)
    assert main(["inspect", "look.csv"]) == 0
    assert capsys.readouterr().out.startswith("format: horoscope\n")


def test_a_refusal_is_one_line_and_status_2(
    installed: list[SimpleNamespace], capsys: pytest.CaptureFixture[str]
) -> None:
    installed.append(point("a", knows_nothing))
    assert main(["inspect", "look.csv"]) == 2
    assert capsys.readouterr().err == "higvf: look.csv: no idea\n"


def test_the_project_names_its_own_inspector() -> None:
    text = (Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8")
    (line,) = [line for line in text.splitlines() if line.startswith("recordings = ")]
    named = EntryPoint("recordings", line.split('"')[1], inspection.GROUP)
    assert callable(named.load())


def writes(spec: InputSpec, plot: Path | None, steps: bool) -> Mapping[str, object]:
    assert plot is not None
    plot.write_text("a picture")
    return inspects(spec, plot, steps)


def fails(spec: InputSpec, plot: Path | None, steps: bool) -> Mapping[str, object]:  # noqa: ARG001
    raise KeyError("oops")


def test_the_namesake_of_the_channel_goes_first_then_other_packages_and_the_own_one_last(
    installed: list[SimpleNamespace],
) -> None:
    asked: list[str] = []

    def asks(name: str) -> inspection.Inspector:
        def inspector(spec: InputSpec, plot: Path | None, steps: bool) -> Mapping[str, object]:
            asked.append(name)
            return knows_nothing(spec, plot, steps)

        return inspector

    installed += [point(name, asks(name)) for name in ("a", "recordings", "glove", "z")]
    installed[1].dist = SimpleNamespace(name="higvf-console")
    for channel in ("glove", "inspect"):
        with pytest.raises(InputError, match="no idea"):
            inspection.inspect(InputSpec(channel, "f"))
    assert asked == ["glove", "a", "z", "recordings", "a", "glove", "z", "recordings"]


def test_an_inspector_that_crashes_does_not_hide_the_others(installed: list[SimpleNamespace]) -> None:
    installed += [point("a", fails), point("b", inspects)]
    assert inspection.inspect(InputSpec("inspect", "f"))["format"] == "horoscope"
    installed[1] = point("b", knows_nothing)
    with pytest.raises(InputError, match="inspector 'a' failed: KeyError: 'oops'; f: no idea"):
        inspection.inspect(InputSpec("inspect", "f"))


def test_a_picture_that_was_not_written_is_said(installed: list[SimpleNamespace], tmp_path: Path) -> None:
    plot = tmp_path / "p.png"
    plot.write_text("an old picture")
    installed.append(point("a", inspects))
    said = inspection.inspect(InputSpec("inspect", "f"), plot)["warnings"]
    assert said == ["nothing is certain", f"no picture: {plot} was not written"]
    installed[0] = point("a", writes)
    assert inspection.inspect(InputSpec("inspect", "f"), plot)["warnings"] == ["nothing is certain"]


def test_the_command_takes_a_channel_with_its_settings(
    installed: list[SimpleNamespace],
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def settings(spec: InputSpec, plot: Path | None, steps: bool) -> Mapping[str, object]:
        return {**inspects(spec, plot, steps), "channel": spec.channel, "settings": dict(spec.settings)}

    monkeypatch.chdir(tmp_path)
    installed.append(point("a", settings))
    scenario = tmp_path / "own.yaml"
    scenario.write_text(TEAM + "inputs: {emg: {threshold: 0.7}}\n")
    assert main(["inspect", "emg=hand.csv:start=2", "--json", "--scenario", str(scenario)]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["channel"], told["source"], told["options"]) == ("emg", "hand.csv", {"start": "2"})
    assert told["settings"] == {"threshold": 0.7}
    (tmp_path / "emg=1.csv").write_text("time,label\n")
    assert main(["inspect", "emg=1.csv", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["source"] == "emg=1.csv"
    assert main(["inspect", "emh=hand.csv"]) == 2
    assert "no interface 'emh' (did you mean 'emg'?)" in capsys.readouterr().err
