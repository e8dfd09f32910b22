"""The words of the command line: every command of `higvf` with its options."""

import argparse
import math
from collections.abc import Callable
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any, NoReturn, TypeVar

Number = TypeVar("Number", int, float)


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


def parser() -> argparse.ArgumentParser:
    """The parser of all commands; `command` holds the name of the one that was given."""
    whole = _Parser(prog="higvf", description="One person guides a team of robots from the browser.")
    whole.add_argument("--version", action="version", version=f"higvf {version('higvf-console')}")
    commands = whole.add_subparsers(required=True, metavar="COMMAND")
    _add_run(commands)
    scenarios = commands.add_parser("scenarios", help="list the shipped scenarios")
    scenarios.set_defaults(command="scenarios")
    replay = commands.add_parser("replay", help="run a recording again and compare the digests")
    replay.add_argument("file", type=Path, metavar="FILE", help="made by `higvf run --record FILE`")
    replay.set_defaults(command="replay")
    _add_reproduce(commands)
    _add_fit(commands)
    _add_bench(commands)
    _add_inspect(commands)
    compiling = commands.add_parser("compile", help="compile the engine now, so that the first run starts at once")
    compiling.set_defaults(command="compile")
    _add_check_interface(commands)
    return whole


def _add_bench(commands: Any) -> None:
    bench = commands.add_parser("bench", help="measure the engine")
    bench.add_argument(
        "--suite", choices=("filter", "tick", "deadlock", "preview", "lsl", "ui"), required=True,
        help="safety filter, whole tick, who arrives in random scenes, look ahead, live streams, or the console",
    )  # fmt: skip
    bench.add_argument("--json", action="store_true", help="write JSON")
    deadlock = bench.add_argument_group("suite deadlock")
    deadlock.add_argument("--scenes", type=_count, metavar="N", help="spaced scenes to run, the others in proportion")
    deadlock.add_argument("--scene", metavar="KIND:SEED", help="tell what happens in one scene, e.g. crowded:17")
    deadlock.add_argument("--save", type=Path, metavar="FILE", help="with --scene: write it as a scenario, and end")
    bench.set_defaults(command="bench")


def _add_check_interface(commands: Any) -> None:
    check = commands.add_parser("check-interface", help="hold an operator interface to its contract")
    check.set_defaults(command="check_interface")
    check.add_argument("name", metavar="NAME", help="of an installed interface, e.g. gaze")
    check.add_argument("--input", metavar="NAME=FILE[:OPTION=VALUE,...]", help="what it reads, as for `higvf run`")
    check.add_argument("--scenario", default="firefighting", metavar="SCENARIO", help="with its arena and settings")
    check.add_argument("--seconds", type=_positive, default=60.0, metavar="S", help="of session time (default 60)")


def _add_run(commands: Any) -> None:
    run = commands.add_parser("run", help="run a scenario in the browser, or headless")
    run.set_defaults(command="run")
    run.add_argument("scenario", nargs="?", default="firefighting", metavar="SCENARIO", help="a name or a .yaml file")
    run.add_argument("--duration", type=_positive, metavar="S", help="end after S seconds of session time")
    run.add_argument(
        "--seed", type=_seed, default=0, metavar="N", help="of start positions, errors and losses (default 0)"
    )
    run.add_argument(
        "--forms", metavar="FORM",
        help="of the paper's equations: corrected, zero-in or printed (default: what the scenario says)",
    )  # fmt: skip
    run.add_argument("--speed", type=_positive, default=1.0, metavar="F", help="times real time, 0.25 to 8 (default 1)")
    run.add_argument("--record", type=Path, metavar="FILE", help="write a recording (JSON lines)")
    run.add_argument("--lsl-out", metavar="NAME", help="tell events and commands as an LSL marker stream of that name")
    inputs = run.add_argument_group("inputs")
    inputs.add_argument(
        "--input", action="append", default=[], metavar="CHANNEL=FILE[:OPTION=VALUE,...]",
        help="an operator input, e.g. gaze=gaze.tsv:frame=screen; once for each channel",
    )  # fmt: skip
    inputs.add_argument("--script", metavar="FILE", help="a YAML list of operator actions")
    inputs.add_argument("--demo", action="store_true", help="the scenario's own recorded inputs")
    headless = run.add_argument_group("headless")
    headless.add_argument("--headless", action="store_true", help="no browser, as fast as it can, and a report")
    headless.add_argument("--report", metavar="FILE", help="where the JSON report goes (default -, standard output)")
    console = run.add_argument_group("console")
    console.add_argument("--host", default="127.0.0.1", help="address to serve at (default 127.0.0.1)")
    console.add_argument("--port", type=_port, default=8080, help="a port, or auto for a free one (default 8080)")
    console.add_argument("--token", metavar="T", help="secret of the login link (default: a new one)")
    console.add_argument("--no-browser", action="store_true", help="do not open a browser")


def _add_reproduce(commands: Any) -> None:
    reproduce = commands.add_parser("reproduce", help="run the paper's cases and report them beside the paper")
    reproduce.set_defaults(command="reproduce")
    reproduce.add_argument("cases", nargs="*", metavar="CASE", help="a case's name (default: all of them)")
    reproduce.add_argument(
        "--out", type=Path, metavar="DIR", help="folder of report.html, report.md, report.json (default reproduction)"
    )
    reproduce.add_argument("--json", metavar="FILE", help="another place for the JSON; - is standard output, no report")


def _add_inspect(commands: Any) -> None:
    inspect = commands.add_parser("inspect", help="say what a file is, and what it would become as operator input")
    inspect.set_defaults(command="inspect")
    inspect.add_argument(
        "file", metavar="FILE[:OPTION=VALUE,...]", help="a recording or a log, with the options that --input takes"
    )
    inspect.add_argument("--json", action="store_true", help="write JSON")
    inspect.add_argument("--plot", type=Path, metavar="FILE.png", help="write a small picture, e.g. a heat map of gaze")
    inspect.add_argument("--steps", action="store_true", help="tell each step from samples to a path")
    inspect.add_argument(
        "--scenario", default="firefighting", metavar="SCENARIO", help="whose arena is looked at (default firefighting)"
    )


def _add_fit(commands: Any) -> None:
    fit = commands.add_parser("fit", help="fit what the paper leaves open to Table II, column 1, and predict the rest")
    fit.set_defaults(command="fit")
    fit.add_argument("--runs", type=int, default=6000, metavar="N", help="worlds to try (default 6000)")
    fit.add_argument("--seed", type=_seed, default=0, metavar="S", help="of the search (default 0)")
    fit.add_argument("--json", metavar="FILE", help="write the result as JSON; - is standard output")
    fit.add_argument("--scenario", metavar="FILE", help="write the chosen world as a scenario file")


def _read(text: str, kind: Callable[[str], Number], meets: Callable[[Number], bool], meaning: str) -> Number:
    with suppress(ValueError):
        if meets(number := kind(text)):
            return number
    raise argparse.ArgumentTypeError(f"{text!r} is not {meaning}")


def _positive(text: str) -> float:
    return _read(text, float, lambda number: 0.0 < number < math.inf, "a number above 0")


def _seed(text: str) -> int:
    return _read(text, int, lambda number: number >= 0, "a whole number from 0")


def _count(text: str) -> int:
    return _read(text, int, lambda number: number >= 1, "a whole number from 1")


def _port(text: str) -> int:
    return 0 if text == "auto" else _read(text, int, lambda _: True, "a port from 1 to 65535, or auto for a free one")
