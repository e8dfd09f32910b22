"""The command `higvf`: runs scenarios, replays and inspects recordings, reproduces the paper, runs benchmarks.

Exit status: 0 on success; 1 if a replay differs or an interface violates its contract; 2 on invalid input, with a
one-line reason on standard error; 130 on Ctrl-C.
"""
# ruff: noqa: PLC0415 (each command imports its own modules, so that `--help` does not load the compiler)

import argparse
import json
import os
import signal
import sys
import webbrowser
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from threading import Event as Signal
from threading import Thread
from time import sleep
from typing import TYPE_CHECKING, Any

from higvf_console.cli.arguments import parser
from higvf_console.core.errors import HigvfError, MissingExtraError
from higvf_console.core.optional import require
from higvf_console.runtime import scheduling

if TYPE_CHECKING:
    from higvf_console.runtime.session import Session
    from higvf_console.scenario.scenario import Scenario
    from higvf_console.world.setup import Setup


_REPORTED = ("refused", "clipped", "failure", "channel", "recording")  # kinds of events that a headless run prints


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one command.

    Args:
        arguments: of the command line; None = `sys.argv`.

    Returns:
        The exit status.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is loaded: its threads wait for each other
    given = parser().parse_args(arguments)
    try:
        return _COMMANDS[given.command](given)
    except HigvfError as error:
        _log(f"higvf: {error}")
        return 2
    except KeyboardInterrupt:
        _log("higvf: interrupted")
        return 130


def _log(text: str) -> None:
    print(text, file=sys.stderr)


def _scenarios(_: argparse.Namespace) -> int:
    from higvf_console.scenario.scenario import load_scenario, scenario_names

    for name in scenario_names():
        try:
            description = load_scenario(name).description
        except MissingExtraError as missing:
            description = f"({missing})"
        print(f"{name:26} {description}")
    return 0


def _inspect(given: argparse.Namespace) -> int:
    from higvf_console.channels.inspection import as_json, as_text, inspect
    from higvf_console.runtime.inputs import input_spec
    from higvf_console.scenario.scenario import load_scenario

    spec = input_spec(f"inspect={given.file}", load_scenario(given.scenario))
    description = inspect(spec, given.plot, given.steps)
    print(as_json(description) if given.json else as_text(description))
    return 0


def _bench(given: argparse.Namespace) -> int:
    from higvf_console.lab.bench import bench

    only = {"--scenes": given.scenes, "--scene": given.scene, "--save": given.save}
    misplaced = [option for option, value in only.items() if value is not None]
    if misplaced and given.suite != bench.DEADLOCK:
        raise HigvfError(f"{misplaced[0]} is an option of --suite {bench.DEADLOCK}, not of --suite {given.suite}")
    if given.save is not None and given.scene is None:
        raise HigvfError("--save needs a scene: add --scene KIND:SEED")
    if given.scene is not None:
        return _scene(given.scene, given.save)
    bench.main(given.suite, given.json, given.scenes)
    return 0


def _scene(name: str, file: Path | None) -> int:
    """Reports the events of a random scene, or saves it as a scenario file."""
    from higvf_console.lab.bench.deadlock import scene_named
    from higvf_console.lab.bench.deadlock_report import story
    from higvf_console.lab.bench.scene_file import scene_yaml

    scene = scene_named(name)
    if file is None:
        print(story(scene))
        return 0
    try:
        file.write_text(scene_yaml(scene), encoding="utf-8")
    except OSError as error:
        raise HigvfError(f"--save {file}: {error.strerror}") from error
    return 0


def _reproduce(given: argparse.Namespace) -> int:
    from higvf_console.lab.reproduce.command import reproduce
    from higvf_console.scenario.scenario import load_scenario

    reproduce(given.cases, given.out, given.json, prepare=lambda: _warm_up(load_scenario("firefighting").setup()))
    return 0


def _fit(given: argparse.Namespace) -> int:
    from higvf_console.lab.fit.study import BASE, study
    from higvf_console.lab.fit.text import summary
    from higvf_console.scenario.scenario import load_scenario

    _warm_up(load_scenario(BASE).setup())
    found = study(given.runs, given.seed)
    if given.scenario is not None:
        _write("--scenario", given.scenario, found.scenario)
    if given.json is not None:
        _write("--json", given.json, json.dumps(found.result, indent=2) + "\n")
    if given.json != "-":
        print(summary(found.result))
    return 0


