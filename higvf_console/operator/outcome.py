"""The outcome of an operator command: the next state and the events that report it."""

import math
from typing import TypeAlias

from higvf_console.core.events import Event, Severity
from higvf_console.core.state import NO_PATH, NOBODY, PointerState, SimState

Outcome: TypeAlias = tuple[SimState, tuple[Event, ...]]


def report(time: float, kind: str, text: str, robot: int | None = None) -> tuple[Event, ...]:
    """One event of severity INFO.

    Args:
        time: session time [s].
        kind: machine-readable kind of the event.
        text: sentence for the operator.
        robot: index of the robot that it is about; None = of none.
    """
    return (Event(time, Severity.INFO, kind, text, robot=robot),)


def refuse(time: float, text: str) -> tuple[Event, ...]:
    """One event of severity WARNING: the reason for which a command was refused."""
    return (Event(time, Severity.WARNING, "refused", text),)


def no_robot(robot: int, robots: int, time: float) -> tuple[Event, ...]:
    """Refuses a robot index outside 0 to `robots` - 1; the message counts from 1."""
    return refuse(time, f"There is no robot {robot + 1}: the team has robots 1 to {robots}.")


def with_pointer_state(state: SimState, **changes: object) -> SimState:
    """The state with some fields of its pointer state replaced."""
    pointer_state: PointerState = state.pointer_state._replace(**changes)  # pyright: ignore[reportArgumentType]
    return state._replace(pointer_state=pointer_state)


def path_dropped(state: SimState) -> SimState:
    """The state without a pending path."""
    return with_pointer_state(state, pending=NO_PATH, pending_robot=NOBODY, pending_repairs=False)


def proposal_dropped(state: SimState) -> SimState:
    """The state without a proposed robot."""
    return with_pointer_state(state, proposed=NOBODY, proposed_until=math.inf)
