"""Devices without hardware: a recording or a script passed through the errors that a device and its decoder make.

    --input bci=FILE:latency=0.4,confusion=0.8,seed=3          decisions: late, lost, mistaken
    --input gaze=FILE:noise_deg=0.5,drift_deg_per_min=1        gaze: noisy, drifting, late, lost
    --input script=FILE:latency=0.3,dropout=0.1                commands of any interface: late, lost

Each item draws from a generator of its own, seeded by (seed, index): the same seed gives the same commands, whatever
the speed of the session and however often it polls. Nothing overtakes: a link delivers in order.
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
from higvf_interfaces.decisions.feeds import DecisionFeed, Due
from higvf_interfaces.fields import Fields, is_number, shown
from higvf_interfaces.formats.records import Decision, GazeRecording
from higvf_interfaces.streams import CLOCK_GRAIN, Stamp

DELAYS = ("latency", "jitter", "dropout", "seed")
ERRORS = (*DELAYS, "confusion")
GAZE_ERRORS = (*DELAYS, "noise_deg", "drift_deg_per_min")
_BLACKOUT = 0.2  # gaze is lost for so long at a time [s]
_MOST_SEED = 2**32


class ErrorModel(NamedTuple):
    """The errors of a device.

    Attributes:
        latency: by which everything comes later [s].
        jitter: mean of a further, exponentially distributed delay [s].
        dropout: share in [0, 1] that is lost.
        confusion: probability that a label is right, or what each label is taken for, by probability; what a row leaves
            of 1 is the label itself.
        noise_deg: standard deviation of gaze on each axis [deg].
        drift_deg_per_min: speed at which gaze wanders off in one direction [deg/min].
        seed: of all of it.
    """

    latency: float = 0.0
    jitter: float = 0.0
    dropout: float = 0.0
    confusion: float | Mapping[str, Mapping[str, float]] = 1.0
    noise_deg: float = 0.0
    drift_deg_per_min: float = 0.0
    seed: int = 0


def error_model(options: Fields) -> ErrorModel | None:
    """The errors that an input's options ask for; None where they ask for none.

    Raises:
        InputError: a value that cannot be used.
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
    """Decision number `index` as the device gives it: late, perhaps mistaken for another of `labels`; None = lost."""
    draw = np.random.default_rng((model.seed, index))
    lost, delay, choice, other = draw.random(), draw.exponential(), draw.random(), draw.random()
    if lost < model.dropout:
        return None
    label = _mistaken(decision.label, labels, model, choice, other)
    return decision._replace(time=decision.time + model.latency + model.jitter * delay, label=label)


class EmulatedFeed:
    """A feed of decisions with a device's errors."""

    def __init__(self, feed: DecisionFeed, model: ErrorModel) -> None:
        """Makes `feed` worse by `model`."""
        self._feed, self._model = feed, model
        self._waiting: deque[Due] = deque()
        self._now = -math.inf
        self._played = False
        self.labels: Sequence[str] = feed.labels

    @property
    def notes(self) -> Sequence[str]:
        """Those of the feed, and that its errors are made."""
        return (*self._feed.notes, f"emulated: {describe(self._model)}")

    @property
    def started(self) -> bool:
        """Whether anything has been played."""
        return self._played

    @property
    def ended(self) -> bool:
        """Whether everything has been played."""
        return self._feed.ended and not self._waiting

    def due(self, now: float) -> list[Due]:
        """Decisions that reach the session by time `now` [s]."""
        if now < self._now:
            self._waiting.clear()
            self._played = False
        self._now = now
        for index, decision in self._feed.due(now):
            worse = emulate(decision, index, self.labels, self._model)
            if worse is not None:
                after = self._waiting[-1].decision.time if self._waiting else -math.inf
                self._waiting.append(Due(index, worse._replace(time=max(worse.time, after))))
        given: list[Due] = []
        while self._waiting and self._waiting[0].decision.time <= now + CLOCK_GRAIN:
            given.append(self._waiting.popleft())
        self._played = self._played or bool(given)
        return given


