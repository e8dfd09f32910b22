"""The state of the run in words: what holds, in which colour, and one sentence on what it means for the team."""

from typing import TYPE_CHECKING, NamedTuple

from higvf_console.runtime.phase import Phase
from higvf_console.team.state import Arming

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot


class RunState(NamedTuple):
    """One state that holds.

    Attributes:
        word: in capitals, as it stands in the strip.
        colour: name of a colour of the palette.
        text: what it means for robots and fires, one sentence.
    """

    word: str
    colour: str
    text: str


STOPPED = RunState("STOPPED", "alarm", "Robots stand still, whatever is near; fires go on. The red button resets it.")
PAUSED = RunState("PAUSED", "warning", "Robots hold their place and still avoid hazards; fires go on.")
FROZEN = RunState("FROZEN", "robot", "The simulation clock stands still: robots and fires wait.")
READY = RunState("READY", "robot", "The run waits for its start: robots and fires wait.")
ENDED = RunState("ENDED", "robot", "The run has ended: robots and fires wait.")
DISARMED = RunState("DISARMED", "warning", "The team is not armed: no robot drives. Arm it in the tab Team.")
CHECKING = RunState("CHECKING", "warning", "Each robot moves a little, then hears nothing: it must stand by itself.")
CHECKED = RunState("CHECKED", "warning", "Silence stops every robot: arm the team in the tab Team to let it drive.")
RUNNING = RunState("RUNNING", "progress", "Robots move, fires burn.")


def run_states(snapshot: "Snapshot") -> tuple[RunState, ...]:
    """The states that hold together, the gravest first; never empty."""
    intent, team = snapshot.state.intent, snapshot.team
    arming = None if team is None else team.arming
    holds = (
        (STOPPED, intent.stopped),
        (DISARMED, arming is Arming.DISARMED),
        (CHECKING, arming is Arming.CHECKING),
        (CHECKED, arming is Arming.CHECKED),
        (PAUSED, intent.paused and not intent.stopped),  # a STOP also pauses
        (READY, snapshot.phase.phase is Phase.READY),
        (ENDED, snapshot.phase.phase is Phase.ENDED),
        (FROZEN, snapshot.frozen),
    )
    return tuple(state for state, held in holds if held) or (RUNNING,)
