"""A whole console for browser tests: session, server and view, live on threads of their own."""

import threading
import time
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import viser

from higvf_console.channels.channels import open_interface
from higvf_console.core.commands import (
    AskReset,
    Discard,
    Freeze,
    OperatorCommand,
    Pick,
    ResetEmergencyStop,
    ResetRun,
    Resume,
    SetSpeed,
)
from higvf_console.core.interface import InputSpec, Interface
from higvf_console.core.state import SimState
from higvf_console.runtime.background.worker import Worker
from higvf_console.runtime.persistence.drafts import Drafts
from higvf_console.runtime.session import Session
from higvf_console.runtime.teams import open_driver
from higvf_console.scenario.scenario import load_scenario
from higvf_console.sim.warm_up import warm_up
from higvf_console.ui.console import Console
from higvf_console.ui.page import guard
from higvf_console.ui.page.access import Role, access_by
from tests.teams import stroke


class Running(NamedTuple):
    """A console at work."""

    session: Session
    server: viser.ViserServer
    console: Console
    url: str

    @property
    def state(self) -> SimState:
        return self.session.snapshot.state

    def push(self, *commands: OperatorCommand) -> None:
        for command in commands:
            self.session.pointer.push(command)

    def start_again(self) -> None:
        """A frozen run at its start, that was not stopped, with robot 1 chosen and nothing that waits."""
        reset = (AskReset(), ResetEmergencyStop()) if self.state.intent.stopped else ()
        self.push(Freeze(True), *reset, SetSpeed(1.0), Discard(), Resume(), ResetRun(), Pick(0))

    def shipped_stroke(self) -> list[OperatorCommand]:
        """The commands of the first stroke that the scenario shows."""
        shown = self.session.scenario.strokes[0]
        return stroke(shown.points, shown.robot)

    def given(self, kind: type[OperatorCommand]) -> list[OperatorCommand]:
        return [applied.command for applied in tuple(self.session.commands) if isinstance(applied.command, kind)]


@contextmanager
def console_at_work(
    scenario: str,
    *interfaces: Interface,
    attended: bool = False,
    folder: Path | None = None,
    worker: Worker | None = None,
    team: str | None = None,
) -> Generator[Running]:
    """A scenario, live, with the console's channel and what else there is.

    Args:
        scenario: name of a shipped one, or a file.
        interfaces: besides the console's channel.
        attended: whether the clock waits for its start and stands at the end; else it runs at once and never stands.
        folder: where drafts and files opened lately are kept; None = nowhere.
        worker: reads what is loaded during the run; None = the session itself does.
        team: robots that drive, as `--team` has it; None = they are integrated.
    """
    console_channel = open_interface(InputSpec("console"))
    loaded = load_scenario(scenario)
    driver = None if team is None else open_driver(team, None, loaded, loaded.setup(), time.monotonic)
    channels = [console_channel, *interfaces]
    session = Session(loaded, channels, attended=attended, waits=attended, worker=worker, team=driver)
    warm_up(session.setup.start, session.setup.world, session.setup.params)
    access = access_by(None)
    server = guard.open_server("127.0.0.1", 0, access, "Console")
    console = Console(session, server, Drafts(session, folder) if folder is not None else None)
    stopping = threading.Event()
    loop = threading.Thread(target=session.run, args=(stopping,), daemon=True)
    loop.start()
    console.start()
    yield Running(session, server, console, guard.login_url(server, access.token(Role.EXPERIMENTER)))
    stopping.set()
    loop.join()
    console.close()
    session.close()
    server.stop()
