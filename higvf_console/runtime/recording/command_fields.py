"""Commands as lines of a recording, and back: every field has the type that the command declares.

Numbers that JSON does not have are written as {"number": "inf"}; null in an array is NaN. Version 0.1 wrote the same
with other names of some commands, which are still read (`_RENAMED`).
"""

import dataclasses
import math
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, get_args, get_type_hints

import numpy as np

from higvf_console.core.arguments import brief
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import Command, OperatorCommand
from higvf_console.core.errors import closest

_KINDS: dict[str, type[Command]] = {kind.__name__: kind for kind in get_args(OperatorCommand)}
_SHAPES = {"points": (-1, 2), "point": (2,), "grip": (2,), "sides": (4,)}  # of fields that hold an array
_NUMBER = "number"
_RENAMED = {
    "Stop": "EmergencyStop", "ResetStop": "ResetEmergencyStop", "BendPath": "MovePathPoint", "AddThing": "AddEntity",
    "MoveThing": "MoveEntity", "ChangeThing": "ChangeEntity", "DeleteThing": "DeleteEntity",
}  # fmt: skip
_OF_ENTITIES = ("AddEntity", "MoveEntity", "ChangeEntity", "DeleteEntity")  # their `kind` was `thing`
_RENAMED_USES = {"amend": "redraw"}  # of StrokeEnd


def written(command: OperatorCommand) -> dict[str, Any]:
    """The name and the fields of a command as JSON has them."""
    fields = {field.name: _plain(getattr(command, field.name)) for field in dataclasses.fields(command)}
    return {"command": type(command).__name__, **fields}


def read(entry: Mapping[str, Any]) -> OperatorCommand:
    """The command that was written.

    Args:
        entry: its name, its fields, and the tick, which is not looked at.

    Raises:
        ValueError: an unknown command or field, a field that is missing, or a value of another type.
    """
    name = entry.get("command")
    name = _RENAMED.get(name, name) if isinstance(name, str) else name
    if not isinstance(name, str) or name not in _KINDS:
        raise ValueError(f"no command {brief(name)} is known{closest(str(name), tuple(_KINDS))}")
    fields = {key: value for key, value in entry.items() if key not in ("tick", "command")}
    if name in _OF_ENTITIES and "thing" in fields:
        fields["kind"] = fields.pop("thing")
    if name == "StrokeEnd" and isinstance(use := fields.get("use"), str):
        fields["use"] = _RENAMED_USES.get(use, use)
    readers = _readers(name)
    for key in fields:
        if key not in readers:
            raise ValueError(f"{name} has no field '{key}'; it has {', '.join(readers)}")
    try:
        return _KINDS[name](**{key: readers[key](value) for key, value in fields.items()})  # pyright: ignore[reportReturnType] (the members of the union)
    except TypeError as error:  # a field is missing
        raise ValueError(str(error).partition(") ")[2] or str(error)) from error


@cache
def _readers(name: str) -> dict[str, Callable[[Any], Any]]:
    """How each field of a command is read."""
    hints = get_type_hints(_KINDS[name])
    return {field.name: _reader(field.name, hints[field.name]) for field in dataclasses.fields(_KINDS[name])}


def _reader(field: str, hint: Any) -> Callable[[Any], Any]:
    optional = type(None) in get_args(hint)
    kind = next(part for part in get_args(hint) if part is not type(None)) if optional else hint
    convert, wanted = _CONVERTERS.get(kind, (lambda value: _array(value, _SHAPES[field]), "an array of numbers"))

    def read_one(value: Any) -> Any:
        if optional and value is None:
            return None
        try:
            return convert(value)
        except (TypeError, ValueError, OverflowError, AttributeError) as error:
            raise ValueError(f"{field} is {brief(value)}; expected {wanted}") from error

    return read_one


def _exactly(kind: type) -> Callable[[Any], Any]:
    def convert(value: Any) -> Any:
        if type(value) is not kind:
            raise TypeError
        return value

    return convert


def _number(value: Any) -> float:
    if isinstance(value, dict):
        (value,) = [text for key, text in value.items() if key == _NUMBER and isinstance(text, str)]  # pyright: ignore[reportUnknownVariableType]
    elif type(value) not in (int, float):
        raise TypeError
    return float(value)


def _array(value: Any, shape: tuple[int, ...]) -> Floats:
    return floats([math.nan if item is None else _number(item) for item in value], *shape)


def _chains(value: Any) -> tuple[Floats, ...]:
    return tuple(_array(chain, (-1, 2)) for chain in _listed(value))


def _whole_numbers(value: Any) -> tuple[int, ...]:
    return tuple(_exactly(int)(item) for item in _listed(value))


def _listed(value: Any) -> list[Any]:
    return _exactly(list)(value)


_CONVERTERS: dict[Any, tuple[Callable[[Any], Any], str]] = {
    str: (_exactly(str), "text"),
    int: (_exactly(int), "a whole number"),
    bool: (_exactly(bool), "true or false"),
    float: (_number, "a number"),
    tuple[Floats, ...]: (_chains, "a list of arrays of numbers"),
    tuple[int, ...]: (_whole_numbers, "a list of whole numbers"),
    Mapping[str, float]: (lambda value: {key: _number(item) for key, item in value.items()}, "numbers by name"),
}


def _plain(value: Any) -> Any:
    """A field's value as JSON has it."""
    match value:
        case np.ndarray():
            array: Floats = value  # pyright: ignore[reportUnknownVariableType]
            return [None if np.isnan(number) else _plain(number) for number in array.ravel().tolist()]
        case tuple() | list():
            return [_plain(item) for item in value]  # pyright: ignore[reportUnknownVariableType]
        case Mapping():
            return {name: _plain(item) for name, item in value.items()}  # pyright: ignore[reportUnknownVariableType]
        case np.generic():
            return _plain(value.item())
        case float() if not math.isfinite(value):
            return {_NUMBER: str(value)}
        case _:
            return value
