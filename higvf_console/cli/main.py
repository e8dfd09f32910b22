"""The command `higvf`: runs scenarios, replays and inspects recordings, reproduces the paper, runs benchmarks.

Exit status: 0 on success; 1 if a replay differs, an interface or a team violates its contract, a guarantee is broken or
a long run does not stay flat; 2 on invalid input, with a one-line reason on standard error; 130 on Ctrl-C; 141 if the
reader of the output ended first, as in `higvf ... | head`.
"""
# ruff: noqa: PLC0415 (each command imports its own modules, so that `--help` does not load the compiler)

import argparse
import json
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from higvf_console.cli.arguments import parser
from higvf_console.cli.output import discard_output, log, write
from higvf_console.core.errors import HigvfError, MissingExtraError

if TYPE_CHECKING:
    pass


_SIGPIPE = 13  # of POSIX; the module `signal` lacks it on Windows
_REPORTED = ("refused", "clipped", "failure", "channel", "recording")  # kinds of events that a headless run prints


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one command.

    Args:
        arguments: of the command line; None = `sys.argv`.

    Returns:
        The exit status.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is loaded: its threads wait for each other
    try:
        return _run_command(arguments)
    except BrokenPipeError:  # whoever read the output has ended, as `head` does
        discard_output()
        return 128 + _SIGPIPE


def _run_command(arguments: Sequence[str] | None) -> int:
    try:
        given = parser().parse_args(arguments)
        return _COMMANDS[given.command](given)
    except HigvfError as error:
        log(f"higvf: {error}")
        return 2
    except KeyboardInterrupt:
        log("higvf: interrupted")
        return 130
    finally:
        sys.stdout.flush()  # at the exit of the interpreter, a closed pipe would be a traceback


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
    from higvf_console.runtime.inputs import inspected_spec
    from higvf_console.scenario.scenario import load_scenario

    spec = inspected_spec(given.file, load_scenario(given.scenario))
    description = inspect(spec, given.plot, given.steps)
    print(as_json(description) if given.json else as_text(description))
    return 0


def _bench(given: argparse.Namespace) -> int:
    from higvf_console.lab.bench import bench

    options = {
        bench.DEADLOCK: {
            "--scenes": given.scenes,
            "--scale": given.scale,
            "--scene": given.scene,
            "--save": given.save,
        },
        bench.SAFETY: {"--ticks": given.ticks, "--seed": given.seed, "--recording": given.recording},
        bench.ENDURANCE: {"--hours": given.hours, "--case": given.case},
        bench.TEAM: {"--kills": given.kills},
    }
    if given.suite != bench.TEAM:
        options[bench.ENDURANCE]["--minutes"] = given.minutes
    for suite, only in options.items():
        misplaced = [option for option, value in only.items() if value is not None]
        if misplaced and given.suite != suite:
            raise HigvfError(f"{misplaced[0]} is an option of --suite {suite}, not of --suite {given.suite}")
    if given.save is not None and given.scene is None:
        raise HigvfError("--save needs a scene: add --scene KIND:SEED")
    if given.scene is not None:
        return _scene(given.scene, given.save)
    if given.suite == bench.SAFETY:
        return _safety(given)
    if given.suite == bench.ENDURANCE:
        return _endurance(given)
    if given.suite == bench.TEAM:
        return _team(given)
    bench.main(given.suite, given.json, given.scenes, given.scale or 1.0)
    return 0


def _safety(given: argparse.Namespace) -> int:
    """Searches for broken guarantees, or checks one recording; status 1 where something is found."""
    from higvf_console.lab.safety import report
    from higvf_console.lab.safety.search import TICKS, check, search

    if given.recording is not None:
        if given.ticks is not None or given.seed is not None or given.json:
            raise HigvfError("--recording checks one recording as it is: give it alone")
        case, failure = check(given.recording)
        print(report.as_verdict(given.recording, case, failure))
        return 0 if failure is None else 1
    searched = search(given.ticks or TICKS, given.seed or 0)
    print(report.as_json(searched) if given.json else report.as_text(searched))
    return 1 if searched.found else 0


