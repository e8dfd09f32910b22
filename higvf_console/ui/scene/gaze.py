"""Where the operator looks, in the arena: the heat map of gaze, and the button that gaze presses with its progress."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.optional import optional
from higvf_console.core.reports import AttentionReport, DwellReport
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.parts import Canvas, Layer

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "console")

_FAINT = 0.04  # share of the peak below which the ground is clear
_OPACITY = 0.8  # of the peak
_DARKEST, _BRIGHTEST = 100, 245  # part of the colour map that is used, out of 0 to 255: never black, never glaring
_RING = 17.0  # radius of the progress round the cursor [px]


class HeatLayer:
    """The picture is painted when the counts change, and only while it is shown."""

    def __init__(self, canvas: Canvas) -> None:
        """Starts hidden."""
        self._picture = canvas.picture(Layer.HEAT, "/gaze/heat")
        self._painted: Floats | None = None

    def update(self, report: AttentionReport | None, shown: bool) -> None:
        """Shows the heat of a report, or nothing."""
        if shown and report is not None and report.heat is not self._painted:
            self._painted = report.heat
            self._picture.paint(heat_picture(report))
        self._picture.show(shown and report is not None)


def heat_picture(report: AttentionReport) -> NDArray[np.uint8]:
    """Red, green, blue and opacity (rows, columns, 4) of the time that gaze spent, blurred by a degree of visual angle.

    From clear over grey blue to the white of the gaze cursor: only brightness carries meaning, and neither fires nor
    paths have that hue.
    """
    cell = report.extent.width / report.heat.shape[1]
    blurred = floats(cv2.GaussianBlur(report.heat, (0, 0), max(0.8, report.degree / cell)))
    share = np.sqrt(blurred / max(float(blurred.max()), 1e-12))  # a long rest must not hide the short ones
    level = np.round(_DARKEST + (_BRIGHTEST - _DARKEST) * share).astype(np.uint8)
    colours = cv2.applyColorMap(level, cv2.COLORMAP_BONE)[:, :, ::-1]
    opacity = np.clip((share - _FAINT) / (1 - _FAINT), 0.0, 1.0) * 255 * _OPACITY
    return np.dstack([colours, np.round(opacity)]).astype(np.uint8)


class DwellLayer:
    """The button's outline, and round the cursor how much of the dwell time has passed."""

    def __init__(self, canvas: Canvas) -> None:
        """Starts without a button."""
        self._radius = _RING * canvas.px
        self._outline = canvas.lines(Layer.STROKE, "/gaze/button", canvas.palette.operator, 1.5)
        self._ring = canvas.lines(Layer.CURSOR, "/gaze/dwell", canvas.palette.operator, 4.0)
        self._shown: Floats | None = None

    def update(self, report: DwellReport | None, cursor: Floats) -> None:
        """Shows the button, and its progress round the cursor (2,) [m]."""
        outline = floats([], 0, 2) if report is None else report.outline
        if self._shown is None or not np.array_equal(outline, self._shown):
            self._shown = outline
            self._outline.draw(shapes.segments(outline) if len(outline) else floats([], 0, 2, 2))
        progress = report.progress if report is not None and np.isfinite(cursor).all() else 0.0
        self._ring.draw(progress_ring(self._radius, progress))
        if progress > 0.0:
            self._ring.move(cursor)  # as the cursor moves: new points would come a moment later


def progress_ring(radius: float, progress: float) -> Floats:
    """The part of a circle (s, 2, 2) round the origin, clockwise from the top, that `progress` in [0, 1] fills."""
    if progress <= 0.0:
        return floats([], 0, 2, 2)
    turn = np.pi / 2 - np.linspace(0.0, 2 * np.pi * min(progress, 1.0), 49)
    return shapes.segments(radius * np.stack([np.cos(turn), np.sin(turn)], axis=1))
