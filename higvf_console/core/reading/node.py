"""A value at its place in a file: every check raises an error that names file, place, value and choices."""
# PyYAML has no types.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, NoReturn, TypeGuard

from higvf_console.core.arguments import one_of
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import HigvfError, ScenarioError, closest
from higvf_console.core.quantity import COORDINATE, Quantity, checked, shown

MOST_ITEMS = 100_000  # of a list
NOTHING_RENAMED: Mapping[str, str] = MappingProxyType({})


@dataclass(frozen=True)
class Node:
    """A value in a YAML file, or among the options of an input.

    Attributes:
        value: as it was read.
        source: the file.
        place: path of keys in it; list items count from 1, as robots and fires do.
        raises: class of the errors.
        warnings: what was read under a former name, collected from all nodes of a file.
    """

    value: Any
    source: str
    place: str = ""
    raises: type[HigvfError] = ScenarioError
    warnings: list[str] = field(default_factory=list[str], compare=False, repr=False)

    @property
    def where(self) -> str:
        """File and place."""
        return f"{self.source}: {self.place}" if self.place else self.source

    def error(self, text: str) -> HigvfError:
        """An error that starts with file and place."""
        return self.raises(f"{self.where}: {text}")

    def wrong(self, wanted: str) -> HigvfError:
        """The error that this value is not what was wanted."""
        return self.error(f"{shown(self.value)} is not {wanted}")

    def entry(self, name: str, value: Any) -> "Node":
        """A value of this mapping under the key `name`."""
        place = f"{self.place}.{name}" if self.place else name
        return Node(value, self.source, place, self.raises, self.warnings)

    def section(
        self, known: Sequence[str], required: Sequence[str] = (), renamed: Mapping[str, str] = NOTHING_RENAMED
    ) -> "dict[str, Node]":
        """The entries of a mapping by name.

        Args:
            known: every key that it may have.
            required: the keys that it must have.
            renamed: former names of known keys, each with its present name; they are read with a warning.

        Raises:
            HigvfError: of class `raises`: not a mapping, an unknown key, one given under both its names, or a required
                key that is missing.
        """
        if not isinstance(self.value, Mapping):
            raise self.wrong(f"a section with the keys {', '.join(known)}")
        entries: dict[str, Node] = {}
        for name, entry in self.mapping().items():
            current = renamed.get(name, name)
            if current not in known:
                raise entry.error(
                    f"unknown key{closest(name, known)}; value {shown(entry.value)}; known keys: {', '.join(known)}"
                )
            if current in entries:
                former = next(old for old, new in renamed.items() if new == current)
                raise entry.error(f"{former} is the former name of {current}, which is given too; remove {former}")
            if current != name:
                new = self.entry(current, None).place
                self.warnings.append(f"{entry.where}: renamed; write {new}")
            entries[current] = self.entry(current, entry.value)
        for name in required:
            if name not in entries:
                self.missing(name, known)
        return entries

    def missing(self, name: str, known: Sequence[str]) -> NoReturn:
        """Raises the error that a key is missing.

        Raises:
            HigvfError: always.
        """
        raise self.error(f"the key '{name}' is missing; known keys: {', '.join(known)}")

    def mapping(self) -> "dict[str, Node]":
        """The entries of a mapping whose keys are free.

        Raises:
            HigvfError: of class `raises`: it is none.
        """
        if not isinstance(self.value, Mapping):
            raise self.wrong("a mapping")
        values: Mapping[Any, Any] = self.value
        return {name: self.entry(str(name), value) for name, value in values.items()}

    def items(self, most: int = MOST_ITEMS) -> "list[Node]":
        """The items of a list, which may have `most` of them.

        Raises:
            HigvfError: of class `raises`: it is none, or longer.
        """
        if not isinstance(self.value, list):
            raise self.wrong("a list")
        values: list[Any] = self.value
        if len(values) > most:
            raise self.error(f"{len(values)} entries; give at most {most}")
        return [
            Node(value, self.source, f"{self.place}[{number}]", self.raises, self.warnings)
            for number, value in enumerate(values, 1)
        ]

    def number(self, quantity: Quantity) -> float:
        """A number within the range of `quantity`.

        Raises:
            HigvfError: of class `raises`: it is none, or out of range.
        """
        return checked(self.where, self.value, quantity, self.raises)

    def numbers(self, count: int, quantity: Quantity = COORDINATE) -> list[float]:
        """A list of `count` numbers within the range of `quantity`.

        Raises:
            HigvfError: of class `raises`: it is none, of another length, or a number is out of range.
        """
        if not isinstance(self.value, list) or len(self.items()) != count:
            raise self.wrong(f"a list of {count} numbers")
        return [item.number(quantity) for item in self.items()]

    def integer(self, low: int, high: int | None = None, what: str = "") -> int:
        """A whole number from `low` up, or to `high`; `what` says what it stands for.

        Raises:
            HigvfError: of class `raises`: it is none, or out of range.
        """
        value = self.value
        if isinstance(value, bool) or not isinstance(value, int) or value < low or (high is not None and value > high):
            wanted = f"a whole number from {low} " + ("up" if high is None else f"to {high}")
            raise self.wrong(f"{what}, {wanted}" if what else wanted)
        return value

    def flag(self) -> bool:
        """True or false.

        Raises:
            HigvfError: of class `raises`: it is neither.
        """
        if not isinstance(self.value, bool):
            raise self.wrong("true or false")
        return self.value

    def text(self, *, blank: bool = True) -> str:
        """A text; `blank` says whether it may be empty.

        Raises:
            HigvfError: of class `raises`: it is none, or blank.
        """
        if not isinstance(self.value, str) or not (blank or self.value.strip()):
            raise self.wrong("a text")
        return self.value

    def choice(self, words: Sequence[str], renamed: Mapping[str, str] = NOTHING_RENAMED) -> str:
        """One of `words`; a former word that is `renamed` is read with a warning.

        Raises:
            HigvfError: of class `raises`: it is none of them.
        """
        value = self.value
        if isinstance(value, str) and value in renamed:
            self.warnings.append(f"{self.where}: {value} is renamed; write {renamed[value]}")
            return renamed[value]
        return one_of(self.where, value, words, self.raises)

    def point(self) -> tuple[float, float]:
        """A ground point [x, y] in m.

        Raises:
            HigvfError: of class `raises`: it is none, or a coordinate is out of range.
        """
        if not isinstance(self.value, list) or len(self.items()) != 2:
            raise self.wrong("a point [x, y]")
        x, y = (item.number(COORDINATE) for item in self.items())
        return x, y

    def points(self, least: int = 0) -> Floats:
        """A list of at least `least` ground points, shape (n, 2) [m].

        Raises:
            HigvfError: of class `raises`: it is none, or there are fewer.
        """
        points = [item.point() for item in self.items()]
        if len(points) < least:
            raise self.error(f"{len(points)} points are too few; give at least {least}")
        return floats(points, -1, 2)


def is_number(value: object) -> TypeGuard[int | float]:
    """Whether `value` is a finite int or float; a bool is neither."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer beyond the floats
        return False
