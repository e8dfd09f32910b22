"""`higvf run`: a scenario with its operator's channels, headless or behind the console in a browser."""
# ruff: noqa: PLC0415 (a headless run loads no browser, and the link is printed before the engine is loaded)

import argparse
import json
import os
import signal
import sys
import webbrowser
from collections.abc import Callable
from contextlib import ExitStack, suppress
from functools import partial
from threading import Event as Signal
from threading import Thread
from time import monotonic, sleep
from typing import TYPE_CHECKING, Any

from higvf_console.cli.output import log, write
from higvf_console.core.errors import HigvfError
from higvf_console.core.optional import require
from higvf_console.runtime.background import scheduling

if TYPE_CHECKING:
    from pathlib import Path

    from higvf_console.runtime.persistence.checkpoints import Checkpoint
    from higvf_console.runtime.recording import Recorder
    from higvf_console.runtime.session import Session
    from higvf_console.runtime.snapshot import Snapshot
    from higvf_console.scenario.scenario import Scenario
    from higvf_console.team.driver import TeamDriver
    from higvf_console.ui.page.access import Access
    from higvf_console.world.setup import Setup

_REPORTED = ("refused", "clipped", "failure", "channel", "recording")  # kinds of events that a headless run prints


def run(given: argparse.Namespace) -> int:
    """Runs a scenario to its end, or until Ctrl-C; returns the exit status."""
    from higvf_console.control.forms import forms_named
    from higvf_console.runtime.clock import FASTEST, SLOWEST
    from higvf_console.scenario.scenario import load_scenario

    if given.headless and given.start_at_once:
        raise HigvfError("--start-at-once is for the console; a headless run always starts at once")
    if given.report is not None and not given.headless:
        raise HigvfError("--report needs a headless run: add --headless")
    for module in () if given.headless else ("viser", "cv2", "mapbox_earcut"):
        require(module, "console", "the console")
    if not SLOWEST <= given.speed <= FASTEST:
        raise HigvfError(f"--speed {given.speed:g}: choose {SLOWEST:g} to {FASTEST:g}")
    scenario = load_scenario(given.scenario)
    if given.seed is not None and not scenario.random:
        log(
            f"Warning: --seed {given.seed} changes nothing: scenario '{scenario.name}' has neither jitter_m, "
            "measurement noise nor packet loss"
        )
    given.seed = given.seed or 0
    if given.forms is not None:
        scenario = scenario.with_forms(forms_named(given.forms))
    setup = scenario.setup(given.seed)  # before the link, since the start may not be safe with this seed
    interfaces = _open_interfaces(given, scenario)
    with ExitStack() as closing:  # what is open already is closed too when loading the engine is interrupted
        for interface in interfaces:
            closing.callback(interface.close)
        team = _open_team(given, scenario, setup)
        if team is not None:
            closing.callback(team.close)
        recorder = _open_recorder(given, scenario, interfaces, team)
        if recorder is not None:
            closing.callback(recorder.close)
        start = partial(_start_session, given, scenario, setup, interfaces, team, recorder, closing)
        return _run_headless(start, given) if given.headless else _serve(start, scenario.title, given)


def _open_team(given: argparse.Namespace, scenario: "Scenario", setup: "Setup") -> "TeamDriver | None":
    if given.team is None:
        if given.poses is not None:
            raise HigvfError(f"--poses {given.poses} tells where the robots of a team are: give --team too")
        return None
    if given.speed != 1.0:
        raise HigvfError(f"--speed {given.speed:g}: the robots of a team drive in real time; leave --speed out")
    from higvf_console.runtime.teams import open_driver

    return open_driver(given.team, given.poses, scenario, setup, None if given.headless else monotonic)


def _open_recorder(
    given: argparse.Namespace, scenario: "Scenario", interfaces: list[Any], team: "TeamDriver | None"
) -> "Recorder | None":
    from higvf_console.channels.input_reports import calibrations_of
    from higvf_console.runtime.recording import Recorder

    measured = calibrations_of(interfaces)
    rules = None if team is None else team.rules
    return Recorder(given.record, scenario, given.seed, measured, rules) if given.record else None


def _start_session(
    given: argparse.Namespace,
    scenario: "Scenario",
    setup: "Setup",
    interfaces: list[Any],
    team: "TeamDriver | None",
    recorder: "Recorder | None",
    closing: ExitStack,
) -> "Session":
    """Loads the engine and opens the session, which is closed with `closing`."""
    from higvf_console.channels.marker_outlet import MarkerOutlet
    from higvf_console.cli.engine import load_engine
    from higvf_console.runtime.background.worker import Worker
    from higvf_console.runtime.session import Session
    from higvf_console.scenario.sections import FilterKind

    load_engine(setup, coupled=scenario.filter is FilterKind.CENTRALISED)
    markers = MarkerOutlet(given.lsl_out, scenario.name, given.seed) if given.lsl_out is not None else None
    waits = not (given.headless or given.start_at_once)
    attended = not given.headless
    worker = None if given.headless else Worker()
    if worker is not None:
        closing.callback(worker.close)
    session = Session(
        scenario,
        interfaces,
        given.seed,
        recorder,
        markers,
        attended=attended,
        waits=waits,
        worker=worker,
        interrupted=_interrupted(given, scenario) if attended else None,
        team=team,
    )
    closing.callback(session.close)
    session.set_speed(given.speed)
    for event in session.snapshot.events:  # nothing has run yet: the warnings of scenario and inputs
        log(f"Warning: {event.text}")
    return session


