"""The argument parser of `higvf`: all commands and their options."""

import argparse
import math
from collections.abc import Callable
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any, NoReturn, TypeVar

Number = TypeVar("Number", int, float)


class _Parser(argparse.ArgumentParser):
    """An argument parser that reports an error in one line and exits with status 2."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


def parser() -> argparse.ArgumentParser:
    """The parser of all commands; `command` of its result is the name of the given command."""
    whole = _Parser(prog="higvf", description="One person guides a team of robots from the browser.")
    whole.add_argument("--version", action="version", version=f"higvf {version('higvf-console')}")
    commands = whole.add_subparsers(required=True, metavar="COMMAND")
    _add_run(commands)
    scenarios = commands.add_parser("scenarios", help="list the shipped scenarios")
    scenarios.set_defaults(command="scenarios")
    replay = commands.add_parser("replay", help="replay a recording and compare the digests")
    replay.add_argument("file", type=Path, metavar="FILE", help="recording written by `higvf run --record FILE`")
    replay.set_defaults(command="replay")
    _add_reproduce(commands)
    _add_fit(commands)
    _add_bench(commands)
    _add_inspect(commands)
    compiling = commands.add_parser("compile", help="compile the engine now, so that the first run starts at once")
    compiling.add_argument("--centralised", action="store_true", help="also the centralised safety filter")
    compiling.add_argument("--lower-filter", action="store_true", help=argparse.SUPPRESS)
    compiling.set_defaults(command="compile")
    _add_check_interface(commands)
    _add_teams(commands)
    return whole


def _add_bench(commands: Any) -> None:
    bench = commands.add_parser("bench", help="run a benchmark")
    bench.add_argument(
        "--suite", required=True,
        choices=("filter", "tick", "deadlock", "safety", "preview", "lsl", "ui", "endurance", "team"),
        help="what to measure: safety filter, whole tick, deadlocks in random scenes, broken guarantees in random runs,"
        " previews, live streams, console, memory and handles over time, robots of another simulator and their link",
    )  # fmt: skip
    bench.add_argument("--json", action="store_true", help="write JSON instead of a table")
    deadlock = bench.add_argument_group("suite deadlock")
    deadlock.add_argument(
        "--scenes", type=_count, metavar="N", help="number of spaced scenes; other kinds in proportion (default 1000)"
    )
    deadlock.add_argument(
        "--scale", type=_positive, metavar="F", help="size of arenas, robots and speeds: 0.00333 of the usual one, ..."
    )
    deadlock.add_argument("--scene", metavar="KIND:SEED", help="run one scene and report its events, e.g. crowded:17")
    deadlock.add_argument(
        "--save", type=Path, metavar="FILE", help="with --scene: save the scene as a scenario file and exit"
    )
    safety = bench.add_argument_group("suite safety")
    safety.add_argument(
        "--ticks", type=_count, metavar="N", help="control periods in random worlds, all together (default 1000000)"
    )
    safety.add_argument("--seed", type=_seed, metavar="N", help="random seed of the search (default 0)")
    safety.add_argument(
        "--recording", type=Path, metavar="FILE", help="no search: repeat one recording and check every control period"
    )
    endurance = bench.add_argument_group("suite endurance")
    endurance.add_argument(
        "--minutes", type=_positive, metavar="M",
        help="time that each live console is watched [min] (default 2); of suite team: to simulate (default 30)",
    )  # fmt: skip
    endurance.add_argument("--hours", type=_positive, metavar="H", help="time to simulate headless [h] (default 1)")
    endurance.add_argument(
        "--case", action="append", metavar="CASE",
        help="robots (1000, live), observers (50, live) or headless; repeat for further ones (default: all)",
    )  # fmt: skip
    team = bench.add_argument_group("suite team")
    team.add_argument("--kills", type=_count, metavar="N", help="how often each part is killed (default 10)")
    bench.set_defaults(command="bench")


def _add_check_interface(commands: Any) -> None:
    check = commands.add_parser("check-interface", help="test an operator interface against its contract")
    check.set_defaults(command="check_interface")
    check.add_argument("name", metavar="NAME", help="name of an installed interface, e.g. gaze")
    check.add_argument(
        "--input", metavar="NAME=FILE[:OPTION=VALUE,...]", help="input of the interface, as for `higvf run`"
    )
    check.add_argument(
        "--scenario",
        default="firefighting",
        metavar="SCENARIO",
        help="scenario that gives arena and settings (default firefighting)",
    )
    check.add_argument(
        "--seconds", type=_positive, default=60.0, metavar="S", help="session time to run it [s] (default 60)"
    )


def _add_teams(commands: Any) -> None:
    named = "NAME[=ADDRESS][:OPTION=VALUE,...]"
    teams = commands.add_parser("teams", help="list the installed teams of robots, or the robots that a network shows")
    teams.set_defaults(command="teams")
    teams.add_argument("network", nargs="?", metavar=named, help="list the robots heard there for 2 s")
    check = commands.add_parser("check-team", help="test a team of robots against its contract")
    check.set_defaults(command="check_team")
    check.add_argument("team", metavar=named, help="the team, as for `higvf run --team`")
    check.add_argument("--poses", metavar=named, help="what tells where they are, if the team does not")
    check.add_argument(
        "--drive", action="store_true", help="the robots may move: each turns on the spot, or moves a little along x"
    )
    for command in (teams, check):
        command.add_argument("--json", action="store_true", help="write JSON instead of text")
        command.add_argument(
            "--scenario", default="epucks", metavar="SCENARIO",
            help="scenario that gives arena and robots (default epucks)",
        )  # fmt: skip


def _add_run(commands: Any) -> None:
    run = commands.add_parser("run", help="run a scenario in the browser or headless")
    run.set_defaults(command="run")
    run.add_argument(
        "scenario",
        nargs="?",
        default="firefighting",
        metavar="SCENARIO",
        help="name or .yaml file of a scenario (default firefighting)",
    )
    run.add_argument(
        "--duration", type=_positive, metavar="S", help="end after S seconds of session time, or with the run if sooner"
    )
    run.add_argument(
        "--seed",
        type=_seed,
        metavar="N",
        help="random seed of start positions, measurement noise and packet loss (default 0)",
    )
    run.add_argument(
        "--forms", metavar="FORM",
        help="form of the paper's equations: corrected, zero-in or printed (default: as in the scenario)",
    )  # fmt: skip
    run.add_argument(
        "--speed", type=_positive, default=1.0, metavar="F", help="speed relative to real time, 0.25 to 8 (default 1)"
    )
    run.add_argument("--record", type=Path, metavar="FILE", help="write a recording (JSON Lines) to a new file")
    run.add_argument("--lsl-out", metavar="NAME", help="send events and commands as an LSL marker stream named NAME")
    inputs = run.add_argument_group("inputs")
    inputs.add_argument(
        "--input", action="append", default=[], metavar="CHANNEL=FILE[:OPTION=VALUE,...]",
        help="operator input, e.g. gaze=gaze.tsv:frame=screen; repeat for further channels",
    )  # fmt: skip
    inputs.add_argument("--script", metavar="FILE", help="YAML list of operator actions")
    inputs.add_argument("--demo", action="store_true", help="use the recorded inputs of the scenario")
    team = run.add_argument_group("team of robots")
    team.add_argument(
        "--team", metavar="NAME[=ADDRESS][:OPTION=VALUE,...]",
        help="drive these robots, e.g. simulated or mqtt=mqtt://127.0.0.1; see `higvf teams`",
    )  # fmt: skip
    team.add_argument(
        "--poses", metavar="NAME[=ADDRESS][:OPTION=VALUE,...]",
        help="what tells where they are, if the team does not, e.g. a camera",
    )  # fmt: skip
    headless = run.add_argument_group("headless")
    headless.add_argument(
        "--headless", action="store_true", help="run without a browser as fast as possible and write a report"
    )
    headless.add_argument("--report", metavar="FILE", help="file of the JSON report (default -, standard output)")
    console = run.add_argument_group("console")
    console.add_argument("--host", default="127.0.0.1", help="address of the server (default 127.0.0.1)")
    console.add_argument("--port", type=_port, default=8080, help="port, or auto for a free port (default 8080)")
    console.add_argument(
        "--token-file", type=Path, metavar="FILE",
        help="tokens of the login links, one line per role, 'ROLE TOKEN'; written with new ones if it does not exist",
    )  # fmt: skip
    console.add_argument(
        "--pages", type=_count, default=16, metavar="N", help="pages that may be open at once (default 16)"
    )
    console.add_argument("--token", metavar="T", help="deprecated: others can see it; use --token-file")
    console.add_argument(
        "--origin", action="append", default=[], metavar="ORIGIN",
        help="further address of the console, e.g. https://lab.example of a proxy; repeat for further ones",
    )  # fmt: skip
    console.add_argument("--certfile", type=Path, metavar="FILE", help="certificate (PEM), for https; needs --keyfile")
    console.add_argument("--keyfile", type=Path, metavar="FILE", help="private key (PEM) of the certificate")
    console.add_argument(
        "--start-at-once", action="store_true", help="start the clock at once (default: Start in the page starts it)"
    )
    console.add_argument("--no-browser", action="store_true", help="do not open a browser")


def _add_reproduce(commands: Any) -> None:
    reproduce = commands.add_parser(
        "reproduce", help="run the cases of the paper and compare the results with the paper"
    )
    reproduce.set_defaults(command="reproduce")
    reproduce.add_argument("cases", nargs="*", metavar="CASE", help="name of a case (default: all)")
    reproduce.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="folder for report.html, report.md and report.json (default reproduction)",
    )
    reproduce.add_argument(
        "--json", metavar="FILE", help="additional file for the JSON; - writes it to standard output and no report"
    )


def _add_inspect(commands: Any) -> None:
    inspect = commands.add_parser("inspect", help="describe a recording and the operator input that it gives")
    inspect.set_defaults(command="inspect")
    inspect.add_argument(
        "file",
        metavar="[CHANNEL=]FILE[:OPTION=VALUE,...]",
        help="recording or log, with the options of --input; with CHANNEL also with its settings in the scenario",
    )
    inspect.add_argument("--json", action="store_true", help="write JSON instead of text")
    inspect.add_argument("--plot", type=Path, metavar="FILE.png", help="write a plot, e.g. a heat map of gaze")
    inspect.add_argument("--steps", action="store_true", help="report each step from samples to a path")
    inspect.add_argument(
        "--scenario",
        default="firefighting",
        metavar="SCENARIO",
        help="scenario that gives the arena and the settings of CHANNEL (default firefighting)",
    )


def _add_fit(commands: Any) -> None:
    fit = commands.add_parser(
        "fit",
        help="fit the parameters that the paper does not give to column 1 of Table II, or to all of its columns",
    )
    fit.set_defaults(command="fit")
    fit.add_argument(
        "--columns",
        choices=("1", "all"),
        default="1",
        help="1: fit column 1 and predict columns 2 and 3 (default); all: fit one world to every number",
    )
    fit.add_argument("--runs", type=int, default=6000, metavar="N", help="number of samples to try (default 6000)")
    fit.add_argument("--seed", type=_seed, default=0, metavar="S", help="random seed of the search (default 0)")
    fit.add_argument(
        "--keep", type=Path, metavar="FILE", help="keep the trials in FILE, and go on from those that it holds"
    )
    fit.add_argument("--json", metavar="FILE", help="write the result as JSON; - writes to standard output")
    fit.add_argument("--scenario", metavar="FILE", help="write the chosen world as a scenario file")


def _read(text: str, kind: Callable[[str], Number], meets: Callable[[Number], bool], meaning: str) -> Number:
    with suppress(ValueError):
        if meets(number := kind(text)):
            return number
    raise argparse.ArgumentTypeError(f"{text!r} is not {meaning}")


def _positive(text: str) -> float:
    return _read(text, float, lambda number: 0.0 < number < math.inf, "a number greater than 0")


def _seed(text: str) -> int:
    return _read(text, int, lambda number: number >= 0, "a whole number from 0 up")


def _count(text: str) -> int:
    return _read(text, int, lambda number: number >= 1, "a whole number from 1 up")


def _port(text: str) -> int:
    return 0 if text == "auto" else _read(text, int, lambda _: True, "a port from 1 to 65535, or auto for a free port")
