"""`--input` and `demo` words: channel, file and options, whatever the file is called."""

from pathlib import Path

import pytest

from higvf_console.core.errors import InputError
from higvf_console.runtime.inputs import demo_specs, input_spec
from higvf_console.scenario.scenario import Scenario, data_folder, parse_scenario


@pytest.mark.parametrize(
    ("text", "channel", "source", "options"),
    [
        ("console", "console", "", {}),
        ("gaze=run.tsv", "gaze", "run.tsv", {}),
        ("gaze=run.tsv:frame=screen", "gaze", "run.tsv", {"frame": "screen"}),
        ("gaze=run.tsv:frame=screen,stream=Gaze 1", "gaze", "run.tsv", {"frame": "screen", "stream": "Gaze 1"}),
        (r"gaze=C:\my runs\gaze.tsv", "gaze", r"C:\my runs\gaze.tsv", {}),
        (r"gaze=C:\my runs\gaze.tsv:frame=unit", "gaze", r"C:\my runs\gaze.tsv", {"frame": "unit"}),
        ("emg=run 12:30:15.csv", "emg", "run 12:30:15.csv", {}),
        ("emg=run 12:30:15.csv:period=0.1", "emg", "run 12:30:15.csv", {"period": "0.1"}),
        ("emg=a=b.csv:stream=x:y", "emg", "a=b.csv", {"stream": "x:y"}),
        ("bci=:stream=Decoder", "bci", "", {"stream": "Decoder"}),
        ("my-device=/dev/ttyUSB0", "my-device", "/dev/ttyUSB0", {}),
    ],
)
def test_a_word_names_channel_file_and_options(
    team: Scenario, text: str, channel: str, source: str, options: dict[str, str]
) -> None:
    spec = input_spec(text, team)
    assert (spec.channel, spec.source, spec.options) == (channel, source, options)
    assert spec.arena == team.arena


def test_an_existing_file_is_taken_by_its_whole_name(team: Scenario, tmp_path: Path) -> None:
    (tmp_path / "odd:frame=unit").touch()
    spec = input_spec(f"gaze={tmp_path}/odd:frame=unit", team)
    assert (spec.source, spec.options) == (f"{tmp_path}/odd:frame=unit", {})
    spec = input_spec(f"gaze={tmp_path}/odd:frame=unit:frame=screen", team)
    assert (spec.source, spec.options) == (f"{tmp_path}/odd:frame=unit", {"frame": "screen"})


@pytest.mark.parametrize("options", ["frame", "frame=screen, start=2", " frame=screen", "frame=screen,start"])
def test_what_follows_an_existing_file_and_is_no_options_is_refused(
    team: Scenario, tmp_path: Path, options: str
) -> None:
    (tmp_path / "look.tsv").touch()
    with pytest.raises(InputError, match=f"look.tsv: '{options}' is not of the form option=value,option=value"):
        input_spec(f"gaze={tmp_path}/look.tsv:{options}", team)
    assert input_spec(f"gaze={tmp_path}/look.tsv:30", team).source == f"{tmp_path}/look.tsv:30"


def test_a_name_that_no_file_can_have_is_no_file(team: Scenario) -> None:
    assert input_spec(f"gaze={'a' * 300}:frame=unit", team).source == "a" * 300


@pytest.mark.parametrize("text", ["", "=run.tsv", "two words=run.tsv", "1=run.tsv"])
def test_a_word_without_a_channel_is_refused_with_the_form(team: Scenario, text: str) -> None:
    with pytest.raises(InputError, match="give CHANNEL=FILE or CHANNEL=FILE:option=value,option=value"):
        input_spec(text, team)


def test_an_option_given_twice_is_refused(team: Scenario) -> None:
    with pytest.raises(InputError, match="option 'frame' is given twice"):
        input_spec("gaze=run.tsv:frame=unit,frame=screen", team)


def test_an_interface_is_given_the_settings_of_its_channel(team: Scenario) -> None:
    scenario = parse_scenario(team.text + "inputs: {emg: {labels: {fist: pause}}}", "t.yaml")
    assert input_spec("emg=run.csv", scenario).settings == {"labels": {"fist": "pause"}}
    assert input_spec("gaze=run.csv", scenario).settings == {}


def test_the_files_of_a_demo_lie_beside_the_scenarios(team: Scenario) -> None:
    scenario = parse_scenario(team.text + "demo: ['gaze=assets/recordings/a.tsv:frame=screen']", "t.yaml")
    (spec,) = demo_specs(scenario)
    assert spec.source == str(data_folder() / "assets" / "recordings" / "a.tsv")
    assert spec.options == {"frame": "screen"}


def test_a_scenario_without_a_demo_says_so(team: Scenario) -> None:
    with pytest.raises(InputError, match="scenario 'team' has no section 'demo'"):
        demo_specs(team)
