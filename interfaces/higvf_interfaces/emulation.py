"""Emulated devices: the errors of a decoder and of an eye tracker, on any recording.

    --input bci=FILE:confusion=0.8,seed=3                      decisions: confusion of labels
    --input gaze=FILE:noise_deg=0.5,drift_deg_per_min=1        gaze: noise, drift

Delay and loss are those of the channel's link, which the console emulates for every interface. Each decision has its
own random generator, seeded by (seed, number of the decision): the same seed gives the same commands at any session
speed.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple, cast

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.interface import LINK_OPTIONS
from higvf_interfaces.decisions.feeds import DecisionFeed, Due
from higvf_interfaces.fields import Fields, is_number, shown
from higvf_interfaces.formats.records import Decision

ERRORS = ("confusion", "seed")
GAZE_ERRORS = ("noise_deg", "drift_deg_per_min", "seed")
_MOST_SEED = 2**32


class ErrorModel(NamedTuple):
    """Parameters of a device's errors.

    Attributes:
        confusion: probability that a label is correct, or the confusion probabilities of each label; the rest of a row
            is the probability of the label itself.
        noise_deg: standard deviation of gaze on each axis [deg].
        drift_deg_per_min: drift speed of gaze, in one constant direction [deg/min].
        seed: seed of all random draws.
    """

    confusion: float | Mapping[str, Mapping[str, float]] = 1.0
    noise_deg: float = 0.0
    drift_deg_per_min: float = 0.0
    seed: int = 0


def error_model(options: Fields, seed: int = 0) -> ErrorModel | None:
    """Return the error model of an input's options, or None if they set none.

    Args:
        options: options of the input.
        seed: seed if the options have none (`InputSpec.seed`).

    Raises:
        InputError: If a value is invalid.
    """
    asked = [key for key in {*ERRORS, *GAZE_ERRORS} - {"seed"} if options.has(key)]
    seed = int(options.number("seed", float(seed), 0.0, float(_MOST_SEED)))
    if not asked:
        return None
    return ErrorModel(
        confusion=_confusion(options),
        noise_deg=options.number("noise_deg", 0.0, 0.0, 45.0, "deg"),
        drift_deg_per_min=options.number("drift_deg_per_min", 0.0, 0.0, 600.0, "deg/min"),
        seed=seed,
    )


def idle_seed(options: Fields) -> tuple[str, ...]:
    """Return a warning if the options have a seed, and no error that it seeds."""
    if not options.has("seed") or error_model(options) is not None:
        return ()
    seeded = [key for key in options.known if key in (*ERRORS, *GAZE_ERRORS) and key != "seed"]
    return (f"{options.place}: seed changes nothing without {', '.join((*LINK_OPTIONS, *seeded))}",)


def confuse(decision: Decision, index: int, labels: Sequence[str], model: ErrorModel) -> Decision:
    """Return a decision as the emulated decoder gives it.

    Args:
        decision: the original decision.
        index: its number in the log, which seeds the random draws.
        labels: labels it may be confused with.
        model: error parameters.
    """
    draw = np.random.default_rng((model.seed, index))
    return decision._replace(label=_confused(decision.label, labels, model, draw.random(), draw.random()))


class ConfusedFeed:
    """A decision feed with the errors of an emulated decoder."""

    def __init__(self, feed: DecisionFeed, model: ErrorModel) -> None:
        """Apply the errors of `model` to `feed`."""
        self._feed, self._model = feed, model
        self.labels: Sequence[str] = feed.labels

    @property
    def notes(self) -> Sequence[str]:
        """The notes of the feed and the emulated errors."""
        return (*self._feed.notes, f"emulated: {describe(self._model)}")

    @property
    def started(self) -> bool:
        """Whether at least one decision has been played."""
        return self._feed.started

    @property
    def ended(self) -> bool:
        """Whether all decisions have been played."""
        return self._feed.ended

    def due(self, now: float) -> list[Due]:
        """Return the decisions that became due by session time `now` [s]."""
        return [
            Due(index, confuse(decision, index, self.labels, self._model)) for index, decision in self._feed.due(now)
        ]


class GazeErrors:
    """Adds noise and drift to gaze, block by block."""

    def __init__(self, model: ErrorModel, units_per_deg: float) -> None:
        """Start at the beginning of a recording.

        Args:
            model: error parameters.
            units_per_deg: units of the points' frame per degree of visual angle.
        """
        self._model, self._units = model, units_per_deg
        self._draw = np.random.default_rng((model.seed, 0))
        angle = self._draw.uniform(0.0, 2 * np.pi)
        self._direction = np.array([np.cos(angle), np.sin(angle)])
        self._first: float | None = None

    def __call__(self, time: Floats, points: Floats) -> Floats:
        """Return the points (n, 2) at times (n,) [s] of the next block with errors."""
        if len(time) and self._first is None:
            self._first = float(time[0])
        minutes = (time - (self._first or 0.0))[:, None] / 60.0
        drift = minutes * self._model.drift_deg_per_min * self._direction
        noise = self._draw.normal(0.0, 1.0, (len(time), 2)) * self._model.noise_deg
        return floats(points + (drift + noise) * self._units)


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
                f"confusion: {label}: {shown(row)} is not a mapping from labels to probabilities of sum 1 or less"  # pyright: ignore[reportUnknownArgumentType]
            )
        rows[str(label).strip().casefold()] = good
    return rows
