"""What teams and sources of poses are installed, with their options, and what a network shows of robots."""

from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import EntryPoint, entry_points, version
from typing import Any, NamedTuple, get_args, get_type_hints

from higvf_console.core.errors import InputError
from higvf_console.core.quantity import Quantity
from higvf_console.core.team import Heard, TeamSpec
from higvf_console.team.opening import BUILT_IN, POSE_SOURCES, TEAMS, team_names

_OWN = "higvf-console"  # name of the distribution


class OptionDescription(NamedTuple):
    """An option: what it may be, what it is if it is not given, one sentence."""

    name: str
    choices: str
    default: str
    text: str


class Installed(NamedTuple):
    """A team or a source of poses; `options` None = its package does not tell, `problem` "" = it loads."""

    name: str
    package: str
    options: tuple[OptionDescription, ...] | None
    problem: str = ""


def installed_teams() -> tuple[Installed, ...]:
    """The teams by name, the built-in one among them."""
    built_in = [
        Installed(name, f"{_OWN} {version(_OWN)}", described_options(opener)) for name, opener in BUILT_IN.items()
    ]
    found = [_installed(point) for point in entry_points(group=TEAMS) if point.name not in BUILT_IN]
    return tuple(sorted([*built_in, *found], key=lambda one: one.name))


def installed_pose_sources() -> tuple[Installed, ...]:
    """The sources of poses by name."""
    found = [_installed(point) for point in entry_points(group=POSE_SOURCES)]
    return tuple(sorted(found, key=lambda one: one.name))


def described_options(opener: object) -> tuple[OptionDescription, ...] | None:
    """The options that an opener tells by its attribute `options`, a NamedTuple; None = it tells none."""
    kind = getattr(opener, "options", None)
    return None if kind is None else options_described(kind)


def options_described(kind: Any) -> tuple[OptionDescription, ...]:
    """The fields of a NamedTuple of options."""
    hints: Mapping[str, Any] = get_type_hints(kind, include_extras=True)
    defaults: Mapping[str, Any] = kind._field_defaults
    described: list[OptionDescription] = []
    for name in kind._fields:
        choices, text = "text", ""
        for extra in get_args(hints[name])[1:]:
            if isinstance(extra, Quantity):
                choices, text = f"{extra.low:g} to {extra.high:g} {extra.unit}".rstrip(), extra.text
            elif isinstance(extra, str):
                text = extra
        default = defaults.get(name, "")
        shown = f"{default:g}" if isinstance(default, int | float) else str(default)
        described.append(OptionDescription(name, choices, shown, text))
    return tuple(described)


def heard_robots(spec: TeamSpec, seconds: float) -> Sequence[Heard]:
    """The robots that the network of a team shows.

    Raises:
        InputError: there is no such team, it cannot be asked, or its address or options cannot be used.
    """
    opener = BUILT_IN.get(spec.name)
    if opener is None:
        points = {point.name: point for point in entry_points(group=TEAMS)}
        if spec.name not in points:
            raise InputError(f"no team '{spec.name}'; installed: {', '.join(team_names())}")
        try:
            opener = points[spec.name].load()
        except Exception as error:  # whatever there is in a package's module
            raise InputError(f"team '{spec.name}' ({points[spec.name].value}) does not load: {error}") from error
    listen: Callable[[TeamSpec, float], Sequence[Heard]] | None = getattr(opener, "heard", None)
    if listen is None:
        raise InputError(f"team '{spec.name}' cannot tell which robots there are; leave the address out")
    return listen(spec, seconds)


def _installed(point: EntryPoint) -> Installed:
    dist = getattr(point, "dist", None)
    package = "" if dist is None else f"{dist.name} {dist.version}"
    try:
        return Installed(point.name, package, described_options(point.load()))
    except Exception as error:  # whatever there is in a package's module
        return Installed(point.name, package, None, f"does not load: {error}")
