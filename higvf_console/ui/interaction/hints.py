"""Three steps for the first run: a strip on the page that ticks each step when what it asks for has happened."""

from typing import NamedTuple

import viser

from higvf_console.ui.page import page


class Step(NamedTuple):
    """One step.

    Attributes:
        name: by which the page remembers that it was done.
        title: what to do.
        text: how.
    """

    name: str
    title: str
    text: str


STEPS = (
    Step("draw", "Draw a path", "Drag in the arena."),
    Step("pick", "Pick a robot", "Click it, or press 1 … 9."),
    Step("stop", "Space stops", "Every robot, at once."),
)


def happened(server: viser.ViserServer, name: str) -> None:
    """Tells every page that the event of a step has happened; the page that tried it ticks the step."""
    page.call(server, "hints", "happened", name)


def install(server: viser.ViserServer) -> None:
    """Shows the steps on every page whose browser has not seen them done, or put away."""
    page.install(server, "hints", {"steps": STEPS})
