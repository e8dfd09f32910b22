"""Authority shares over time as stacked bands, for one robot and for the team."""

from collections import deque
from typing import NamedTuple

import numpy as np

from higvf_console.analysis.explain import Authority
from higvf_console.core.arrays import Floats, floats
from higvf_console.ui.theme import CSS
from higvf_console.ui.widgets.chart import WIDTH
from higvf_console.ui.widgets.html import text

SPAN = 30.0  # of session time that is shown [s]
PERIOD = 0.2  # between two samples [s]
HEIGHT = 74  # [CSS px]
AUTHORITY_LOOK = {
    Authority.HUMAN: ("human", CSS.operator),
    Authority.ROBOT: ("own target", CSS.own_target),
    Authority.NEIGHBOURS: ("neighbours", CSS.neighbours),
    Authority.SAFETY: ("safety", CSS.safety),
}
_LEFT, _BOTTOM = 48, 18


class Sample(NamedTuple):
    """Shares by `Authority` at one time [s]."""

    time: float
    robot: Floats
    team: Floats


class AuthorityHistory:
    """The last `SPAN` seconds; another robot, or a time that runs backwards, starts anew."""

    def __init__(self) -> None:
        """Starts empty."""
        self._samples: deque[Sample] = deque()
        self._robot: int | None = None

    def add(self, time: float, robot: int, own: Floats, team: Floats) -> None:
        """Takes the shares (4,) of a robot and of the team at a time [s], if a sample is due."""
        if robot != self._robot or (self._samples and time < self._samples[-1].time):
            self._samples.clear()
            self._robot = robot
        if self._samples and time < self._samples[-1].time + PERIOD:
            return
        self._samples.append(Sample(time, own, team))
        while self._samples[0].time < time - SPAN:
            self._samples.popleft()

    def curves(self) -> tuple[Floats, Floats, Floats]:
        """Times (n,) [s], shares of the robot (n, 4) and of the team (n, 4)."""
        samples = list(self._samples)
        return (
            floats([sample.time for sample in samples]),
            floats([sample.robot for sample in samples], -1, len(Authority)),
            floats([sample.team for sample in samples], -1, len(Authority)),
        )


def legend_html() -> str:
    """The bands' names and colours."""
    return "".join(
        f'<span class="channel"><span class="swatch" style="background:{colour}"></span>{text(name)}</span>'
        for name, colour in AUTHORITY_LOOK.values()
    )


def bands_svg(title: str, time: Floats, authority: Floats) -> str:
    """Shares (n, 4) over time (n,) [s] as bands of the full height; a gap where nobody has authority."""
    right, bottom = WIDTH - 8, HEIGHT - _BOTTOM
    end = max(float(time[-1]) if len(time) else 0.0, SPAN)
    x = _LEFT + (right - _LEFT) * (1.0 - (end - time) / SPAN)
    edges = bottom - (bottom - 4) * np.concatenate([np.zeros((len(time), 1)), np.cumsum(authority, axis=1)], axis=1)
    bands = [
        f'<polygon points="{_points(x, edges[:, source], edges[:, source + 1])}" fill="{AUTHORITY_LOOK[source][1]}"/>'
        for source in Authority
        if len(time) > 1 and authority[:, source].any()
    ]
    frame = f'<path class="rule" d="M{_LEFT} 4H{right}V{bottom}H{_LEFT}Z"/>'
    lettering = (
        f'<text x="{_LEFT - 6}" y="{bottom / 2 + 6:.0f}" text-anchor="end">{text(title)}</text>'
        f'<text x="{_LEFT}" y="{HEIGHT - 4}">{end - SPAN:.0f}</text>'
        f'<text x="{right}" y="{HEIGHT - 4}" text-anchor="end">{end:.0f} s</text>'
    )
    return (
        f'<svg class="chart" viewBox="0 0 {WIDTH} {HEIGHT}" width="100%" role="img" fill="none">'
        f"{''.join(bands)}{frame}{lettering}</svg>"
    )


def _points(x: Floats, lower: Floats, upper: Floats) -> str:
    outline = [*zip(x, lower, strict=True), *zip(x[::-1], upper[::-1], strict=True)]
    return " ".join(f"{px:.1f},{py:.1f}" for px, py in outline)
