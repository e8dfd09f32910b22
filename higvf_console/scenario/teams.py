"""The `teams` section of a scenario: options of `--team NAME` and `--poses NAME`, which the command line overrides.

teams:
  simulated: {latency_s: 0.1, noise_m: 0.002, loss: 0.05}
"""

from collections.abc import Mapping

from higvf_console.core.errors import closest
from higvf_console.core.reading.node import Node
from higvf_console.team.opening import pose_source_names, team_names


def read_teams(node: Node) -> dict[str, dict[str, str]]:
    """Options by the name of a team or of a source of poses, each as text; `runtime.teams` checks what they mean.

    Raises:
        ScenarioError: an entry is no mapping of options, or an option is neither text nor a number.
    """
    return {
        str(name): {str(key): _option(value) for key, value in section.mapping().items()}
        for name, section in node.mapping().items()
    }


def _option(node: Node) -> str:
    if isinstance(node.value, bool) or not isinstance(node.value, str | int | float):
        raise node.wrong("a text or a number")
    return str(node.value)


def unknown_teams(teams: Mapping[str, Mapping[str, str]]) -> tuple[str, ...]:
    """A warning for each name that is neither a team nor a source of poses."""
    known = (*team_names(), *pose_source_names()) if teams else ()
    return tuple(
        f"teams.{name}: no such team or source of poses is installed{closest(name, known)}; installed: "
        f"{', '.join(known)}"
        for name in teams
        if name not in known
    )


def written_teams(teams: Mapping[str, Mapping[str, str]]) -> dict[str, dict[str, str]]:
    """The section that `read_teams` reads as these options."""
    return {name: dict(options) for name, options in teams.items()}
