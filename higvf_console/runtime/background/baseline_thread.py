"""The thread that runs every world without an operator, for comparison."""

from threading import Event as Signal
from typing import TYPE_CHECKING

from higvf_console.analysis.baseline import compute_baseline
from higvf_console.runtime.background.scheduling import stand_back
from higvf_console.scenario.sections import FilterKind

if TYPE_CHECKING:
    from higvf_console.runtime.session import Session
    from higvf_console.world.setup import Setup

_LOOK = 0.1  # [s] between two looks whether the world is another one


def keep_baseline(session: "Session", stopping: Signal) -> None:
    """Renews `session.baseline` whenever the world is edited or loaded, until `stopping` is set."""
    stand_back()
    known: Setup | None = None
    while not stopping.wait(_LOOK):
        setup, scenario = session.setup, session.scenario
        if setup is known:
            continue
        known, session.baseline = setup, None
        if scenario.filter is FilterKind.DISTRIBUTED:  # the centralised filter has no fast roll
            found = compute_baseline(setup, scenario.duration, stopping)
            session.baseline = found if session.setup is setup else None
