"""Takes checked values out of options and YAML mappings: what is wrong is said with its place, value and choices."""

import math
import reprlib
from collections.abc import Mapping, Sequence
from typing import NoReturn, TypeGuard, cast

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import HigvfError, InputError
from higvf_console.core.interface import InputSpec

_NAMING = "stream marker_stream x y name type source_id host channels format calibration markers"
NAMES = frozenset(_NAMING.split())  # options that name something, which may be called by a number
_REPR = reprlib.Repr()
_REPR.maxlevel, _REPR.maxstring, _REPR.maxother = 3, 80, 80


class Fields:
    """The values of one mapping, each taken with a check of its own."""

    def __init__(
        self, values: Mapping[str, object], known: Sequence[str], place: str, error: type[HigvfError] = InputError
    ) -> None:
        """Takes a mapping whose keys are all known.

        Args:
            values: the mapping as it was read.
            known: every key that it may hold.
            place: how an error message calls it, e.g. "priority.yaml, entry 2".
            error: class of the errors raised.

        Raises:
            HigvfError: of class `error`: an unknown key; the message lists the known ones.
        """
        self.values = values
        self.place = place
        self._error = error
        for key in values:
            if key not in known:
                self.fail(f"unknown key {shown(key)}; known keys: {', '.join(known)}")

    def fail(self, text: str, error: type[HigvfError] | None = None) -> NoReturn:
        """Raises the error of this mapping, or `error`, with its place before `text`."""
        raise (error or self._error)(f"{self.place}: {text}")

    def has(self, key: str) -> bool:
        """Whether `key` is given."""
        return key in self.values

    def number(self, key: str, default: float | None, low: float, high: float, unit: str = "") -> float:
        """A finite number in [low, high]; `default` None makes it required."""
        if key not in self.values and default is not None:
            return default
        value = self._required(key)
        if not is_number(value) or not low <= value <= high:
            self.fail(f"{key}: {shown(value)} is not a number from {low:g} to {high:g} {unit}".rstrip())
        return float(value)

    def whole(self, key: str, low: int) -> int:
        """A required whole number, at least `low`."""
        value = self._required(key)
        if isinstance(value, bool) or not isinstance(value, int) or value < low:
            self.fail(f"{key}: {shown(value)} is not a whole number from {low} up")
        return value

    def flag(self, key: str, default: bool | None = None) -> bool:
        """True or false; `default` None makes it required."""
        if key not in self.values and default is not None:
            return default
        value = self._required(key)
        if not isinstance(value, bool):
            self.fail(f"{key}: {shown(value)} is neither true nor false")
        return bool(value)

    def choice(self, key: str, default: str, choices: Sequence[str]) -> str:
        """One of `choices`."""
        value = self.values.get(key, default)
        if value not in choices:
            self.fail(f"{key}: {shown(value)} is not one of {', '.join(choices)}")
        return str(value)

    def text(self, key: str) -> str:
        """A required, non-empty text."""
        value = self._required(key)
        if not isinstance(value, str) or not value.strip():
            self.fail(f"{key}: {shown(value)} is not a text")
        return value

    def mapping(self, key: str) -> Mapping[str, object]:
        """A mapping; empty where `key` is not given."""
        value = self.values.get(key, {})
        if not isinstance(value, dict):
            self.fail(f"{key}: {shown(value)} is not a mapping")
        return cast(dict[str, object], value)

    def items(self, key: str) -> list[object]:
        """A list; empty where `key` is not given."""
        value = self.values.get(key, [])
        if not isinstance(value, list):
            self.fail(f"{key}: {shown(value)} is not a list")
        return cast(list[object], value)

    def numbers(self, key: str, count: int) -> list[float]:
        """A required list of `count` finite numbers."""
        value = self._required(key)
        if not (isinstance(value, list) and len(value) == count and all(is_number(item) for item in value)):
            self.fail(f"{key}: {shown(value)} is not a list of {count} numbers")
        return [float(item) for item in cast(list[float], value)]

    def points(self, key: str) -> Floats:
        """Required ground points (n, 2) [m], n >= 1."""
        value = self._required(key)
        if not isinstance(value, list) or not value:
            self.fail(f"{key}: {shown(value)} is not a list of points [x, y]")
        for number, point in enumerate(cast(list[object], value), start=1):
            if not (isinstance(point, list) and len(point) == 2 and all(is_number(part) for part in point)):
                self.fail(f"{key}: point {number}: {shown(point)} is not [x, y] in metres")
        return floats(cast(list[list[float]], value))

    def _required(self, key: str) -> object:
        if key not in self.values:
            self.fail(f"{key} is missing")
        return self.values[key]


def shown(value: object) -> str:
    """`value` as a message shows it, shortened where it is long."""
    return _REPR.repr(value)


def is_number(value: object) -> TypeGuard[int | float]:
    """Whether `value` is a finite int or float (a bool is neither)."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer beyond the floats
        return False


def option_fields(spec: InputSpec, known: Sequence[str]) -> Fields:
    """An input's options: those of the command line over those of the scenario; a text that is a number becomes one.

    The options `NAMES` stay texts.
    """
    place = f"input {spec.channel}={spec.source}" if spec.source else f"input {spec.channel}"
    return Fields({**spec.settings, **{key: _typed(key, text) for key, text in spec.options.items()}}, known, place)


def _typed(key: str, text: str) -> object:
    if key in NAMES:
        return text
    try:
        return float(text)
    except ValueError:
        return text
