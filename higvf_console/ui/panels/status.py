"""What the operator must always know: state, time, latest message, who is influenced, clearance, filter, inputs."""

import math
from collections.abc import Sequence
from time import monotonic
from typing import TYPE_CHECKING

import viser

from higvf_console.core.events import Event
from higvf_console.core.interface import ChannelHealth, ChannelState
from higvf_console.core.state import PathKind, PathStatus, SimState
from higvf_console.sim.events import too_near
from higvf_console.ui.page import page
from higvf_console.ui.panels.log import alarms_text
from higvf_console.ui.panels.messages import LatestMessage, newer
from higvf_console.ui.panels.run import nearest_speed
from higvf_console.ui.panels.widgets.html import clock, nearness, severity_colour, text
from higvf_console.ui.run_state import run_states
from higvf_console.ui.theme import CSS
from higvf_console.ui.ui_state import UiStore

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

# Shape and word tell the state; the colour only repeats it.
CHANNEL_MARK = {
    ChannelState.NEVER_SEEN: ("\u25cb", CSS.scorched_text),  # circle
    ChannelState.LIVE: ("\u25cf", CSS.fighting),  # disc
    ChannelState.STALE: ("\u25d0", CSS.warning),  # half a disc
    ChannelState.LOST: ("\u2715", CSS.alarm),  # cross
    ChannelState.RECOVERED: ("\u25b2", CSS.warning),  # triangle
    ChannelState.ENDED: ("\u25a0", CSS.scorched_text),  # square
}


class StatusStrip:
    """Feeds the strip over the arena: what it shows is sent when it reads differently."""

    def __init__(self, server: viser.ViserServer, control_period: float, ui: UiStore) -> None:
        """Shows nothing before `update`."""
        self._server, self._ui = server, ui
        self._period_ms = 1e3 * control_period
        self._message = LatestMessage()
        self._newest: Event | None = None
        self._shown: dict[str, object] = {}

    def update(self, snapshot: "Snapshot") -> None:
        """Shows a snapshot."""
        fresh = newer(snapshot.events, self._newest)
        if fresh:
            self._newest = fresh[-1]
        standing = self._ui.state.alarms
        message = self._message.chosen(fresh, standing, monotonic())
        parts = {
            "clock": clock(snapshot.time),
            "run": run_view(snapshot),
            "facts": facts_html(snapshot, self._period_ms),
            "alarms": alarms_text(len(standing)) if standing else "",
            "message": message_view(message, snapshot, standing),
            "returned": [name for name, health in snapshot.channels if health.state is ChannelState.RECOVERED],
        }
        for method, view in parts.items():
            if self._shown.get(method) != view:
                self._shown[method] = view
                page.call(self._server, "strip", method, view)

    def cleanup(self) -> None:
        """There is no widget to remove."""


def run_view(snapshot: "Snapshot") -> page.Body:
    """States and speed, and which buttons of the run mean what, as the strip shows them."""
    intent = snapshot.state.intent
    return {
        "states": [state._asdict() for state in run_states(snapshot)],
        "speed": nearest_speed(snapshot.speed),
        "paused": intent.paused,
        "stopped": intent.stopped,
        "frozen": snapshot.frozen,
    }


def message_view(message: Event | None, snapshot: "Snapshot", standing: Sequence[Event] = ()) -> page.Body:
    """The latest message, or what the state of the run means, as the strip shows it; `unread` while it stands."""
    if message is None:
        state = run_states(snapshot)[0]
        return {"time": "", "text": state.text, "colour": f"var(--hg-{state.colour})", "unread": False}
    return {
        "time": clock(message.time),
        "text": message.text,
        "colour": severity_colour(message.severity),
        "unread": any(message is alarm for alarm in standing),
    }


def facts_html(snapshot: "Snapshot", period_ms: float) -> str:
    """What the operator must always know of the team and the inputs."""
    facts = [
        ("Operator", operator_line(snapshot.state)),
        ("Clearance", clearance_line(float(snapshot.trace.clearance.min(initial=math.inf)), snapshot.min_clearance)),
        ("Filter", filter_line(snapshot)),
        ("Inputs", " ".join(channel_html(name, health) for name, health in snapshot.channels)),
        ("Tick", f'{snapshot.tick_ms:.2f} ms <span class="dim">of {period_ms:g} ms</span>'),
    ]
    return "".join(f"<span><i>{name}</i>{value}</span>" for name, value in facts if value)


def operator_line(state: SimState) -> str:
    """Whom the operator influences, and how far the path has come."""
    intent, motion = state.intent, state.motion
    robot = f'<span class="operator">robot {intent.influenced + 1}</span>'
    if intent.path.kind == PathKind.NONE:
        return f'{robot} <span class="dim">no path yet</span>'
    status = {
        PathStatus.FINISHED: "path finished",
        PathStatus.BREAK_AWAY: "path left for a fire",
        PathStatus.BLOCKED: '<span class="warn">path given up</span>',
    }.get(PathStatus(motion.path_status))
    if status is None and math.isfinite(intent.path.length) and not intent.path.closed:
        done = motion.path_parameter if intent.path.direction > 0 else intent.path.length - motion.path_parameter
        status = f"on its path, {min(max(done / intent.path.length, 0.0), 1.0):.0%}"
    return f"{robot} {status or 'on its path'}"


def clearance_line(now: float, least: float) -> str:
    """The smallest distance to anything, now and in the run; a violation stands out."""
    if not math.isfinite(least):
        return f"{nearness(least)} so far"
    return f'{nearness(now)} <span class="dim">now,</span> {nearness(least)} <span class="dim">least</span>'


def filter_line(snapshot: "Snapshot") -> str:
    """Whether the safety filter finds a velocity for everybody."""
    infeasible, deadlocked = int(snapshot.trace.infeasible.sum()), int(snapshot.trace.deadlocked.sum())
    if infeasible:
        now = f'<span class="alarm">{infeasible} infeasible</span>'
    elif near := int(too_near(snapshot.trace).sum()):
        now = f'<span class="alarm">{near} too near</span>'
    elif deadlocked:
        now = f'<span class="warn">{deadlocked} held by barriers</span>'
    else:
        now = "all constraints met"
    past: list[str] = []
    if snapshot.infeasible_ticks:
        past.append(f"{snapshot.infeasible_ticks} ticks infeasible")
    if snapshot.deadlock_s > 0.0:
        past.append(f"{snapshot.deadlock_s:.1f} s held")
    return now + (f' <span class="dim">{", ".join(past)}</span>' if past else "")


def channel_html(name: str, health: ChannelHealth) -> str:
    """One input: a mark whose shape and colour tell its state, its name, and the state in words unless it is live."""
    mark, colour = CHANNEL_MARK[health.state]
    grave = health.state in (ChannelState.LOST, ChannelState.RECOVERED)
    word = f' <span class="{"alarm" if grave else "dim"}">{text(health.state.value)}</span>'
    return (
        f'<span class="channel" title="{text(health.detail)}"><span class="mark" style="color:{colour}">{mark}</span>'
        f"{text(name)}{'' if health.state is ChannelState.LIVE else word}</span>"
    )