class EmulatedInterface:
    """Any interface behind a link that delays and loses commands; the ends of strokes are delayed and never lost."""

    def __init__(self, interface: Interface, model: ErrorModel) -> None:
        """Puts `interface` behind the link."""
        self._interface, self._model = interface, model
        self._stamp = Stamp(interface.name)
        self._waiting: deque[OperatorCommand] = deque()
        self._due: deque[float] = deque()
        self._now = -math.inf
        self._heard = 0

    @property
    def name(self) -> str:
        """Channel name, shown in the status line."""
        return self._interface.name

    @property
    def capabilities(self) -> Capabilities:
        """Those of the interface; nothing can be pushed through the link."""
        return replace(capabilities_of(self._interface), takes_pointer=False)

    def poll(self, context: OperatorContext) -> list[OperatorCommand]:
        """Commands that have come through, stamped with the time at which they did."""
        if context.time < self._now:
            self._waiting.clear()
            self._due.clear()
            self._heard = 0
        self._now = context.time
        for command in self._interface.poll(context):
            self._send(command)
        given: list[OperatorCommand] = []
        while self._due and self._due[0] <= context.time + CLOCK_GRAIN:
            given.append(self._stamp(self._waiting.popleft(), self._due.popleft(), context))
        return given

    def health(self, now: float) -> ChannelHealth:
        """That of the interface, and that its errors are made."""
        health = self._interface.health(now)
        return health._replace(detail=f"{health.detail}; emulated: {describe(self._model)}")

    def close(self) -> None:
        """Closes the interface."""
        self._interface.close()

    def _send(self, command: OperatorCommand) -> None:
        draw = np.random.default_rng((self._model.seed, self._heard))
        self._heard += 1
        lost, delay = draw.random(), draw.exponential()
        if lost < self._model.dropout and not isinstance(command, StrokeBegin | StrokeEnd | StrokeCancel):
            return
        due = command.time + self._model.latency + self._model.jitter * delay
        self._due.append(max(due, self._due[-1] if self._due else -math.inf))
        self._waiting.append(command)


class GazeErrors:
    """Makes gaze worse block by block, as a worse eye tracker would have given it."""

    def __init__(self, model: ErrorModel, units_per_deg: float) -> None:
        """Starts a recording.

        Args:
            model: the errors; jitter of gaze is a delay of the whole, as a tracker sends at a steady rate.
            units_per_deg: units of the points' frame in one degree of visual angle.
        """
        self._model, self._units = model, units_per_deg
        self._draw = np.random.default_rng((model.seed, 0))
        angle = self._draw.uniform(0.0, 2 * np.pi)
        self._direction = np.array([np.cos(angle), np.sin(angle)])
        self._delay = model.latency + model.jitter * self._draw.exponential()
        self._first: float | None = None

    def __call__(self, time: Floats, points: Floats, valid: Bools) -> tuple[Floats, Floats, Bools]:
        """The next block: times (n,) [s], points (n, 2), and whether each is valid (n,)."""
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
        """Whether a stretch of time is lost, whatever block it is met in."""
        return bool(np.random.default_rng((self._model.seed, 1, abs(blackout))).random() < self._model.dropout)


def emulate_gaze(recording: GazeRecording, model: ErrorModel, units_per_deg: float) -> GazeRecording:
    """A gaze recording as a worse eye tracker would have given it: `GazeErrors` of the whole."""
    time, points, valid = GazeErrors(model, units_per_deg)(recording.time, recording.points, recording.valid)
    return recording._replace(time=time, points=points, valid=valid)


def describe(model: ErrorModel) -> str:
    """The errors that a model makes, as its options."""
    default = ErrorModel()._asdict()
    given = {key: value for key, value in model._asdict().items() if value != default[key] and key != "confusion"}
    parts = [f"{key}={value:g}" for key, value in given.items()]
    if model.confusion != 1.0:
        parts.append(
            f"confusion={model.confusion:g}" if not isinstance(model.confusion, Mapping) else "confusion by label"
        )
    return ", ".join(parts)


def _mistaken(label: str, labels: Sequence[str], model: ErrorModel, choice: float, other: float) -> str:
    if not isinstance(model.confusion, Mapping):
        others = [known for known in labels if known != label]
        return label if choice < model.confusion or not others else others[int(other * len(others))]
    reached = 0.0
    for said, probability in model.confusion.get(label.strip().casefold(), {}).items():
        reached += probability
        if choice < reached:
            return said
    return label


def _confusion(options: Fields) -> float | dict[str, dict[str, float]]:
    if not isinstance(options.values.get("confusion"), dict):
        return options.number("confusion", 1.0, 0.0, 1.0)
    rows: dict[str, dict[str, float]] = {}
    for label, row in options.mapping("confusion").items():
        shares = cast(dict[object, object], row) if isinstance(row, dict) else {}
        good = {str(said): float(share) for said, share in shares.items() if is_number(share) and 0 <= share <= 1}
        if not shares or len(good) < len(shares) or sum(good.values()) > 1 + 1e-9:
            options.fail(f"confusion: {label}: {shown(row)} is not a mapping from labels to shares of 1")
        rows[str(label).strip().casefold()] = good
    return rows
