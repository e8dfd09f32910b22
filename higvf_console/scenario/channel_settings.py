"""The `inputs` section of a scenario: settings for each interface, and the session's limits of each channel.

inputs:
  gaze: {stale: 0.5, lost: 2, on_lost: hold, clutch: held}   # the first three are the session's
"""

from collections.abc import Mapping

from higvf_console.channels.channel_state import GivenLimits, OnLost
from higvf_console.core.interface import current_channel, renamed_channel
from higvf_console.core.quantity import Quantity
from higvf_console.core.reading.node import Node

_KEYS = ("stale", "lost", "on_lost")
_SILENCE = Quantity("s", 0.05, 3600.0, "", "Silence of a channel.")


def read_inputs(node: Node) -> tuple[dict[str, dict[str, object]], dict[str, GivenLimits]]:
    """Settings by interface, without the session's keys, and the limits given for each of these channels.

    A channel's former name is read with a warning.

    Raises:
        ScenarioError: an entry is no mapping of settings, its limits cannot be used, or a channel has both its names.
    """
    settings: dict[str, dict[str, object]] = {}
    limits: dict[str, GivenLimits] = {}
    for given, section in node.mapping().items():
        name, entries = current_channel(given), section.mapping()
        if name in settings:
            raise section.error(f"channel '{name}' is given twice, also under its former name; remove one")
        if warning := renamed_channel(given):
            node.warnings.append(f"{section.where}: {warning}")
        settings[name] = {key: entry.value for key, entry in entries.items() if key not in _KEYS}
        limits[name] = _limits(section, entries)
    return settings, limits


def written_inputs(
    settings: Mapping[str, Mapping[str, object]], limits: Mapping[str, GivenLimits]
) -> dict[str, dict[str, object]]:
    """The section that `read_inputs` reads as these settings and limits."""
    return {name: {**settings[name], **_said(limits[name])} for name in settings}


def _said(limits: GivenLimits) -> dict[str, object]:
    said = {"stale": limits.stale, "lost": limits.lost, "on_lost": limits.on_lost.value}
    return {key: value for key, value in said.items() if value is not None and value != OnLost.AUTONOMY.value}


def _limits(section: Node, given: Mapping[str, Node]) -> GivenLimits:
    stale = given["stale"].number(_SILENCE) if "stale" in given else None
    lost = given["lost"].number(_SILENCE) if "lost" in given else None
    if stale is not None and lost is not None and lost <= stale:
        raise section.error(f"lost: {lost:g} s is not longer than stale, {stale:g} s")
    on_lost = OnLost(given["on_lost"].choice(tuple(OnLost))) if "on_lost" in given else OnLost.AUTONOMY
    return GivenLimits(stale, lost, on_lost)
