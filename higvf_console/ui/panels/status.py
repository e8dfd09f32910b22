"""What the operator must always know: time, mode, influenced robot, inputs, safety margin, filter, computation."""

import math
from typing import TYPE_CHECKING

import viser

from higvf_console.control.guidance.paths import point_at
from higvf_console.core.commands import Acknowledge
from higvf_console.core.interface import ChannelHealth, ChannelState, PointerSink
from higvf_console.core.state import Motion, Path, PathKind, PathStatus, SimState
from higvf_console.runtime.phase import Phase
from higvf_console.sim.events import too_near
from higvf_console.ui.panels.log import alarms_text
from higvf_console.ui.panels.standing import standing_text
from higvf_console.ui.panels.widgets.callbacks import reaction
from higvf_console.ui.panels.widgets.html import DASH, TIMES, block, clock, nearness, text
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


class StatusPanel:
    """A few lines of HTML, renewed when they read differently."""

    def __init__(self, gui: viser.GuiApi, control_period: float, sink: PointerSink, ui: UiStore) -> None:
        """Starts empty; what the operator acknowledges goes to `sink`."""
        self._ui = ui
        self._period_ms = 1e3 * control_period
        self._html = gui.add_html("")
        self._acknowledge = gui.add_button(
            "Acknowledge",
            icon=viser.Icon.CHECK,
            color="yellow",
            hint="Use the inputs again that were lost and are back",
        )
        self._acknowledge.visible = False
        self._acknowledge.on_click(reaction(lambda _: sink.push(Acknowledge())))

    def update(self, snapshot: "Snapshot") -> None:
        """Shows a snapshot."""
        self._html.content = status_html(snapshot, self._period_ms, len(self._ui.state.alarms))
        back = [name for name, health in snapshot.channels if health.state is ChannelState.RECOVERED]
        self._acknowledge.visible = bool(back)
        if back:
            self._acknowledge.label = f"Acknowledge: {', '.join(back)}"


def modes_of(state: SimState, phase: Phase, frozen: bool) -> list[tuple[str, str]]:
    """All modes that hold, each in one word with its colour: that of the team, then that of the clock."""
    team = ("STOPPED", CSS.alarm) if state.intent.stopped else ("PAUSED", CSS.warning)
    modes = [team] if state.intent.stopped or state.intent.paused else []
    if phase in (Phase.READY, Phase.ENDED):
        modes.append((phase.value.upper(), CSS.robot))
    if frozen:
        modes.append(("FROZEN", CSS.robot))
    return modes or [("RUNNING", CSS.progress)]


def status_html(snapshot: "Snapshot", period_ms: float, unread: int = 0) -> str:
    """The status lines, and the count of alarms that nobody has acknowledged."""
    modes = "".join(
        f'<span class="mode" style="background:{colour}">{mode}</span>'
        for mode, colour in modes_of(snapshot.state, snapshot.phase.phase, snapshot.frozen)
    )
    alarms = f'<span class="unseen" title="Acknowledge them under Log">{alarms_text(unread)}</span>' if unread else ""
    head = (
        f'<div class="head">{modes}<span class="clock">{clock(snapshot.time)}</span>{alarms}'
        f'<span class="speed">{snapshot.speed:g}{TIMES}</span></div>'
    )
    rows = [
        ("Steering", steering_line(snapshot.state, snapshot.setup.params.path.capture_distance)),
        ("Safety margin", margin_line(float(snapshot.trace.clearance.min(initial=math.inf)), snapshot.min_clearance)),
        ("Safety filter", filter_line(snapshot)),
        ("Computation", _computation(snapshot, period_ms)),
    ]
    standing = text(standing_text(snapshot)) or f'<span class="dim">{DASH}</span>'
    rows.insert(1, ("Stands", f'<div style="min-height: 3em">{standing}</div>'))  # two lines, so that nothing jumps
    if snapshot.channels:
        rows.append(("Inputs", " ".join(channel_html(name, health) for name, health in snapshot.channels)))
    lines = "".join(f"<dt>{name}</dt><dd>{value}</dd>" for name, value in rows)
    return block(f"{head}<dl>{lines}</dl>")


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
    return f", {share:.0%}" if share >= 0.005 else ""


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


def channel_html(name: str, health: ChannelHealth) -> str:
    """One input: a mark whose shape and colour tell its state, its name, and the state in words unless it is live."""
    mark, colour = CHANNEL_MARK[health.state]
    grave = health.state in (ChannelState.LOST, ChannelState.RECOVERED)
    word = f' <span class="{"alarm" if grave else "dim"}">{text(health.state.value)}</span>'
    return (
        f'<span class="channel" title="{text(health.detail)}"><span class="mark" style="color:{colour}">{mark}</span>'
        f"{text(name)}{'' if health.state is ChannelState.LIVE else word}</span>"
    )
