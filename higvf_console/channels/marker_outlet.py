"""Run events and operator commands as a marker stream of the Lab Streaming Layer, beside what the devices send.

Each marker is one JSON text: `{"label": "Pick", "source": "bci", "time": 12.34, ...}` for a command. What happened has
`"event"` in place of `"source"`, and `"robot"` (from 0), `"fire"` (from 0) or `"channel"` where it is about one. A
LabRecorder that records this stream and the devices' has them on one clock.
"""

import dataclasses
import json
from importlib import import_module
from typing import Any

from higvf_console.core.commands import Command
from higvf_console.core.errors import InputError
from higvf_console.core.events import Event

TYPE = "Markers"
_LEFT_OUT = ("points", "point", "operator", "time")  # too long, or said once


class MarkerOutlet:
    """The stream; pushing never waits, whether anybody listens or not."""

    def __init__(self, name: str, scenario: str, seed: int) -> None:
        """Opens the stream; its source id follows from its name alone, so that a recorder finds it again.

        Args:
            name: of the stream.
            scenario: name of what is run.
            seed: of the start positions.

        Raises:
            InputError: the library is not there, or the name is empty.
        """
        try:
            lsl = import_module("pylsl")
        except (ImportError, OSError, RuntimeError) as problem:
            raise InputError(f"--lsl-out needs pylsl: pip install 'higvf-console[lsl]' ({problem})") from problem
        if not name.strip():
            raise InputError("--lsl-out: the stream needs a name")
        info = lsl.StreamInfo(name, TYPE, 1, 0.0, lsl.cf_string, f"higvf-console {name}")
        info.desc().append_child_value("scenario", scenario)
        info.desc().append_child_value("seed", str(seed))
        self._outlet: Any = lsl.StreamOutlet(info)

    def command(self, time: float, command: Command) -> None:
        """A command was applied at session `time` [s]."""
        fields = {field.name: getattr(command, field.name) for field in dataclasses.fields(command)}
        said = {name: value for name, value in fields.items() if name not in _LEFT_OUT and value is not None}
        self._push({"label": type(command).__name__, **said, "time": round(time, 9)})

    def event(self, event: Event) -> None:
        """Something happened."""
        about = {"robot": event.robot, "fire": event.fire, "channel": event.channel or None}
        said = {"event": event.kind, "severity": event.severity.value, "text": event.text}
        said |= {name: value for name, value in about.items() if value is not None}
        self._push({"label": event.kind, **said, "time": round(event.time, 9)})

    def close(self) -> None:
        """Ends the stream; may be called twice."""
        self._outlet = None

    def _push(self, marker: dict[str, Any]) -> None:
        if self._outlet is not None:
            self._outlet.push_sample([json.dumps(marker, default=str)])
