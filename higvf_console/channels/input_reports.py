"""What the interfaces report beside their commands, asked for by the session and shown by the view.

Nothing here reaches the team. An interface whose report fails is asked no more; its commands go on counting.
"""

import logging
from collections.abc import Callable, Iterable
from typing import NamedTuple, TypeVar

from higvf_console.channels.channels import Channels
from higvf_console.channels.link import device_of
from higvf_console.core.events import Event, Severity
from higvf_console.core.interface import Interface
from higvf_console.core.reports import (
    AttentionReport,
    Attentive,
    Calibrated,
    CalibrationReport,
    CaptureReport,
    Deciding,
    DecisionReport,
    DwellReport,
)

PERIOD = 0.5  # from one look at what takes counting to the next [s]

_Kind = TypeVar("_Kind")
_Answer = TypeVar("_Answer")
_log = logging.getLogger(__name__)


class InputReports(NamedTuple):
    """The latest reports of the interfaces.

    Attributes:
        attention: of the first interface that sees where the operator looks; None = there is none, or nothing yet.
        dwell: the button that gaze can press; None = there is none.
        capture: how the making of a calibration stands; None = no interface has a screen.
        calibrations: by interface, of those that have one.
        decisions: by interface, of those that decode.
    """

    attention: AttentionReport | None = None
    dwell: DwellReport | None = None
    capture: CaptureReport | None = None
    calibrations: tuple[tuple[str, CalibrationReport], ...] = ()
    decisions: tuple[tuple[str, DecisionReport], ...] = ()


class Reporter:
    """Asks the interfaces: each control period for what moves with gaze, twice a second for what must be counted."""

    def __init__(self, channels: Channels, control_period: float) -> None:
        """Finds out which interface reports what; `control_period` is in seconds."""
        named = [(name, channels.device(name)) for name in channels.names]
        self._attentive = [(name, it) for name, it in named if isinstance(it, Attentive)]
        self._calibrated = [(name, it) for name, it in named if isinstance(it, Calibrated)]
        self._deciding = [(name, it) for name, it in named if isinstance(it, Deciding)]
        self._channels = channels
        self._every = max(1, round(PERIOD / control_period))
        self._calls = 0
        self._mute: set[str] = set()
        self._latest = self.count(0.0, InputReports())
        self._known = self._latest.calibrations

    @property
    def calibrated(self) -> Calibrated | None:
        """The interface whose calibration can be made."""
        return next((interface for _, interface in self._calibrated), None)

    def take(self, now: float) -> InputReports:
        """What there is to show at session time `now` [s]; call it once a control period."""
        if self._calls % self._every == 0:
            self._latest = self.count(now, self._latest)
        self._calls += 1
        if self._attentive or self._calibrated:
            dwell = _first(self._each(self._attentive, lambda it: it.dwell_report()))
            capture = _first(self._each(self._calibrated, lambda it: it.capture_report()))
            self._latest = self._latest._replace(dwell=dwell, capture=capture)
        return self._latest

    def count(self, now: float, before: InputReports) -> InputReports:
        """`before`, with what takes counting as it is at session time `now` [s]."""
        return before._replace(
            attention=_first(self._each(self._attentive, lambda it: it.attention_report())),
            calibrations=self._each(self._calibrated, lambda it: it.calibration_report()),
            decisions=self._each(self._deciding, lambda it: it.decision_report(now)),
        )

    def new_calibrations(self) -> tuple[tuple[str, CalibrationReport], ...]:
        """The calibrations that came into use since the last call, by interface."""
        known, self._known = self._known, self._latest.calibrations
        return tuple(entry for entry in self._known if entry not in known)

    def _each(
        self, interfaces: Iterable[tuple[str, _Kind]], ask: Callable[[_Kind], _Answer | None]
    ) -> tuple[tuple[str, _Answer], ...]:
        """The answers of the interfaces that give one, with their names."""
        answers: list[tuple[str, _Answer]] = []
        for name, interface in interfaces:
            if name in self._mute or self._channels.failed(name):
                continue
            try:
                answer = ask(interface)
            except Exception:  # whatever a device's code raises must not stop the team's loop
                self._mute.add(name)
                _log.exception("input '%s' cannot tell of itself", name)
                continue
            if answer is not None:
                answers.append((name, answer))
        return tuple(answers)


def calibrations_of(interfaces: Iterable[Interface]) -> dict[str, CalibrationReport]:
    """The calibrations in use, by interface."""
    devices = map(device_of, interfaces)
    reports = [(it.name, it.calibration_report()) for it in devices if isinstance(it, Calibrated)]
    return {name: report for name, report in reports if report is not None}


def calibration_event(channel: str, report: CalibrationReport, time: float) -> Event:
    """That an interface has a new calibration."""
    text = f"Input '{channel}' is calibrated anew: off by {report.residual_px:.0f} px, {report.residual_m:.1f} m."
    return Event(time, Severity.INFO, "channel", text, channel=channel)


def _first(answers: tuple[tuple[str, _Answer], ...]) -> _Answer | None:
    return answers[0][1] if answers else None