def _endurance(given: argparse.Namespace) -> int:
    """Runs for long; status 1 where something does not stay flat."""
    from higvf_console.lab.bench import endurance

    cases = endurance.run(
        given.minutes or endurance.MINUTES, given.hours or endurance.HOURS, given.case or endurance.CASES
    )
    print(json.dumps(endurance.plain(cases), indent=2) if given.json else endurance.table(cases))
    return 0 if endurance.flat(cases) else 1


def _team(given: argparse.Namespace) -> int:
    """Drives robots of another simulator; status 1 where a body touched another, or a robot did not stand in time."""
    from higvf_console.lab.team import suite

    figures = suite.measure(given.minutes or suite.MINUTES, given.kills or suite.KILLS)
    print(json.dumps(suite.plain(figures), indent=2) if given.json else suite.table(figures))
    return 0 if figures.kept else 1


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
    from higvf_console.cli.engine import load_engine
    from higvf_console.lab.reproduce.command import reproduce
    from higvf_console.scenario.scenario import load_scenario

    reproduce(given.cases, given.out, given.json, prepare=lambda: load_engine(load_scenario("firefighting").setup()))
    return 0


def _fit(given: argparse.Namespace) -> int:
    from higvf_console.cli.engine import load_engine
    from higvf_console.lab.fit.joint_study import joint_study
    from higvf_console.lab.fit.joint_text import joint_summary
    from higvf_console.lab.fit.study import BASE, study
    from higvf_console.lab.fit.text import summary
    from higvf_console.scenario.scenario import load_scenario

    load_engine(load_scenario(BASE).setup())
    fit, text = (study, summary) if given.columns == "1" else (joint_study, joint_summary)
    found = fit(given.runs, given.seed, keep=given.keep)
    if given.scenario is not None:
        write("--scenario", given.scenario, found.scenario)
    if given.json is not None:
        write("--json", given.json, json.dumps(found.result, indent=2) + "\n")
    if given.json != "-":
        print(text(found.result))
    return 0


def _compile(given: argparse.Namespace) -> int:
    from higvf_console.cli.engine import help_to_compile, load_engine
    from higvf_console.scenario.scenario import load_scenario

    if given.lower_filter:
        help_to_compile()
    else:
        seconds = load_engine(load_scenario("firefighting").setup(), given.centralised)
        print(f"The engine is compiled ({seconds:.1f} s).")
    return 0


def _check_interface(given: argparse.Namespace) -> int:
    from higvf_console.channels.interface_check import check_interface
    from higvf_console.core.interface import current_channel
    from higvf_console.runtime.inputs import input_spec, renamed_specs
    from higvf_console.scenario.scenario import load_scenario

    for warning in renamed_specs([given.input or given.name]):
        log(f"Warning: {warning}")
    spec = input_spec(given.input or given.name, load_scenario(given.scenario))
    if spec.channel != current_channel(given.name):
        raise HigvfError(f"--input {given.input}: the input is for the interface '{spec.channel}', not '{given.name}'")
    findings = check_interface(spec, given.seconds)
    for finding in findings:
        print(f"{'ok    ' if finding.kept else 'FAILED'} {finding.rule}: {finding.detail}")
    return 0 if all(finding.kept for finding in findings) else 1


def _replay(given: argparse.Namespace) -> int:
    from higvf_console.runtime.recording import read_recording, replay

    recording = read_recording(given.file)
    for warning in recording.warnings:
        log(f"Warning: {warning}")
    result = replay(recording)
    if not result.complete:
        log(f"{given.file}: the recording is truncated after {result.ticks} ticks")
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


def _teams(given: argparse.Namespace) -> int:
    from higvf_console.cli.teams import teams

    return teams(given)


def _check_team(given: argparse.Namespace) -> int:
    from higvf_console.cli.teams import check_team

    return check_team(given)


def _run(given: argparse.Namespace) -> int:
    from higvf_console.cli.run import run

    return run(given)


_COMMANDS = {
    "scenarios": _scenarios,
    "replay": _replay,
    "compile": _compile,
    "bench": _bench,
    "check_interface": _check_interface,
    "check_team": _check_team,
    "teams": _teams,
    "run": _run,
    "reproduce": _reproduce,
    "inspect": _inspect,
    "fit": _fit,
}
