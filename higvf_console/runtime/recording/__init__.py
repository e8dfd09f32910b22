"""Recordings: the scenario's text, the seed and every command with its tick are enough to repeat a session.

The polygons traced from the masks of the scenario, and of those loaded during the run, are recorded too, so that a
replay needs no image.

JSON lines: a header; `{"tick": 120, "command": "Pick", ...}` for each command; `{"mark": 150, "digest": ...}` each
second of session time; at the end a mark with `"end": true`. The digest is that of `run.TrajectoryDigest`. Numbers that
JSON does not have are written as {"number": "inf"}; null in an array is NaN. The header has the calibration of each
input that has one; `{"tick": 90, "calibration": "gaze", ...}` reports a new one. A replay needs neither: the points of
commands are on the ground already.

Marks bound the ticks between them, so that no damaged number can make a replay endless. Lines are flushed each second
of real time, also while the clock of the session stands. Version 0.1 wrote the same format with other names of some
commands, which are still read, see `command_fields`.
"""

from higvf_console.runtime.recording.reading import Mark, Recording, read_recording
from higvf_console.runtime.recording.recorder import NONE_MEASURED, Recorder, versions
from higvf_console.runtime.recording.replaying import Replay, replay

__all__ = ["NONE_MEASURED", "Mark", "Recorder", "Recording", "Replay", "read_recording", "replay", "versions"]
