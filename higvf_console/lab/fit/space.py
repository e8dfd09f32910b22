"""Free parameters of the firefighting world that the paper does not give, and the range of the search for each.

`SPACE` was fixed before the search whose result is shipped, but not blindly: earlier searches had a narrower range of
bars and no formation gain, and their predictions of columns 2 and 3 were known when both were added. A sample holds one
value per parameter, rounded to its grid, so that a scenario file with these numbers gives the same run bit for bit.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple, TypeAlias

import numpy as np

from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import ScenarioError
from higvf_console.core.quantity import quantities
from higvf_console.scenario.sections import SPEED_LIMIT_FACTOR
from higvf_console.world.misfits import late_stand_off
from higvf_console.world.placement import check_barriers
from higvf_console.world.setup import Setup, make_setup

DURATION = 60.0  # [s]; the last fire of the paper is out after about 41 s
BAR_HALF_WIDTH = 6.0  # [m]


class Free(NamedTuple):
    """A free parameter.

    Attributes:
        name: group and name of a parameter (`control.parameters`), or a coordinate of the vertical bar.
        low: lower limit of the search.
        high: upper limit of the search.
        step: step of the grid; 0.02 s is one control period.
    """

    name: str
    low: float
    high: float
    step: float


Sample: TypeAlias = tuple[float, ...]  # one value per parameter of SPACE

SPACE: tuple[Free, ...] = (
    Free("fires.start_delay", 6.0, 13.4, 0.02),  # fire 1 of column 1 stops growing after 13.4 s
    Free("fires.extinguish_time", 0.0, 0.1, 0.0005),
    Free("fires.stand_off", 18.0, 50.0, 0.1),  # below this, no robot could hold at the larger fires
    Free("blending.cruise_speed", 60.0, 235.0, 0.5),  # above this, the sampling condition of the barriers fails
    Free("blending.intention_floor", 0.002, 0.1, 0.001),
    Free("blending.formation_gain", 0.001, 0.04, 0.0005),
    Free("perception.target_band", 10.0, 150.0, 0.5),
    Free("bar.x", 780.0, 1000.0, 1.0),  # anywhere between the team's start and fire 5
    Free("bar.y_low", 100.0, 300.0, 1.0),
    Free("bar.y_high", 360.0, 500.0, 1.0),
)
NAMES = tuple(free.name for free in SPACE)


def on_grid(values: Floats) -> Sample:
    """The sample on the grid nearest to `values` (P,)."""
    return tuple(
        round(free.step * round(float(value) / free.step), 6) for free, value in zip(SPACE, values, strict=True)
    )


def scaled(sample: Sample) -> Floats:
    """The sample (P,) normalised to the ranges of its parameters."""
    return np.array([(value - free.low) / (free.high - free.low) for free, value in zip(SPACE, sample, strict=True)])


def unit(name: str) -> str:
    """Unit of a free parameter."""
    group, _, key = name.partition(".")
    return "m" if group == "bar" else quantities(type(getattr(Parameters(), group)))[key].unit


def sample_of(setup: Setup) -> Sample:
    """The sample of a world with one vertical bar.

    Raises:
        ScenarioError: the world does not have exactly one vertical bar.
    """
    bars = setup.layout.obstacles.bars
    if len(bars) != 1 or bars[0, 0] != bars[0, 2]:
        raise ScenarioError(f"the world of the fit has one vertical bar, not {len(bars)} bars {bars.tolist()}")
    x, low, _, high, _ = (float(number) for number in bars[0])
    bar = {"bar.x": x, "bar.y_low": low, "bar.y_high": high}
    return tuple(bar[name] if name in bar else float(_gain(setup.params, name)) for name in NAMES)


def world_of(sample: Sample, base: Setup) -> Setup:
    """The world of a sample: `base` with its parameters and its bar.

    Raises:
        ScenarioError: the barriers do not hold with these parameters, or no robot can hold at a fire for `DURATION`.
    """
    given = dict(zip(NAMES, sample, strict=True))
    params = params_of(given, base.params)
    bar = floats([[given["bar.x"], given["bar.y_low"], given["bar.x"], given["bar.y_high"], BAR_HALF_WIDTH]])
    layout = base.layout._replace(obstacles=base.layout.obstacles._replace(bars=bar), params=params)
    setup = make_setup(layout, base.start.motion.position)
    check_barriers(setup.world, layout.fire_radius, params, "sample")
    late = late_stand_off(layout.fire_radius, setup.world.fire_growth, DURATION, params)
    if late:
        raise ScenarioError(f"sample: {late[0]}")
    return setup


def params_of(given: Mapping[str, float], params: Parameters) -> Parameters:
    """`params` with the values named GROUP.NAME; the speed limit follows the cruise speed, as in a scenario."""
    for name, value in given.items():
        group, _, key = name.partition(".")
        if group in Parameters._fields:
            params = params._replace(**{group: getattr(params, group)._replace(**{key: value})})
    limit = SPEED_LIMIT_FACTOR * params.blending.cruise_speed
    return params._replace(safety=params.safety._replace(speed_limit=limit))


def _gain(params: Parameters, name: str) -> float:
    group, _, key = name.partition(".")
    return getattr(getattr(params, group), key)


def distance(sample: Sample, other: Sample) -> float:
    """Euclidean distance between two normalised samples."""
    return math.dist(scaled(sample).tolist(), scaled(other).tolist())
