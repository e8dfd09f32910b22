"""Screen point -> ground point, pure: how pixels of a screen lie over the arena."""

from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats


class Arena(NamedTuple):
    """The rectangle that the operator sees [m]."""

    x_min: float
    y_min: float
    x_max: float
    y_max: float

    @property
    def width(self) -> float:
        """Extent along x [m]."""
        return self.x_max - self.x_min

    @property
    def height(self) -> float:
        """Extent along y [m]."""
        return self.y_max - self.y_min


class Viewport(NamedTuple):
    """A screen that looks straight down on the ground: pixels from its top left corner, y down.

    Attributes:
        width_px: screen width [px].
        height_px: screen height [px].
        centre_x: ground point under the screen's centre [m].
        centre_y: ground point under the screen's centre [m].
        metres_per_px: ground distance of one pixel [m/px].
    """

    width_px: float
    height_px: float
    centre_x: float
    centre_y: float
    metres_per_px: float

    def to_ground(self, pixels: Floats) -> Floats:
        """Ground points (n, 2) [m] under screen points (n, 2) [px]."""
        offset = (pixels - np.array([self.width_px / 2, self.height_px / 2])) * self.metres_per_px
        return np.array([self.centre_x, self.centre_y]) + offset * np.array([1.0, -1.0])

    def to_screen(self, ground: Floats) -> Floats:
        """Screen points (n, 2) [px] over ground points (n, 2) [m]."""
        offset = (ground - np.array([self.centre_x, self.centre_y])) / self.metres_per_px
        return np.array([self.width_px / 2, self.height_px / 2]) + offset * np.array([1.0, -1.0])


def fit(arena: Arena, width_px: float, height_px: float) -> Viewport:
    """The viewport in which the whole arena just fits a screen, centred, undistorted."""
    metres_per_px = max(arena.width / width_px, arena.height / height_px)
    centre_x, centre_y = (arena.x_min + arena.x_max) / 2, (arena.y_min + arena.y_max) / 2
    return Viewport(width_px, height_px, centre_x, centre_y, metres_per_px)
