"""Emulated devices: apply the errors of a device and its decoder to a recording or a script.

    --input bci=FILE:latency=0.4,confusion=0.8,seed=3          decisions: delay, loss, confusion
    --input gaze=FILE:noise_deg=0.5,drift_deg_per_min=1        gaze: noise, drift, delay, loss
    --input script=FILE:latency=0.3,dropout=0.1                commands of any interface: delay, loss

Each item has its own random generator, seeded by (seed, index): the same seed gives the same commands at any session
speed and polling rate. Delivery preserves order.
"""

import math
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, cast

import numpy as np

from higvf_console.core.arrays import Bools, Floats, bools, floats
from higvf_console.core.commands import OperatorCommand, StrokeBegin, StrokeCancel, StrokeEnd
from higvf_console.core.interface import Capabilities, ChannelHealth, Interface, OperatorContext, capabilities_of
from higvf_console.core.reports import Warned
from higvf_interfaces.decisions.feeds import DecisionFeed, Due
from higvf_interfaces.fields import Fields, is_number, shown
from higvf_interfaces.formats.records import Decision, GazeRecording
from higvf_interfaces.streams import CLOCK_GRAIN, RunClock, Stamp

DELAYS = ("latency", "jitter", "dropout", "seed")
ERRORS = (*DELAYS, "confusion")
GAZE_ERRORS = (*DELAYS, "noise_deg", "drift_deg_per_min")
_BLACKOUT = 0.2  # duration of one loss of gaze [s]
_MOST_SEED = 2**32


class ErrorModel(NamedTuple):
    """Parameters of a device's errors.

    Attributes:
        latency: constant delay [s].
        jitter: mean of an additional, exponentially distributed delay [s].
        dropout: probability in [0, 1] that an item is lost.
        confusion: probability that a label is correct, or the confusion probabilities of each label; the rest of a row
            is the probability of the label itself.
        noise_deg: standard deviation of gaze on each axis [deg].
        drift_deg_per_min: drift speed of gaze, in one constant direction [deg/min].
        seed: seed of all random draws.
    """

    latency: float = 0.0
    jitter: float = 0.0
    dropout: float = 0.0
    confusion: float | Mapping[str, Mapping[str, float]] = 1.0
    noise_deg: float = 0.0
    drift_deg_per_min: float = 0.0
    seed: int = 0


def error_model(options: Fields) -> ErrorModel | None:
    """Return the error model of an input's options, or None if they set none.

    Raises:
        InputError: If a value is invalid.
    """
    asked = [key for key in {*ERRORS, *GAZE_ERRORS} - {"seed"} if options.has(key)]
    seed = options.number("seed", 0.0, 0.0, float(_MOST_SEED))
    if not asked:
        return None
    return ErrorModel(
        latency=options.number("latency", 0.0, 0.0, 60.0, "s"),
        jitter=options.number("jitter", 0.0, 0.0, 60.0, "s"),
        dropout=options.number("dropout", 0.0, 0.0, 1.0),
        confusion=_confusion(options),
        noise_deg=options.number("noise_deg", 0.0, 0.0, 45.0, "deg"),
        drift_deg_per_min=options.number("drift_deg_per_min", 0.0, 0.0, 600.0, "deg/min"),
        seed=int(seed),
    )


def emulate(decision: Decision, index: int, labels: Sequence[str], model: ErrorModel) -> Decision | None:
    """Return a decision as the emulated device delivers it.

    Args:
        decision: the original decision.
        index: its number in the log, which seeds the random draws.
        labels: labels it may be confused with.
        model: error parameters.

    Returns:
        The delayed, possibly confused decision; None if it is lost.
    """
    draw = np.random.default_rng((model.seed, index))
    lost, delay, choice, other = draw.random(), draw.exponential(), draw.random(), draw.random()
    if lost < model.dropout:
        return None
    label = _confused(decision.label, labels, model, choice, other)
    return decision._replace(time=decision.time + model.latency + model.jitter * delay, label=label)


class EmulatedFeed:
    """A decision feed with the errors of an emulated device."""

    def __init__(self, feed: DecisionFeed, model: ErrorModel) -> None:
        """Apply the errors of `model` to `feed`."""
        self._feed, self._model = feed, model
        self._waiting: deque[Due] = deque()
        self._clock = RunClock()
        self._played = False
        self.labels: Sequence[str] = feed.labels

    @property
    def notes(self) -> Sequence[str]:
        """The notes of the feed and the emulated errors."""
        return (*self._feed.notes, f"emulated: {describe(self._model)}")

    @property
    def started(self) -> bool:
        """Whether at least one decision has been delivered."""
        return self._played

    @property
    def ended(self) -> bool:
        """Whether all decisions have been delivered."""
        return self._feed.ended and not self._waiting

    def due(self, now: float) -> list[Due]:
        """Return the decisions that arrive by session time `now` [s]."""
        if self._clock.was_reset(now):
            self._waiting.clear()
            self._played = False
        for index, decision in self._feed.due(now):
            emulated = emulate(decision, index, self.labels, self._model)
            if emulated is not None:
                after = self._waiting[-1].decision.time if self._waiting else -math.inf
                self._waiting.append(Due(index, emulated._replace(time=max(emulated.time, after))))
        given: list[Due] = []
        while self._waiting and self._waiting[0].decision.time <= now + CLOCK_GRAIN:
            given.append(self._waiting.popleft())
        self._played = self._played or bool(given)
        return given