def _interrupted(given: argparse.Namespace, scenario: "Scenario") -> "Checkpoint | None":
    """The run of this scenario whose console was killed, if there is one that can be restored."""
    from higvf_console.runtime.persistence.checkpoints import left_checkpoints, remove, restored
    from higvf_console.scenario.kept import state_folder

    for file in left_checkpoints(state_folder()):
        try:
            found = restored(file)
        except HigvfError as error:
            log(f"Warning: a run that was interrupted cannot be restored: {error}")
            remove(file)
            continue
        of = found.run_state.scenario
        if of is None or of.text != scenario.text:
            continue
        remove(file)
        if given.record is not None:
            log("Warning: a run of this scenario was interrupted; it is not restored, for a recording starts anew")
            return None
        if given.team is not None and len(of.robots.points) != len(found.run_state.state.motion.position):
            log("Warning: an interrupted run of this scenario is not restored: the team has another number of robots")
            return None
        return found
    return None


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
        log(f"Warning: {warning}")
    specs = [input_spec(text, scenario) for text in given.input]
    if given.demo:
        specs += demo_specs(scenario)
    if given.script is not None:
        settings, robots = scenario.inputs.get("script", {}), len(scenario.robots.points)
        specs.append(InputSpec("script", given.script, {}, settings, scenario.arena, robots))
    return specs


def _run_headless(start: "Callable[[], Session]", given: argparse.Namespace) -> int:
    from higvf_console.core.events import Severity
    from higvf_console.runtime.headless import run_headless

    session = start()
    report = json.dumps(run_headless(session, given.duration), indent=2) + "\n"
    session.close()  # closing may fail too, and reports that as an event
    for event in session.snapshot.events:
        if event.kind in _REPORTED and event.severity in (Severity.WARNING, Severity.ALARM):
            log(f"{event.time:.2f} s: {event.text}")
    write("--report", given.report or "-", report)
    return 0


def _serve(start: "Callable[[], Session]", title: str, given: argparse.Namespace) -> int:
    """Serves the console until Ctrl-C, a termination signal, or the end of the duration; the link comes first."""
    from higvf_console.ui.page.control_lease import MOST_PAGES
    from higvf_console.ui.page.guard import login_url, open_server
    from higvf_console.ui.page.loading import loading

    if given.pages > MOST_PAGES:
        raise HigvfError(f"--pages {given.pages}: choose 1 to {MOST_PAGES}")
    access, certificate, stopping = _access(given), _certificate(given), Signal()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with suppress(KeyboardInterrupt), ExitStack() as ends:  # callbacks run from last to first
        scheduling.go_first()
        ends.callback(scheduling.stand_back)
        server = open_server(
            given.host,
            given.port,
            access,
            title,
            max_clients=given.pages,
            origins=tuple(given.origin),
            certificate=certificate,
        )
        ends.callback(server.stop)
        print(f"Console: {login_url(server, access.token(access.highest))}")
        for role in access.roles if given.token_file is not None else ():
            print(f"Link of an {role}: {login_url(server, access.token(role))}")
        print("Press Ctrl-C to end it.", flush=True)
        if not given.no_browser and _has_display():
            # Others can see with what a browser is started: this link opens once.
            webbrowser.open(login_url(server, access.ticket(access.highest)))
        with loading(server, "Loading the engine ..."):
            from higvf_console.runtime.persistence.checkpoints import Checkpoints
            from higvf_console.runtime.persistence.drafts import Drafts
            from higvf_console.scenario.kept import state_folder
            from higvf_console.ui.console import Console

            scheduling.stand_back()
            session = start()
            scheduling.go_first()
            drafts = Drafts(session, state_folder())
            checkpoints = Checkpoints(session, state_folder())
            console = Console(session, server, drafts)
        scheduling.keep_loaded()
        ends.callback(console.close)
        threads = [
            Thread(target=target, args=(stopping,), name=name)
            for name, target in (("session", session.run), ("drafts", drafts.run), ("checkpoints", checkpoints.run))
        ]
        ends.callback(_join, threads, stopping)  # before the first starts: a signal may come between two of them
        console.start()
        for thread in threads:
            thread.start()
        scheduling.stand_back()
        if given.duration is not None and not given.start_at_once:
            log(f"The {given.duration:g} s of --duration begin with Start in the page; --start-at-once needs no page.")
        while given.duration is None or not _over(session.snapshot, given.duration):
            sleep(0.1)  # not stopping.wait: an interrupt could leave its lock acquired
    return 0


def _join(threads: list[Thread], stopping: Signal) -> None:
    """Ends the threads that have been started."""
    stopping.set()
    for thread in threads:
        if thread.is_alive():
            thread.join()


def _access(given: argparse.Namespace) -> "Access":
    """The tokens that were given, else new ones."""
    from higvf_console.ui.page.access import Access, Role, access_by

    if given.token is None:
        return access_by(given.token_file)
    if given.token_file is not None:
        raise HigvfError("--token and --token-file exclude each other; --token is deprecated")
    log("Warning: --token is deprecated: everybody on this machine can see it; use --token-file FILE")
    return Access({Role.EXPERIMENTER: given.token})


def _certificate(given: argparse.Namespace) -> "tuple[Path, Path] | None":
    if (given.certfile is None) is not (given.keyfile is None):
        raise HigvfError("--certfile and --keyfile need each other")
    return None if given.certfile is None else (given.certfile, given.keyfile)


def _over(snapshot: "Snapshot", duration: float) -> bool:
    """Whether a run has ended, or its time [s] has."""
    return snapshot.phase.phase == "ended" or snapshot.time >= duration


def _has_display() -> bool:
    if sys.platform in ("darwin", "win32"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
