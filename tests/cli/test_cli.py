"""The command line: exit status, one-line errors, and a `--help` that loads no compiler."""

import json
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import higvf_console
from higvf_console.channels import channels
from higvf_console.cli import run as run_module
from higvf_console.cli.arguments import parser
from higvf_console.cli.main import main
from higvf_console.core.interface import InputSpec, Interface
from higvf_console.runtime.recording import read_recording
from higvf_console.scenario.scenario import load_scenario, scenario_names
from tests.fake_interfaces import FakeConsole, FakeInterface


@pytest.fixture(scope="module", autouse=True)
def _compiled() -> None:
    """Compiles the engine beforehand, since a compilation writes a line to stderr, where these tests count lines."""
    assert main(["compile"]) == 0


def test_help_loads_neither_numba_nor_scipy() -> None:
    code = (
        "import sys; from higvf_console.cli.main import main\n"
        "try: main(['run', '--help'])\n"
        "except SystemExit: pass\n"
        "print(sorted({'numba', 'scipy', 'numpy', 'viser', 'yaml'} & set(sys.modules)), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"
    assert "--headless" in done.stdout


def test_every_public_name_can_be_imported_and_nothing_else() -> None:
    for name in higvf_console.__all__:
        assert getattr(higvf_console, name).__name__ if name != "OperatorCommand" else True
        assert name in dir(higvf_console)
    with pytest.raises(AttributeError, match="has no attribute 'Robot'"):
        _ = higvf_console.Robot  # pyright: ignore[reportAttributeAccessIssue, reportUnknownVariableType]


def test_scenarios_are_listed_with_their_descriptions(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenarios"]) == 0
    listed = capsys.readouterr().out.splitlines()
    assert tuple(line.split()[0] for line in listed) == scenario_names()
    assert all(len(line.split()) > 3 for line in listed)


def test_a_headless_run_writes_its_report_to_standard_output(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "empty", "--headless", "--duration", "0.2", "--seed", "4"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert (report["scenario"], report["ticks"], report["seed"]) == ("empty", 10, 4)


def test_a_seed_that_changes_nothing_is_warned_of(capsys: pytest.CaptureFixture[str]) -> None:
    said = "Warning: --seed 4 changes nothing: scenario '{}' has neither jitter_m, measurement noise nor packet loss"
    for scenario, warned in (("empty", True), ("unicycles", False)):
        assert main(["run", scenario, "--headless", "--duration", "0.02", "--seed", "4"]) == 0
        assert (said.format(scenario) in capsys.readouterr().err) is warned
    assert main(["run", "empty", "--headless", "--duration", "0.02"]) == 0
    assert "--seed" not in capsys.readouterr().err


def test_a_report_may_go_to_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["run", "empty", "--headless", "--duration", "0.2", "--report", str(tmp_path / "report.json")]
    assert main(arguments) == 0
    assert json.loads((tmp_path / "report.json").read_text())["scenario"] == "empty"
    assert capsys.readouterr().out == ""


def test_a_recorded_run_replays_and_a_forged_one_does_not(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "run.jsonl"
    assert main(["run", "firefighting", "--headless", "--duration", "1.5", "--record", str(file)]) == 0
    digest = json.loads(capsys.readouterr().out)["digest"]
    assert main(["replay", str(file)]) == 0
    assert capsys.readouterr().out == f"The replay of 75 ticks matches the recording: digest {digest}\n"
    file.write_text(file.read_text().replace("[700, 300]", "[700, 301]"))
    assert main(["replay", str(file)]) == 1
    assert "The replay differs after tick 0" in capsys.readouterr().out


def test_a_replay_reports_a_truncated_recording(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "run.jsonl"
    assert main(["run", "empty", "--headless", "--duration", "2.5", "--record", str(file)]) == 0
    file.write_text(file.read_text()[:-40])
    assert main(["replay", str(file)]) == 0
    assert "the recording is truncated after 100 ticks" in capsys.readouterr().err


def test_a_script_steers_a_headless_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    script = tmp_path / "script.yaml"
    script.write_text("- {at_s: 0.1, do: pick, robot: 2}\n")
    assert main(["run", "empty", "--headless", "--duration", "0.4", "--script", str(script)]) == 0
    (command,) = json.loads(capsys.readouterr().out)["commands"]
    assert (command["kind"], command["source"]) == ("Pick", "script")
    assert command["time"] == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["run", "nowhere", "--headless"], "higvf: no scenario 'nowhere'"),
        (["run", "nowhere.yaml", "--headless"], "higvf: nowhere.yaml: No such file"),
        (["run", "empty", "--report", "x.json"], "higvf: --report needs a headless run: add --headless"),
        (["run", "empty", "--headless", "--speed", "9"], "higvf: --speed 9: choose 0.25 to 8"),
        (["run", "empty", "--headless", "--demo"], "higvf: scenario 'empty' has no section 'demo'"),
        (["run", "empty", "--headless", "--input", "gase=x"], "higvf: no interface 'gase' (did you mean 'gaze'?)"),
        (["run", "empty", "--headless", "--input", "gaze=none.tsv:frame=screen"], "none.tsv"),
        (["run", "empty", "--headless", "--input", "="], "higvf: --input =: give CHANNEL=FILE"),
        (["run", "empty", "--headless", "--script", "none.yaml"], "none.yaml"),
        (
            ["run", "empty", "--headless", "--duration", "0.1", "--report", "no/such/x.json"],
            "higvf: --report no/such/x.json",
        ),
        (["run", "empty", "--headless", "--record", "no/such/x.jsonl"], "higvf: no/such/x.jsonl: cannot be written"),
        (["replay", "none.jsonl"], "higvf: none.jsonl: No such file"),
    ],
)
def test_bad_input_is_one_line_and_exit_2(
    arguments: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    output = capsys.readouterr()
    assert sentence in output.err
    assert output.err.count("\n") == 1
    assert output.out == ""


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ([], "higvf: the following arguments are required: COMMAND"),
        (["fly"], "invalid choice: 'fly'"),
        (["run", "--duration", "-1"], "argument --duration: '-1' is not a number greater than 0"),
        (["run", "--duration", "soon"], "argument --duration: 'soon' is not a number greater than 0"),
        (["run", "--seed", "-1"], "argument --seed: '-1' is not a whole number from 0 up"),
        (["run", "--port", "http"], "argument --port: 'http' is not a port from 1 to 65535, or auto for a free port"),
        (["bench"], "the following arguments are required: --suite"),
        (["bench", "--suite", "all"], "invalid choice: 'all'"),
    ],
)
def test_a_wrong_command_line_is_one_line_and_exit_2(
    arguments: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == 2
    output = capsys.readouterr()
    assert sentence in output.err
    assert output.err.count("\n") == 1


# The background jobs of a shell, and their children, ignore SIGINT.
_HANDLES_SIGINT = """
import signal, sys
from higvf_console.cli.main import main
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize("interruption", [signal.SIGINT, signal.SIGTERM])
def test_a_console_is_served_until_it_is_interrupted(tmp_path: Path, interruption: signal.Signals) -> None:
    file = tmp_path / "run.jsonl"
    command = [sys.executable, "-c", _HANDLES_SIGINT, "run", "empty", "--port", "auto", "--no-browser"]
    process = subprocess.Popen([*command, "--record", str(file)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        assert re.match(r"Console: http://127\.0\.0\.1:\d+/\?token=\S{20,}$", process.stdout.readline())
        process.send_signal(interruption)
        assert process.wait(timeout=30) == 0
    finally:
        process.kill()
    assert read_recording(file).complete


def test_a_live_run_ends_after_its_duration() -> None:
    options = ["--port", "auto", "--no-browser", "--start-at-once"]
    command = [sys.executable, "-m", "higvf_console", "run", "empty", *options]
    done = subprocess.run([*command, "--duration", "0.1", "--token", "abc"], capture_output=True, text=True, check=True)
    assert "/?token=abc\n" in done.stdout
    assert "Warning: --token is deprecated: everybody on this machine can see it; use --token-file FILE" in done.stderr


def test_a_file_of_tokens_gives_a_link_for_each_role(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "higvf_console", "run", "empty", "--port", "auto", "--no-browser"]
    options = ["--start-at-once", "--duration", "0.1", "--token-file", str(tmp_path / "tokens")]
    done = subprocess.run([*command, *options], capture_output=True, text=True, check=True)
    for line in (tmp_path / "tokens").read_text(encoding="utf-8").splitlines():
        role, token = line.split()
        assert re.search(rf"Link of an {role}: http://127\.0\.0\.1:\d+/\?token={token}\n", done.stdout)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--token", "abc", "--token-file", "tokens"], "--token and --token-file exclude each other"),
        (["--certfile", "lab.pem"], "--certfile and --keyfile need each other"),
        (["--origin", "lab.example"], "--origin lab.example: expected scheme and host"),
        (["--pages", "500"], "--pages 500: choose 1 to 128"),
    ],
)
def test_options_of_access_that_cannot_be_are_one_line(
    options: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "empty", "--no-browser", *options]) == 2
    assert message in capsys.readouterr().err


def test_a_headless_run_that_is_told_to_start_at_once_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "empty", "--headless", "--start-at-once"]) == 2
    assert "a headless run always starts at once" in capsys.readouterr().err


def test_an_address_that_cannot_be_served_is_one_line_and_exit_2(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "empty", "--host", "203.0.113.7"]) == 2
    assert "higvf: host 203.0.113.7 is not an address of this machine" in capsys.readouterr().err


def test_a_channel_may_be_given_by_its_name_from_before(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "empty", "--headless", "--duration", "0.2", "--input", "mouse"]) == 0
    said = capsys.readouterr()
    assert said.err == "Warning: --input mouse: channel 'mouse' is renamed; write 'console'\n"
    assert list(json.loads(said.out)["channels"]) == ["console"]


@pytest.mark.parametrize(
    ("arguments", "opened"),
    [
        ([], ["console"]),
        (["--headless"], []),
        (["--input", "gamepad"], ["console", "gamepad"]),
        (["--input", "gamepad", "--input", "console"], ["gamepad", "console"]),
        (["--input", "table"], ["table"]),
    ],
)
def test_a_console_opens_its_own_channel_unless_another_takes_the_pointer(
    monkeypatch: pytest.MonkeyPatch, arguments: list[str], opened: list[str]
) -> None:
    def fake(spec: InputSpec) -> Interface:
        return FakeInterface(spec.channel) if spec.channel == "gamepad" else FakeConsole(name=spec.channel)

    monkeypatch.setattr(channels, "open_interface", fake)
    given = parser().parse_args(["run", "empty", *arguments])
    interfaces = run_module._open_interfaces(given, load_scenario("empty"))  # pyright: ignore[reportPrivateUsage]
    assert [interface.name for interface in interfaces] == opened


def test_compile_reports_its_duration(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compile"]) == 0
    assert capsys.readouterr().out.startswith("The engine is compiled (")


def test_the_package_runs_as_a_module() -> None:
    done = subprocess.run([sys.executable, "-m", "higvf_console", "run", "nowhere"], capture_output=True, check=False)
    assert done.returncode == 2