class EmulatedInterface:
    """An interface behind a lossy link: commands are delayed or lost; stroke begin and end are delayed, never lost."""

    def __init__(self, interface: Interface, model: ErrorModel) -> None:
        """Wrap `interface` in a link with the errors of `model`."""
        self._interface, self._model = interface, model
        self._stamp = Stamp(interface.name)
        self._waiting: deque[OperatorCommand] = deque()
        self._due: deque[float] = deque()
        self._clock = RunClock()
        self._count = 0

    @property
    def name(self) -> str:
        """Channel name, shown in the status line."""
        return self._interface.name

    @property
    def capabilities(self) -> Capabilities:
        """Those of the interface; nothing can be pushed through the link."""
        return replace(capabilities_of(self._interface), takes_pointer=False)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Those of the interface."""
        return self._interface.warnings if isinstance(self._interface, Warned) else ()

    def poll(self, context: OperatorContext) -> list[OperatorCommand]:
        """Return the commands that have arrived, stamped with their times of arrival."""
        if self._clock.was_reset(context.time):
            self._waiting.clear()
            self._due.clear()
            self._count = 0
        for command in self._interface.poll(context):
            self._send(command)
        given: list[OperatorCommand] = []
        while self._due and self._due[0] <= context.time + CLOCK_GRAIN:
            given.append(self._stamp(self._waiting.popleft(), self._due.popleft(), context))
        return given

    def health(self, now: float) -> ChannelHealth:
        """The health of the interface, with the emulated errors in its detail."""
        health = self._interface.health(now)
        return health._replace(detail=f"{health.detail}; emulated: {describe(self._model)}")

    def close(self) -> None:
        """Close the interface."""
        self._interface.close()

    def _send(self, command: OperatorCommand) -> None:
        draw = np.random.default_rng((self._model.seed, self._count))
        self._count += 1
        lost, delay = draw.random(), draw.exponential()
        if lost < self._model.dropout and not isinstance(command, StrokeBegin | StrokeEnd | StrokeCancel):
            return
        due = command.time + self._model.latency + self._model.jitter * delay
        self._due.append(max(due, self._due[-1] if self._due else -math.inf))
        self._waiting.append(command)


class GazeErrors:
    """Adds noise, drift, delay and loss to gaze, block by block."""

    def __init__(self, model: ErrorModel, units_per_deg: float) -> None:
        """Start at the beginning of a recording.

        Args:
            model: error parameters; jitter delays gaze as a whole, because a tracker sends at a steady rate.
            units_per_deg: units of the points' frame per degree of visual angle.
        """
        self._model, self._units = model, units_per_deg
        self._draw = np.random.default_rng((model.seed, 0))
        angle = self._draw.uniform(0.0, 2 * np.pi)
        self._direction = np.array([np.cos(angle), np.sin(angle)])
        self._delay = model.latency + model.jitter * self._draw.exponential()
        self._first: float | None = None

    def __call__(self, time: Floats, points: Floats, valid: Bools) -> tuple[Floats, Floats, Bools]:
        """Return the next block with errors: times (n,) [s], points (n, 2) and validity (n,)."""
        if len(time) and self._first is None:
            self._first = float(time[0])
        minutes = (time - (self._first or 0.0))[:, None] / 60.0
        drift = minutes * self._model.drift_deg_per_min * self._direction
        noise = self._draw.normal(0.0, 1.0, (len(time), 2)) * self._model.noise_deg
        blackouts, within = np.unique(np.floor(time / _BLACKOUT).astype(np.int64), return_inverse=True)
        dark = bools([self._dark(index) for index in blackouts.tolist()])
        return (
            floats(time + self._delay),
            floats(points + (drift + noise) * self._units),
            bools(valid & ~dark[within]),
        )

    def _dark(self, blackout: int) -> bool:
        """Whether gaze is lost in blackout interval `blackout`; independent of the division into blocks."""
        return bool(np.random.default_rng((self._model.seed, 1, abs(blackout))).random() < self._model.dropout)


def emulate_gaze(recording: GazeRecording, model: ErrorModel, units_per_deg: float) -> GazeRecording:
    """Return a gaze recording with the errors of `model`; see `GazeErrors`."""
    time, points, valid = GazeErrors(model, units_per_deg)(recording.time, recording.points, recording.valid)
    return recording._replace(time=time, points=points, valid=valid)


def describe(model: ErrorModel) -> str:
    """Return the errors of a model in the syntax of its options."""
    default = ErrorModel()._asdict()
    given = {key: value for key, value in model._asdict().items() if value != default[key] and key != "confusion"}
    parts = [f"{key}={value:g}" for key, value in given.items()]
    if model.confusion != 1.0:
        parts.append(
            f"confusion={model.confusion:g}" if not isinstance(model.confusion, Mapping) else "confusion by label"
        )
    return ", ".join(parts)


def _confused(label: str, labels: Sequence[str], model: ErrorModel, choice: float, other: float) -> str:
    if not isinstance(model.confusion, Mapping):
        others = [known for known in labels if known != label]
        return label if choice < model.confusion or not others else others[int(other * len(others))]
    reached = 0.0
    for other_label, probability in model.confusion.get(label.strip().casefold(), {}).items():
        reached += probability
        if choice < reached:
            return other_label
    return label


def _confusion(options: Fields) -> float | dict[str, dict[str, float]]:
    if not isinstance(options.values.get("confusion"), dict):
        return options.number("confusion", 1.0, 0.0, 1.0)
    rows: dict[str, dict[str, float]] = {}
    for label, row in options.mapping("confusion").items():
        shares = cast(dict[object, object], row) if isinstance(row, dict) else {}
        good = {str(name): float(share) for name, share in shares.items() if is_number(share) and 0 <= share <= 1}
        if not shares or len(good) < len(shares) or sum(good.values()) > 1 + 1e-9:
            options.fail(
                f"confusion: {label}: {shown(row)} is not a mapping from labels to probabilities of sum 1 or less"
            )
        rows[str(label).strip().casefold()] = good
    return rows
