"""What a scenario's `inputs` section says of each channel to the session, beside what it says to the interface.

inputs:
  gaze: {stale: 0.5, lost: 2, on_lost: hold, clutch: held}   # the first three are the session's
"""

from collections.abc import Mapping

from higvf_console.channels.channel_state import LOST_BY_STALE, Limits, OnLost, default_limits
from higvf_console.core.quantity import Quantity
from higvf_console.core.reading.node import Node

_KEYS = ("stale", "lost", "on_lost")
_SILENCE = Quantity("s", 0.05, 3600.0, "", "Silence of a channel.")


def read_inputs(node: Node) -> tuple[dict[str, dict[str, object]], dict[str, Limits]]:
    """Settings by interface, as the interface wants them, and the limits of each channel that is named.

    Raises:
        ScenarioError: not sections of settings, or limits that cannot be used.
    """
    settings: dict[str, dict[str, object]] = {}
    limits: dict[str, Limits] = {}
    for name, section in node.mapping().items():
        entries = section.mapping()
        settings[name] = {key: entry.value for key, entry in entries.items() if key not in _KEYS}
        limits[name] = _limits(section, entries, default_limits(name))
    return settings, limits


def written_inputs(
    settings: Mapping[str, Mapping[str, object]], limits: Mapping[str, Limits]
) -> dict[str, dict[str, object]]:
    """The section that `read_inputs` reads as these settings and limits."""
    return {name: {**settings[name], **_differing(limits[name], default_limits(name))} for name in settings}


def _differing(limits: Limits, default: Limits) -> dict[str, object]:
    if limits == default:
        return {}
    return {"stale": limits.stale, "lost": limits.lost, "on_lost": limits.on_lost.value}


def _limits(section: Node, given: Mapping[str, Node], default: Limits) -> Limits:
    stale = given["stale"].number(_SILENCE) if "stale" in given else default.stale
    lost = given["lost"].number(_SILENCE) if "lost" in given else max(default.lost, LOST_BY_STALE * stale)
    if lost <= stale:
        raise section.error(f"lost: {lost:g} s is not longer than stale, {stale:g} s")
    on_lost = OnLost(given["on_lost"].choice(tuple(OnLost))) if "on_lost" in given else default.on_lost
    return Limits(stale, lost, on_lost)
