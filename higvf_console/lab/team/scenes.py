"""What the e-pucks are asked to do: two fires, and three drawn paths between obstacles; and who asks it."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import yaml

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import Arm, AskArm, OperatorCommand, StrokeBegin, StrokeEnd, StrokePoints
from higvf_console.core.events import Event
from higvf_console.core.interface import Capabilities, ChannelHealth, ChannelState, OperatorContext
from higvf_console.scenario.scenario import Scenario, load_scenario, parse_scenario

ARMED_TEXT = "The team is armed"  # how the event begins
_ASK_AT, _ASK_EVERY = 0.5, 0.5  # [s]
_MARGIN = 0.1  # around a path [m]


class Scene(NamedTuple):
    """A task.

    Attributes:
        name: for tables.
        scenario: what is run.
        robot: that the operator draws for.
        stroke: (n, 2) what is drawn [m].
        limit: time that it may take [s].
    """

    name: str
    scenario: Scenario
    robot: int
    stroke: Floats
    limit: float


def scenes() -> tuple[Scene, ...]:
    """All of them, all in the arena of the scenario `epucks`."""
    epucks = load_scenario("epucks")
    shown = epucks.strokes[0]
    given: dict[str, Any] = yaml.safe_load(epucks.text)
    fires = Scene("fires", epucks, 1, shown.points, epucks.duration)
    return (fires, *(_path_scene(given, name, *scene) for name, scene in _PATHS.items()))


_PATHS: dict[str, tuple[list[list[float]], list[list[float]]]] = {
    "slalom": (
        [[1.1, 1.0, 0.08], [1.7, 0.8, 0.08], [2.3, 1.0, 0.08]],
        [[0.7, 1.0], [0.9, 1.2], [1.1, 1.25], [1.4, 1.05], [1.7, 0.55], [2.0, 0.7], [2.3, 1.25], [2.7, 1.2]],
    ),
    "gate": (
        [[1.6, 0.72, 0.1], [1.6, 1.28, 0.1]],
        [[0.7, 1.0], [1.1, 1.05], [1.6, 1.0], [2.0, 0.9], [2.6, 1.0]],
    ),
    "turn": (
        [[1.5, 0.7, 0.1], [1.9, 1.3, 0.1]],
        [[0.7, 1.0], [1.2, 1.1], [1.6, 1.1], [2.1, 0.9], [2.3, 0.6], [2.0, 0.35], [1.4, 0.4]],
    ),
}  # circles (x, y, radius), and what is drawn [m]


def _path_scene(given: dict[str, Any], name: str, circles: list[list[float]], points: list[list[float]]) -> Scene:
    scenario = given | {
        "title": f"E-pucks: {name}",
        "obstacles": {"circles": [{"at_m": circle[:2], "radius_m": circle[2]} for circle in circles]},
        "ends": {"when": "never"},
    }
    del scenario["fires"], scenario["strokes"]
    text = yaml.safe_dump(scenario)
    return Scene(name, parse_scenario(text, f"the scene '{name}'"), 1, floats(points, -1, 2), 90.0)


class Operator:
    """Arms the team in its two steps, then draws once."""

    name = "script"
    capabilities = Capabilities()

    def __init__(self, scene: Scene) -> None:
        """Nothing is asked yet.

        Attributes:
            events: the session's, once there is one.
        """
        self._scene, self._next, self._drawn = scene, _ASK_AT, False
        self.events: Callable[[], Sequence[Event]] = lambda: ()
        self.armed_at: float | None = None

    def poll(self, context: OperatorContext) -> Sequence[OperatorCommand]:
        """What it does in this control period."""
        if self.armed_at is None and any(event.text.startswith(ARMED_TEXT) for event in self.events()):
            self.armed_at = context.time
            return self._draw()
        if self.armed_at is not None or context.time < self._next:
            return ()
        first, self._next = self._next == _ASK_AT, self._next + _ASK_EVERY
        return (AskArm(),) if first else (Arm(),)

    def _draw(self) -> Sequence[OperatorCommand]:
        return StrokeBegin(), StrokePoints(points=self._scene.stroke), StrokeEnd(robot=self._scene.robot)

    def health(self, now: float) -> ChannelHealth:  # noqa: ARG002
        """Always live."""
        return ChannelHealth(ChannelState.LIVE, "arms and draws")

    def close(self) -> None:
        """Has nothing to let go of."""


def distances_to(stroke: Floats, points: Floats) -> Floats:
    """Distance (m,) of points (m, 2) from a polyline (n, 2) [m]."""
    begin, along = stroke[:-1], np.diff(stroke, axis=0)
    share = ((points[:, None] - begin) * along).sum(axis=2) / (along**2).sum(axis=1)
    nearest = begin + np.clip(share, 0.0, 1.0)[:, :, None] * along
    return np.sqrt(((points[:, None] - nearest) ** 2).sum(axis=2)).min(axis=1)
