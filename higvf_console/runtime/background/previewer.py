"""The thread that looks ahead: a preview of what the operator is about to do, renewed while it may still change."""

import logging
import time
from collections.abc import Callable
from threading import Event as Signal
from threading import Thread
from typing import Any, NamedTuple

from higvf_console.analysis.preview import USUAL, Preview, foresee, wish
from higvf_console.core.arrays import floats
from higvf_console.core.commands import StrokeUse
from higvf_console.core.path_terms import USUAL_TERMS, PathTerms, stroke_end
from higvf_console.core.state import SimState
from higvf_console.runtime.background.scheduling import stand_back
from higvf_console.runtime.session import Session
from higvf_console.scenario.sections import FilterKind
from higvf_console.world.setup import Setup

RENEWED = 0.2  # [s] at most between two previews while the team moves, unless one takes longer
_LOOK = 0.02  # [s] between two looks at the session
_log = logging.getLogger(__name__)


class Choice(NamedTuple):
    """What the operator chose.

    Attributes:
        horizon: how far to look ahead [s].
        use: what a stroke is for that is drawn at the console.
        terms: on which the path is followed that it becomes.
        robot: index of the robot that the path is for; None = the one that is influenced.
    """

    horizon: float = USUAL
    use: StrokeUse = StrokeUse.PATH
    terms: PathTerms = USUAL_TERMS
    robot: int | None = None


class Previewer:
    """Renews a preview on a thread of its own; the session never waits for it.

    Attributes:
        latest: the newest preview; None while nothing is about to be done. Replaced as a whole, never written.
        count: previews made so far.
        failed: whether the preview is off because it failed; the reason is in the log.
    """

    def __init__(self, session: Session, choice: Callable[[], Choice] = Choice) -> None:
        """Starts with nothing foreseen; `choice` is asked for each preview."""
        self.latest: Preview | None = None
        self.count, self.failed = 0, False
        self._session, self._choice = session, choice
        self._known: tuple[Any, ...] = ()
        self._chosen: Choice | None = None
        self._tick = -1
        self._pause, self._started = 0.0, 0.0
        self._stopping = Signal()
        self._thread: Thread | None = None

    @property
    def available(self) -> bool:
        """The centralised filter has no fast roll, so nothing can be foreseen with it."""
        return self._session.scenario.filter is FilterKind.DISTRIBUTED

    def start(self) -> None:
        """Looks ahead until `close`."""
        if self.available:
            rehearse(self._session.setup)
        self._thread = Thread(target=self._run, name="preview", daemon=True)  # another scenario may have another filter
        self._thread.start()

    def close(self) -> None:
        """Ends the thread; may be called twice."""
        self._stopping.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None

    def _run(self) -> None:
        stand_back()
        while not self._stopping.wait(_LOOK):
            try:
                self.look()
            except Exception:
                _log.exception("the preview failed and is off")
                self.latest, self.failed = None, True
                return

    def look(self) -> None:
        """Makes a new preview if the wish has changed, or if the last one is old and the team has moved on."""
        if not self.available:
            self.latest = None
            return
        snapshot, choice = self._session.snapshot, self._choice()
        setup, state = snapshot.setup, snapshot.state
        matter = _matter(setup, state)
        changed = len(matter) != len(self._known) or any(a is not b for a, b in zip(matter, self._known, strict=True))
        changed = changed or choice != self._chosen
        old = state.motion.tick != self._tick and time.perf_counter() - self._started > self._pause
        if not (changed or old):
            return
        self._known, self._chosen, self._tick = matter, choice, state.motion.tick
        self._started = time.perf_counter()
        drawn_here = self._session.draws_previewed(state.pointer_state.stroke_source)
        wished = wish(state, setup, stroke_end(choice.terms, choice.use, choice.robot) if drawn_here else None)
        if wished is None:
            self.latest = None
            return
        found = foresee(state, wished, setup, choice.horizon, lambda: self._overtaken(state))
        self._pause = max(RENEWED, 2.0 * (time.perf_counter() - self._started))  # half a core at most
        if found is not None and not self._overtaken(state):
            self.latest, self.count = found, self.count + 1

    def _overtaken(self, state: SimState) -> bool:
        """Whether another wish has taken the place of this one; a stroke that has only grown has not."""
        before, now = state.pointer_state, self._session.snapshot.state.pointer_state
        return self._stopping.is_set() or (
            (before.stroke_source, before.proposed) != (now.stroke_source, now.proposed)
            or before.pending is not now.pending
        )


def rehearse(setup: Setup) -> None:
    """Makes one short preview, so that the first real one need not load what it calls while the team moves."""
    x_min, y_min, x_max, y_max = setup.arena
    pointer_state = setup.start.pointer_state._replace(
        stroke=floats([[x_min, y_min], [x_max, y_min], [x_max, y_max]]), stroke_source="rehearsal"
    )
    state = setup.start._replace(pointer_state=pointer_state)
    wished = wish(state, setup)
    if wished is not None:
        foresee(state, wished, setup, 0.0)


def _matter(setup: Setup, state: SimState) -> tuple[Any, ...]:
    """What a preview depends on besides the motion and the choice, compared by identity."""
    pointer_state, intent = state.pointer_state, state.intent
    return (setup, pointer_state.stroke, pointer_state.pending, pointer_state.stroke_source, pointer_state.proposed,
            intent.path, intent.influenced, intent.paused, intent.priority)  # fmt: skip
