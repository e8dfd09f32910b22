"""EMG interface: by default a fist pauses, an open hand resumes, a pinch closes the clutch and a spread opens it."""

from higvf_console.core.interface import InputSpec
from higvf_interfaces.decisions.interface import DecisionReplay
from higvf_interfaces.decisions.interpretation import IDLE

GESTURES = {
    "fist": "pause",
    "open": "resume",
    "pinch": "clutch_close",
    "spread": "clutch_open",
    "rest": IDLE,
}


def open_emg(spec: InputSpec) -> DecisionReplay:
    """Entry point `emg`; the options are in interfaces/README.md."""
    return DecisionReplay(spec, GESTURES)
