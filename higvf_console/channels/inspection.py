"""Asks the installed packages what a file is: inspectors are found by entry point, as interfaces are.

The inspector that has the name of the channel is asked first, then those of other packages by name, the console's own
last. The first one that knows the file describes it.
"""

import json
import math
from collections.abc import Mapping, Sequence
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any, Protocol, cast

from higvf_console.channels.link import LinkErrors, split_link
from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec

GROUP = "higvf_console.inspectors"
_OWN = "higvf-console"  # name of the distribution
_NO_PICTURE = "no picture"
_LIST_WIDTH = 100  # letters; a longer list is told item by item


class Inspector(Protocol):
    """Describes a file in plain values; an entry point of the group `higvf_console.inspectors`."""

    def __call__(self, spec: InputSpec, plot: Path | None, steps: bool) -> Mapping[str, object]:
        """Format, kind, streams, samples, duration_s, rate_hz, frame, origin, valid_share, gaps, warnings, and more.

        Raises:
            InputError: it knows no such file, or the file cannot be read.
        """
        ...


def inspect(spec: InputSpec, plot: Path | None = None, steps: bool = False) -> Mapping[str, object]:
    """What the first inspector that knows `spec.source` says of it; a picture that was not written is a warning.

    Args:
        spec: the file, with the options and settings of the channel that it is to become.
        plot: where a picture goes; None = none.
        steps: whether the steps of the processing are told.

    Raises:
        InputError: no inspector is installed, or none knows the file; the message gives each one's reason.
    """
    points = sorted(entry_points(group=GROUP), key=lambda point: _rank(point, spec.channel))
    if not points:
        raise InputError(f"no inspector is installed (entry points of the group {GROUP}); install the package again")
    spec, errors = split_link(spec)
    refusals: list[str] = []
    before = _written(plot)
    for point in points:
        try:
            inspector: Inspector = point.load()
            description = inspector(spec, plot, steps)
        except InputError as refusal:
            refusals.append(str(refusal))
        except Exception as error:  # whatever another package's code raises
            refusals.append(f"inspector '{point.name}' failed: {type(error).__name__}: {error}")
        else:
            unplotted = plot is not None and _written(plot) == before
            return _warned(description, [*_unplotted(description, plot if unplotted else None), *_unlinked(errors)])
    raise InputError("; ".join(refusals))


def _rank(point: EntryPoint, channel: str) -> tuple[bool, bool, str]:
    dist = getattr(point, "dist", None)
    return point.name != channel, dist is not None and dist.name == _OWN, point.name


def _written(plot: Path | None) -> tuple[int, int] | None:
    """Size and time of a picture, which tell whether it was written; None if there is none."""
    try:
        found = None if plot is None else plot.stat()
    except OSError:
        return None
    return None if found is None else (found.st_size, found.st_mtime_ns)


def _unplotted(description: Mapping[str, object], plot: Path | None) -> list[str]:
    """That a picture was not written, where the description does not say so itself; nothing without one."""
    said = any(warning.startswith(_NO_PICTURE) for warning in _warnings(description))
    return [f"{_NO_PICTURE}: {plot} was not written"] if plot is not None and not said else []


def _unlinked(errors: LinkErrors | None) -> list[str]:
    return [f"{errors}: errors of the link, which hold in a run and are not applied here"] if errors else []


def _warnings(description: Mapping[str, object]) -> list[str]:
    return [str(warning) for warning in cast(Sequence[object], description.get("warnings") or ())]


def _warned(description: Mapping[str, object], more: Sequence[str]) -> Mapping[str, object]:
    return {**description, "warnings": [*_warnings(description), *more]} if more else description


def as_json(description: Mapping[str, object]) -> str:
    """A description as JSON; a number that is none becomes null."""
    return json.dumps(_finite(description), indent=2, ensure_ascii=False)


def as_text(description: Mapping[str, object]) -> str:
    """A description as lines of `key: value`, warnings last."""
    lines = _lines({key: value for key, value in description.items() if key != "warnings"}, 0)
    warnings = cast(Sequence[object], description.get("warnings") or ())
    return "\n".join([*lines, *(f"Warning: {warning}" for warning in warnings)])


def _lines(values: Mapping[str, object], depth: int) -> list[str]:
    """Lines of a mapping, those of a mapping in it further in; what is empty or does not apply has none."""
    lines: list[str] = []
    for key, value in values.items():
        if value in (None, {}, [], ()):
            continue
        head = "  " * depth + key.replace("_", " ") + ":"
        if isinstance(value, Mapping):
            lines += [head, *_lines(cast(Mapping[str, object], value), depth + 1)]
        elif isinstance(value, list | tuple):
            items = [_item(item) for item in cast(Sequence[object], value)]
            joined = ", ".join(items)
            short = len(joined) <= _LIST_WIDTH
            lines += [f"{head} {joined}"] if short else [head, *("  " * (depth + 1) + item for item in items)]
        else:
            lines.append(f"{head} {_item(value)}")
    return lines


def _item(value: object) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {item}" for key, item in cast(Mapping[str, object], value).items())
    return f"{value:g}" if isinstance(value, float) else str(value)


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _finite(item) for key, item in cast(Mapping[object, Any], value).items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in cast(Sequence[Any], value)]
    return None if isinstance(value, float) and not math.isfinite(value) else value
