"""A motion carried over into another world: rows that stay, rows that come, sides of rings that are no more."""

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.arrays import Ints
from higvf_console.core.state import ACTING, NO_PATH, NOBODY, Intent, Motion, PathStatus, PointerState, World

Number = TypeVar("Number", bound=np.generic)
NEW = -1  # a row that was not there before

_BY_ROBOT = ("position", "heading", "velocity", "intention", "target", "target_value", "stalled", "recovery_stage")
_BY_FIRE = ("fire_radius", "fire_progress", "fire_burning")


def carried(motion: Motion, robots: Ints, fires: Ints, before: World, after: World) -> Motion:
    """The motion with other rows.

    Args:
        motion: in the world before.
        robots: (N,) row that each robot had before, or `NEW`: it is at rest, its place is still to be given.
        fires: (M,) likewise; a new fire burns, its radius is still to be given.
        before: the world that the motion comes from.
        after: the world that it goes to.
    """
    rows: dict[str, Any] = {name: _taken(getattr(motion, name), robots) for name in _BY_ROBOT}
    rows |= {name: _taken(getattr(motion, name), fires) for name in _BY_FIRE}
    rows["target"] = _renumbered(rows["target"], fires, len(motion.fire_radius))
    rows["target"][robots == NEW] = NOBODY
    rows["fire_burning"][fires == NEW] = True
    return motion._replace(**rows, circulation=_sides(motion.circulation, robots, fires, before, after))


def led_on(motion: Motion, intent: Intent, robots: Ints, fires: Ints, fires_before: int) -> tuple[Motion, Intent]:
    """Motion (of the rows after) and intent with the numbers that robots and fires have now.

    The robot that was influenced may be gone: then robot 1 is, and the human intention is over.
    """
    place = {old: new for new, old in enumerate(robots.tolist()) if old != NEW}
    influenced = place.get(intent.influenced, 0)
    if intent.influenced not in place and motion.path_status in ACTING:
        motion = motion._replace(path_status=int(PathStatus.FINISHED))
    priority = intent.priority.copy()
    priority[:, 0] = [place.get(int(robot), NOBODY) for robot in priority[:, 0]]
    priority[:, 1] = _renumbered(priority[:, 1].astype(np.int64), fires, fires_before)
    kept = (priority[:, :2] != NOBODY).all(axis=1)
    return motion, intent._replace(influenced=influenced, priority=np.ascontiguousarray(priority[kept]))


def waiting_on(pointer_state: PointerState, robots: Ints) -> PointerState:
    """What waits, for the robot that it was for; without a path or a proposal whose robot is gone."""
    place = {old: new for new, old in enumerate(robots.tolist()) if old != NEW} | {NOBODY: NOBODY}
    if pointer_state.pending_robot not in place:
        pointer_state = pointer_state._replace(pending=NO_PATH, pending_robot=NOBODY, pending_repairs=False)
    return pointer_state._replace(
        pending_robot=place[pointer_state.pending_robot], proposed=place.get(pointer_state.proposed, NOBODY)
    )


def inverse(rows: Ints, before: int) -> Ints:
    """(before,) row that each old row has now, or `NEW` for one that went."""
    back = np.full(before, NEW, np.int64)
    kept = rows != NEW
    back[rows[kept]] = np.flatnonzero(kept)
    return back


def same_rows(count: int) -> Ints:
    """Every row where it was."""
    return np.arange(count, dtype=np.int64)


def _taken(array: NDArray[Number], rows: Ints) -> NDArray[Number]:
    taken = np.zeros((len(rows), *array.shape[1:]), array.dtype)
    taken[rows != NEW] = array[rows[rows != NEW]]
    return taken


def _renumbered(target: Ints, fires: Ints, before: int) -> Ints:
    """Fire numbers (any,) of before as they are now; NOBODY where the fire is gone."""
    return np.concatenate([inverse(fires, before), [NOBODY]])[target]


def _sides(circulation: Ints, robots: Ints, fires: Ints, before: World, after: World) -> Ints:
    """Circulation sides (N, K): those round obstacles that are as they were are kept."""
    groups = len(after.boundary)
    same = len(before.boundary) == groups and bool((before.boundary == after.boundary).all())
    own = _taken(circulation, robots)
    round_obstacles = own[:, : len(before.boundary)] if same else np.zeros((len(robots), groups), np.int64)
    round_fires = _taken(own[:, len(before.boundary) :].T, fires).T
    return np.ascontiguousarray(np.concatenate([round_obstacles, round_fires], axis=1))