def _compile(given: argparse.Namespace) -> int:
    from higvf_console.cli.engine import compile_smaller_stages, load_engine
    from higvf_console.scenario.scenario import load_scenario

    setup = load_scenario("firefighting").setup()
    if given.smaller_stages:
        compile_smaller_stages(setup, given.centralised)
        return 0
    print(f"The engine is compiled ({load_engine(setup, given.centralised):.1f} s).")
    return 0


def _check_interface(given: argparse.Namespace) -> int:
    from higvf_console.channels.interface_check import check_interface
    from higvf_console.core.interface import current_channel
    from higvf_console.runtime.inputs import input_spec, renamed_specs
    from higvf_console.scenario.scenario import load_scenario

    for warning in renamed_specs([given.input or given.name]):
        _log(f"Warning: {warning}")
    spec = input_spec(given.input or given.name, load_scenario(given.scenario))
    if spec.channel != current_channel(given.name):
        raise HigvfError(f"--input {given.input}: the input is for the interface '{spec.channel}', not '{given.name}'")
    findings = check_interface(spec, given.seconds)
    for finding in findings:
        print(f"{'ok    ' if finding.kept else 'FAILED'} {finding.rule}: {finding.detail}")
    return 0 if all(finding.kept for finding in findings) else 1


def _warm_up(setup: "Setup") -> None:
    from higvf_console.cli.engine import load_engine

    load_engine(setup)


def _warm_up_session(session: "Session") -> None:
    from higvf_console.cli.engine import load_engine
    from higvf_console.scenario.sections import FilterKind

    load_engine(session.setup, coupled=session.scenario.filter is FilterKind.CENTRALISED)


def _replay(given: argparse.Namespace) -> int:
    from higvf_console.runtime.recording import read_recording, replay

    recording = read_recording(given.file)
    for warning in recording.warnings:
        _log(f"Warning: {warning}")
    result = replay(recording)
    if not result.complete:
        _log(f"{given.file}: the recording is truncated after {result.ticks} ticks")
    if result.agrees:
        print(f"The replay of {result.ticks} ticks matches the recording: digest {result.digest}")
        return 0
    if result.differs_after is None:
        print(f"The replay of {result.ticks} ticks cannot be compared: the recording has no digest")
        return 1
    print(f"The replay differs after tick {result.differs_after}: digest {result.digest}, recorded {result.expected}")
    if result.changed_versions:
        print(f"Versions that differ from the recording: {', '.join(result.changed_versions)}")
    return 1


def _run(given: argparse.Namespace) -> int:
    if given.report is not None and not given.headless:
        raise HigvfError("--report needs a headless run: add --headless")
    for module in () if given.headless else ("viser", "cv2", "mapbox_earcut"):
        require(module, "console", "the console")
    session = _open_session(given)
    try:
        for event in session.snapshot.events:  # nothing has run yet: the warnings of scenario and inputs
            _log(f"Warning: {event.text}")
        return _run_headless(session, given) if given.headless else _serve(session, given)
    finally:
        session.close()


def _open_session(given: argparse.Namespace) -> "Session":
    from higvf_console.channels.input_reports import calibrations_of
    from higvf_console.channels.marker_outlet import MarkerOutlet
    from higvf_console.control.forms import forms_named
    from higvf_console.runtime.recording import Recorder
    from higvf_console.runtime.session import FASTEST, SLOWEST, Session
    from higvf_console.scenario.scenario import load_scenario

    if not SLOWEST <= given.speed <= FASTEST:
        raise HigvfError(f"--speed {given.speed:g}: choose {SLOWEST:g} to {FASTEST:g}")
    scenario = load_scenario(given.scenario)
    if given.forms is not None:
        scenario = scenario.with_forms(forms_named(given.forms))
    interfaces = _open_interfaces(given, scenario)
    measured = calibrations_of(interfaces)
    recorder = Recorder(given.record, scenario, given.seed, measured) if given.record else None
    markers = MarkerOutlet(given.lsl_out, scenario.name, given.seed) if given.lsl_out is not None else None
    session = Session(scenario, interfaces, given.seed, recorder, markers)
    session.set_speed(given.speed)
    return session


