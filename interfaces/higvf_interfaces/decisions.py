"""A log of decoded labels, replayed on the session clock: label -> action -> command.

Every action's own name is a label too, and so is what a channel's defaults add; the scenario's map goes over both:

    inputs: {emg: {labels: {fist: pause, spread: none, point: "robot:2"}, threshold: 0.6, refractory: 1.0}}
"""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from typing import cast

from higvf_console.arrays import floats
from higvf_console.commands import (
    ChannelHealth,
    ChannelState,
    InputSpec,
    OperatorCommand,
    OperatorContext,
    Pick,
    ResetRun,
)
from higvf_interfaces.actions import ACTIONS, CHOICES, command_for
from higvf_interfaces.fields import Fields, option_fields, shown
from higvf_interfaces.formats.reading import read_command_log
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.streams import Playhead, Stamp

OPTIONS = ("labels", "threshold", "refractory", "start", "format")
IDLE = "none"  # the action of a label that is known and means nothing


class DecisionReplay:
    """A channel's decoded labels, played on the session clock.

    A decision below the `threshold` of confidence is rejected (one without confidence passes), and so is a label that
    comes back within its `refractory` time [s]. What gives no command is counted and told by `health`.
    """

    def __init__(self, spec: InputSpec, defaults: Mapping[str, str]) -> None:
        """Reads `spec.source`; `defaults` are the channel's own labels and their actions.

        Raises:
            InputError: the log, an option or the label map cannot be used.
        """
        options = option_fields(spec, OPTIONS)
        self._commands = label_map(defaults, options)
        self._threshold = options.number("threshold", 0.0, 0.0, 1.0)
        self._refractory = options.number("refractory", 0.0, 0.0, 3600.0, "s")
        start = options.number("start", 0.0, -1e6, 1e6, "s")
        log = read_command_log(spec.source, options.text("format") if options.has("format") else None)
        self._decisions = tuple(decision._replace(time=decision.time + start) for decision in log.decisions)
        self._notes = log.notes
        self._name = spec.channel
        self._playhead = Playhead(floats([decision.time for decision in self._decisions]))
        self._stamp = Stamp(spec.channel)
        self._now = -math.inf
        self._accepted_at: dict[str, float] = {}
        self._resets: set[int] = set()
        self._ignored: Counter[str] = Counter()
        self._latest = "no decision yet"

    @property
    def name(self) -> str:
        """Channel name, shown in the status line."""
        return self._name

    def poll(self, context: OperatorContext) -> list[OperatorCommand]:
        """Commands of the decisions that have fallen due, at their own times."""
        if context.time < self._now:
            self._accepted_at.clear()
        self._now = context.time
        given: list[OperatorCommand] = []
        for index in self._playhead.advance(context.time):
            decision = self._decisions[index]
            command = self._decide(index, decision, context.robots)
            if command is not None:
                command = replace(command, confidence=decision.confidence)
                given.append(self._stamp(command, decision.time, context))
        return given

    def health(self, now: float) -> ChannelHealth:  # noqa: ARG002 - a log is as well as its last decision
        """Never seen before the first decision, ended after the last; the detail tells what was ignored."""
        ignored = ", ".join(f"{count} x {reason}" for reason, count in self._ignored.most_common(5))
        detail = "; ".join((self._latest, *([f"ignored: {ignored}"] if ignored else []), *self._notes))
        if self._playhead.ended and self._playhead.started:
            return ChannelHealth(ChannelState.ENDED, f"replayed to its end; {detail}")
        return ChannelHealth(ChannelState.LIVE if self._playhead.started else ChannelState.NEVER_SEEN, detail)

    def close(self) -> None:
        """Has nothing to let go of: the file was closed after reading."""

    def _decide(self, index: int, decision: Decision, robots: int) -> OperatorCommand | None:
        label = plain_label(decision.label)
        trust = "" if decision.confidence is None else f" ({decision.confidence:.2f})"
        self._latest = f"latest: {decision.label}{trust}"
        if label not in self._commands:
            return self._ignore(f"unknown label {shown(decision.label)}")
        command = self._commands[label]
        if command is None:
            return None
        objection = self._objection(label, decision, command, robots)
        if objection:
            return self._ignore(objection)
        if isinstance(command, ResetRun):
            # The restart plays this log again; given twice, it would never end.
            if index in self._resets:
                return None
            self._resets.add(index)
        self._accepted_at[label] = decision.time
        return command

    def _objection(self, label: str, decision: Decision, command: OperatorCommand, robots: int) -> str:
        """Why a decision gives no command; empty where it gives one."""
        if decision.confidence is not None and decision.confidence < self._threshold:
            return f"confidence below {self._threshold:g}"
        if decision.time - self._accepted_at.get(label, -math.inf) < self._refractory:
            return "repeated within the refractory time"
        if isinstance(command, Pick) and command.robot >= robots:
            return f"there is no robot {command.robot + 1}"
        return ""

    def _ignore(self, reason: str) -> None:
        self._ignored[reason] += 1


def label_map(defaults: Mapping[str, str], options: Fields) -> dict[str, OperatorCommand | None]:
    """Label -> command, or None for a label that means nothing.

    Raises:
        InputError: a label that is no text, or an action that is not in the list; the message gives the list.
    """
    actions = {**{action: action for action in ACTIONS}, **{plain_label(k): v for k, v in defaults.items()}}
    for label, action in cast(Mapping[object, object], options.mapping("labels")).items():
        if isinstance(label, bool) or not isinstance(label, str | int):
            options.fail(f"labels: {shown(label)} is not a text; put it in quotation marks")
        text = IDLE if action is None else str(action).strip()
        if text != IDLE and command_for(text) is None:
            options.fail(
                f"labels: {label}: {shown(action)} is not an action; known actions: {', '.join((*CHOICES, IDLE))}"
            )
        actions[plain_label(str(label))] = text
    return {label: command_for(action) for label, action in actions.items()}


def plain_label(label: str) -> str:
    """A label as it is compared: without case, without blanks at its ends."""
    return label.strip().casefold()
