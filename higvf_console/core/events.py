"""What happened in a run and a person should read."""

from enum import StrEnum
from typing import NamedTuple


class Severity(StrEnum):
    """How much an event wants the operator's attention."""

    INFO = "info"
    GOOD = "good"
    WARNING = "warning"
    ALARM = "alarm"


class Event(NamedTuple):
    """Something that happened and that a person should read.

    Attributes:
        time: session time [s].
        severity: how loud.
        kind: machine-readable word, e.g. "extinguished", "target", "path", "infeasible", "refused".
        text: one sentence, which nobody needs to parse: whom it is about is told by the fields below.
        robot: index from 0 of the robot that it is about; None = of none, or of the whole team.
        fire: index from 0 of the fire, likewise.
        channel: name of the operator channel; "" = of none.
        command: class name of the command that was refused; "" = of none.
    """

    time: float
    severity: Severity
    kind: str
    text: str
    robot: int | None = None
    fire: int | None = None
    channel: str = ""
    command: str = ""
