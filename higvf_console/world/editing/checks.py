"""Conditions that every edit must keep: clearances, barriers in discrete time, parameters that fit the team."""

from collections.abc import Callable
from typing import NamedTuple

from higvf_console.control.forms import PRINTED
from higvf_console.core.arrays import Floats, Ints
from higvf_console.core.errors import ScenarioError
from higvf_console.core.state import MOVER_SPEED, Motion, World
from higvf_console.core.viewport import Arena
from higvf_console.world.editing.safe_places import newly_crowded
from higvf_console.world.layout import Layout
from higvf_console.world.network import check_formation, check_intention, intention_radius, start_network
from higvf_console.world.placement import check_rates, check_robots, check_stand_off, check_start, wall_gaps

_SOURCE = "the edit"


class Stand(NamedTuple):
    """The part of a run state that the checks need; `influenced` is the index of the influenced robot."""

    layout: Layout
    world: World
    motion: Motion
    influenced: int


def check_edit(before: Stand, after: Stand, robots: Ints) -> None:
    """Refuses an edit that breaks a guarantee that held before it.

    Args:
        before: the run before the edit.
        after: the run after it.
        robots: (N,) row that each robot had before, or `NEW`.

    Raises:
        ScenarioError: a clearance, the sampling condition, the least stand-off, or the limit of the formation or of
            the intention is missed.
    """
    for check, groups in _CHECKS:
        _newly(check, groups, before, after)
    if newly_crowded((before.layout, before.motion), (after.layout, after.motion), robots):
        layout, world, motion, _ = after
        obstacles = layout.obstacles_at(motion.tick)
        check_start(motion.position, *_burning(world, motion), obstacles, layout.params, _SOURCE)


def check_fires(before: Stand, after: Stand) -> None:
    """Refuses an edit by which a condition on fires would fail, now or when the run starts again.

    Raises:
        ScenarioError: the sampling condition or the least stand-off is missed.
    """
    for check, groups in _OF_FIRES:
        _newly(check, groups, before, after)


def _newly(check: Callable[[Stand], None], groups: tuple[str, ...], before: Stand, after: Stand) -> None:
    """Raises what is wrong after the edit, unless something of the kind was wrong before.

    What was wrong before, as fires grow and robots come together, is no licence to change the tunables in `groups`, on
    which it depends, to values that are wrong too.
    """
    try:
        check(after)
    except ScenarioError as wrong:
        if any(getattr(before.layout.params, group) != getattr(after.layout.params, group) for group in groups):
            raise
        try:
            check(before)
        except ScenarioError:
            return
        raise wrong from None


def _formation(stand: Stand) -> None:
    layout, motion = stand.layout, stand.motion
    network = start_network(motion.position, layout.links, layout.params.formation.communication_range)
    check_formation(network.degree, layout.params, _SOURCE)


def _intention(stand: Stand) -> None:
    layout = stand.layout
    if layout.params.forms.intention == PRINTED:
        radius = intention_radius(stand.motion.position, layout.links, stand.influenced, layout.params)
        check_intention(radius, _SOURCE)


def _robots(stand: Stand) -> None:
    growth = stand.world.fire_growth[stand.motion.fire_burning]
    speed = stand.world.mover[:, MOVER_SPEED]
    check_robots(stand.layout.params, max(float(growth.max(initial=0.0)), float(speed.max(initial=0.0))), _SOURCE)


def _rates(stand: Stand) -> None:
    radius, world = _burning(stand.world, stand.motion)
    check_rates(world, radius, stand.layout.params, _SOURCE)


def _stand_off(stand: Stand) -> None:
    radius, world = _burning(stand.world, stand.motion)
    check_stand_off(world, radius, stand.layout.params, _SOURCE)


def _burning(world: World, motion: Motion) -> tuple[Floats, World]:
    """Radii of the burning fires [m], and the world with no others."""
    burning = motion.fire_burning
    fires = world._replace(fire_position=world.fire_position[burning], fire_growth=world.fire_growth[burning])
    return motion.fire_radius[burning], fires


_OF_FIRES = (
    (_robots, ("robots", "safety")),
    (_rates, ("robots", "safety")),
    (_stand_off, ("fires",)),
)
# Each check, and the groups of tunables that it depends on.
_CHECKS = (
    (_formation, ("formation",)),
    (_intention, ("intention", "formation")),
    *_OF_FIRES,
)


def check_walls(arena: Arena, walls: bool, layout: Layout, motion: Motion) -> None:
    """Refuses an arena without an inside, or whose walls leave robots or fires outside.

    Raises:
        ScenarioError: with what is outside.
    """
    if not (arena.width > 0.0 and arena.height > 0.0):
        raise ScenarioError(f"an arena of {arena.width:g} m x {arena.height:g} m has no area")
    for what, points in (("robot", motion.position), ("fire", layout.fire_position)) if walls else ():
        for gap in wall_gaps(points, arena):
            if len(gap) and gap.min() < 0.0:
                raise ScenarioError(f"{what} {int(gap.argmin()) + 1} would be outside the walls; move it first")
