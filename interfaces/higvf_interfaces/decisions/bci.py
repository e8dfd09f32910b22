"""BCI interface: by default each decoded class selects a robot."""

from higvf_console.core.interface import InputSpec
from higvf_interfaces.decisions.interface import DecisionReplay
from higvf_interfaces.decisions.interpretation import IDLE

CLASSES = {
    **{f"robot{number}": f"robot:{number}" for number in range(1, 10)},
    **{str(number): f"robot:{number}" for number in range(1, 10)},
    "idle": IDLE,
    "rest": IDLE,
}


def open_bci(spec: InputSpec) -> DecisionReplay:
    """Entry point `bci`; the options are in interfaces/README.md."""
    return DecisionReplay(spec, CLASSES)
