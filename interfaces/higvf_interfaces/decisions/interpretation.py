"""Interpretation of decisions: label -> action -> evidence -> command; a doubtful robot change is only proposed."""

import math
from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import replace
from typing import cast

from higvf_console.core.commands import OperatorCommand, Pick, ProposePick
from higvf_console.core.reports import DecisionReport
from higvf_interfaces.decisions.actions import ACTIONS, CHOICES, command_for
from higvf_interfaces.decisions.debouncer import Debounced, Evidence, Stage, Verdict, judge, observe, support, votes_for
from higvf_interfaces.decisions.evidence import NEEDS, EvidenceTable
from higvf_interfaces.fields import Fields, shown
from higvf_interfaces.formats.records import Decision

UNKNOWN = "unknown"  # stage of an unknown label or robot
IDLE = "none"  # action of a label that gives no command
OPTIONS = (*NEEDS, "evidence", "confirm", "confirm_within")
_TRACE = 50  # verdicts kept for display


class Interpreter:
    """Turns decoded labels into commands; counts decisions without a command and keeps the verdicts.

    Attributes:
        trace: the last verdicts, oldest first.
    """

    def __init__(self, defaults: Mapping[str, str], options: Fields, base: Evidence) -> None:
        """Read the label map and the evidence required for the actions.

        Raises:
            InputError: If an option is invalid; the message lists the choices.
        """
        self._actions = label_map(defaults, options)
        self._evidence = EvidenceTable(options, base)
        self._confirm = options.number("confirm", 0.0, 0.0, 1.0)
        self._timeout = options.number("confirm_within", 5.0, 0.1, 3600.0, "s")
        self.restart()

    def restart(self) -> None:
        """Reset state and counters, because the run was reset."""
        self._state = Debounced()
        self._ignored: Counter[str] = Counter()
        self._stages: Counter[str] = Counter()
        self._proposed = 0
        self._latest: Decision | None = None
        self._stage = ""
        self.trace: deque[Verdict] = deque(maxlen=_TRACE)

    def command(self, decision: Decision, robots: int) -> OperatorCommand | None:
        """Return the command of a decision, with its confidence, or None.

        Args:
            decision: next decision in order of time.
            robots: number of robots.
        """
        decision = decision._replace(label=plain_label(decision.label))
        self._latest = decision
        action = self._actions.get(decision.label)
        if action is None:
            return self._ignore(UNKNOWN, f"unknown label {shown(decision.label)}")
        if action == IDLE:
            self._stage = "idle"
            self._state = observe(self._state, decision, self._needed)
            return None
        wanted = command_for(action)
        if isinstance(wanted, Pick) and wanted.robot >= robots:
            return self._ignore(UNKNOWN, f"there is no robot {wanted.robot + 1}")
        self._state, verdict = judge(self._state, decision, self._needed)
        self.trace.append(verdict)
        if verdict.stage is not Stage.PASSED:
            return self._ignore(verdict.stage, verdict.reason)
        self._stage = Stage.PASSED
        self._stages[Stage.PASSED] += 1
        return None if wanted is None else self._sure_enough(replace(wanted, confidence=decision.confidence))

    def describe(self) -> tuple[str, ...]:
        """Return the latest decision and the ignored decisions as text."""
        ignored = ", ".join(f"{count} x {reason}" for reason, count in self._ignored.most_common(5))
        latest = "no decision yet"
        if self._latest is not None:
            trust = "" if self._latest.confidence is None else f" ({self._latest.confidence:.2f})"
            latest = f"latest: {self._latest.label[:40]}{trust}"
        return (latest, *([f"ignored: {ignored}"] if ignored else []))

    def report(self, now: float) -> DecisionReport:
        """Return the latest decision, the evidence for its label at session time `now` [s], and the counters."""
        label = "" if self._latest is None else self._latest.label
        needed, recent = self._needed(label), self._state.recent
        accepted = dict(self._state.accepted).get(label, -math.inf)
        return DecisionReport(
            label=label[:40],
            confidence=None if self._latest is None else self._latest.confidence,
            stage=self._stage,
            votes=votes_for(recent, label, needed) if label else 0,
            votes_needed=needed.votes,
            of=needed.of,
            threshold=needed.threshold,
            support=support(recent, label, needed) if label else 0.0,
            enter=needed.enter,
            leave=needed.leave,
            active=self._state.active,
            refractory=max(0.0, accepted + needed.refractory - now),
            passed=self._stages[Stage.PASSED],
            proposed=self._proposed,
            unknown=self._stages[UNKNOWN],
            held=tuple((stage.value, self._stages[stage]) for stage in Stage if stage is not Stage.PASSED),
        )

    def _sure_enough(self, wanted: OperatorCommand) -> OperatorCommand:
        """Return the command, or the proposal of a doubtful robot change, which any channel may confirm."""
        if not isinstance(wanted, Pick) or wanted.confidence is None or wanted.confidence >= self._confirm:
            return wanted
        self._proposed += 1
        return ProposePick(wanted.robot, self._timeout, confidence=wanted.confidence)

    def _needed(self, label: str) -> Evidence:
        return self._evidence.of(self._actions.get(label, IDLE))

    def _ignore(self, stage: str, reason: str) -> None:
        self._stage = stage
        self._stages[stage] += 1
        self._ignored[reason] += 1


def label_map(defaults: Mapping[str, str], options: Fields) -> dict[str, str]:
    """Return the action of each label; `IDLE` for a label without a command.

    Raises:
        InputError: If a label is not text or an action is unknown; the message lists the known actions.
    """
    actions = {action: action for action in ACTIONS}
    actions |= {plain_label(label): action for label, action in defaults.items()}
    for label, action in cast(Mapping[object, object], options.mapping("labels")).items():
        if isinstance(label, bool) or not isinstance(label, str | int):
            options.fail(f"labels: {shown(label)} is not text; put it in quotation marks")
        text = IDLE if action is None else str(action).strip()
        if text != IDLE and command_for(text) is None:
            options.fail(
                f"labels: {label}: {shown(action)} is not an action; known actions: {', '.join((*CHOICES, IDLE))}"
            )
        actions[plain_label(str(label))] = text
    return actions


def plain_label(label: str) -> str:
    """Return a label in the form used for comparison: case-folded, without surrounding blanks."""
    return label.strip().casefold()
