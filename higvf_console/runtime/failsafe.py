"""What becomes of the team when the engine fails, or was killed: a latched STOP, and an alarm for the operator."""

from higvf_console.core.events import Event, Severity
from higvf_console.core.state import SimState


def halted(state: SimState) -> SimState:
    """The same state with all velocities zero and STOP latched."""
    motion = state.motion._replace(velocity=state.motion.velocity * 0.0)
    return state._replace(motion=motion, intent=state.intent._replace(stopped=True))


def failure_event(error: Exception, time: float) -> Event:
    """The alarm that reports it to the operator."""
    text = f"The engine failed; the team stands and the clock is frozen: {type(error).__name__}: {error}"
    return Event(time, Severity.ALARM, "failure", text)


def interruption_event(time: float) -> Event:
    """The alarm that a run is that of a console which was killed at session `time` [s]."""
    text = f"The console was killed at {time:.1f} s: its run is restored, and STOP is active until you reset it."
    return Event(time, Severity.ALARM, "failure", text)
