"""`higvf`: run a scenario, replay a recording, inspect a file, reproduce the paper, measure.

Exit status: 0; 1 where a replay differs or an interface breaks its contract; 2 on input that cannot be used (one line
on stderr says why); 130 on Ctrl-C.
"""
# ruff: noqa: PLC0415 (each command imports what it needs, so that `--help` loads no compiler)

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
from time import perf_counter, sleep
from typing import TYPE_CHECKING, Any

from higvf_console.cli.arguments import parser
from higvf_console.core.errors import HigvfError
from higvf_console.runtime import scheduling

if TYPE_CHECKING:
    from higvf_console.runtime.session import Session
    from higvf_console.scenario.scenario import Scenario
    from higvf_console.sim.setup import Setup


_WORTH_SAYING = ("refused", "clipped", "failure", "channel", "recording")  # events of which a headless run warns


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one command and returns the exit status."""
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
        print(f"{name:26} {load_scenario(name).description}")
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
        raise HigvfError(f"{misplaced[0]} belongs to --suite {bench.DEADLOCK}, not {given.suite}")
    if given.save is not None and given.scene is None:
        raise HigvfError("--save writes one scene: add --scene KIND:SEED")
    if given.scene is not None:
        return _scene(given.scene, given.save)
    bench.main(given.suite, given.json, given.scenes)
    return 0


def _scene(name: str, file: Path | None) -> int:
    """Tells the story of a random scene, or saves it as a scenario."""
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


def _compile(_: argparse.Namespace) -> int:
    from higvf_console.scenario.scenario import load_scenario

    seconds = _warm_up(load_scenario("firefighting").setup())
    print(f"The engine is compiled ({seconds:.1f} s).")
    return 0


def _check_interface(given: argparse.Namespace) -> int:
    from higvf_console.channels.interface_check import check_interface
    from higvf_console.runtime.inputs import input_spec
    from higvf_console.scenario.scenario import load_scenario

    spec = input_spec(given.input or given.name, load_scenario(given.scenario))
    if spec.channel != given.name:
        raise HigvfError(f"--input {given.input}: is not for the interface '{given.name}'")
    findings = check_interface(spec, given.seconds)
    for finding in findings:
        print(f"{'ok    ' if finding.kept else 'BROKEN'} {finding.rule}: {finding.detail}")
    return 0 if all(finding.kept for finding in findings) else 1


def _warm_up(setup: "Setup") -> float:
    """Compiles the engine, or loads it; how long that took [s]."""
    from higvf_console.sim.warm_up import warm_up

    started = perf_counter()
    warm_up(setup.start, setup.world, setup.params)
    return perf_counter() - started


def _replay(given: argparse.Namespace) -> int:
    from higvf_console.runtime.recording import read_recording, replay

    result = replay(read_recording(given.file))
    if not result.complete:
        _log(f"{given.file}: the recording was cut off; its readable part has {result.ticks} ticks")
    if result.agrees:
        print(f"The run of {result.ticks} ticks agrees: {result.digest}")
        return 0
    if result.differs_after is None:
        print(f"The run of {result.ticks} ticks cannot be compared: the recording holds no digest")
        return 1
    print(f"The run differs after tick {result.differs_after}: {result.digest} is not {result.expected}")
    if result.changed_versions:
        print(f"Recorded with other versions: {', '.join(result.changed_versions)}")
    return 1


def _run(given: argparse.Namespace) -> int:
    if given.report is not None and not given.headless:
        raise HigvfError("--report is written by a headless run: add --headless")
    session = _open_session(given)
    try:
        for warning in session.scenario.warnings:
            _log(f"Warning: {warning}")
        return _run_headless(session, given) if given.headless else _serve(session, given)
    finally:
        session.close()


def _open_session(given: argparse.Namespace) -> "Session":
    from higvf_console.channels.channels import open_interface
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
    interfaces = [open_interface(spec) for spec in _input_specs(given, scenario)]
    measured = calibrations_of(interfaces)
    recorder = Recorder(given.record, scenario, given.seed, measured) if given.record else None
    _warm_up(scenario.setup(given.seed))
    markers = MarkerOutlet(given.lsl_out, scenario.name, given.seed) if given.lsl_out is not None else None
    session = Session(scenario, interfaces, given.seed, recorder, markers)
    session.set_speed(given.speed)
    return session


def _input_specs(given: argparse.Namespace, scenario: "Scenario") -> list[Any]:
    from higvf_console.core.interface import InputSpec
    from higvf_console.runtime.inputs import demo_specs, input_spec

    specs = [input_spec(text, scenario) for text in given.input]
    if given.demo:
        specs += demo_specs(scenario)
    if given.script is not None:
        settings, robots = scenario.inputs.get("script", {}), len(scenario.robots.points)
        specs.append(InputSpec("script", given.script, {}, settings, scenario.arena, robots))
    if not given.headless and all(spec.channel != "mouse" for spec in specs):
        specs.insert(0, input_spec("mouse", scenario))
    return specs


def _run_headless(session: "Session", given: argparse.Namespace) -> int:
    from higvf_console.runtime.headless import run_headless
    from higvf_console.sim.setup import Severity

    report = json.dumps(run_headless(session, given.duration), indent=2) + "\n"
    session.close()  # now: that may fail as well, of which the events tell
    for event in session.snapshot.events:
        if event.kind in _WORTH_SAYING and event.severity in (Severity.WARNING, Severity.ALARM):
            _log(f"{event.time:.2f} s: {event.text}")
    _write("--report", given.report or "-", report)
    return 0


def _write(option: str, file: str, text: str) -> None:
    """Writes what an option asks for; - is standard output."""
    if file == "-":
        sys.stdout.write(text)
        return
    try:
        Path(file).write_text(text, encoding="utf-8")
    except OSError as error:
        raise HigvfError(f"{option} {file}: {error.strerror}") from error


def _serve(session: "Session", given: argparse.Namespace) -> int:
    """Serves the console until Ctrl-C, a termination signal, or the end of the duration."""
    from higvf_console.ui.console import Console
    from higvf_console.ui.page.guard import login_url, new_token, open_server

    token, stopping = given.token or new_token(), Signal()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with suppress(KeyboardInterrupt), ExitStack() as ends:  # the stack is undone from last to first
        scheduling.go_first()
        ends.callback(scheduling.stand_back)
        server = open_server(given.host, given.port, token, session.scenario.title)
        ends.callback(server.stop)
        console = Console(session, server)
        console.start()
        ends.callback(console.close)
        loop = Thread(target=session.run, args=(stopping,), name="session")
        loop.start()
        ends.callback(loop.join)
        ends.callback(stopping.set)
        scheduling.stand_back()
        print(f"Console: {login_url(server, token)}\nCtrl-C ends it.", flush=True)
        if not given.no_browser and _has_display():
            webbrowser.open(login_url(server, token))
        while given.duration is None or session.snapshot.time < given.duration:
            sleep(0.1)  # not stopping.wait: an interrupt there could leave its lock taken
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
