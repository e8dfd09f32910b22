"""Preview of the conversion of a gaze recording: its gaps, fixations, strokes and heat map.

A stroke of the preview is a sequence of fixations without a gap longer than `PEN_UP`: what `clutch=always` would draw,
split at these gaps.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.optional import optional
from higvf_console.core.viewport import Arena
from higvf_interfaces.gaze.fixations import THRESHOLDS, Classified, fixations_of
from higvf_interfaces.gaze.heat_map import counts, paint
from higvf_interfaces.gaze.path import gaze_path
from higvf_interfaces.gaze.screens import Screen, ground_length, to_ground

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "devices")

PEN_UP = 1.5  # a gap longer than this ends a stroke [s]
_FEWEST = 3  # minimum number of fixations of a stroke
_LONGEST_BLINK = 0.5  # a longer gap is not a blink [s]
_STROKES_LISTED = 20
_MOST_CENTROIDS = 300  # per stroke; the spline fit is slow for more
_WIDTH = 900  # of the picture [px]
_DOT = 3  # radius of a fixation's dot [px]
_PAPER, _INK = 250, (40, 60, 110)


class Stroke(NamedTuple):
    """A stroke: its start and end [s], number of fixations, and their first centroids (k, 2) [m]."""

    start: float
    end: float
    fixations: int
    centroids: Floats


class ConversionPreview:
    """Accumulates the preview of a recording chunk by chunk, in bounded memory.

    Attributes:
        blinks: number of gaps no longer than a blink.
    """

    def __init__(self, screen: Screen, px_per_deg: float, arena: Arena) -> None:
        """Start before the first chunk.

        Args:
            screen: mapping from screen pixels to the arena.
            px_per_deg: pixels per degree of visual angle.
            arena: ground that the heat map covers.
        """
        self.blinks = 0
        self._screen, self._arena = screen, arena
        self._degree = ground_length(px_per_deg, screen)
        self._grid = counts(floats([], 0, 2), arena, _WIDTH)
        self._seen_at: float | None = None
        self._lost = self._longest = 0.0
        self._gaps = self._fixations = self._strokes = 0
        self._fixated = 0.0
        self._stages = dict.fromkeys(("with short gaps filled", "without the sides of blinks", "fixating"), 0)
        self._open: Stroke | None = None
        self._listed: list[Stroke] = []

    def add(self, chunk: Classified) -> None:
        """Add the next chunk."""
        self._count_gaps(chunk)
        for stage, column in zip(self._stages, (chunk.seen, chunk.steady, chunk.fixating), strict=True):
            self._stages[stage] += int(np.count_nonzero(column))
        self._grid += counts(to_ground(chunk.points[chunk.seen], self._screen), self._arena, _WIDTH)
        for start, end, point in fixations_of(chunk):
            self._fixations += 1
            self._fixated += end - start
            self._draw(start, end, to_ground(floats(point, 1, 2), self._screen)[0])

    def finish(self) -> None:
        """End the current stroke."""
        if self._open is not None and self._open.fixations >= _FEWEST:
            self._strokes += 1
            if len(self._listed) < _STROKES_LISTED:
                self._listed.append(self._open)
        self._open = None

    @property
    def gaps(self) -> Mapping[str, object]:
        """Number and durations of the gaps that are too long to fill."""
        return {"count": self._gaps, "longest_s": round(self._longest, 3), "total_s": round(self._lost, 3)}

    @property
    def summary(self) -> Mapping[str, object]:
        """Number of fixations and strokes, and the mean fixation duration."""
        mean = self._fixated / self._fixations if self._fixations else None
        return {
            "fixations": self._fixations,
            "mean_fixation_s": None if mean is None else round(mean, 3),
            "strokes": self._strokes,
        }

    def steps(self) -> Mapping[str, object]:
        """Return the number of samples after each processing step, and the paths of the first strokes."""
        return {
            **self._stages,
            "fixations": self._fixations,
            "strokes": [self._path_of(stroke) for stroke in self._listed],
        }

    def picture(self) -> NDArray[np.uint8]:
        """Return a heat map (height, width, 3) of the arena with the fixations of the first strokes."""
        heat = floats(paint(self._grid, self._arena, _WIDTH, self._degree))
        opacity = heat[:, :, 3:] / 255
        picture = np.ascontiguousarray(_PAPER * (1 - opacity) + heat[:, :, :3] * opacity, dtype=np.uint8)
        corner = np.array([self._arena.x_min, self._arena.y_max])
        for stroke in self._listed:
            pixels = (stroke.centroids - corner) * np.array([1, -1]) * _WIDTH / self._arena.width
            for x, y in pixels[np.isfinite(pixels).all(axis=1)].tolist():
                cv2.circle(picture, (round(x), round(y)), _DOT, _INK, -1, cv2.LINE_AA)
        return picture

    def _count_gaps(self, chunk: Classified) -> None:
        seen = chunk.time[chunk.seen]
        before = float(chunk.time[0]) if self._seen_at is None else self._seen_at
        steps = np.diff(seen, prepend=before)
        gaps = steps[steps > THRESHOLDS.longest_filled]
        self._gaps += len(gaps)
        self.blinks += int(np.count_nonzero(gaps <= _LONGEST_BLINK))
        self._lost += float(gaps.sum())
        self._longest = max(self._longest, *gaps.tolist(), 0.0)
        self._seen_at = float(seen[-1]) if len(seen) else before

    def _draw(self, start: float, end: float, point: Floats) -> None:
        if self._open is not None and start - self._open.end > PEN_UP:
            self.finish()
        if self._open is None:
            self._open = Stroke(start, end, 1, floats(point, 1, 2))
            return
        centroids = self._open.centroids
        if len(centroids) < _MOST_CENTROIDS:
            centroids = floats(np.concatenate([centroids, point[None]]))
        self._open = Stroke(self._open.start, end, self._open.fixations + 1, centroids)

    def _path_of(self, stroke: Stroke) -> Mapping[str, object]:
        path = gaze_path(stroke.centroids, 0.5 * self._degree)
        radius = path.smallest_radius
        return {
            "from_s": round(stroke.start, 3),
            "to_s": round(stroke.end, 3),
            "fixations": stroke.fixations,
            "distinct": len(path.distinct),
            "path_length_m": round(path.length, 1),
            "smallest_radius_m": round(radius, 1) if np.isfinite(radius) else None,
        }
