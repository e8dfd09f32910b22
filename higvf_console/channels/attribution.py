"""Attribution: which channel commanded each effect in force, so that a lost channel's effects can be ended."""

from collections.abc import Mapping
from typing import NamedTuple, TypeAlias

from higvf_console.core.arrays import Ints
from higvf_console.core.commands import Clutch, Confirm, LoadScenario, OperatorCommand, Prioritise, StrokeEnd, StrokeUse
from higvf_console.core.state import ACTING, NOBODY, PathKind, SimState
from higvf_console.world.editing.carry import NEW

Favour: TypeAlias = tuple[float, ...]  # a priority: robot, fire, factor


class Attribution(NamedTuple):
    """Names of channels, empty where nobody gave anything.

    Attributes:
        path: gave the path in force.
        waits: gave the path that waits.
        clutch: closed the clutch.
        priorities: gave each priority.
    """

    path: str = ""
    waits: str = ""
    clutch: str = ""
    priorities: Mapping[Favour, str] = {}

    def robots(self, channel: str) -> list[int]:
        """Robots that have a priority of a channel."""
        return sorted({int(favour[0]) for favour, by in self.priorities.items() if by == channel})


def attributed(
    attribution: Attribution, channel: str, command: OperatorCommand, before: SimState, after: SimState,
    rows: tuple[Ints, Ints] | None = None,
) -> Attribution:  # fmt: skip
    """The claims after a command.

    Args:
        attribution: before it.
        channel: that gave it.
        command: what it gave.
        before: the state before it.
        after: the state after it.
        rows: (N,), (M,) row before of each robot and each fire after it; None = as they were.
    """
    if isinstance(command, LoadScenario) and after.intent is not before.intent:
        return Attribution()  # what a scenario begins with is nobody's
    path, waits, clutch, priorities = attribution
    pending = after.pointer_state.pending
    if after.intent.path.kind == PathKind.NONE:
        path = ""
    elif after.intent.path is not before.intent.path or _revived(before, after):
        path = waits if isinstance(command, Confirm) and waits else channel
    if pending is not before.pointer_state.pending:
        waits = "" if pending.kind == PathKind.NONE else channel
    if isinstance(command, Clutch):
        clutch = channel if command.closed else ""
    if after.intent.priority is not before.intent.priority:
        kept = priorities if rows is None else _renumbered(priorities, *rows)
        given = _favoured(command, after)
        favours: list[Favour] = [tuple(row) for row in after.intent.priority.tolist()]
        priorities = {favour: channel if favour[0] == given else kept.get(favour, channel) for favour in favours}
    return Attribution(path, waits, clutch, priorities)


def _favoured(command: OperatorCommand, after: SimState) -> int:
    """The robot that a command gives all the priorities that it has from now on."""
    match command:
        case Prioritise(robot=None) | StrokeEnd(use=StrokeUse.PRIORITY):
            return after.intent.influenced
        case Prioritise(robot=int() as robot):
            return robot
        case _:
            return NOBODY


def _revived(before: SimState, after: SimState) -> bool:
    return after.motion.path_status in ACTING and before.motion.path_status not in ACTING


def _renumbered(priorities: Mapping[Favour, str], robots: Ints, fires: Ints) -> dict[Favour, str]:
    """The priorities with the numbers that robots and fires have now."""
    robot, fire = ({old: new for new, old in enumerate(rows.tolist()) if old != NEW} for rows in (robots, fires))
    return {
        (robot[row[0]], fire[row[1]], *row[2:]): by
        for row, by in priorities.items()
        if row[0] in robot and row[1] in fire
    }
