"""The session's watch over its channels: who may command, who has gone silent, and what is done about it.

A channel that is lost, or back and not yet acknowledged, may stop and pause the team and move the cursor, nothing else.
If it was steering when it, or the page that had control, was lost, commands of the session end that, and the
priorities that it gave: they are recorded like any other, so that a replay agrees. After `NextTask` v_h = 0, and the
shared intention, dv_s/dt = w1 v_t - (w0 + w1) v_s + neighbours, leaves the human's for the robots' own with time
constant 1 / (w0 + w1), 0.13 s by default, and no velocity jumps. A team that has no task of its own, and one that is to
hold, stands from the next control period on.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from higvf_console.channels.attribution import Attribution, attributed
from higvf_console.channels.channel_state import (
    OUT_OF_SERVICE,
    GivenLimits,
    Limits,
    OnLost,
    acknowledged,
    judged,
    limits_of,
    observed,
)
from higvf_console.channels.channels import Channels
from higvf_console.channels.faults import Line, problem
from higvf_console.core.arrays import Ints
from higvf_console.core.command import SESSION
from higvf_console.core.commands import (
    Acknowledge,
    Clutch,
    ControlChange,
    Cursor,
    EmergencyStop,
    HandOver,
    InjectFault,
    NextTask,
    OperatorCommand,
    Pause,
    Prioritise,
    ResetRun,
    Resume,
    StrokeCancel,
)
from higvf_console.core.events import Event, Severity
from higvf_console.core.interface import ChannelHealth, ChannelState, OperatorContext, current_channel, renamed_channel
from higvf_console.core.state import ACTING, SimState

_OUTCOME = {
    OnLost.AUTONOMY: "The team goes on with its own task.",
    OnLost.HOLD: "The team holds.",
    OnLost.KEEP: "Its path stays in force.",
}


class Said(NamedTuple):
    """A command and the channel that it came by."""

    channel: str
    command: OperatorCommand


class Supervisor:
    """Polls the interfaces through their lines and keeps the state of each channel.

    Attributes:
        health: how each channel is, as last watched.
        limits: of each channel, by name; replaced as a whole.
    """

    limits: Mapping[str, Limits]

    def __init__(self, channels: Channels, limits: Mapping[str, GivenLimits]) -> None:
        """Starts with every channel as it says itself.

        Args:
            channels: the interfaces.
            limits: what the scenario says of the channels that it names; the others have their own.
        """
        self._channels = channels
        self.limit(limits)
        self._forget()
        self.watch(0.0, None)

    def limit(self, limits: Mapping[str, GivenLimits]) -> None:
        """Another scenario has other limits; the channels that it does not name have their own."""
        offered = self._channels.capabilities
        self.limits = {name: limits_of(limits.get(name, GivenLimits()), offered[name].stale_after) for name in offered}

    def poll(self, context: OperatorContext) -> tuple[list[Said], tuple[Event, ...]]:
        """The commands that count now, and what there is to say of the rest."""
        given, events = self._channels.poll(context)
        jumped, self._clock_jumped = self._clock_jumped, False
        said: list[Said] = []
        for name in self._channels.names:
            for command in self._lines[name].carry(given.get(name, ()), context.time):
                if jumped and self._replays(name) and not isinstance(command, EmergencyStop):
                    continue  # it was given, and done, before the run was set back
                if self._may(name, command):
                    said.append(Said(name, command))
                else:
                    self._withheld[name] = self._withheld.get(name, 0) + 1
        return said, tuple(events)

    def applied(
        self, said: Said, time: float, before: SimState, after: SimState, rows: tuple[Ints, Ints] | None = None
    ) -> tuple[Event, ...]:
        """Takes note of a command applied at session `time` [s]: who steers, what the operator has acknowledged.

        Args:
            said: what was applied.
            time: now.
            before: the state before it.
            after: the state after it.
            rows: (N,), (M,) row before of each robot and each fire after it; None = as they were.
        """
        channel, command = said
        self._attribution = attributed(self._attribution, channel, command, before, after, rows)
        self._clock_jumped |= after.motion.tick > before.motion.tick
        match command:
            case Acknowledge(channel=name):
                return self._acknowledge(name, time)
            case InjectFault():
                return self._inject(command, time)
            case Resume() if not after.intent.paused:
                return self._take_back([name for name in self._states if name != channel], time)
            case ResetRun():
                self._forget()
            case HandOver(how=ControlChange.LOST):
                self._deserted = channel
            case _:
                pass
        by_hand = self._by_hand(channel) and not isinstance(command, Cursor | EmergencyStop | Pause | HandOver)
        if by_hand:
            return self._take_back([channel], time)
        return ()

    def watch(self, now: float, state: SimState | None) -> tuple[list[OperatorCommand], tuple[Event, ...]]:
        """Looks after every channel at session time `now` [s]; what must be done and said where one has changed."""
        commands: list[OperatorCommand] = []
        events: list[Event] = []
        health: list[tuple[str, ChannelHealth]] = []
        for name, own in self._channels.health(now):
            seen = self._lines[name].seen(own, now)
            was = self._states.get(name)
            here = judged(seen, now, self.limits[name])
            self._states[name] = become = here if was is None else observed(was, here)
            health.append((name, seen._replace(state=become, detail=self._detail(name, seen, now))))
            lost = was is not None and was is not become and become is ChannelState.LOST
            done = self._end_steering(name, now, state) if state and (lost or name == self._deserted) else []
            commands += done
            if was is None or was is become:
                continue
            events += self._report(name, was, become, seen, now, bool(done))
        self.health, self._deserted = tuple(health), ""
        return commands, tuple(events)

    def _forget(self) -> None:
        """Starts like new, because the run has."""
        self._states: dict[str, ChannelState] = {}
        self._lines = {name: Line() for name in self._channels.names}
        self._withheld: dict[str, int] = {}
        self._attribution = Attribution()
        self._clock_jumped = False  # whether an undo has just put the clock forward
        self._deserted = ""  # the channel of which the page that had control is lost

    def _replays(self, name: str) -> bool:
        """Whether a channel follows the session clock."""
        live = self._channels.capabilities[name].takes_pointer
        return not live and all(health.last_seen is None for channel, health in self.health if channel == name)

    def _by_hand(self, name: str) -> bool:
        """Whether a channel's own commands acknowledge that it is back; the session's own have no channel."""
        return name in self._channels.capabilities and self._channels.capabilities[name].self_acknowledging

    def _may(self, name: str, command: OperatorCommand) -> bool:
        if self._states.get(name) not in OUT_OF_SERVICE:
            return True
        by_hand = self._by_hand(name) and self._states[name] is ChannelState.RECOVERED
        return by_hand or isinstance(command, EmergencyStop | Pause | Cursor | Acknowledge | InjectFault | HandOver)

    def _end_steering(self, name: str, now: float, state: SimState) -> list[OperatorCommand]:
        """What ends the steering of a channel that is lost; nothing where it was not steering."""
        done: list[OperatorCommand] = []
        if state.pointer_state.stroke_source == name:
            done.append(StrokeCancel(time=now, source=SESSION))
        if self._attribution.clutch == name and state.pointer_state.clutch:
            done += [StrokeCancel(time=now, source=SESSION)] if not done and state.pointer_state.stroke_source else []
            done.append(Clutch(closed=False, time=now, source=SESSION))
        following = state.motion.path_status in ACTING
        on_path = self._attribution.path == name and following
        favoured = self._attribution.robots(name)
        on_lost = self.limits[name].on_lost
        if on_lost is OnLost.AUTONOMY:
            done += [NextTask(time=now, source=SESSION)] if on_path else []
            done += [Prioritise(robot=robot, time=now, source=SESSION) for robot in favoured]
        if on_lost is OnLost.HOLD and (done or on_path or favoured) and not state.intent.paused:
            done.append(Pause(time=now, source=SESSION))
        return done

    def _acknowledge(self, given: str, time: float) -> tuple[Event, ...]:
        name = current_channel(given)
        names = [name] if name else list(self._states)
        events = self._take_back(names, time)
        if events:
            return events
        waiting = f"Input '{name}' does not wait" if name else "No input waits"
        return (Event(time, Severity.WARNING, "refused", f"{waiting} to be acknowledged.", channel=name),)

    def _take_back(self, names: list[str], time: float) -> tuple[Event, ...]:
        events: list[Event] = []
        for name in names:
            was = self._states.get(name)
            if was is ChannelState.RECOVERED:
                self._states[name] = acknowledged(was)
                withheld = self._withheld.pop(name, 0)
                text = f"Input '{name}' is used again; {withheld} of its commands were withheld."
                events.append(Event(time, Severity.INFO, "channel", text, channel=name))
        return tuple(events)

    def _inject(self, fault: InjectFault, time: float) -> tuple[Event, ...]:
        wrong, renamed = problem(fault), renamed_channel(fault.channel)
        fault = replace(fault, channel=current_channel(fault.channel))
        if fault.channel not in self._lines:
            wrong = f"there is no input '{fault.channel}'; inputs: {', '.join(self._lines) or 'none'}"
        if wrong:
            text = f"No fault injected: {wrong}."
            return (Event(time, Severity.WARNING, "refused", text, channel=fault.channel),)
        self._lines[fault.channel].inject(fault, time)
        text = f"Fault injected: {fault.kind} of input '{fault.channel}' for {fault.seconds:g} s."
        text += f" The {renamed}." if renamed else ""
        return (Event(time, Severity.WARNING, "channel", text, channel=fault.channel),)

    def _detail(self, name: str, seen: ChannelHealth, now: float) -> str:
        quiet = f"last seen {max(0.0, now - seen.last_seen):.1f} s ago; " if seen.last_seen is not None else ""
        withheld = self._withheld.get(name, 0)
        return f"{quiet}{seen.detail}" + (f"; {withheld} commands withheld" if withheld else "")

    def _report(
        self, name: str, was: ChannelState, become: ChannelState, seen: ChannelHealth, now: float, ended: bool
    ) -> tuple[Event, ...]:
        quiet = f"nothing for {now - seen.last_seen:.1f} s" if seen.last_seen is not None else seen.detail
        match become:
            case ChannelState.STALE:
                severity, text = Severity.INFO, f"Input '{name}' is stale: {quiet}."
            case ChannelState.LOST if self._channels.failed(name):
                return ()  # reported when it failed
            case ChannelState.LOST:
                outcome = f" {_OUTCOME[self.limits[name].on_lost]}" if ended else ""
                severity, text = Severity.ALARM, f"Input '{name}' is lost: {quiet}.{outcome}"
            case ChannelState.RECOVERED:
                severity, text = Severity.WARNING, f"Input '{name}' is back; acknowledge it to use it again."
            case ChannelState.LIVE if was is ChannelState.STALE:
                severity, text = Severity.INFO, f"Input '{name}' is live again."
            case _:
                return ()
        return (Event(now, severity, "channel", text, channel=name),)
