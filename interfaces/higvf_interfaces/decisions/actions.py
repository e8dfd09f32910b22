"""Actions that a decoded label or a script entry may name, and their commands."""

import re
from collections.abc import Callable

from higvf_console.core.commands import (
    Acknowledge,
    AskReset,
    ClearPath,
    Clutch,
    Confirm,
    Disarm,
    Discard,
    EmergencyStop,
    NextTask,
    OperatorCommand,
    Pause,
    Pick,
    Redo,
    ResetEmergencyStop,
    ResetRun,
    Resume,
    ReversePath,
    Undo,
)

PLAIN: dict[str, Callable[[], OperatorCommand]] = {
    "pause": Pause,
    "resume": Resume,
    "stop": EmergencyStop,
    "ask_reset": AskReset,
    "reset_stop": ResetEmergencyStop,
    "clear_path": ClearPath,
    "reverse_path": ReversePath,
    "next_task": NextTask,
    "reset_run": ResetRun,
    "confirm": Confirm,
    "discard": Discard,
    "acknowledge": Acknowledge,
    "undo": Undo,
    "redo": Redo,
    "disarm": Disarm,
}
ACTIONS: dict[str, Callable[[], OperatorCommand]] = {
    **PLAIN,
    "clutch_close": lambda: Clutch(closed=True),
    "clutch_open": lambda: Clutch(closed=False),
}
CHOICES = (*ACTIONS, "robot:NUMBER (from 1)")
_ROBOT = re.compile(r"robot:\s*([1-9][0-9]{0,5})")


def command_for(action: str) -> OperatorCommand | None:
    """Return the command of `action`, or None for an unknown action."""
    robot = _ROBOT.fullmatch(action)
    if robot:
        return Pick(int(robot[1]) - 1)
    return ACTIONS[action]() if action in ACTIONS else None
