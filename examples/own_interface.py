"""An operator's device of one's own: anything with a name, `poll`, `health` and `close` steers a run.

As a package with an entry point it is found by `higvf run --input NAME=...`; see `interfaces/README.md`.
"""

from collections.abc import Sequence

import numpy as np

import higvf_console as hc
from higvf_console import commands


class Joystick:
    """Draws a stroke after one second, pauses at four, resumes at five."""

    name = "joystick"

    def __init__(self) -> None:
        """Starts before the first command."""
        stroke = np.array([[700.0, 300.0], [600.0, 200.0], [450.0, 130.0], [300.0, 90.0]])
        begin, end = commands.StrokeBegin(source=self.name), commands.StrokeEnd(source=self.name, robot=0)
        self._plan: list[tuple[float, hc.OperatorCommand]] = [
            (1.0, begin),
            (1.0, commands.StrokePoints(points=stroke, source=self.name)),
            (1.0, end),
            (4.0, commands.Pause(source=self.name)),
            (5.0, commands.Resume(source=self.name)),
        ]

    def poll(self, context: hc.OperatorContext) -> Sequence[hc.OperatorCommand]:
        """What is due by now; called every control period, must return at once."""
        due = [command for time, command in self._plan if time <= context.time]
        self._plan = self._plan[len(due) :]
        return due

    def health(self, now: float) -> hc.ChannelHealth:
        """How the device is."""
        return hc.ChannelHealth(hc.ChannelState.LIVE, f"well at {now:.1f} s")

    def close(self) -> None:
        """Nothing to let go of."""


report = hc.run("firefighting", duration=8.0, interfaces=[Joystick()])
for command in report["commands"]:
    print(f"{command['time']:5.2f} s  {command['kind']} by {command['source']}")
print(f"Digest of the run: {report['digest'][:16]}...")
