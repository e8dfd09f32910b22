"""What the operator must always know: state, time, latest message, influenced robot, safety, inputs."""

import math
from collections.abc import Sequence
from time import monotonic
from typing import TYPE_CHECKING

import viser

from higvf_console.control.guidance.paths import point_at
from higvf_console.core.events import Event
from higvf_console.core.interface import ChannelState
from higvf_console.core.numbers import percent
from higvf_console.core.state import Motion, Path, PathKind, PathStatus, SimState
from higvf_console.sim.events import too_near
from higvf_console.ui.messages import LatestMessage, newer
from higvf_console.ui.page import page
from higvf_console.ui.run_state import run_states
from higvf_console.ui.standing import standing_text
from higvf_console.ui.ui_state import UiStore
from higvf_console.ui.widgets.channel_mark import channel_html
from higvf_console.ui.widgets.event_list import alarms_text
from higvf_console.ui.widgets.html import clock, nearness, severity_colour, text
from higvf_console.ui.widgets.speeds import nearest_speed

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot


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
        ("Steering", steering_line(snapshot.state, snapshot.setup.params.path.capture_distance)),
        ("Stands", text(standing_text(snapshot))),
        ("Safety margin", margin_line(float(snapshot.trace.clearance.min(initial=math.inf)), snapshot.min_clearance)),
        ("Safety filter", filter_line(snapshot)),
        ("Inputs", " ".join(channel_html(name, health) for name, health in snapshot.channels)),
        ("Computation", _computation(snapshot, period_ms)),
    ]
    return "".join(f"<span><i>{name}</i>{value}</span>" for name, value in facts if value)


def steering_line(state: SimState, near: float) -> str:
    """The influenced robot, and how far it has come along the path, which it is on when nearer than `near` [m]."""
    intent, motion = state.intent, state.motion
    robot = f'<span class="operator">robot {intent.influenced + 1}</span>'
    if intent.path.kind == PathKind.NONE:
        return f'{robot}, <span class="dim">no path yet</span>'
    status = {
        PathStatus.FINISHED: "path finished",
        PathStatus.BREAK_AWAY: "path left for a fire",
        PathStatus.BLOCKED: '<span class="warn">path given up</span>',
    }.get(PathStatus(motion.path_status))
    if status is None:
        x, y, *_ = point_at(intent.path, motion.path_parameter)
        away = math.dist((x, y), motion.position[intent.influenced].tolist())
        status = ("heading for its path" if away > near else "on its path") + _progress(intent.path, motion)
    return f"{robot}, {status}"


def _progress(path: Path, motion: Motion) -> str:
    """The share of an open path that is done; nothing at its start."""
    if not math.isfinite(path.length) or path.closed:
        return ""
    done = motion.path_parameter if path.direction > 0 else path.length - motion.path_parameter
    share = min(max(done / path.length, 0.0), 1.0)
    return f", {percent(share)}" if share >= 0.005 else ""


def margin_line(now: float, minimum: float) -> str:
    """The smallest margin beyond a clearance, now and in the run [m]; a violation stands out."""
    if not math.isfinite(minimum):
        return f"{nearness(minimum)} so far"
    return f'{nearness(now)}<span class="dim">, minimum</span> {nearness(minimum)}'


def _computation(snapshot: "Snapshot", period_ms: float) -> str:
    """How long a control period takes to compute, and by how much the run lags behind real time if it does."""
    line = f'{snapshot.tick_ms:.2f} <span class="dim">of {period_ms:g} ms</span>'
    if snapshot.lost_time > 0.0:
        line += f' <span class="warn">{snapshot.lost_time:.1f} s late</span>'
    return line


def filter_line(snapshot: "Snapshot") -> str:
    """Whether the safety filter finds a safe velocity for every robot, and what it has cost so far."""
    infeasible, deadlocked = int(snapshot.trace.infeasible.sum()), int(snapshot.trace.deadlocked.sum())
    if infeasible:
        now = f'<span class="alarm">{infeasible} infeasible</span>'
    elif near := int(too_near(snapshot.trace).sum()):
        now = f'<span class="alarm">{near} too near</span>'
    elif deadlocked:
        now = f'<span class="warn">{deadlocked} held by barriers</span>'
    else:
        now = "OK"
    past: list[str] = []
    if snapshot.infeasible_ticks:
        past.append(f"{snapshot.infeasible_ticks} ticks infeasible")
    if snapshot.deadlock_s > 0.0:
        past.append(f"robots held for {snapshot.deadlock_s:.1f} s")
    return now + (f' <span class="dim">({", ".join(past)})</span>' if past else "")
