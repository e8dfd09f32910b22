"""Attention counts since the start of the run: gaze time by place, fixation time by fire and robot."""

import math
from collections import deque

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.interface import NO_TARGETS, Targets
from higvf_console.core.reports import AttentionReport
from higvf_console.core.viewport import Arena
from higvf_interfaces.gaze.attention import ELSEWHERE, Transitions, fixated_targets
from higvf_interfaces.gaze.fixations import Fixation
from higvf_interfaces.gaze.heat_map import counts

HEAT_PX = 480  # width of the heat map's picture; its grid has 120 columns
_REMEMBERED = 64  # number of recent target positions kept, over some seconds
_REMEMBER_EVERY = 0.1  # [s]


class AttentionCounts:
    """Accumulates gaze time by place, and fixation time by fire and robot.

    A fixation is assigned to the target whose border is nearest to its centroid, within one degree of visual angle,
    with the positions of the targets at the middle of the fixation.
    """

    def __init__(self, arena: Arena) -> None:
        """Start with zero counts.

        Args:
            arena: ground that the heat map covers.
        """
        self._arena = arena
        self._heat = counts(floats([], 0, 2), arena, HEAT_PX)
        self._points: list[Floats] = []  # gaze since the last report, not yet in the heat map
        self._spans: list[float] = []
        self._before: float | None = None
        self._seen = 0.0
        self._targets: deque[tuple[float, Targets]] = deque([(-np.inf, NO_TARGETS)], maxlen=_REMEMBERED)
        self._fixations, self._fixated = 0, 0.0
        self._transitions = Transitions()
        self._fires, self._robots, self._elsewhere = floats([]), floats([]), 0.0
        self._degree = 0.0

    def look(self, time: float, point: Floats | None, targets: Targets) -> None:
        """Add the time since the last call to the place of gaze.

        Args:
            time: session time [s].
            point: gaze on the ground (2,) [m]; None if unknown.
            targets: current fires and robots.
        """
        span = 0.0 if self._before is None else time - self._before
        self._before = time
        if point is not None:
            self._seen += span
            self._points.append(point)
            self._spans.append(span)
        if time - self._targets[-1][0] >= _REMEMBER_EVERY:
            self._targets.append((time, targets))

    def fixate(self, fixation: Fixation, degree: float) -> None:
        """Add a completed fixation.

        Args:
            fixation: fixation with its centroid on the ground [m].
            degree: ground length of one degree of visual angle [m].
        """
        middle = (fixation.start + fixation.end) / 2
        _, targets = min(self._targets, key=lambda remembered: abs(remembered[0] - middle))
        fires, robots = len(targets.fires), len(targets.robots)
        places = np.concatenate([targets.fires, targets.robots])
        reach = np.concatenate([targets.fire_radius, np.zeros(robots)]) + degree
        at = int(fixated_targets(floats(fixation.point, 1, 2), places, reach)[0])
        length = fixation.end - fixation.start
        self._fires, self._robots = _sized(self._fires, fires), _sized(self._robots, robots)
        if at == ELSEWHERE:
            self._elsewhere += length
        elif at < fires:
            self._fires[at] += length
        else:
            self._robots[at - fires] += length
        self._fixations += 1
        self._fixated += length
        self._transitions.add(at if at < fires else fires - at - 2)  # an added fire does not renumber the robots
        self._degree = degree

    def report(self) -> AttentionReport | None:
        """Return the counts so far; None before the first gaze sample."""
        if not self._points and not self._seen:
            return None
        if self._points:
            self._heat = self._heat + counts(floats(self._points, -1, 2), self._arena, HEAT_PX, floats(self._spans))
            self._points, self._spans = [], []
        _, targets = self._targets[-1]
        return AttentionReport(
            heat=self._heat,
            extent=self._arena,
            degree=self._degree,
            fires=_sized(self._fires, len(targets.fires)),
            robots=_sized(self._robots, len(targets.robots)),
            elsewhere=self._elsewhere,
            fixation_rate=self._fixations / self._seen if self._seen else 0.0,
            fixation_duration=self._fixated / self._fixations if self._fixations else math.nan,
            transition_entropy=self._transitions.entropy,
        )


def _sized(spent: Floats, count: int) -> Floats:
    """Return a copy resized to `count` targets; new targets start at 0."""
    kept = np.zeros(count)
    kept[: len(spent)] = spent[:count]
    return kept