def _open_interfaces(given: argparse.Namespace, scenario: "Scenario") -> list[Any]:
    """The inputs that were asked for; a console has one that takes what its pages give."""
    from higvf_console.channels.channels import open_interface
    from higvf_console.core.command import CONSOLE
    from higvf_console.core.interface import capabilities_of
    from higvf_console.runtime.inputs import input_spec

    interfaces = [open_interface(spec) for spec in _input_specs(given, scenario)]
    if not given.headless and not any(capabilities_of(interface).takes_pointer for interface in interfaces):
        interfaces.insert(0, open_interface(input_spec(CONSOLE, scenario)))
    return interfaces


def _input_specs(given: argparse.Namespace, scenario: "Scenario") -> list[Any]:
    from higvf_console.core.interface import InputSpec
    from higvf_console.runtime.inputs import demo_specs, input_spec, renamed_specs

    for warning in renamed_specs(given.input):
        _log(f"Warning: {warning}")
    specs = [input_spec(text, scenario) for text in given.input]
    if given.demo:
        specs += demo_specs(scenario)
    if given.script is not None:
        settings, robots = scenario.inputs.get("script", {}), len(scenario.robots.points)
        specs.append(InputSpec("script", given.script, {}, settings, scenario.arena, robots))
    return specs


def _run_headless(session: "Session", given: argparse.Namespace) -> int:
    from higvf_console.core.events import Severity
    from higvf_console.runtime.headless import run_headless

    _warm_up_session(session)
    report = json.dumps(run_headless(session, given.duration), indent=2) + "\n"
    session.close()  # closing may fail too, and reports that as an event
    for event in session.snapshot.events:
        if event.kind in _REPORTED and event.severity in (Severity.WARNING, Severity.ALARM):
            _log(f"{event.time:.2f} s: {event.text}")
    _write("--report", given.report or "-", report)
    return 0


def _write(option: str, file: str, text: str) -> None:
    """Writes the output of an option to a file; - is standard output."""
    if file == "-":
        sys.stdout.write(text)
        return
    try:
        Path(file).write_text(text, encoding="utf-8")
    except OSError as error:
        raise HigvfError(f"{option} {file}: {error.strerror}") from error


def _serve(session: "Session", given: argparse.Namespace) -> int:
    """Serves the console until Ctrl-C, a termination signal, or the end of the duration."""
    from higvf_console.ui.page.guard import login_url, new_token, open_server
    from higvf_console.ui.page.loading import loading

    token, stopping = given.token or new_token(), Signal()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with suppress(KeyboardInterrupt), ExitStack() as ends:  # callbacks run from last to first
        scheduling.go_first()
        ends.callback(scheduling.stand_back)
        server = open_server(given.host, given.port, token, session.scenario.title)
        ends.callback(server.stop)
        print(f"Console: {login_url(server, token)}\nPress Ctrl-C to end it.", flush=True)
        if not given.no_browser and _has_display():
            webbrowser.open(login_url(server, token))
        with loading(server, "Loading the engine ..."):
            from higvf_console.ui.console import Console

            scheduling.stand_back()
            _warm_up_session(session)
            scheduling.go_first()
            console = Console(session, server)
        console.start()
        ends.callback(console.close)
        loop = Thread(target=session.run, args=(stopping,), name="session")
        loop.start()
        ends.callback(loop.join)
        ends.callback(stopping.set)
        scheduling.stand_back()
        while given.duration is None or session.snapshot.time < given.duration:
            sleep(0.1)  # not stopping.wait: an interrupt could leave its lock acquired
    return 0


def _has_display() -> bool:
    if sys.platform in ("darwin", "win32"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


_COMMANDS = {
    "scenarios": _scenarios,
    "replay": _replay,
    "compile": _compile,
    "bench": _bench,
    "check_interface": _check_interface,
    "run": _run,
    "reproduce": _reproduce,
    "inspect": _inspect,
    "fit": _fit,
}
