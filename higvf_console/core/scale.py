"""The scale of a team: the body and the speed limit of its robots, from which lengths, speeds and times follow.

Defaults and ranges of all tunables suit a robot whose body has a radius of 12 m and that drives at most 90 m/s. For
another robot every length is multiplied by the ratio of the radii, every speed by that of the speed limits, and every
time by the quotient of both: the equations then give the same motion on another scale.
"""

import math
from typing import NamedTuple

BODY_RADIUS = 12.0  # of the robot that the defaults are made for [m]
SPEED_LIMIT = 90.0  # of that robot [m/s]


class Scale(NamedTuple):
    """Size and speed of a robot.

    Attributes:
        body_radius: of the circle round its body [m].
        speed_limit: [m/s].
    """

    body_radius: float = BODY_RADIUS
    speed_limit: float = SPEED_LIMIT

    @property
    def length(self) -> float:
        """Ratio of its lengths to those of the robot that the defaults are made for."""
        return self.body_radius / BODY_RADIUS

    @property
    def speed(self) -> float:
        """Ratio of its speeds."""
        return self.speed_limit / SPEED_LIMIT

    @property
    def time(self) -> float:
        """Ratio of the times that its motion takes."""
        return self.length / self.speed

    @property
    def decimals(self) -> int:
        """Decimals of a length [m] that no hand sets more exactly: millimetres at the usual scale."""
        return 3 + max(0, round(-math.log10(self.length)))

    @property
    def speed_decimals(self) -> int:
        """Decimals of a speed [m/s] that people read: one at the usual scale."""
        return 1 + max(0, round(-math.log10(self.speed)))

    def factor(self, unit: str) -> float:
        """By what a number of this unit is multiplied; 1 for what has no scale, such as an angle."""
        match unit:
            case "m":
                return self.length
            case "m/s":
                return self.speed
            case "s":
                return self.time
            case "1/s" | "rad/s":
                return 1.0 / self.time
            case "s/m":
                return 1.0 / self.speed
            case _:
                return 1.0


USUAL_SCALE = Scale()
