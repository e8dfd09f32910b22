"""The commands that keys give, and the same actions of the command palette."""

from typing import TYPE_CHECKING

from higvf_console.core.commands import (
    AskReset,
    ClearPath,
    Confirm,
    Discard,
    Freeze,
    OperatorCommand,
    Pause,
    Pick,
    Prioritise,
    Redo,
    ResetEmergencyStop,
    Resume,
    ReversePath,
    Step,
    Undo,
)

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

_PICK = "pick_"


def command_of(name: str, snapshot: "Snapshot") -> OperatorCommand | None:
    """The command of a key.

    Args:
        name: of `keys.KEYMAP`.
        snapshot: now; a key that turns something on and off depends on it.

    Returns:
        None where the key gives no command.
    """
    if name.startswith(_PICK):
        return Pick(int(name.removeprefix(_PICK)) - 1)
    commands: dict[str, OperatorCommand] = {
        "ask_reset": AskReset(),
        "reset_stop": ResetEmergencyStop(),
        "pause": Resume() if snapshot.state.intent.paused else Pause(),
        "confirm": Confirm(),
        "discard": Discard(),
        "clear_path": ClearPath(),
        "reverse_path": ReversePath(),
        "clear_priority": Prioritise(),
        "freeze": Freeze(not snapshot.frozen),
        "step": Step(),
        "undo": Undo(),
        "redo": Redo(),
    }
    return commands.get(name)
