"""The entries of one mapping, options or YAML, taken with a default where they may be missing.

The checks and their messages are those of `core.reading.node`.
"""

from collections.abc import Mapping, Sequence
from typing import NoReturn

from higvf_console.core.arrays import Floats
from higvf_console.core.errors import HigvfError, InputError
from higvf_console.core.interface import InputSpec
from higvf_console.core.quantity import Quantity, shown
from higvf_console.core.reading.node import NOTHING_RENAMED, Node, is_number

__all__ = ["NAMES", "Fields", "is_number", "option_fields", "shown"]

_NAMING = "stream marker_stream x y name type source_id host channels format calibration markers"
NAMES = frozenset(_NAMING.split())  # options that name something, which may be called by a number


class Fields:
    """The values of one mapping, each taken with a check of its own."""

    def __init__(
        self, values: Mapping[str, object], known: Sequence[str], place: str, error: type[HigvfError] = InputError
    ) -> None:
        """Takes a mapping whose keys are all known.

        Args:
            values: the mapping as it was read.
            known: every key that it may hold.
            place: how an error message calls it, e.g. "input gaze".
            error: class of the errors raised.

        Raises:
            HigvfError: of class `error`: an unknown key; the message lists the known ones.
        """
        self._take(Node(values, place, raises=error), known, NOTHING_RENAMED)

    @classmethod
    def of(cls, node: Node, known: Sequence[str], renamed: Mapping[str, str] = NOTHING_RENAMED) -> "Fields":
        """The entries of a node, see `Node.section`."""
        fields = cls.__new__(cls)
        fields._take(node, known, renamed)
        return fields

    def _take(self, node: Node, known: Sequence[str], renamed: Mapping[str, str]) -> None:
        self.node = node
        self.known = known
        self.entries = node.section(known, renamed=renamed)

    @property
    def values(self) -> dict[str, object]:
        """The values as they were read."""
        return {name: entry.value for name, entry in self.entries.items()}

    @property
    def place(self) -> str:
        """How an error message calls the mapping."""
        return self.node.where

    def fail(self, text: str, error: type[HigvfError] | None = None) -> NoReturn:
        """Raises the error of this mapping, or `error`, with its place before `text`."""
        raise (error or self.node.raises)(f"{self.place}: {text}")

    def has(self, key: str) -> bool:
        """Whether `key` is given."""
        return key in self.entries

    def required(self, key: str) -> Node:
        """The entry `key`.

        Raises:
            HigvfError: it is missing.
        """
        if key not in self.entries:
            self.node.missing(key, self.known)
        return self.entries[key]

    def number(self, key: str, default: float | None, low: float, high: float, unit: str = "") -> float:
        """A number in [low, high]; `default` None makes it required."""
        if key not in self.entries and default is not None:
            return default
        return self.required(key).number(Quantity(unit, low, high, "", ""))

    def whole(self, key: str, low: int) -> int:
        """A required whole number, at least `low`."""
        return self.required(key).integer(low)

    def flag(self, key: str, default: bool | None = None) -> bool:
        """True or false; `default` None makes it required."""
        if key not in self.entries and default is not None:
            return default
        return self.required(key).flag()

    def choice(
        self, key: str, default: str, choices: Sequence[str], renamed: Mapping[str, str] = NOTHING_RENAMED
    ) -> str:
        """One of `choices`."""
        return self.entries[key].choice(choices, renamed) if key in self.entries else default

    def text(self, key: str) -> str:
        """A required, non-empty text."""
        return self.required(key).text(blank=False)

    def mapping(self, key: str) -> Mapping[str, object]:
        """A mapping; empty where `key` is not given."""
        if key not in self.entries:
            return {}
        return {name: entry.value for name, entry in self.entries[key].mapping().items()}

    def items(self, key: str) -> list[object]:
        """A list; empty where `key` is not given."""
        return [item.value for item in self.nodes(key)]

    def nodes(self, key: str) -> list[Node]:
        """The items of a list with their places; none where `key` is not given."""
        return self.entries[key].items() if key in self.entries else []

    def numbers(self, key: str, count: int) -> list[float]:
        """A required list of `count` numbers."""
        return self.required(key).numbers(count)

    def points(self, key: str) -> Floats:
        """Required ground points (n, 2) [m], n >= 1."""
        return self.required(key).points(least=1)


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
