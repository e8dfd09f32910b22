"""What the operator must always know: time, mode, who is influenced, inputs, clearance, filter, tick time."""

import math
from typing import TYPE_CHECKING

import viser

from higvf_console.core.commands import Acknowledge
from higvf_console.core.interface import ChannelHealth, ChannelState, PointerSink
from higvf_console.core.state import PathKind, PathStatus, SimState
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

    def cleanup(self) -> None:
        """Removes the panel."""
        self._acknowledge.remove()
        self._html.remove()


def modes_of(state: SimState, phase: Phase, frozen: bool) -> list[tuple[str, str]]:
    """All modes that hold, each in one word with its colour: that of the team, then that of the clock."""
    team = ("STOPPED", CSS.alarm) if state.intent.stopped else ("PAUSED", CSS.warning)
    modes: list[tuple[str, str]] = [team] if state.intent.stopped or state.intent.paused else []
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
        ("Operator", operator_line(snapshot.state)),
        ("Clearance", clearance_line(float(snapshot.trace.clearance.min(initial=math.inf)), snapshot.min_clearance)),
        ("Filter", filter_line(snapshot)),
        ("Tick", f'{snapshot.tick_ms:.2f} ms <span class="dim">of {period_ms:g} ms</span>'),
    ]
    standing = text(standing_text(snapshot)) or f'<span class="dim">{DASH}</span>'
    rows.insert(1, ("Stands", f'<div style="min-height: 3em">{standing}</div>'))  # two lines, so that nothing jumps
    if snapshot.channels:
        rows.append(("Inputs", " ".join(channel_html(name, health) for name, health in snapshot.channels)))
    lines = "".join(f"<dt>{name}</dt><dd>{value}</dd>" for name, value in rows)
    return block(f"{head}<dl>{lines}</dl>")


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
