"""What does not fit, and is no reason to refuse a run: a warning for each."""

import numpy as np

from higvf_console.control.parameters import Parameters, controlled
from higvf_console.control.safety.barriers.sampling import least_stand_off
from higvf_console.core.arrays import Floats
from higvf_console.core.numbers import metres
from higvf_console.world.layout import Layout
from higvf_console.world.obstacles import Obstacles
from higvf_console.world.placement import clearance_words, obstacle_gaps


def unavoidable(layout: Layout) -> tuple[str, ...]:
    """A warning for each fire and moving obstacle that comes as fast as robots can yield, or faster."""
    limit = controlled(layout.params).safety.speed_limit
    dangers = [(f"fire {number} grows at", fire.growth) for number, fire in enumerate(layout.fires, 1)]
    obstacles = layout.obstacles
    dangers += [(f"{obstacles.name(row)} moves at", course.speed) for row, course in obstacles.movers()]
    return tuple(
        f"{what} {speed:g} m/s; robots, whose speed limit is {limit:.3g} m/s, cannot always keep clear of it"
        for what, speed in dangers
        if speed >= limit
    )


def buried_fires(fire_position: Floats, fire_radius: Floats, obstacles: Obstacles) -> tuple[str, ...]:
    """A warning for each fire that lies inside an obstacle, where no robot can see it."""
    return tuple(
        f"fire {fire + 1} lies inside {what}; no robot sees it until it has grown out of it"
        for what, gap in obstacle_gaps(fire_position, obstacles)
        for fire in np.flatnonzero(gap <= -fire_radius)
    )


def misfits(layout: Layout, position: Floats) -> tuple[str, ...]:
    """A warning for each number that does not fit the arena, and for each fire that is held from the start.

    Args:
        layout: arena, fires and parameters.
        position: (N, 2) of the robots at the start [m].
    """
    arena, params = layout.arena, layout.params
    side = min(arena.width, arena.height)
    size = f"the arena of {arena.width:g} m x {arena.height:g} m"
    remedy = "give robots.radius_m and speed_limit_m_per_s, from which the defaults follow, or another value"
    lengths = [
        ("safety.robot_clearance", params.safety.robot_clearance, 1.0),
        ("boundaries.reactive_margin", params.boundaries.reactive_margin, 0.5),
        ("path.capture_distance", params.path.capture_distance, 1.0),
    ]
    if layout.fires:
        lengths.append(("fires.stand_off", params.fires.stand_off, 0.5))
    found = [
        f"{name} is {value:g} m, more than {'half of ' * (share < 1.0)}the shorter side of {size}; {remedy}"
        for name, value, share in lengths
        if value > share * side
    ]
    if params.blending.cruise_speed * params.path.progress_timeout > 2.0 * max(arena.width, arena.height):
        found.append(
            f"blending.cruise_speed is {params.blending.cruise_speed:g} m/s: a robot crosses {size} within half of "
            f"path.progress_timeout, {params.path.progress_timeout:g} s; {remedy}"
        )
    reach = layout.fire_radius + params.fires.stand_off
    for number, fire in enumerate(layout.fires, 1):
        near = int((np.hypot(*(position - fire.position).T) <= reach[number - 1]).sum())
        if near >= fire.needs:
            found.append(
                f"fire {number} is held from the start: {near} robots stand within fires.stand_off, "
                f"{params.fires.stand_off:g} m, of its edge"
            )
    return tuple(found)


def robot_warnings(params: Parameters) -> tuple[str, ...]:
    """What the robots' model and noise make of other tunables without need to refuse them."""
    robots, point, warnings = params.robots, controlled(params).safety, list[str]()
    if robots.look_ahead == 0.0 and np.isfinite(robots.turn_rate_limit):
        warnings.append("robots.turn_rate_limit has no effect on single integrators; unicycles have a look_ahead")
    if point.speed_limit < params.safety.speed_limit and point.speed_limit < params.blending.cruise_speed:
        warnings.append(
            f"look_ahead and turn_rate_limit let unicycles go {point.speed_limit:.3g} m/s; "
            f"cruise_speed is {params.blending.cruise_speed:g} m/s"
        )
    if point != params.safety and params.boundaries.repulsive_margin <= point.obstacle_clearance:
        warnings.append(
            f"{clearance_words('obstacle', params.safety.obstacle_clearance, params)}; it should stay below "
            f"repulsive_margin ({params.boundaries.repulsive_margin:g} m), where robots circulate"
        )
    return tuple(warnings)


def late_stand_off(fire_radius: Floats, fire_growth: Floats, duration: float, params: Parameters) -> tuple[str, ...]:
    """A warning for each fire that grows, within `duration` [s], until no robot can hold at it."""
    grown = fire_radius + fire_growth * duration
    safety = controlled(params).safety
    least = [least_stand_off(float(r), float(g), safety) for r, g in zip(grown, fire_growth, strict=True)]
    return tuple(
        f"fire {number} can grow to {radius:.3g} m, where its barrier holds robots {metres(far)} off; "
        f"stand_off is {params.fires.stand_off:g} m"
        for number, (radius, far) in enumerate(zip(grown, least, strict=True), 1)
        if far > params.fires.stand_off
    )
