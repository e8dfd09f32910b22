"""Teams and sources of poses, found by entry point or built in."""

from collections.abc import Callable, Mapping
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from higvf_console.core.errors import HigvfError, InputError, closest
from higvf_console.core.team import PoseSource, Team, TeamSpec
from higvf_console.team.simulated import SimulatedTeam

TEAMS, POSE_SOURCES = "higvf_console.teams", "higvf_console.pose_sources"
BUILT_IN: Mapping[str, Callable[[TeamSpec], Team]] = {SimulatedTeam.name: SimulatedTeam}


class TeamCrashedError(InputError):
    """A team failed to open where it should have refused its address or options with `InputError`."""


def team_names() -> tuple[str, ...]:
    """Names of the teams: the built-in one and those that are installed."""
    return tuple(sorted({*BUILT_IN, *(point.name for point in entry_points(group=TEAMS))}))


def pose_source_names() -> tuple[str, ...]:
    """Names of the sources of poses that are installed."""
    return tuple(sorted(point.name for point in entry_points(group=POSE_SOURCES)))


def open_team(spec: TeamSpec) -> Team:
    """Opens a team.

    Raises:
        InputError: no such team is installed, it cannot be imported, or its address or options cannot be used.
        TeamCrashedError: it raised something else while it opened, or offers what is no team.
    """
    if spec.name in BUILT_IN:
        return BUILT_IN[spec.name](spec)
    return _opened(spec, TEAMS, "team", team_names(), ("poses", "drive", "stop", "links", "close"))


def open_poses(spec: TeamSpec) -> PoseSource:
    """Opens a source of poses; errors as of `open_team`."""
    return _opened(spec, POSE_SOURCES, "source of poses", pose_source_names(), ("poses", "close"))


def _opened(spec: TeamSpec, group: str, word: str, names: tuple[str, ...], functions: tuple[str, ...]) -> Any:
    points: Mapping[str, EntryPoint] = {point.name: point for point in entry_points(group=group)}
    if spec.name not in points:
        raise InputError(f"no {word} '{spec.name}'{closest(spec.name, names)}; installed: {', '.join(names) or 'none'}")
    try:
        opener: Any = points[spec.name].load()
    except Exception as error:  # whatever there is in a package's module
        raise InputError(f"{word} '{spec.name}' ({points[spec.name].value}) does not load: {error}") from error
    try:
        found = opener(spec)
    except HigvfError:
        raise
    except Exception as error:  # as above
        raise TeamCrashedError(f"{word} '{spec.name}' does not open: {type(error).__name__}: {error}") from error
    if missing := [name for name in functions if not callable(getattr(found, name, None))]:
        raise TeamCrashedError(f"{word} '{spec.name}' opens as {found!r:.60}, without {', '.join(missing)}")
    return found
