"""How obstacles move, read from a scenario file and written to one.

path_m: [[x, y], ...], speed_m_per_s: 5, loop: true    from its place through these points, and back if it loops
velocity_m_per_s: [vx, vy]                             straight on for ever
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from higvf_console.control.guidance.obstacles import LOOP, ONWARD
from higvf_console.core.arrays import Floats
from higvf_console.core.quantity import Quantity
from higvf_console.core.reading.node import Node
from higvf_console.world.obstacles import SPEED, Course, course_along, course_straight

COURSE_KEYS = ("path_m", "speed_m_per_s", "loop", "velocity_m_per_s")
_VELOCITY = Quantity("m/s", -SPEED.high, SPEED.high, "", "Velocity along one axis.")


def read_course(item: Node, entries: Mapping[str, Node], place: tuple[float, float]) -> Course | None:
    """The course of an obstacle; None where it stands still.

    Args:
        item: the obstacle, for errors.
        entries: its keys.
        place: centre of a circle, or middle of a bar, at time 0 [m].

    Raises:
        ScenarioError: a path is given together with a velocity, or without a speed, or it leads nowhere.
    """
    given = [key for key in COURSE_KEYS if key in entries]
    if "velocity_m_per_s" in given:
        if len(given) > 1:
            raise item.error(f"{', '.join(given)}: give path_m and speed_m_per_s, or velocity_m_per_s, not both")
        return _straight(entries["velocity_m_per_s"])
    if not given:
        return None
    for key in ("path_m", "speed_m_per_s"):
        if key not in given:
            raise item.error(f"the key '{key}' is missing; {given[0]} needs path_m and speed_m_per_s")
    points = entries["path_m"].points(least=1).tolist()
    speed = entries["speed_m_per_s"].number(SPEED)
    loop = entries["loop"].flag() if "loop" in given else False
    try:
        return course_along([place, *points], speed, loop)
    except ValueError as error:
        raise entries["path_m"].error(f"{error}, ({place[0]:g}, {place[1]:g}) m; give one that leads away") from error


def _straight(node: Node) -> Course:
    if not isinstance(node.value, list) or len(node.value) != 2:  # pyright: ignore[reportUnknownArgumentType, reportUnknownMemberType]
        raise node.wrong("a velocity [vx, vy] in m/s")
    vx, vy = (item.number(_VELOCITY) for item in node.items())
    speed = float(np.hypot(vx, vy))
    if not 0.0 < speed <= SPEED.high:
        raise node.error(f"[{vx:g}, {vy:g}] is {speed:g} m/s; give more than 0 and at most {SPEED.high:g} m/s")
    return course_straight(vx, vy)


def written_course(course: Course | None, time: float, start: Floats) -> dict[str, Any]:
    """The keys that `read_course` reads as what is left of a course at a time [s]; none where it is over.

    Args:
        course: of an obstacle; None where it stands still.
        time: of the session [s].
        start: (2,) centre of a circle, or middle of a bar, at the start of its course [m].
    """
    if course is None:
        return {}
    if course.ending == ONWARD:
        velocity = course.speed * course.points[1, :2]
        return {"velocity_m_per_s": velocity.tolist()} if course.speed > 0.0 else {}
    length = float(course.points[-1, 2])
    travelled = course.travelled(time)
    travelled = travelled % length if course.ending == LOOP else min(max(travelled, 0.0), length)
    ahead = course.points[course.points[:, 2] > travelled, :2]
    if course.ending == LOOP:
        behind = course.points[course.points[:, 2] < travelled, :2]
        ahead = np.concatenate([ahead, behind[1:]]) if travelled > 0.0 else ahead[:-1]
    if not len(ahead):
        return {}
    way = {"path_m": (ahead + start).tolist(), "speed_m_per_s": course.speed}
    return way | {"loop": True} if course.ending == LOOP else way
