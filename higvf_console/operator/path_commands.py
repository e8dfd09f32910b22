"""Commands on the desired path: follow a path, repair it, resume or remove a listed one, finish it.

The active path is the one that the influenced robot follows. A pending path waits for a Confirm.
"""

import math
from collections.abc import Callable

import numpy as np

from higvf_console.control.guidance.paths import EVERYWHERE, nearest, path_points, start_parameter
from higvf_console.core.arguments import one_of
from higvf_console.core.arrays import floats
from higvf_console.core.commands import ShapePath
from higvf_console.core.errors import PathError
from higvf_console.core.events import Event
from higvf_console.core.numbers import measured, percent
from higvf_console.core.path_terms import ENDINGS, FASTEST, SLOWEST, PathTerms, changed_terms
from higvf_console.core.scale import USUAL_SCALE, Scale
from higvf_console.core.state import ACTING, Path, PathEnding, PathKind, PathStatus, SimState
from higvf_console.operator.outcome import Outcome, path_dropped, refuse, report, with_pointer_state
from higvf_console.operator.path_edits import reclosed

PATHS_KEPT = 20


def follow(state: SimState, path: Path) -> SimState:
    """The state with `path` as the active path; the influenced robot joins it from its present position."""
    intent, motion = state.intent, state.motion
    if path.kind == PathKind.NONE:
        status, w = PathStatus.NONE, 0.0
    else:
        x, y = motion.position[intent.influenced]
        status, w = PathStatus.FOLLOWING, start_parameter(path, float(x), float(y))
    motion = motion._replace(
        path_parameter=w, path_status=int(status), path_idle=0.0, path_gap=math.inf, path_left=path.duration,
        recovery_stage=np.zeros_like(motion.recovery_stage),
    )  # fmt: skip
    return state._replace(motion=motion, intent=intent._replace(path=path))


def terms_of(path: Path, smoothing: float | None = None) -> PathTerms:
    """The terms on which a path is followed; what its stroke was smoothed by [m] is not known of it, but given."""
    duration = float(path.duration) if math.isfinite(path.duration) else 0.0
    return PathTerms(ending_word(path), float(path.pace), duration, smoothing)


def with_terms(path: Path, terms: PathTerms) -> Path:
    """The path, followed on these terms.

    Raises:
        PathError: a value is outside its range.
    """
    one_of("path ending", terms.ending, ENDINGS, PathError)
    if not SLOWEST <= terms.pace <= FASTEST:
        raise PathError(f"pace {terms.pace:g} is outside {SLOWEST:g} to {FASTEST:g}")
    if not terms.duration >= 0.0:
        raise PathError(f"duration {terms.duration:g} s is not at least 0 s (0 means no limit)")
    return path._replace(
        ending=int(ENDINGS[terms.ending]), pace=float(terms.pace), duration=float(terms.duration) or math.inf
    )


def shaped(path: Path, command: ShapePath, scale: Scale = USUAL_SCALE) -> Path:
    """The path with the ending, pace, duration and closure that a command gives; fields of None keep the present value.

    Raises:
        PathError: a value is outside its range, or the path cannot be closed or opened.
    """
    if command.closed is not None:
        path = reclosed(path, command.closed, scale)
    return with_terms(path, changed_terms(terms_of(path), command))


def in_hand(state: SimState) -> Path:
    """The path that a repair changes: the pending path, else the active one."""
    pending = state.pointer_state.pending
    return state.intent.path if pending.kind == PathKind.NONE else pending


def repaired(
    state: SimState, time: float, repair: Callable[[Path], Path], *, restart: bool = False, preview: bool = False
) -> Outcome:
    """Repairs the path that `in_hand` returns.

    Args:
        state: present state.
        time: session time [s].
        repair: function from the old path to the new one; its PathError is reported, and the state stays unchanged.
        restart: whether the duration of the active path restarts.
        preview: whether the repaired active path becomes pending. A pending path stays pending in either case.
    """
    old = in_hand(state)
    try:
        if old.kind == PathKind.NONE:
            raise PathError("there is no path to repair")
        path = repair(old)
    except PathError as error:
        return state, refuse(time, f"The path is unchanged: {error}.")
    if preview or old is not state.intent.path:
        repairs = state.pointer_state.pending_repairs or old is state.intent.path
        events = report(time, "pending", f"Pending path: {path_words(path)}.")
        return with_pointer_state(state, pending=path, pending_repairs=repairs), events
    return repair_path(state, path, time, restart=restart)


