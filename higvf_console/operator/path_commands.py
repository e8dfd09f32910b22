"""Commands on the desired path: follow another, reshape the one in force, take up an old one, let it be finished."""

import math
from collections.abc import Callable

import numpy as np

from higvf_console.control.guidance.paths import EVERYWHERE, nearest, path_points, start_parameter
from higvf_console.core.arrays import floats
from higvf_console.core.commands import ShapePath
from higvf_console.core.errors import PathError
from higvf_console.core.events import Event
from higvf_console.core.path_terms import ENDINGS, FASTEST, SLOWEST, PathTerms, changed_terms
from higvf_console.core.state import ACTING, Path, PathEnding, PathKind, PathStatus, SimState
from higvf_console.operator.outcome import Outcome, path_dropped, refuse, report, with_pointer_state
from higvf_console.operator.path_edits import reclosed

PATHS_KEPT = 20


def follow(state: SimState, path: Path) -> SimState:
    """The same state with `path` as the human intention, joined from where the influenced robot is."""
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
        PathError: it cannot be.
    """
    if terms.ending not in ENDINGS:
        raise PathError(f"'{terms.ending}' is no ending of a path; endings: {', '.join(ENDINGS)}")
    if not SLOWEST <= terms.pace <= FASTEST:
        raise PathError(f"a pace of {terms.pace:g} is not within {SLOWEST:g} to {FASTEST:g}")
    if not terms.duration >= 0.0:
        raise PathError(f"a duration of {terms.duration:g} s is not from 0 s, which means no limit")
    return path._replace(
        ending=int(ENDINGS[terms.ending]), pace=float(terms.pace), duration=float(terms.duration) or math.inf
    )


def shaped(path: Path, command: ShapePath) -> Path:
    """The path, followed as the command says.

    Raises:
        PathError: it cannot be.
    """
    if command.closed is not None:
        path = reclosed(path, command.closed)
    return with_terms(path, changed_terms(terms_of(path), command))


def in_hand(state: SimState) -> Path:
    """The path that a repair changes: the one that waits, else the one in force."""
    pending = state.pointer_state.pending
    return state.intent.path if pending.kind == PathKind.NONE else pending


def repaired(
    state: SimState, time: float, repair: Callable[[Path], Path], *, anew: bool = False, waits: bool = False
) -> Outcome:
    """The path `in_hand`, repaired.

    Args:
        state: now.
        time: of the session [s].
        repair: makes the new path of the old one; a PathError is said, and changes nothing.
        anew: whether the duration of the path in force begins again.
        waits: whether what becomes of the path in force waits for a Confirm. A path that waits goes on waiting.
    """
    old = in_hand(state)
    try:
        if old.kind == PathKind.NONE:
            raise PathError("there is none to change")
        path = repair(old)
    except PathError as error:
        return state, refuse(time, f"The path stays as it is: {error}.")
    if waits or old is not state.intent.path:
        repairs = state.pointer_state.pending_repairs or old is state.intent.path
        said = report(time, "pending", f"The path that waits is now {path_words(path)}.")
        return with_pointer_state(state, pending=path, pending_repairs=repairs), said
    return repair_path(state, path, time, anew=anew)


def repair_path(state: SimState, path: Path, time: float, *, anew: bool | None = None) -> Outcome:
    """`path` in place of the one in force: it goes on where that is. `anew` = None: if the durations differ.

    Where the time of the one in force is over, it begins again.
    """
    old, motion = state.intent.path, state.motion
    anew = path.duration != old.duration if anew is None else anew
    motion = motion._replace(
        path_parameter=same_place(old, path, motion.path_parameter), path_status=int(PathStatus.FOLLOWING),
        path_idle=0.0, path_gap=math.inf,
        path_left=motion.path_left if motion.path_left > 0.0 and not anew else path.duration,
    )  # fmt: skip
    paths = tuple(path if other is old else other for other in state.pointer_state.paths)
    state = with_pointer_state(state._replace(motion=motion, intent=state.intent._replace(path=path)), paths=paths)
    return state, report(time, "path", f"The path is now {path_words(path)}.")


def same_place(old: Path, path: Path, w: float) -> float:
    """Parameter of `path` at the place that has parameter w on `old`, of which it is a repair."""
    if path.spline is old.spline:
        return w
    x, y = path_points(old, floats([w]))[0].tolist()
    return nearest(path, 0.0, EVERYWHERE, x, y)[0]


def ending_word(path: Path) -> str:
    """What happens at the end of a path, in one word of `ENDINGS`."""
    return next(word for word, ending in ENDINGS.items() if ending == path.ending)


def path_words(path: Path) -> str:
    """What a path is like, in words."""
    words = (
        "an endless line" if path.length == math.inf else f"{'closed' if path.closed else 'open'}, {path.length:.0f} m"
    )
    words += ", in reverse" if path.direction < 0 else ""
    words += "" if path.ending == PathEnding.RELEASE else f", {ending_word(path)} at its end"
    words += "" if path.pace == 1.0 else f", at {path.pace:.0%} pace"
    return words + ("" if path.duration == math.inf else f", for {path.duration:g} s")


def take_up(state: SimState, number: int, time: float) -> Outcome:
    """Follows a path of the list again."""
    paths = state.pointer_state.paths
    if not 0 <= number < len(paths):
        return state, _no_path(number, len(paths), time)
    text = f"Robot {state.intent.influenced + 1} takes up path {number + 1} again, {path_words(paths[number])}."
    return follow(path_dropped(state), paths[number]), report(time, "path", text)


def forget(state: SimState, number: int, time: float) -> Outcome:
    """Takes a path off the list."""
    paths = state.pointer_state.paths
    if not 0 <= number < len(paths):
        return state, _no_path(number, len(paths), time)
    kept = paths[:number] + paths[number + 1 :]
    return with_pointer_state(state, paths=kept), report(time, "path", f"Path {number + 1} is off the list.")


def _no_path(number: int, paths: int, time: float) -> tuple[Event, ...]:
    known = f"the list has paths 1 to {paths}" if paths else "the list is empty"
    return refuse(time, f"There is no path {number + 1}: {known}.")


def finish(state: SimState, time: float) -> Outcome:
    """Ends the human intention; the path stays drawn."""
    if state.motion.path_status not in ACTING:
        return state, ()
    motion = state.motion._replace(path_status=int(PathStatus.FINISHED))
    return state._replace(motion=motion), report(time, "path", "The team goes on with its own task.")
