"""Replayed EMG gestures as operator input: a squeeze pauses, an open hand resumes, a pinch holds the drawing clutch."""

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