def repair_path(state: SimState, path: Path, time: float, *, restart: bool | None = None) -> Outcome:
    """Replaces the active path by a repair of it; the influenced robot continues from the same place.

    Args:
        state: present state.
        path: the repaired path.
        time: session time [s].
        restart: whether the duration restarts; None restarts it if the two durations differ. It also restarts when the
            time of the active path is over.
    """
    old, motion = state.intent.path, state.motion
    restart = path.duration != old.duration if restart is None else restart
    motion = motion._replace(
        path_parameter=same_place(old, path, motion.path_parameter), path_status=int(PathStatus.FOLLOWING),
        path_idle=0.0, path_gap=math.inf,
        path_left=motion.path_left if motion.path_left > 0.0 and not restart else path.duration,
    )  # fmt: skip
    paths = tuple(path if other is old else other for other in state.pointer_state.paths)
    state = with_pointer_state(state._replace(motion=motion, intent=state.intent._replace(path=path)), paths=paths)
    return state, report(time, "path", f"Path changed: {path_words(path)}.")


def same_place(old: Path, path: Path, w: float) -> float:
    """Arc length [m] on `path`, a repair of `old`, of the point with arc length w [m] on `old`."""
    if path.spline is old.spline:
        return w
    x, y = path_points(old, floats([w]))[0].tolist()
    return nearest(path, 0.0, EVERYWHERE, x, y)[0]


def ending_word(path: Path) -> str:
    """Name in `ENDINGS` of the ending of a path."""
    return next(word for word, ending in ENDINGS.items() if ending == path.ending)


def path_words(path: Path) -> str:
    """Describes a path: closure, length, direction, ending, pace and duration."""
    shape = "closed" if path.closed else "open"
    words = "an endless line" if path.length == math.inf else f"{shape}, {measured(path.length)} m"
    words += ", in reverse" if path.direction < 0 else ""
    words += "" if path.ending == PathEnding.RELEASE else f", {ending_word(path)} at its end"
    words += "" if path.pace == 1.0 else f", at {percent(path.pace)} pace"
    return words + ("" if path.duration == math.inf else f", for {path.duration:g} s")


def take_up(state: SimState, number: int, time: float) -> Outcome:
    """Makes a listed path the active one again."""
    paths = state.pointer_state.paths
    if not 0 <= number < len(paths):
        return state, _no_path(number, len(paths), time)
    text = f"Robot {state.intent.influenced + 1} follows path {number + 1} again: {path_words(paths[number])}."
    return follow(path_dropped(state), paths[number]), report(time, "path", text)


def forget(state: SimState, number: int, time: float) -> Outcome:
    """Removes a path from the list."""
    paths = state.pointer_state.paths
    if not 0 <= number < len(paths):
        return state, _no_path(number, len(paths), time)
    kept = paths[:number] + paths[number + 1 :]
    return with_pointer_state(state, paths=kept), report(time, "path", f"Path {number + 1} is removed from the list.")


def _no_path(number: int, paths: int, time: float) -> tuple[Event, ...]:
    known = f"the list has paths 1 to {paths}" if paths else "the list is empty"
    return refuse(time, f"There is no path {number + 1}: {known}.")


def finish(state: SimState, time: float) -> Outcome:
    """Ends the human intention; the path stays visible."""
    if state.motion.path_status not in ACTING:
        return state, ()
    motion = state.motion._replace(path_status=int(PathStatus.FINISHED))
    text = "The human intention has ended; the team continues its own task."
    return state._replace(motion=motion), report(time, "path", text)
