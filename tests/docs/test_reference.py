"""The generated reference is complete: whatever the code knows has its place and its sentence."""

import json
import re
from dataclasses import fields
from pathlib import Path
from typing import get_args

import pytest

from docs._ext import tables
from docs._ext.markdown import number
from docs._ext.scenario_trace import EXAMPLES, scenario_keys
from higvf_console.cli.arguments import parser
from higvf_console.control.forms import Forms
from higvf_console.control.parameters import Parameters
from higvf_console.core.commands import OperatorCommand
from higvf_console.core.quantity import quantities
from higvf_console.runtime.headless import run_headless
from higvf_console.runtime.recording import Recorder
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import KEYS, load_scenario, parse_scenario
from higvf_console.team.tracking import Rules

DOCS = Path(__file__).parents[2] / "docs"


def text(name: str) -> str:
    return "\n".join(tables.TABLES[name]())


def test_every_scenario_key_has_a_sentence_and_no_sentence_is_left_over() -> None:
    assert set(scenario_keys()) == set(tables.described("scenario_keys"))


def test_every_top_level_key_is_observed() -> None:
    assert {key for key in scenario_keys() if key in KEYS} == set(KEYS)


@pytest.mark.parametrize("key", ["robots.jitter_m", "fires[].growth_m_per_s", "obstacles.masks[].tolerance_m", "demo"])
def test_the_scenario_page_lists_nested_keys(key: str) -> None:
    assert f"`{key}`" in text("scenario")


def test_the_range_of_a_key_is_that_of_the_reader() -> None:
    assert scenario_keys()["robots.jitter_m"].span == "0 to 1000"
    assert scenario_keys()["path.pace"].span == "0.2 to 1.5"


@pytest.mark.parametrize("file", sorted(EXAMPLES.glob("*.yaml")), ids=lambda file: file.stem)
def test_the_scenarios_that_are_observed_run(file: Path) -> None:
    scenario = parse_scenario(file.read_text(encoding="utf-8"), str(file))
    assert run_headless(Session(scenario, []), 0.1)["ticks"] == 5


def test_every_parameter_is_listed_with_its_range_and_sentence() -> None:
    page = text("parameters")
    for part in Parameters():
        for name, about in quantities(type(part)).items():
            assert re.search(
                rf"\| `{name}` \|.*\| {number(about.low)} to {number(about.high)} \| {re.escape(about.text)}", page
            ), name


def test_every_form_is_listed() -> None:
    page = text("forms")
    assert all(f"| `{name}` | [" in page for name in Forms._fields)


@pytest.mark.parametrize("command", get_args(OperatorCommand), ids=lambda command: command.__name__)
def test_every_command_is_listed_with_its_fields(command: type) -> None:
    page = text("commands")
    own = page[page.index(f"### `{command.__name__}`\n") :].partition("\n### ")[0]
    shared = page[: page.index("## Commands")]
    for field in fields(command):
        assert f"| `{field.name}` |" in own + shared, field.name


def test_every_subcommand_is_listed_with_its_options() -> None:
    page = text("command-line")
    subcommands = re.findall(r"^ {4}([a-z][a-z-]+)(?: |$)", parser().format_help(), re.MULTILINE)
    assert {"run", "replay", "check-interface"} <= set(subcommands)
    assert all(f"## higvf {name}\n" in page for name in subcommands)
    assert "| `--seed N` |" in page


def test_every_key_of_a_report_has_a_sentence() -> None:
    report = run_headless(Session(load_scenario("empty"), []), 0.1)
    assert set(report) == set(tables.described("report_keys"))


def test_every_key_of_a_recordings_header_is_described(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "run.jsonl", load_scenario("empty"), 0, rules=Rules(1.0, 0.0, 0.1))
    recorder.close()
    header = json.loads((tmp_path / "run.jsonl").read_text(encoding="utf-8").splitlines()[0])
    row = next(line for line in (DOCS / "reference" / "recording.md").read_text().splitlines() if "| header" in line)
    assert set(header) == set(re.findall(r"`(\w+)`", row))


def test_every_name_in_the_glossary_is_one_of_the_code() -> None:
    assert "| guiding vector field |" in text("glossary")


def test_a_name_that_the_code_does_not_have_is_an_error() -> None:
    with pytest.raises(LookupError, match=r"core\.state has no 'Motion\.nowhere'"):
        tables.resolve("core.state", "Motion.nowhere")


def test_every_package_is_in_the_picture_of_the_layers() -> None:
    packages = {file.parent.name for file in (DOCS.parent / "higvf_console").glob("*/__init__.py")}
    assert set(re.findall(r"^\*\*(\w+)\*\*", text("layers"), re.MULTILINE)) == packages
