"""Registry of formats: those of other packages, found by entry point, then the console's own.

Each of the three groups holds format records, as the readers of this package do:

    [project.entry-points."higvf_interfaces.gaze_formats"]
    my-tracker = "my_tracker:FORMAT"                # a GazeFormat of formats.reading
"""

import sys
from collections.abc import Callable
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any, TypeVar

from higvf_console.core.errors import InputError

GAZE = "higvf_interfaces.gaze_formats"
SIGNALS = "higvf_interfaces.signal_formats"
DECISIONS = "higvf_interfaces.decision_formats"

_WAY_OUT = "repair or uninstall its package"

_Format = TypeVar("_Format", bound=tuple[Any, ...])


def registered(group: str, own: tuple[_Format, ...]) -> tuple[_Format, ...]:
    """Return the formats of other packages, sorted by the name of their entry point, then the console's own.

    Args:
        group: group of entry points.
        own: the console's own formats, of one NamedTuple class with a `name`.

    Raises:
        InputError: If a format of another package does not load, is of another class, or has the name of another.
    """
    names = {_name(known) for known in own}
    outside: list[_Format] = []
    for point in _points(group, tuple(sys.path)):
        known = _loaded(point, type(own[0]))
        if _name(known) in names:
            raise InputError(f"{_titled(point)} has the name of another format, '{_name(known)}'; {_WAY_OUT}")
        names.add(_name(known))
        outside.append(known)
    return (*outside, *own)


@cache
def _points(group: str, _path: tuple[str, ...]) -> tuple[EntryPoint, ...]:
    """Return the entry points of a group; kept, because every file asks for them, as long as the path is the same."""
    return tuple(sorted(entry_points(group=group), key=lambda point: point.name))


def _loaded(point: EntryPoint, kind: type[_Format]) -> _Format:
    try:
        known = point.load()
    except Exception as error:  # whatever there is in a package's module
        raise InputError(f"{_titled(point)} does not load: {error}; {_WAY_OUT}") from error
    if not isinstance(known, kind):
        raise InputError(f"{_titled(point)} is {known!r:.60}, not a {kind.__name__}; {_WAY_OUT}")
    record: Any = known
    functions = {key: value for key, value in record._asdict().items() if callable(value)}
    return record._replace(**{key: _guarded(point, value) for key, value in functions.items()})


def _guarded(point: EntryPoint, function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of another package that fails with `InputError` only."""

    def call(*given: Any) -> Any:
        try:
            return function(*given)
        except InputError:
            raise
        except Exception as error:  # as above
            raise InputError(f"{_titled(point)} failed: {type(error).__name__}: {error}") from error

    return call


def _titled(point: EntryPoint) -> str:
    return f"format '{point.name}' ({point.value})"


def _name(known: Any) -> str:
    return str(known.name)
