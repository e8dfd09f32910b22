"""Before a run: what the mission is, what the operator sees and the robots do not, and when the run ends."""

import math
from typing import TYPE_CHECKING

import numpy as np

from higvf_console.analysis.sight import hider_names, sights
from higvf_console.scenario.ends import EndWhen
from higvf_console.scenario.scenario import Scenario
from higvf_console.ui.widgets.html import clock, text

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot


def hidden_lines(snapshot: "Snapshot") -> list[str]:
    """What is to be seen from above and not from where the robots are, one sentence each."""
    setup, motion, value = snapshot.setup, snapshot.state.motion, snapshot.trace.fire_value
    lines = list[str]()
    for fire in np.flatnonzero(motion.fire_burning).tolist():
        blind = np.flatnonzero(value[:, fire] <= 0.0).tolist()
        if len(blind) == len(value):
            lines.append(f"No robot sees fire {fire + 1}{_why_hidden(snapshot, fire)}.")
        elif blind:
            lines.append(f"{len(blind)} of {len(value)} robots do not see fire {fire + 1}.")
    reach = setup.params.perception.perception_range
    if len(motion.fire_burning) and math.isfinite(reach):
        lines.append(f"Robots see fires up to {reach:g} m away.")
    if setup.world.mover.size:
        lines.append("Robots know where moving obstacles are now, not where they will be.")
    return lines


def _why_hidden(snapshot: "Snapshot", fire: int) -> str:
    """What hides a fire from the robot that is nearest to it."""
    gap = np.hypot(*(snapshot.state.motion.position - snapshot.setup.world.fire_position[fire]).T)
    seen = {sight.fire: sight for sight in sights(int(gap.argmin()), snapshot.last, snapshot.setup)}
    if fire not in seen:
        return ""
    if not seen[fire].in_range:
        return ": it is too far away"
    names = hider_names(seen[fire], snapshot.setup)
    return f": {names[0]} hides it" if names else ""


def mission_lines(snapshot: "Snapshot") -> list[str]:
    """What the team does by itself, and when the run ends."""
    setup, fires = snapshot.setup, int(snapshot.state.motion.fire_burning.sum())
    lines = list[str]()
    if fires:
        needs = np.unique(setup.world.fire_needs[snapshot.state.motion.fire_burning]).tolist()
        crew = f"{needs[0]}" if len(needs) == 1 else f"{needs[0]} to {needs[-1]}"
        each = "it takes" if fires == 1 else "each takes"
        lines.append(
            f"{_count(fires, 'fire')} to put out; {each} {crew} of {_count(len(setup.layout.formation), 'robot')}."
        )
    if setup.params.fires.start_delay > 0.0 and fires:
        lines.append(f"The team sets out {setup.params.fires.start_delay:g} s after the start.")
    if snapshot.team is not None and not snapshot.team.armed:
        lines.append("The team is not armed: no robot drives before you arm it in the tab Team.")
    lines.append(end_line(snapshot.scenario, fires > 0))
    return lines


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def end_line(scenario: Scenario, fires: bool) -> str:
    """When the run ends, in one sentence."""
    ends, limit = scenario.ends, f"after {clock(scenario.duration)}"
    when = f"{ends.after:g} s after" if ends.after > 0.0 else "when"
    if ends.when is EndWhen.NEVER:
        return "The run has no end: take your time."
    if ends.when is EndWhen.PATH_FINISHED:
        return f"The run ends {when} the path is finished, or {limit}."
    return f"The run ends {when} all fires are out, or {limit}." if fires else f"The run ends {limit}."


def ready_html(snapshot: "Snapshot", note: str = "") -> str:
    """The card of a run that waits for its start; `note` is HTML above it."""
    scenario = snapshot.scenario
    told = "".join(f"<p>{text(part)}</p>" for part in (scenario.description, scenario.briefing) if part)
    mission = "".join(f"<li>{text(line)}</li>" for line in mission_lines(snapshot))
    hidden = "".join(f"<li>{text(line)}</li>" for line in hidden_lines(snapshot))
    if not hidden and snapshot.state.motion.fire_burning.any():
        hidden = "<li>Every robot sees every fire now; obstacles may hide some on the way.</li>"
    sees = f'<div class="sees"><h3>You see what the robots do not</h3><ul>{hidden}</ul></div>' if hidden else ""
    return (
        f'<header><h2>Ready: {text(scenario.title)}</h2><button class="fold" data-fold></button></header>'
        f'<div class="body">{note}{told}<ul>{mission}</ul>{sees}</div>'
        '<footer><button class="act first" data-act="start">Start</button>'
        '<button class="act" data-act="scenarios">Other scenario …</button></footer>'
    )
